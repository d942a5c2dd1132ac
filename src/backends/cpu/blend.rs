//! Blending front to back, with a check of the order.
//!
//! In: cells in about the order of their depths. Out: the contribution of each pixel, and the blocks in which a fragment came too late.
//! A fragment nearly always lies behind all that its pixel has drawn, and is put behind it. Where the order is to be exact, one that
//! came late is put where it belongs: with the fragments behind it, which the [`Log`] remembers for a while, composited to one, the
//! contribution of all is `front over behind`, and becomes `front over late over behind` ([`Optics::slipped_in`]).
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use arrayvec::ArrayVec;

use super::log::{Earlier, Log, NOTHING};
use super::simd::Simd;
use super::sink::{Fragments, Sink};
use super::tile::BLOCKS;
use crate::optics::lanes::min;
use crate::optics::{Contribution, LANES, Lanes, Optics};

/// Fragments that a late one may lie before, and still be put there.
const BEHIND: usize = 32;

/// Slack of the order check: two neighbours meet where both compute the same plane, but clamps and edges round differently.
#[derive(Clone, Copy, Debug)]
pub(super) struct OrderSlack {
    pub(super) relative: f32,
    pub(super) absolute: f32,
}

/// How a tile is blended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blending {
    /// Late fragments are put where they belong; otherwise they are counted.
    pub(super) is_exact: bool,
    /// A block is done when all its pixels transmit less.
    pub(super) stop_transmittance: f32,
    pub(super) slack: OrderSlack,
}

/// What is known of a block.
#[derive(Clone, Copy, bytemuck::Zeroable)]
struct Block {
    pixels: Contribution,
    /// Of each pixel the smallest inverse depth of a fragment's entry.
    v_farthest: Lanes,
    /// The last record.
    last: u32,
}

/// Blends a tile; counts the fragments that came after one behind them.
pub(super) struct Blend {
    blending: Blending,
    blocks: Box<[Block; BLOCKS]>,
    done: u64,
    /// The farthest that all of a block's pixels have drawn when it was done.
    v_done: [f32; BLOCKS],
    violations: u64,
    late_blocks: u64,
}

impl Default for Blend {
    fn default() -> Self {
        let slack = OrderSlack { relative: 0.0, absolute: 0.0 };
        Self {
            blending: Blending { is_exact: false, stop_transmittance: 0.0, slack },
            blocks: bytemuck::zeroed_box(),
            done: 0,
            v_done: [0.0; BLOCKS],
            violations: 0,
            late_blocks: 0,
        }
    }
}

impl Blend {
    /// Empties the tile.
    pub(super) fn reset<O: Optics>(&mut self, blending: Blending) {
        self.blending = blending;
        let pixels = O::CLEAR.map(|clear| [clear; LANES]);
        self.blocks.fill(Block { pixels, v_farthest: [f32::INFINITY; LANES], last: NOTHING });
        self.v_done.fill(f32::NEG_INFINITY);
        (self.done, self.violations, self.late_blocks) = (0, 0, 0);
    }

    /// Fragments that came after one that lies behind them.
    pub(super) fn violations(&self) -> u64 {
        self.violations
    }

    /// One bit for each block with such a fragment that was not put right.
    pub(super) fn late_blocks(&self) -> u64 {
        self.late_blocks
    }

    /// The contribution of each pixel, block by block, lane by lane.
    pub(super) fn contributions(&self) -> impl Iterator<Item = [f32; 4]> {
        self.blocks.iter().flat_map(|block| (0..LANES).map(move |lane| std::array::from_fn(|c| block.pixels[c][lane])))
    }

