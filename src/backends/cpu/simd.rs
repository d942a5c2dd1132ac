//! Sixteen lanes in the registers of an instruction set: what is added, compared and chosen in them, chosen lanes moved together, and
//! back. One or two instructions each where the processor has them, a loop elsewhere, the same bits.
//!
//! Loops over plain arrays become the same instructions where they are short; where a loop needs all registers there are, the
//! compiler is better told which they are.
#![expect(
    unsafe_code,
    reason = "a function compiled for more than the baseline may run only where the processor has it"
)]
#![expect(clippy::inline_always, reason = "kernels must inline into the function compiled for wider vectors")]

use crate::optics::lanes;
use crate::optics::{LANES, Lanes, Mask};

/// What an instruction set does with sixteen lanes.
pub(super) trait Simd: Copy {
    /// Sixteen numbers in registers.
    type Vector: Copy;

    fn load(self, from: &Lanes) -> Self::Vector;
    fn store(self, vector: Self::Vector, to: &mut Lanes);
    /// One number in all lanes.
    fn splat(self, value: f32) -> Self::Vector;
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn mul(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn abs(self, a: Self::Vector) -> Self::Vector;
    /// As [`lanes::min`].
    fn min(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// As [`lanes::max`].
    fn max(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// All bits of all lanes set, or none.
    fn splat_mask(self, mask: u32) -> Self::Vector;
    /// `a` where the bits of `mask` are set, `b` elsewhere.
    fn select(self, mask: Self::Vector, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// One bit for each lane in which a < b.
    fn bits_where_less(self, a: Self::Vector, b: Self::Vector) -> u16;
    /// The lanes whose bit is set, moved together to the front; anything after them.
    fn pack(self, lanes: u16, from: Self::Vector) -> Self::Vector;

    /// One bit for each lane of the mask that is set.
    fn bits(self, mask: &Mask) -> u16;
    /// The lanes whose bit is set, moved together to the front; anything after them.
    fn compress(self, lanes: u16, from: &Lanes) -> Lanes;
    /// The reverse: the first numbers of `packed` in the lanes whose bit is set, `elsewhere` in the others.
    fn expand(self, lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes;
    /// Puts one number in the lanes whose bit is set.
    fn put(self, lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes;
}

/// For each pattern of eight lanes, the set ones in order, then zeros.
static LANE_FROM_PACKED: [[u8; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut lanes = 0;
    while lanes < 256 {
        let (mut lane, mut len) = (0, 0);
        while lane < 8 {
            if lanes >> lane & 1 == 1 {
                table[lanes][len] = lane as u8;
                len += 1;
            }
            lane += 1;
        }
        lanes += 1;
    }
    table
};

/// For each pattern of eight lanes and each lane, how many set ones come before it.
static PACKED_FROM_LANE: [[u8; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut lanes = 0;
    while lanes < 256 {
        let mut lane = 1;
        while lane < 8 {
            table[lanes][lane] = table[lanes][lane - 1] + (lanes >> (lane - 1) & 1) as u8;
            lane += 1;
        }
        lanes += 1;
    }
    table
};

/// Lane by lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct ByLane;

/// Lane by lane: the same for two vectors.
#[inline(always)]
fn each(a: Lanes, b: Lanes, of: impl Fn(f32, f32) -> f32) -> Lanes {
    let mut result = [0.0; LANES];
    for i in 0..LANES {
        result[i] = of(a[i], b[i]);
    }
    result
}

impl Simd for ByLane {
    type Vector = Lanes;

    #[inline(always)]
    fn load(self, from: &Lanes) -> Lanes {
        *from
    }

    #[inline(always)]
    fn store(self, vector: Lanes, to: &mut Lanes) {
        *to = vector;
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Lanes {
        [value; LANES]
    }

    #[inline(always)]
    fn add(self, a: Lanes, b: Lanes) -> Lanes {
        each(a, b, |a, b| a + b)
    }

    #[inline(always)]
    fn mul(self, a: Lanes, b: Lanes) -> Lanes {
        each(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn abs(self, a: Lanes) -> Lanes {
        each(a, a, |a, _| a.abs())
    }

    #[inline(always)]
    fn min(self, a: Lanes, b: Lanes) -> Lanes {
        each(a, b, lanes::min)
    }

    #[inline(always)]
    fn max(self, a: Lanes, b: Lanes) -> Lanes {
        each(a, b, lanes::max)
    }

    #[inline(always)]
    fn splat_mask(self, mask: u32) -> Lanes {
        [f32::from_bits(mask); LANES]
    }

    #[inline(always)]
    fn select(self, mask: Lanes, a: Lanes, b: Lanes) -> Lanes {
        let mut result = [0.0; LANES];
        for i in 0..LANES {
            result[i] = lanes::select(mask[i].to_bits(), a[i], b[i]);
        }
        result
    }

    #[inline(always)]
    fn bits_where_less(self, a: Lanes, b: Lanes) -> u16 {
        let mut is_less = [0; LANES];
        for i in 0..LANES {
            is_less[i] = lanes::mask(a[i] < b[i]);
        }
        self.bits(&is_less)
    }

    #[inline(always)]
    fn pack(self, lanes: u16, from: Lanes) -> Lanes {
        self.compress(lanes, &from)
    }

    #[inline(always)]
    fn bits(self, mask: &Mask) -> u16 {
        mask.iter().enumerate().fold(0, |bits, (lane, mask)| bits | mask & 1 << lane) as u16
    }

    #[inline(always)]
    fn compress(self, lanes: u16, from: &Lanes) -> Lanes {
        let [low, high] = lanes.to_le_bytes();
        let (low_order, high_order) = (&LANE_FROM_PACKED[low as usize], &LANE_FROM_PACKED[high as usize]);
        let mut to = [0.0; LANES + 8];
        let middle = low.count_ones() as usize;
        for i in 0..8 {
            to[i] = from[low_order[i] as usize % 8];
        }
        for i in 0..8 {
            to[middle % 9 + i] = from[8 + high_order[i] as usize % 8];
        }
        let mut packed = [0.0; LANES];
        packed.copy_from_slice(&to[..LANES]);
        packed
    }

    #[inline(always)]
    fn expand(self, lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes {
        let [low, high] = lanes.to_le_bytes();
        let (low_order, high_order) = (&PACKED_FROM_LANE[low as usize], &PACKED_FROM_LANE[high as usize]);
        let middle = low.count_ones() as usize;
        let mut to = [0.0; LANES];
        for i in 0..8 {
            to[i] = packed[low_order[i] as usize % 8];
            to[8 + i] = packed[(middle + high_order[i] as usize) % LANES];
        }
        for (lane, to) in to.iter_mut().enumerate() {
            *to = if lanes >> lane & 1 == 1 { *to } else { elsewhere };
        }
        to
    }

    #[inline(always)]
    fn put(self, lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes {
        let mut to = *elsewhere;
        for (lane, to) in to.iter_mut().enumerate() {
            *to = if lanes >> lane & 1 == 1 { value } else { *to };
        }
        to
    }
}

/// By the instructions of AVX2, on a processor that has them.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug)]
pub(super) struct ByAvx2(());

#[cfg(target_arch = "x86_64")]
impl ByAvx2 {
    /// # Safety
    /// The processor must have AVX2.
    pub(super) unsafe fn new() -> Self {
        Self(())
    }
}

#[cfg(target_arch = "x86_64")]
impl Simd for ByAvx2 {
    type Vector = [std::arch::x86_64::__m256; 2];

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
        unsafe { avx2::splat(value) }
    }

    #[inline(always)]
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx2::add(a, b) }
    }

    #[inline(always)]
    fn mul(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx2::mul(a, b) }
    }

    #[inline(always)]
    fn abs(self, a: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx2::abs(a) }
    }

    #[inline(always)]
    fn min(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx2::min(a, b) }
    }

    #[inline(always)]
    fn max(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx2::max(a, b) }
    }

    #[inline(always)]
    fn splat_mask(self, mask: u32) -> Self::Vector {
        self.splat(f32::from_bits(mask))
    }

    #[inline(always)]
    fn select(self, mask: Self::Vector, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx2::select(mask, a, b) }
    }

    #[inline(always)]
    fn bits_where_less(self, a: Self::Vector, b: Self::Vector) -> u16 {
        // SAFETY: as above.
        unsafe { avx2::bits_where_less(a, b) }
    }

    #[inline(always)]
    fn pack(self, lanes: u16, from: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx2::pack(lanes, from) }
    }

    #[inline(always)]
    fn bits(self, mask: &Mask) -> u16 {
        // SAFETY: as above.
        unsafe { avx2::bits(mask) }
    }

    #[inline(always)]
    fn compress(self, lanes: u16, from: &Lanes) -> Lanes {
        // SAFETY: as above.
        unsafe { avx2::compress(lanes, from) }
    }

    #[inline(always)]
    fn expand(self, lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes {
        // SAFETY: as above.
        unsafe { avx2::expand(lanes, packed, elsewhere) }
    }

    #[inline(always)]
    fn put(self, lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes {
        // SAFETY: as above.
        unsafe { avx2::put(lanes, value, elsewhere) }
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{
        __m128i, __m256, __m256i, _CMP_LT_OQ, _mm256_add_ps, _mm256_and_si256, _mm256_andnot_ps, _mm256_blendv_ps,
        _mm256_castsi256_ps, _mm256_cmp_ps, _mm256_cmpeq_epi32, _mm256_cvtepu8_epi32, _mm256_max_ps, _mm256_min_ps,
        _mm256_movemask_ps, _mm256_mul_ps, _mm256_permutevar8x32_ps, _mm256_set1_epi32, _mm256_set1_ps,
    };

    use super::{LANE_FROM_PACKED, PACKED_FROM_LANE};
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

/// By the instructions of AVX-512 F, on a processor that has them.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug)]
pub(super) struct ByAvx512(());

#[cfg(target_arch = "x86_64")]
impl ByAvx512 {
    /// # Safety
    /// The processor must have AVX-512 F.
    pub(super) unsafe fn new() -> Self {
        Self(())
    }
}

#[cfg(target_arch = "x86_64")]
impl Simd for ByAvx512 {
    type Vector = std::arch::x86_64::__m512;

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
        unsafe { avx512::splat(value) }
    }

    #[inline(always)]
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx512::add(a, b) }
    }

    #[inline(always)]
    fn mul(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx512::mul(a, b) }
    }

    #[inline(always)]
    fn abs(self, a: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx512::abs(a) }
    }

    #[inline(always)]
    fn min(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx512::min(a, b) }
    }

    #[inline(always)]
    fn max(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx512::max(a, b) }
    }

    #[inline(always)]
    fn splat_mask(self, mask: u32) -> Self::Vector {
        self.splat(f32::from_bits(mask))
    }

    #[inline(always)]
    fn select(self, mask: Self::Vector, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx512::select(mask, a, b) }
    }

