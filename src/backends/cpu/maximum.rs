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
