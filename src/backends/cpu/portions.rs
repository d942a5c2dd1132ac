//! Portions: which blocks of a tile are collected at once, so that their fragments fit.
//!
//! In: blocks to draw again, a bit each, and how many fragments fit. Out: groups of blocks, none with more; or the number of
//! the block that has more alone.
//!
//! Every pass finds and shades the fragments of all blocks and keeps those of one group: which form of the integral a cell
//! takes depends on all of its rays in the tile, so that blocks on their own would differ in the last bit.
#![expect(clippy::inline_always, reason = "kernels must inline into the function compiled for wider vectors")]

use super::collect::Collect;
use super::log::Log;
use super::simd::Simd;
use super::sink::{Fragments, Sink};
use super::tile::BLOCKS;
use crate::optics::Optics;

/// Counts the fragments of some blocks, and collects those of a portion of them.
pub(super) struct Portion<'a> {
    blocks: u64,
    kept: u64,
    collect: &'a mut Collect,
    counts: BlockCounts,
}

impl<'a> Portion<'a> {
    /// Of `blocks`, one bit each, collects those of `kept`, which may be none.
    pub(super) fn new(blocks: u64, kept: u64, collect: &'a mut Collect) -> Self {
        collect.reset(kept);
        Self { blocks, kept, collect, counts: BlockCounts { blocks, fragments_from_block: [0; BLOCKS] } }
    }

    /// What was counted.
    pub(super) fn into_counts(self) -> BlockCounts {
        self.counts
    }
}

impl<O: Optics> Sink<O> for Portion<'_> {
    #[inline(always)]
    fn is_any_done(&self) -> bool {
        true
    }

    #[inline(always)]
    fn done(&self, _: f32) -> u64 {
        !self.blocks
    }

    #[inline(always)]
    fn is_all_done(&self) -> bool {
        false
    }

    #[inline(always)]
    fn accept(&mut self, simd: impl Simd, fragments: &Fragments, log: &mut Log) {
        self.counts.fragments_from_block[fragments.block] += fragments.lanes.count_ones() as usize;
        if self.kept >> fragments.block & 1 == 1 {
            Sink::<O>::accept(self.collect, simd, fragments, log);
        }
    }
}

/// The fragments of each block.
pub(super) struct BlockCounts {
    blocks: u64,
    fragments_from_block: [usize; BLOCKS],
}

impl BlockCounts {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn portions_hold_every_block_once_and_keep_the_limit() {
        let mut count = BlockCounts { blocks: 0b1011_0110_1001 | 1 << 63, fragments_from_block: [0; BLOCKS] };
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
        assert_eq!(count.largest(), 5);
        count.blocks = 0;
        assert_eq!(count.portions(5).count(), 0);
    }
}