    /// Puts late fragments where they belong, or counts them: where the order need not be exact they are drawn already.
    #[inline(never)]
    fn put_late<O: Optics>(&mut self, log: &mut Log, number: usize, late: u16) {
        let block = log.block_of(number);
        let mut rest = late;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            self.violations += 1;
            if !self.blending.is_exact {
                self.late_blocks |= 1 << block;
                continue;
            }
            let fragment = log.mark_late(number, lane);
            let pixels = &self.blocks[block].pixels;
            let front = [pixels[0][lane], pixels[1][lane], pixels[2][lane], pixels[3][lane]];
            let Some(whole) = slipped_in::<O>(log, front, &fragment, (number, lane)) else {
                self.late_blocks |= 1 << block;
                continue;
            };
            for (pixels, whole) in self.blocks[block].pixels.iter_mut().zip(whole) {
                pixels[lane] = whole;
            }
        }
    }
}

/// A pixel with a fragment before those that lie behind it; none where these are not known any more, or too many, or too dark.
fn slipped_in<O: Optics>(
    log: &Log,
    whole: [f32; 4],
    fragment: &Earlier,
    (number, lane): (usize, usize),
) -> Option<[f32; 4]> {
    let mut behind: ArrayVec<(f32, [f32; 4]), BEHIND> = ArrayVec::new();
    for earlier in log.before(number, lane) {
        let earlier = earlier?;
        if earlier.v_enter < fragment.v_enter {
            behind.try_push((earlier.v_enter, earlier.contribution)).ok()?;
        } else if !earlier.is_late {
            // It lay behind all before it, so these lie before the fragment too.
            break;
        }
    }
    behind.sort_by(|a, b| b.0.total_cmp(&a.0));
    let behind = behind.iter().map(|&(_, contribution)| contribution).fold(O::CLEAR, O::over);
    O::slipped_in(whole, behind, fragment.contribution)
}

impl<O: Optics> Sink<O> for Blend {
    #[inline(always)]
    fn is_any_done(&self) -> bool {
        self.done != 0
    }

    #[inline(always)]
    fn done(&self, v_max: f32) -> u64 {
        if !self.blending.is_exact {
            return self.done;
        }
        // Where the order must be exact, an opaque block still looks at cells that might lie in front.
        self.v_done.iter().enumerate().fold(0, |done, (block, &v)| done | u64::from(v_max <= v) << block)
    }

    #[inline(always)]
    fn is_all_done(&self) -> bool {
        !self.blending.is_exact && self.done == u64::MAX
    }

    #[inline(always)]
    fn accept(&mut self, simd: impl Simd, fragments: &Fragments, log: &mut Log) {
        let Fragments { block, number, lanes, v_enter, contribution } = *fragments;
        let Blending { is_exact, stop_transmittance, slack } = self.blending;
        let of_block = &mut self.blocks[block];
        let mut late = 0;
        if O::IS_ORDERED {
            if is_exact {
                log.link(number, &mut of_block.last);
            }
            let (v, v_enter) = (simd.load(&of_block.v_farthest), simd.load(v_enter));
            let rounding = simd.add(simd.mul(simd.abs(v), simd.splat(slack.relative)), simd.splat(slack.absolute));
            late = simd.bits_where_less(simd.add(v, rounding), v_enter) & lanes;
            simd.store(simd.min(v_enter, v), &mut of_block.v_farthest);
        }
        let mut contribution = *contribution;
        if late != 0 && is_exact {
            // What came late waits.
            for (channel, clear) in contribution.iter_mut().zip(O::CLEAR) {
                *channel = simd.put(late, clear, channel);
            }
        }
        let front = of_block.pixels;
        let mut transmittance = [0.0; LANES];
        for i in 0..LANES {
            let front = [front[0][i], front[1][i], front[2][i], front[3][i]];
            let back = [contribution[0][i], contribution[1][i], contribution[2][i], contribution[3][i]];
            let both = O::over(front, back);
            for c in 0..4 {
                of_block.pixels[c][i] = both[c];
            }
            transmittance[i] = O::transmittance(both);
        }
        if O::IS_ORDERED && simd.bits_where_less(simd.load(&transmittance), simd.splat(stop_transmittance)) == u16::MAX
        {
            self.done |= 1 << block;
            self.v_done[block] = of_block.v_farthest.iter().fold(f32::INFINITY, |least, &v| min(v, least));
        }
        if late != 0 {
            self.put_late::<O>(log, number, late);
        }
    }
}
