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
    /// The lanes whose bit is set, moved together to the front; 0 after them.
    fn compress(self, lanes: u16, from: &Lanes) -> Lanes;
    /// The reverse: the first numbers of `packed` in the lanes whose bit is set, `elsewhere` in the others.
    fn expand(self, lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes;
}

/// Lane by lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct ByLane;

impl Compress for ByLane {
    #[inline(always)]
    fn bits(self, mask: &Mask) -> u16 {
        let mut bits = 0;
        for i in 0..LANES {
            bits |= mask[i] & 1 << i;
        }
        bits as u16
    }

    #[inline(always)]
    fn compress(self, mut lanes: u16, from: &Lanes) -> Lanes {
        let mut to = [0.0; LANES];
        let mut len = 0;
        while lanes != 0 {
            to[len % LANES] = from[lanes.trailing_zeros() as usize % LANES];
            lanes &= lanes - 1;
            len += 1;
        }
        to
    }

    #[inline(always)]
    fn expand(self, mut lanes: u16, packed: &Lanes, elsewhere: f32) -> Lanes {
        let mut to = [elsewhere; LANES];
        let mut len = 0;
        while lanes != 0 {
            to[lanes.trailing_zeros() as usize % LANES] = packed[len % LANES];
            lanes &= lanes - 1;
            len += 1;
        }
        to
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
    use super::*;

    fn compressors() -> Vec<(&'static str, fn(u16, &Lanes) -> (Lanes, Lanes))> {
        fn both(by: impl Compress, lanes: u16, from: &Lanes) -> (Lanes, Lanes) {
            (by.compress(lanes, from), by.expand(lanes, from, 7.0))
        }
        let mut all: Vec<(&'static str, fn(u16, &Lanes) -> (Lanes, Lanes))> =
            vec![("by lane", |lanes, from| both(ByLane, lanes, from))];
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: detected in the line above.
            all.push(("AVX-512", |lanes, from| both(unsafe { ByAvx512::new() }, lanes, from)));
        }
        all
    }

    #[test]
    fn every_mask_compresses_and_expands_like_a_filter() {
        let from: Lanes = std::array::from_fn(|i| i as f32 + 0.5);
        for (name, run) in compressors() {
            for lanes in 0..=u16::MAX {
                let chosen: Vec<usize> = (0..LANES).filter(|i| lanes >> i & 1 == 1).collect();
                let mut compressed = [0.0; LANES];
                let mut expanded = [7.0; LANES];
                for (place, &lane) in chosen.iter().enumerate() {
                    compressed[place] = from[lane];
                    expanded[lane] = from[place];
                }
                assert_eq!(run(lanes, &from), (compressed, expanded), "{name}, lanes {lanes:#b}");
            }
        }
    }
}
