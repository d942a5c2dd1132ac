//! The instructions of AVX2.
#![expect(clippy::inline_always, reason = "kernels must inline into the function compiled for wider vectors")]
#![expect(
    unsafe_code,
    reason = "a function compiled for more than the baseline may run only where the processor has it"
)]

use std::arch::x86_64::__m256;

use super::Simd;
use crate::optics::{Lanes, Mask};

/// By the instructions of AVX2, on a processor that has them.
#[derive(Clone, Copy, Debug)]
pub(in crate::backends::cpu) struct ByAvx2(());

impl ByAvx2 {
    /// # Safety
    /// The processor must have AVX2.
    pub(in crate::backends::cpu) unsafe fn new() -> Self {
        Self(())
    }
}

impl Simd for ByAvx2 {
    type Vector = [__m256; 2];

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
        __m128i, __m256, __m256i, _CMP_LT_OQ, _mm256_add_ps, _mm256_and_si256, _mm256_andnot_ps, _mm256_blendv_ps,
        _mm256_castsi256_ps, _mm256_cmp_ps, _mm256_cmpeq_epi32, _mm256_cvtepu8_epi32, _mm256_max_ps, _mm256_min_ps,
        _mm256_movemask_ps, _mm256_mul_ps, _mm256_permutevar8x32_ps, _mm256_set1_epi32, _mm256_set1_ps,
    };

    use super::super::{LANE_FROM_PACKED, PACKED_FROM_LANE};
    use crate::optics::{LANES, Lanes, Mask};

    type Vector = [__m256; 2];

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn splat(value: f32) -> Vector {
        [_mm256_set1_ps(value); 2]
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn add(a: Vector, b: Vector) -> Vector {
        [_mm256_add_ps(a[0], b[0]), _mm256_add_ps(a[1], b[1])]
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn mul(a: Vector, b: Vector) -> Vector {
        [_mm256_mul_ps(a[0], b[0]), _mm256_mul_ps(a[1], b[1])]
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn abs(a: Vector) -> Vector {
        let sign = _mm256_set1_ps(-0.0);
        [_mm256_andnot_ps(sign, a[0]), _mm256_andnot_ps(sign, a[1])]
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn min(a: Vector, b: Vector) -> Vector {
        [_mm256_min_ps(a[0], b[0]), _mm256_min_ps(a[1], b[1])]
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn max(a: Vector, b: Vector) -> Vector {
        [_mm256_max_ps(a[0], b[0]), _mm256_max_ps(a[1], b[1])]
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn select(mask: Vector, a: Vector, b: Vector) -> Vector {
        [_mm256_blendv_ps(b[0], a[0], mask[0]), _mm256_blendv_ps(b[1], a[1], mask[1])]
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn bits_where_less(a: Vector, b: Vector) -> u16 {
        let half = |k: usize| _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a[k], b[k]));
        (half(0) | half(1) << 8) as u16
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn pack(lanes: u16, from: Vector) -> Vector {
        bytemuck::cast(compress(lanes, &bytemuck::cast(from)))
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn bits(mask: &Mask) -> u16 {
        let [low, high] = bytemuck::cast::<_, [__m256; 2]>(*mask);
        (_mm256_movemask_ps(low) | _mm256_movemask_ps(high) << 8) as u16
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn indices(of: [u8; 8]) -> __m256i {
        _mm256_cvtepu8_epi32(bytemuck::cast::<_, __m128i>([of, [0; 8]]))
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn compress(lanes: u16, from: &Lanes) -> Lanes {
        let [low, high] = lanes.to_le_bytes();
        let [from_low, from_high] = bytemuck::cast::<_, [__m256; 2]>(*from);
        let low_order = indices(LANE_FROM_PACKED[low as usize]);
        let high_order = indices(LANE_FROM_PACKED[high as usize]);
        let mut to = [0.0; LANES];
        to[..8].copy_from_slice(&bytemuck::cast::<_, [f32; 8]>(_mm256_permutevar8x32_ps(from_low, low_order)));
        let middle = low.count_ones() as usize;
        to[middle.min(8)..][..8]
            .copy_from_slice(&bytemuck::cast::<_, [f32; 8]>(_mm256_permutevar8x32_ps(from_high, high_order)));
        to
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn expand(lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes {
        let [low, high] = lanes.to_le_bytes();
        let mut from_high = [0.0; 8];
        from_high.copy_from_slice(&packed[(low.count_ones() as usize).min(8)..][..8]);
        let half = |lanes: u8, from: [f32; 8]| {
            let from = bytemuck::cast::<_, __m256>(from);
            let moved = _mm256_permutevar8x32_ps(from, indices(PACKED_FROM_LANE[lanes as usize]));
            _mm256_blendv_ps(_mm256_set1_ps(elsewhere), moved, _mm256_castsi256_ps(mask_of(lanes)))
        };
        let mut from_low = [0.0; 8];
        from_low.copy_from_slice(&packed[..8]);
        bytemuck::cast([half(low, from_low), half(high, from_high)])
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn put(lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes {
        let [low, high] = lanes.to_le_bytes();
        let [in_low, in_high] = bytemuck::cast::<_, Vector>(*elsewhere);
        let half = |lanes: u8, elsewhere: __m256| {
            _mm256_blendv_ps(elsewhere, _mm256_set1_ps(value), _mm256_castsi256_ps(mask_of(lanes)))
        };
        bytemuck::cast([half(low, in_low), half(high, in_high)])
    }

    /// All bits of the lanes whose bit is set.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn mask_of(lanes: u8) -> __m256i {
        let bit = bytemuck::cast::<_, __m256i>([1_u32, 2, 4, 8, 16, 32, 64, 128]);
        _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(i32::from(lanes)), bit), bit)
    }
}
