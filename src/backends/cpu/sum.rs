//! The sink of models whose contributions add up: no order, no end before the last cell, and sums that lose next to nothing.
//!
//! A sum of n numbers in f32 may be off by n · 2^-24 of itself, and is where all are alike and rounded the same way: 10^4 segments
//! of a homogeneous medium cost 10^-4. Here eight are added up in f32, which for numbers of one sign costs 7 · 2^-24 at most, and
//! these sums in f64: 5·10^-7 of the sum for any n, the last rounding included. Adding each in f64 took twice as long a frame: twice
//! the memory for each fragment.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::log::Log;
use super::simd::Simd;
use super::sink::{Fragments, Sink};
use super::tile::BLOCKS;
use crate::optics::{Contribution, LANES, Optics};

/// Fragments of a block that are added up in f32.
const IN_F32: u8 = 8;

/// Four sums for each pixel of a tile.
pub(super) struct Sum {
    /// Of the fragments since the last time, and how many these are.
    recent: Box<[Contribution; BLOCKS]>,
    fragments: [u8; BLOCKS],
    /// Of those before.
    total: Vec<[[f64; LANES]; 4]>,
}

impl Default for Sum {
    fn default() -> Self {
        Self {
            recent: Box::new([[[0.0; LANES]; 4]; BLOCKS]),
            fragments: [0; BLOCKS],
            total: vec![[[0.0; LANES]; 4]; BLOCKS],
        }
    }
}

impl Sum {
    /// Empties the tile.
    pub(super) fn reset(&mut self) {
        self.recent.fill([[0.0; LANES]; 4]);
        self.fragments.fill(0);
        self.total.fill([[0.0; LANES]; 4]);
    }

    /// The sums of each pixel, block by block, lane by lane.
    pub(super) fn contributions(&self) -> impl Iterator<Item = [f32; 4]> {
        let sum = |block: usize, c: usize, lane: usize| {
            (self.total[block][c][lane] + f64::from(self.recent[block][c][lane])) as f32
        };
        let of_block = move |block| (0..LANES).map(move |lane| std::array::from_fn(|c| sum(block, c, lane)));
        (0..BLOCKS).flat_map(of_block)
    }
}

impl<O: Optics> Sink<O> for Sum {
    #[inline(always)]
    fn is_any_done(&self) -> bool {
        false
    }

    #[inline(always)]
    fn done(&self, _: f32) -> u64 {
        0
    }

    #[inline(always)]
    fn is_all_done(&self) -> bool {
        false
    }

    #[inline(always)]
    fn accept(&mut self, _: impl Simd, fragments: &Fragments, _: &mut Log) {
        let block = fragments.block;
        let recent = &mut self.recent[block];
        for c in 0..O::CHANNELS {
            for i in 0..LANES {
                recent[c][i] += fragments.contribution[c][i];
            }
        }
        self.fragments[block] += 1;
        if self.fragments[block] == IN_F32 {
            self.fragments[block] = 0;
            for (total, recent) in self.total[block].iter_mut().zip(recent).take(O::CHANNELS) {
                for i in 0..LANES {
                    total[i] += f64::from(recent[i]);
                    recent[i] = 0.0;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::simd::ByLane;
    use super::*;
    use crate::optics::{BandDepths, Lanes};

    /// Segments of a medium: some alike, some a million times thinner.
    fn depths(i: usize) -> Lanes {
        std::array::from_fn(|lane| match lane % 4 {
            0 => 1.0e-3,
            1 => 1.1e-3 + 1e-9 * (i % 7) as f32,
            2 => {
                if i.is_multiple_of(2) {
                    0.7
                } else {
                    0.7e-6
                }
            }
            _ => 0.1 / (1.0 + i as f32),
        })
    }

    #[test]
    fn a_hundred_thousand_segments_keep_their_sum_which_f32_loses() {
        let mut sum = Sum::default();
        sum.reset();
        let mut plain = [0.0_f32; LANES];
        let mut exact = [0.0_f64; LANES];
        for i in 0..100_003 {
            let lanes = depths(i);
            let contribution = [lanes; 4];
            let fragments =
                Fragments { block: 9, lanes: u16::MAX, number: 0, v_enter: &[1.0; LANES], contribution: &contribution };
            Sink::<BandDepths>::accept(&mut sum, ByLane, &fragments, &mut Log::default());
            for lane in 0..LANES {
                plain[lane] += lanes[lane];
                exact[lane] += f64::from(lanes[lane]);
            }
        }
        let found: Vec<[f32; 4]> = sum.contributions().skip(9 * LANES).take(LANES).collect();
        let off = |found: f32, lane: usize| (f64::from(found) / exact[lane] - 1.0).abs();
        let worst = (0..LANES).map(|lane| off(found[lane][3], lane)).fold(0.0, f64::max);
        let worst_plain = (0..LANES).map(|lane| off(plain[lane], lane)).fold(0.0, f64::max);
        println!("relative error of 100,003 segments: {worst:.1e}, in plain f32 {worst_plain:.1e}");
        assert!(worst < 5e-7 && worst_plain > 1e-4);
        assert!(sum.contributions().take(9 * LANES).all(|other| other.map(f32::to_bits) == [0; 4]));
    }
}
