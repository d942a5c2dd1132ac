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
        // SAFETY: whoever made `self` vouched for the processor.
        unsafe { kernels::load(from) }
    }

    #[inline(always)]
    fn store(self, vector: Self::Vector, to: &mut Lanes) {
        // SAFETY: as above.
        unsafe { kernels::store(vector, to) }
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Self::Vector {
        // SAFETY: as above.
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
        __m256, __m256i, _CMP_LT_OQ, _mm_loadl_epi64, _mm256_add_ps, _mm256_and_si256, _mm256_andnot_ps,
        _mm256_blendv_ps, _mm256_castsi256_ps, _mm256_cmp_ps, _mm256_cmpeq_epi32, _mm256_cvtepu8_epi32,
        _mm256_loadu_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_permutevar8x32_ps,
        _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32, _mm256_storeu_ps,
    };

    use super::super::{LANE_FROM_PACKED, PACKED_FROM_LANE};
    use crate::optics::{LANES, Lanes, Mask};

    type Vector = [__m256; 2];

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn load(from: &Lanes) -> Vector {
        let (low, high) = from.split_at(8);
        // SAFETY: eight numbers are read from either half.
        unsafe { [_mm256_loadu_ps(low.as_ptr()), _mm256_loadu_ps(high.as_ptr())] }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn store(vector: Vector, to: &mut Lanes) {
        let (low, high) = to.split_at_mut(8);
        // SAFETY: eight numbers are written to either half.
        unsafe {
            _mm256_storeu_ps(low.as_mut_ptr(), vector[0]);
            _mm256_storeu_ps(high.as_mut_ptr(), vector[1]);
        }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn stored(vector: Vector) -> Lanes {
        let mut to = [0.0; LANES];
        store(vector, &mut to);
        to
    }

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
        let low = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a[0], b[0]));
        let high = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a[1], b[1]));
        (low | high << 8) as u16
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn pack(lanes: u16, from: Vector) -> Vector {
        let [low, high] = lanes.to_le_bytes();
        let mut to = [0.0; LANES];
        let middle = (low.count_ones() as usize).min(8);
        // SAFETY: eight numbers are written to the first eight of sixteen, and then to eight from the ninth or an earlier one on.
        unsafe {
            let packed = _mm256_permutevar8x32_ps(from[0], indices(&LANE_FROM_PACKED[low as usize]));
            _mm256_storeu_ps(to.as_mut_ptr(), packed);
            let packed = _mm256_permutevar8x32_ps(from[1], indices(&LANE_FROM_PACKED[high as usize]));
            _mm256_storeu_ps(to.as_mut_ptr().add(middle), packed);
        }
        load(&to)
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn bits(mask: &Mask) -> u16 {
        let [low, high] = load(bytemuck::cast_ref(mask));
        (_mm256_movemask_ps(low) | _mm256_movemask_ps(high) << 8) as u16
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn indices(of: &[u8; 8]) -> __m256i {
        // SAFETY: eight bytes are read from eight.
        _mm256_cvtepu8_epi32(unsafe { _mm_loadl_epi64(of.as_ptr().cast()) })
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn compress(lanes: u16, from: &Lanes) -> Lanes {
        stored(pack(lanes, load(from)))
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn expand(lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes {
        let [low, high] = lanes.to_le_bytes();
        let middle = (low.count_ones() as usize).min(8);
        let elsewhere = _mm256_set1_ps(elsewhere);
        // SAFETY: eight numbers are read from the first of sixteen on, and from the ninth or an earlier one on.
        let (first, second) =
            unsafe { (_mm256_loadu_ps(packed.as_ptr()), _mm256_loadu_ps(packed.as_ptr().add(middle))) };
        let first = _mm256_permutevar8x32_ps(first, indices(&PACKED_FROM_LANE[low as usize]));
        let second = _mm256_permutevar8x32_ps(second, indices(&PACKED_FROM_LANE[high as usize]));
        stored([_mm256_blendv_ps(elsewhere, first, mask_of(low)), _mm256_blendv_ps(elsewhere, second, mask_of(high))])
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn put(lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes {
        let [low, high] = lanes.to_le_bytes();
        let (elsewhere, value) = (load(elsewhere), _mm256_set1_ps(value));
        stored([
            _mm256_blendv_ps(elsewhere[0], value, mask_of(low)),
            _mm256_blendv_ps(elsewhere[1], value, mask_of(high)),
        ])
    }

    /// All bits of the lanes whose bit is set.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn mask_of(lanes: u8) -> __m256 {
        let bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(i32::from(lanes)), bit), bit))
    }
}
