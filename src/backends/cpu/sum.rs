//! The sink of models whose contributions add up: no order, no end before the last cell, and sums that lose nothing.
//!
//! A sum of n numbers in f32 may be off by n/2 · 2^-24 of itself, and more so where all are alike and rounded the same way: 10^4
//! segments of a homogeneous medium cost 10^-4. Sums are kept in f64: n · 2^-53, then rounded to f32 once.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::compress::Compress;
use super::sink::{Fragments, Sink};
use super::tile::BLOCKS;
use crate::optics::{LANES, Optics};

/// Four sums for each pixel of a tile.
pub(super) struct Sum {
    blocks: Box<[[[f64; LANES]; 4]; BLOCKS]>,
}

impl Default for Sum {
    fn default() -> Self {
        Self { blocks: Box::new([[[0.0; LANES]; 4]; BLOCKS]) }
    }
}

impl Sum {
    /// Empties the tile.
    pub(super) fn reset(&mut self) {
        self.blocks.fill([[0.0; LANES]; 4]);
    }

    /// The sums of each pixel, block by block, lane by lane.
    pub(super) fn contributions(&self) -> impl Iterator<Item = [f32; 4]> {
        let of_lane = |block: &[[f64; LANES]; 4], lane: usize| block.map(|sums| sums[lane] as f32);
        self.blocks.iter().flat_map(move |block| (0..LANES).map(move |lane| of_lane(block, lane)))
    }
}

impl<O: Optics> Sink<O> for Sum {
    #[inline(always)]
    fn is_done(&self, _: usize, _: f32) -> bool {
        false
    }

    #[inline(always)]
    fn is_all_done(&self) -> bool {
        false
    }

    #[inline(always)]
    fn accept(&mut self, _: impl Compress, fragments: &Fragments) {
        let sums = &mut self.blocks[fragments.block];
        for c in 0..4 {
            for i in 0..LANES {
                sums[c][i] += f64::from(fragments.contribution[c][i]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::compress::ByLane;
    use super::*;
    use crate::optics::{BandDepths, Lanes};

    /// Segments of a medium: some alike, some a million times thinner.
    fn depths(i: usize) -> Lanes {
        std::array::from_fn(|lane| match lane % 4 {
            0 => 1.0e-3,
            1 => 1.1e-3 + 1e-9 * (i % 7) as f32,
            2 => if i.is_multiple_of(2) { 0.7 } else { 0.7e-6 },
            _ => 0.1 / (1.0 + i as f32),
        })
    }

    #[test]
    fn a_hundred_thousand_segments_keep_their_sum_which_f32_loses() {
        let mut sum = Sum::default();
        sum.reset();
        let mut plain = [0.0_f32; LANES];
        let mut exact = [0.0_f64; LANES];
        for i in 0..100_000 {
            let lanes = depths(i);
            let contribution = [lanes; 4];
            let fragments =
                Fragments { block: 9, is_hit: &[u32::MAX; LANES], v_enter: &[1.0; LANES], contribution: &contribution };
            Sink::<BandDepths>::accept(&mut sum, ByLane, &fragments);
            for lane in 0..LANES {
                plain[lane] += lanes[lane];
                exact[lane] += f64::from(lanes[lane]);
            }
        }
        let found: Vec<[f32; 4]> = sum.contributions().skip(9 * LANES).take(LANES).collect();
        let off = |found: f32, lane: usize| (f64::from(found) / exact[lane] - 1.0).abs();
        let worst = (0..LANES).map(|lane| off(found[lane][3], lane)).fold(0.0, f64::max);
        let worst_plain = (0..LANES).map(|lane| off(plain[lane], lane)).fold(0.0, f64::max);
        println!("relative error of 100,000 segments: {worst:.1e}, in plain f32 {worst_plain:.1e}");
        assert!(worst < 1e-7 && worst_plain > 1e-4);
        assert!(sum.contributions().take(9 * LANES).all(|other| other.map(f32::to_bits) == [0; 4]));
    }
}
