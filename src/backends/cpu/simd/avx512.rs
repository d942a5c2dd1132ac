//! The instructions of AVX-512 F.
#![expect(clippy::inline_always, reason = "kernels must inline into the function compiled for wider vectors")]
#![expect(
    unsafe_code,
    reason = "a function compiled for more than the baseline may run only where the processor has it"
)]

use std::arch::x86_64::__m512;

use super::Simd;
use crate::optics::{Lanes, Mask};

/// By the instructions of AVX-512 F, on a processor that has them.
#[derive(Clone, Copy, Debug)]
pub(in crate::backends::cpu) struct ByAvx512(());

impl ByAvx512 {
    /// # Safety
    /// The processor must have AVX-512 F.
    pub(in crate::backends::cpu) unsafe fn new() -> Self {
        Self(())
    }
}

impl Simd for ByAvx512 {
    type Vector = __m512;

    #[inline(always)]
    fn load(self, from: &Lanes) -> Self::Vector {
        bytemuck::cast(*from)
    }

    #[inline(always)]
    fn store(self, vector: Self::Vector, to: &mut Lanes) {
        *to = bytemuck::cast(vector);
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Self::Vector {
        // SAFETY: whoever made `self` vouched for the processor.
        unsafe { kernels::splat(value) }
    }

    #[inline(always)]
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::add(a, b) }
    }

    #[inline(always)]
    fn mul(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::mul(a, b) }
    }

    #[inline(always)]
    fn abs(self, a: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::abs(a) }
    }

    #[inline(always)]
    fn min(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::min(a, b) }
    }

    #[inline(always)]
    fn max(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::max(a, b) }
    }

    #[inline(always)]
    fn splat_mask(self, mask: u32) -> Self::Vector {
        self.splat(f32::from_bits(mask))
    }

    #[inline(always)]
    fn select(self, mask: Self::Vector, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::select(mask, a, b) }
    }

    #[inline(always)]
    fn bits_where_less(self, a: Self::Vector, b: Self::Vector) -> u16 {
        // SAFETY: as above.
        unsafe { kernels::bits_where_less(a, b) }
    }

    #[inline(always)]
    fn pack(self, lanes: u16, from: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { kernels::pack(lanes, from) }
    }

    #[inline(always)]
    fn bits(self, mask: &Mask) -> u16 {
        // SAFETY: as above.
        unsafe { kernels::bits(mask) }
    }

    #[inline(always)]
    fn compress(self, lanes: u16, from: &Lanes) -> Lanes {
        // SAFETY: as above.
        unsafe { kernels::compress(lanes, from) }
    }

    #[inline(always)]
    fn expand(self, lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes {
        // SAFETY: as above.
        unsafe { kernels::expand(lanes, packed, elsewhere) }
    }

    #[inline(always)]
    fn put(self, lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes {
        // SAFETY: as above.
        unsafe { kernels::put(lanes, value, elsewhere) }
    }
}

mod kernels {
    use std::arch::x86_64::{
        __m512, __m512i, _CMP_LT_OQ, _mm512_abs_ps, _mm512_add_ps, _mm512_cmp_ps_mask, _mm512_mask_expand_ps,
        _mm512_mask_mov_ps, _mm512_maskz_compress_ps, _mm512_max_ps, _mm512_min_ps, _mm512_mul_ps, _mm512_set1_ps,
        _mm512_ternarylogic_epi32, _mm512_test_epi32_mask,
    };

    use crate::optics::{Lanes, Mask};

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn splat(value: f32) -> __m512 {
        _mm512_set1_ps(value)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn add(a: __m512, b: __m512) -> __m512 {
        _mm512_add_ps(a, b)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn mul(a: __m512, b: __m512) -> __m512 {
        _mm512_mul_ps(a, b)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn abs(a: __m512) -> __m512 {
        _mm512_abs_ps(a)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn min(a: __m512, b: __m512) -> __m512 {
        _mm512_min_ps(a, b)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn max(a: __m512, b: __m512) -> __m512 {
        _mm512_max_ps(a, b)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn select(mask: __m512, a: __m512, b: __m512) -> __m512 {
        // (mask & a) | (!mask & b), as a table of the three bits.
        const CHOOSE: i32 = 0b1100_1010;
        let [mask, a, b] = [mask, a, b].map(bytemuck::cast::<_, __m512i>);
        bytemuck::cast(_mm512_ternarylogic_epi32::<CHOOSE>(mask, a, b))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn bits_where_less(a: __m512, b: __m512) -> u16 {
        _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn pack(lanes: u16, from: __m512) -> __m512 {
        _mm512_maskz_compress_ps(lanes, from)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn bits(mask: &Mask) -> u16 {
        let mask = bytemuck::cast::<_, __m512i>(*mask);
        _mm512_test_epi32_mask(mask, mask)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn compress(lanes: u16, from: &Lanes) -> Lanes {
        bytemuck::cast(_mm512_maskz_compress_ps(lanes, bytemuck::cast::<_, __m512>(*from)))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn expand(lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes {
        let elsewhere = _mm512_set1_ps(elsewhere);
        bytemuck::cast(_mm512_mask_expand_ps(elsewhere, lanes, bytemuck::cast::<_, __m512>(*packed)))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    pub(super) fn put(lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes {
        bytemuck::cast(_mm512_mask_mov_ps(bytemuck::cast::<_, __m512>(*elsewhere), lanes, _mm512_set1_ps(value)))
    }
}
