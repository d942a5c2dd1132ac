//! Blending front to back, with a check of the order.
//!
//! In: cells in about the order of their depths. Out: the contribution of each pixel, and the blocks in which a fragment came too late.
//! A fragment nearly always lies behind all that its pixel has drawn, and is put behind it. Where the order is to be exact, one that
//! came late is put where it belongs: with the fragments behind it, which the [`Log`] remembers for a while, composited to one, the
//! contribution of all is `front over behind`, and becomes `front over late over behind` ([`Optics::slipped_in`]).
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use arrayvec::ArrayVec;

use super::compress::Compress;
use super::log::{Before, Log, NOTHING};
use super::sink::{Fragments, Sink};
use super::tile::BLOCKS;
use crate::optics::lanes::{mask, min, select};
use crate::optics::{Contribution, LANES, Lanes, Mask, Optics};

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

/// Blends a tile; counts the fragments that came after one behind them.
pub(super) struct Blend {
    blending: Blending,
    pixels: Box<[Contribution; BLOCKS]>,
    /// Of each pixel the smallest inverse depth of a fragment's entry, and its last fragment.
    v_farthest: Box<[Lanes; BLOCKS]>,
    last: Box<[Mask; BLOCKS]>,
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
            pixels: Box::new([[[0.0; LANES]; 4]; BLOCKS]),
            v_farthest: Box::new([[0.0; LANES]; BLOCKS]),
            last: Box::new([[NOTHING; LANES]; BLOCKS]),
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
        self.pixels.fill(O::CLEAR.map(|clear| [clear; LANES]));
        self.v_farthest.fill([f32::INFINITY; LANES]);
        self.last.fill([NOTHING; LANES]);
        (self.done, self.violations, self.late_blocks) = (0, 0, 0);
    }

    /// Fragments that came after one that lies behind them, and stayed there.
    pub(super) fn violations(&self) -> u64 {
        self.violations
    }

    /// One bit for each block with such a fragment.
    pub(super) fn late_blocks(&self) -> u64 {
        self.late_blocks
    }

    /// The contribution of each pixel, block by block, lane by lane.
    pub(super) fn contributions(&self) -> impl Iterator<Item = [f32; 4]> {
        self.pixels.iter().flat_map(|block| (0..LANES).map(move |lane| std::array::from_fn(|c| block[c][lane])))
    }

    /// Puts late fragments where they belong, or counts them.
    #[inline(never)]
    fn put_late<O: Optics>(&mut self, log: &mut Log, block: usize, (lanes, late): (u16, u16), first: usize) {
        let mut rest = late;
        while rest != 0 {
            let lane = rest.trailing_zeros();
            rest &= rest - 1;
            let before = lanes & ((1 << lane) - 1);
            let place = first + before.count_ones() as usize;
            log.mark_late(place);
            if !self.blending.is_exact || !self.slip_in::<O>(log, place, block, lane as usize) {
                self.violations += 1;
                self.late_blocks |= 1 << block;
            }
        }
    }

    /// Puts a fragment before those that lie behind it; false where these are not known any more, or too many, or too dark.
    fn slip_in<O: Optics>(&mut self, log: &Log, place: usize, block: usize, lane: usize) -> bool {
        let (v_enter, contribution) = log.fragment(place);
        let mut behind: ArrayVec<(f32, [f32; 4]), BEHIND> = ArrayVec::new();
        let mut at = place;
        loop {
            match log.before(at) {
                Before::Nothing => break,
                Before::Forgotten => return false,
                Before::Fragment(other) => at = other,
            }
            let other = log.fragment(at);
            if other.0 < v_enter {
                if behind.try_push(other).is_err() {
                    return false;
                }
            } else if !log.is_late(at) {
                // It lay behind all before it, so these lie before the fragment too.
                break;
            }
        }
        behind.sort_by(|a, b| b.0.total_cmp(&a.0));
        let behind = behind.iter().map(|&(_, contribution)| contribution).fold(O::CLEAR, O::over);
        let pixels = &mut self.pixels[block];
        let whole = [0, 1, 2, 3].map(|c: usize| pixels[c][lane]);
        let Some(whole) = O::slipped_in(whole, behind, contribution) else { return false };
        for c in 0..4 {
            pixels[c][lane] = whole[c];
        }
        true
    }
}

impl<O: Optics> Sink<O> for Blend {
    #[inline(always)]
    fn is_done(&self, block: usize, v_max: f32) -> bool {
        // Where the order must be exact, an opaque block still looks at cells that might lie in front.
        self.done >> block & 1 == 1 && (!self.blending.is_exact || v_max <= self.v_done[block])
    }

    #[inline(always)]
    fn is_all_done(&self) -> bool {
        !self.blending.is_exact && self.done == u64::MAX
    }

    #[inline(always)]
    fn accept(&mut self, compress: impl Compress, fragments: &Fragments, log: &mut Log) {
        let Fragments { block, lanes, is_hit, ray, v_enter, contribution } = *fragments;
        let Blending { is_exact, stop_transmittance, slack } = self.blending;
        let mut is_late = [0; LANES];
        if O::IS_ORDERED {
            if is_exact {
                log.link(compress, ray, lanes, is_hit, &mut self.last[block]);
            }
            let v_farthest = &mut self.v_farthest[block];
            for i in 0..LANES {
                let v = v_farthest[i];
                is_late[i] = is_hit[i] & mask(v_enter[i] > v + (v.abs() * slack.relative + slack.absolute));
                v_farthest[i] = select(is_hit[i], min(v_enter[i], v), v);
            }
        }
        // What came late waits where the order is to be exact.
        let waits = mask(is_exact);
        let pixels = &mut self.pixels[block];
        let mut is_clear = [0; LANES];
        for i in 0..LANES {
            let front = [pixels[0][i], pixels[1][i], pixels[2][i], pixels[3][i]];
            let back = [contribution[0][i], contribution[1][i], contribution[2][i], contribution[3][i]];
            let both = O::over(front, back);
            for c in 0..4 {
                pixels[c][i] = select(is_late[i] & waits, front[c], both[c]);
            }
            is_clear[i] = mask(O::transmittance(both) >= stop_transmittance);
        }
        if O::IS_ORDERED {
            if compress.bits(&is_clear) == 0 {
                self.done |= 1 << block;
                self.v_done[block] = self.v_farthest[block].iter().fold(f32::INFINITY, |least, &v| min(v, least));
            }
            let late = compress.bits(&is_late);
            if late != 0 {
                self.put_late::<O>(log, block, (lanes, late), ray);
            }
        }
    }
}
