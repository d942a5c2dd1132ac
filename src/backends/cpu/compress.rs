//! Moving chosen lanes together, and back: one instruction where the processor has it, a loop elsewhere, the same bits.
#![expect(
    unsafe_code,
    reason = "a function compiled for more than the baseline may run only where the processor has it"
)]
#![expect(clippy::inline_always, reason = "kernels must inline into the function compiled for wider vectors")]

use crate::optics::{LANES, Lanes, Mask};

/// How an instruction set compresses and expands.
pub(super) trait Compress: Copy {
    /// One bit for each lane of the mask that is set.
    fn bits(self, mask: &Mask) -> u16;
    /// The lanes whose bit is set, moved together to the front; anything after them.
    fn compress(self, lanes: u16, from: &Lanes) -> Lanes;
    /// The reverse: the first numbers of `packed` in the lanes whose bit is set, `elsewhere` in the others.
    fn expand(self, lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes;
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

impl Compress for ByLane {
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
impl Compress for ByAvx2 {
    #[inline(always)]
    fn bits(self, mask: &Mask) -> u16 {
        // SAFETY: whoever made `self` vouched for the processor.
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
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{
        __m128i, __m256, __m256i, _mm256_and_si256, _mm256_blendv_ps, _mm256_castsi256_ps, _mm256_cmpeq_epi32,
        _mm256_cvtepu8_epi32, _mm256_movemask_ps, _mm256_permutevar8x32_ps, _mm256_set1_epi32, _mm256_set1_ps,
    };

    use super::{LANE_FROM_PACKED, PACKED_FROM_LANE};
    use crate::optics::{LANES, Lanes, Mask};

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
            let bit = bytemuck::cast::<_, __m256i>([1_u32, 2, 4, 8, 16, 32, 64, 128]);
            let is_set = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(i32::from(lanes)), bit), bit);
            _mm256_blendv_ps(_mm256_set1_ps(elsewhere), moved, _mm256_castsi256_ps(is_set))
        };
        let mut from_low = [0.0; 8];
        from_low.copy_from_slice(&packed[..8]);
        bytemuck::cast([half(low, from_low), half(high, from_high)])
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
impl Compress for ByAvx512 {
    #[inline(always)]
    fn bits(self, mask: &Mask) -> u16 {
        // SAFETY: whoever made `self` vouched for the processor.
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
}

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use std::arch::x86_64::{
        __m512, __m512i, _mm512_mask_expand_ps, _mm512_maskz_compress_ps, _mm512_set1_ps, _mm512_test_epi32_mask,
    };

    use crate::optics::{Lanes, Mask};

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
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "numbers are moved, not computed")]

    use super::*;

    type Run = fn(u16, &Lanes) -> (u16, Lanes, Lanes);

    fn all() -> Vec<(&'static str, Run)> {
        fn run(by: impl Compress, lanes: u16, from: &Lanes) -> (u16, Lanes, Lanes) {
            let mask = std::array::from_fn(|lane| u32::from(lanes >> lane & 1 == 1).wrapping_neg());
            (by.bits(&mask), by.compress(lanes, from), by.expand(lanes, from, 7.0))
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
                let (bits, compressed, expanded) = run(lanes, &from);
                assert_eq!(bits, lanes, "{name}");
                let chosen = (0..LANES).filter(|i| lanes >> i & 1 == 1);
                let mut expected = [7.0; LANES];
                for (place, lane) in chosen.enumerate() {
                    assert_eq!(compressed[place], from[lane], "{name}, lanes {lanes:#b}");
                    expected[lane] = from[place];
                }
                assert_eq!(expanded, expected, "{name}, lanes {lanes:#b}");
            }
        }
    }
}