    #[inline(always)]
    fn bits_where_less(self, a: Self::Vector, b: Self::Vector) -> u16 {
        // SAFETY: as above.
        unsafe { avx512::bits_where_less(a, b) }
    }

    #[inline(always)]
    fn pack(self, lanes: u16, from: Self::Vector) -> Self::Vector {
        // SAFETY: as above.
        unsafe { avx512::pack(lanes, from) }
    }

    #[inline(always)]
    fn bits(self, mask: &Mask) -> u16 {
        // SAFETY: as above.
        unsafe { avx512::bits(mask) }
    }

    #[inline(always)]
    fn compress(self, lanes: u16, from: &Lanes) -> Lanes {
        // SAFETY: as above.
        unsafe { avx512::compress(lanes, from) }
    }

    #[inline(always)]
    fn expand(self, lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes {
        // SAFETY: as above.
        unsafe { avx512::expand(lanes, packed, elsewhere) }
    }

    #[inline(always)]
    fn put(self, lanes: u16, value: f32, elsewhere: &Lanes) -> Lanes {
        // SAFETY: as above.
        unsafe { avx512::put(lanes, value, elsewhere) }
    }
}

#[cfg(target_arch = "x86_64")]
mod avx512 {
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

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "numbers are moved, not computed")]

    use super::*;

    type Run = fn(u16, &Lanes) -> (u16, [Lanes; 4]);

    fn all() -> Vec<(&'static str, Run)> {
        fn run(by: impl Simd, lanes: u16, from: &Lanes) -> (u16, [Lanes; 4]) {
            let mask = std::array::from_fn(|lane| u32::from(lanes >> lane & 1 == 1).wrapping_neg());
            let mut packed = [0.0; LANES];
            by.store(by.pack(lanes, by.load(from)), &mut packed);
            let moved = [by.compress(lanes, from), packed, by.expand(lanes, from, 7.0), by.put(lanes, 7.0, from)];
            (by.bits(&mask), moved)
        }
        let mut all: Vec<(&'static str, Run)> = vec![("by lane", |lanes, from| run(ByLane, lanes, from))];
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            // SAFETY: detected in the line above.
            all.push(("AVX2", |lanes, from| run(unsafe { ByAvx2::new() }, lanes, from)));
        }
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: detected in the line above.
            all.push(("AVX-512", |lanes, from| run(unsafe { ByAvx512::new() }, lanes, from)));
        }
        all
    }

    #[test]
    fn every_pattern_of_lanes_is_moved_like_by_a_filter() {
        let from: Lanes = std::array::from_fn(|i| i as f32 + 0.5);
        for (name, run) in all() {
            for lanes in 0..=u16::MAX {
                let (bits, [compressed, packed, expanded, put]) = run(lanes, &from);
                assert_eq!(bits, lanes, "{name}");
                let chosen = (0..LANES).filter(|i| lanes >> i & 1 == 1);
                let mut expected = [7.0; LANES];
                let mut expected_put = from;
                for (place, lane) in chosen.enumerate() {
                    assert_eq!([compressed[place], packed[place]], [from[lane]; 2], "{name}, lanes {lanes:#b}");
                    expected[lane] = from[place];
                    expected_put[lane] = 7.0;
                }
                assert_eq!(expanded, expected, "{name}, lanes {lanes:#b}");
                assert_eq!(put, expected_put, "{name}, lanes {lanes:#b}");
            }
        }
    }

    #[test]
    fn arithmetic_is_that_of_every_lane() {
        fn run(by: impl Simd, a: &Lanes, b: &Lanes) -> ([Lanes; 8], u16) {
            let (u, v) = (by.load(a), by.load(b));
            let of = [
                by.add(u, v),
                by.mul(u, v),
                by.min(u, v),
                by.max(u, v),
                by.abs(u),
                by.select(by.splat_mask(u32::MAX), u, v),
                by.select(by.splat_mask(0), u, v),
                by.splat(b[3]),
            ];
            let stored = of.map(|vector| {
                let mut lanes = [0.0; LANES];
                by.store(vector, &mut lanes);
                lanes
            });
            (stored, by.bits_where_less(u, v))
        }
        let numbers = [0.0, -0.0, 1.5, -2.25, 1e-40, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 3e38, -7.0];
        let at = |turn: usize, i: usize| numbers[(i * (turn + 3) + turn) % numbers.len()];
        let bits = |(stored, less): ([Lanes; 8], u16)| (stored.map(|lanes| lanes.map(f32::to_bits)), less);
        for turn in 0..50 {
            let (a, b) = (std::array::from_fn(|i| at(turn, i)), std::array::from_fn(|i| at(turn / 7, i + turn)));
            let expected = bits(run(ByLane, &a, &b));
            #[cfg(target_arch = "x86_64")]
            if is_x86_feature_detected!("avx2") {
                // SAFETY: detected in the line above.
                assert_eq!(bits(run(unsafe { ByAvx2::new() }, &a, &b)), expected, "AVX2, {a:?}, {b:?}");
            }
            #[cfg(target_arch = "x86_64")]
            if is_x86_feature_detected!("avx512f") {
                // SAFETY: detected in the line above.
                assert_eq!(bits(run(unsafe { ByAvx512::new() }, &a, &b)), expected, "AVX-512, {a:?}, {b:?}");
            }
        }
    }
}
