//! The sink of maximum intensity: the largest value on each ray, and what cannot exceed it left out.
//!
//! A block takes no fragments of a cell whose largest value is not above the smallest of its pixels' maxima, a tile none of cells that are
//! so for all its blocks. Cells come by falling value ([`largest`](crate::stages::sort::largest)), so that most tiles are finished after
//! few of them; in any other order the picture is the same.
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::log::Log;
use super::simd::Simd;
use super::sink::{Fragments, Sink};
use super::tile::BLOCKS;
use crate::optics::lanes::min;
use crate::optics::{LANES, Lanes, Optics};

/// The maxima of a tile's pixels.
pub(super) struct Maximum {
    largest: Box<[Lanes; BLOCKS]>,
    /// Of each block the smallest of them, and of all blocks.
    least: Box<[Lanes; BLOCKS / LANES]>,
    least_of_all: f32,
}

impl Default for Maximum {
    fn default() -> Self {
        let none = f32::NEG_INFINITY;
        let (largest, least) = ([[none; LANES]; BLOCKS], [[none; LANES]; BLOCKS / LANES]);
        Self { largest: Box::new(largest), least: Box::new(least), least_of_all: none }
    }
}

impl Maximum {
    /// Empties the tile.
    pub(super) fn reset(&mut self) {
        self.largest.fill([f32::NEG_INFINITY; LANES]);
        self.least.fill([f32::NEG_INFINITY; LANES]);
        self.least_of_all = f32::NEG_INFINITY;
    }

    /// The contribution of each pixel, block by block, lane by lane.
    pub(super) fn contributions(&self) -> impl Iterator<Item = [f32; 4]> {
        self.largest.as_flattened().iter().map(|&largest| [largest, 0.0, 0.0, 0.0])
    }
}

impl<O: Optics> Sink<O> for Maximum {
    #[inline(always)]
    fn is_any_done(&self) -> bool {
        true
    }

    #[inline(always)]
    fn done(&self, _: f32) -> u64 {
        0
    }

    #[inline(always)]
    fn done_at(&self, simd: impl Simd, _: f32, s_max: f32) -> u64 {
        let s_max = simd.splat(s_max);
        let mut takes = 0;
        for (nth, least) in self.least.iter().enumerate() {
            takes |= u64::from(simd.bits_where_less(simd.load(least), s_max)) << (nth * LANES);
        }
        !takes
    }

    #[inline(always)]
    fn is_all_done(&self) -> bool {
        false
    }

    #[inline(always)]
    fn is_all_done_at(&self, s_max: f32) -> bool {
        s_max <= self.least_of_all
    }

    #[inline(always)]
    fn accept(&mut self, simd: impl Simd, fragments: &Fragments, _: &mut Log) {
        let block = fragments.block;
        let largest = &mut self.largest[block];
        simd.store(simd.max(simd.load(&fragments.contribution[0]), simd.load(largest)), largest);
        let least_of_block = largest.iter().fold(f32::INFINITY, |least, &value| min(value, least));
        let least = &mut self.least[block / LANES][block % LANES];
        if least_of_block > *least {
            let was_least_of_all = *least <= self.least_of_all;
            *least = least_of_block;
            if was_least_of_all {
                self.least_of_all =
                    self.least.as_flattened().iter().fold(f32::INFINITY, |least, &value| min(value, least));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::simd::ByLane;
    use super::*;
    use crate::optics::Mip;

    #[test]
    fn what_is_left_out_changes_nothing() {
        let mut maximum = Maximum::default();
        maximum.reset();
        let done = |maximum: &Maximum, s_max| Sink::<Mip>::done_at(maximum, ByLane, 1.0, s_max);
        let mut naive = [[f32::NEG_INFINITY; LANES]; BLOCKS];
        let mut left_out = 0;
        for i in 0..20_000_usize {
            let block = i * 37 % BLOCKS;
            let value = |lane: usize| ((i * 7919 + lane * 104_729) % 1000) as f32 - 1e-3 * i as f32;
            let values: Lanes = std::array::from_fn(value);
            let s_max = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            for lane in 0..LANES {
                naive[block][lane] = naive[block][lane].max(values[lane]);
            }
            let least = naive[block].iter().copied().fold(f32::INFINITY, f32::min);
            if done(&maximum, s_max) >> block & 1 == 1 {
                left_out += 1;
                continue;
            }
            let contribution = [values, [0.0; LANES], [0.0; LANES], [0.0; LANES]];
            let (lanes, v_enter) = (u16::MAX, [1.0; LANES]);
            let fragments = Fragments { block, number: 0, lanes, v_enter: &v_enter, contribution: &contribution };
            Sink::<Mip>::accept(&mut maximum, ByLane, &fragments, &mut Log::default());
            assert_eq!(maximum.least[block / LANES][block % LANES].to_bits(), least.to_bits());
        }
        assert!(left_out > 1000, "{left_out}");
        let found: Vec<f32> = maximum.contributions().map(|[largest, ..]| largest).collect();
        assert_eq!(found, naive.as_flattened());
        let least = naive.as_flattened().iter().copied().fold(f32::INFINITY, f32::min);
        assert!(Sink::<Mip>::is_all_done_at(&maximum, least));
        assert!(!Sink::<Mip>::is_all_done_at(&maximum, least + 1.0));
        assert_eq!(done(&maximum, least), u64::MAX);
        assert_eq!(done(&maximum, f32::INFINITY), 0);
    }
}
