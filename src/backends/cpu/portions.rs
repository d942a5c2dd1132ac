//! Portions: which blocks of a tile are collected at once, so that their fragments fit.
//!
//! In: blocks, a bit each, and how many fragments fit. Out: groups of blocks, none with more; or the block that has more alone.
#![expect(clippy::inline_always, reason = "kernels must inline into the function compiled for wider vectors")]

use super::compress::Compress;
use super::sink::{Fragments, Sink};
use super::tile::BLOCKS;
use crate::optics::{LANES, Optics};

/// Counts the fragments of some blocks, and keeps none.
pub(super) struct CountFragments {
    blocks: u64,
    fragments_from_block: [usize; BLOCKS],
}

impl CountFragments {
    /// Of `blocks`, one bit each.
    pub(super) fn new(blocks: u64) -> Self {
        Self { blocks, fragments_from_block: [0; BLOCKS] }
    }

    /// The fragments of the fullest block.
    pub(super) fn largest(&self) -> usize {
        self.fragments_from_block.iter().copied().max().unwrap_or(0)
    }

    /// The blocks in groups of at most `limit` fragments each, where no block has more.
    pub(super) fn portions(&self, limit: usize) -> impl Iterator<Item = u64> {
        let mut rest = self.blocks;
        std::iter::from_fn(move || {
            let (mut group, mut fragments) = (0, 0);
            while rest != 0 {
                let block = rest.trailing_zeros() as usize;
                fragments += self.fragments_from_block[block];
                if group != 0 && fragments > limit {
                    break;
                }
                group |= 1 << block;
                rest &= rest - 1;
            }
            (group != 0).then_some(group)
        })
    }
}

impl<O: Optics> Sink<O> for CountFragments {
    #[inline(always)]
    fn is_done(&self, block: usize, _: f32) -> bool {
        self.blocks >> block & 1 == 0
    }

    #[inline(always)]
    fn is_all_done(&self) -> bool {
        false
    }

    #[inline(always)]
    fn accept(&mut self, _: impl Compress, fragments: &Fragments) {
        let mut hits = 0;
        for i in 0..LANES {
            hits += fragments.is_hit[i] & 1;
        }
        self.fragments_from_block[fragments.block] += hits as usize;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn portions_hold_every_block_once_and_keep_the_limit() {
        let mut count = CountFragments::new(0b1011_0110_1001 | 1 << 63);
        for block in 0..BLOCKS {
            count.fragments_from_block[block] = if count.blocks >> block & 1 == 1 { 1 + block % 5 } else { 0 };
        }
        for limit in [5, 6, 9, 100] {
            let portions: Vec<_> = count.portions(limit).collect();
            assert_eq!(portions.iter().sum::<u64>(), count.blocks);
            assert_eq!(portions.iter().map(|portion| portion.count_ones()).sum::<u32>(), count.blocks.count_ones());
            for &portion in &portions {
                let of_block = |block: usize| (portion >> block & 1) as usize * count.fragments_from_block[block];
                assert!((0..BLOCKS).map(of_block).sum::<usize>() <= limit);
            }
        }
        assert_eq!((count.largest(), CountFragments::new(0).portions(1).count()), (5, 0));
    }
}
