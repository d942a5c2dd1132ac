//! Where a tile's fragments go: blended at once, or collected and sorted per pixel.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::compress::{ByLane, Compress};
use super::tile::{BLOCKS, PIXELS};
use crate::optics::lanes::{mask, min, select};
use crate::optics::{Contribution, LANES, Lanes, Mask, Optics};

/// The fragments of one cell in one 4×4 block.
pub(super) struct Fragments<'a> {
    /// The block in the tile.
    pub(super) block: usize,
    /// The lanes that meet the cell.
    pub(super) is_hit: &'a Mask,
    /// Inverse depth at entry.
    pub(super) v_enter: &'a Lanes,
    /// What each lane's segment contributes; nothing in lanes that miss.
    pub(super) contribution: &'a Contribution,
}

/// Takes fragments, cells in the tile's order.
pub(super) trait Sink<O: Optics> {
    /// Whether the block takes no fragments of a cell whose nearest point has inverse depth `v_max`.
    fn is_done(&self, block: usize, v_max: f32) -> bool;
    /// Whether no block takes fragments of any cell.
    fn is_all_done(&self) -> bool;
    /// Takes the fragments of one cell in one block.
    fn accept(&mut self, compress: impl Compress, fragments: &Fragments);
}

/// Slack of the order check: two neighbours meet where both compute the same plane, but clamps and edges round differently.
#[derive(Clone, Copy, Debug)]
pub(super) struct OrderSlack {
    pub(super) relative: f32,
    pub(super) absolute: f32,
}

/// Blends front to back and counts the fragments that came after one behind them.
///
/// Each pixel holds back the farthest `HELD` of its fragments and blends the nearest of these and a newcomer: most of what an
/// approximate order gets wrong is a cell exchanged with one of the next few, which this puts right.
pub(super) struct Blend<const HELD: usize> {
    pixels: Box<[Contribution; BLOCKS]>,
    v_last: Box<[Lanes; BLOCKS]>,
    /// Nearest first.
    held: Box<[[Fragment16; HELD]; BLOCKS]>,
    done: u64,
    /// The farthest that a block has drawn when it was done.
    v_done: [f32; BLOCKS],
    stop: f32,
    slack: OrderSlack,
    violations: u64,
    late_blocks: u64,
}

/// A fragment for each pixel of a block.
#[derive(Clone, Copy)]
struct Fragment16 {
    v_enter: Lanes,
    contribution: Contribution,
}

impl<const HELD: usize> Default for Blend<HELD> {
    fn default() -> Self {
        let nothing = Fragment16 { v_enter: [0.0; LANES], contribution: [[0.0; LANES]; 4] };
        Self {
            pixels: Box::new([nothing.contribution; BLOCKS]),
            v_last: Box::new([nothing.v_enter; BLOCKS]),
            held: Box::new([[nothing; HELD]; BLOCKS]),
            done: 0,
            v_done: [0.0; BLOCKS],
            stop: 0.0,
            slack: OrderSlack { relative: 0.0, absolute: 0.0 },
            violations: 0,
            late_blocks: 0,
        }
    }
}

impl<const HELD: usize> Blend<HELD> {
    /// Empties the tile; a block is done when all its pixels transmit less than `stop`.
    pub(super) fn reset<O: Optics>(&mut self, stop: f32, slack: OrderSlack) {
        let contribution = O::CLEAR.map(|clear| [clear; LANES]);
        let v = [f32::INFINITY; LANES];
        self.pixels.fill(contribution);
        self.v_last.fill(v);
        self.held.fill([Fragment16 { v_enter: v, contribution }; HELD]);
        (self.done, self.stop, self.slack, self.violations, self.late_blocks) = (0, stop, slack, 0, 0);
    }

    /// Blends what is held back.
    pub(super) fn finish<O: Optics>(&mut self) {
        for block in 0..BLOCKS {
            for nearest in 0..HELD {
                let Fragment16 { v_enter, contribution } = self.held[block][nearest];
                self.blend::<O>(ByLane, block, &[u32::MAX; LANES], &v_enter, &contribution);
            }
        }
    }

    /// Fragments that came after one that lies behind them.
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

    /// Puts a fragment behind all that its pixel holds, in the lanes of `is_hit`; elsewhere it contributes nothing.
    #[inline(always)]
    fn blend<O: Optics>(
        &mut self,
        compress: impl Compress,
        block: usize,
        is_hit: &Mask,
        v_enter: &Lanes,
        contribution: &Contribution,
    ) {
        let pixels = &mut self.pixels[block];
        let mut is_clear = [0; LANES];
        for i in 0..LANES {
            let front = [pixels[0][i], pixels[1][i], pixels[2][i], pixels[3][i]];
            let back = [contribution[0][i], contribution[1][i], contribution[2][i], contribution[3][i]];
            let both = O::over(front, back);
            for c in 0..4 {
                pixels[c][i] = both[c];
            }
            is_clear[i] = mask(O::transmittance(both) >= self.stop);
        }
        if O::IS_ORDERED {
            let v_last = &mut self.v_last[block];
            let mut is_late = [0; LANES];
            for i in 0..LANES {
                let last = v_last[i];
                let limit = last + (last.abs() * self.slack.relative + self.slack.absolute);
                is_late[i] = is_hit[i] & mask(v_enter[i] > limit);
                v_last[i] = select(is_hit[i], v_enter[i], last);
            }
            let late = compress.bits(&is_late);
            if late != 0 {
                self.violations += u64::from(late.count_ones());
                self.late_blocks |= 1 << block;
            }
            if compress.bits(&is_clear) == 0 {
                self.done |= 1 << block;
                self.v_done[block] = v_last.iter().fold(f32::INFINITY, |least, &v| min(v, least));
            }
        }
    }
}

impl<O: Optics, const HELD: usize> Sink<O> for Blend<HELD> {
    #[inline(always)]
    fn is_done(&self, block: usize, v_max: f32) -> bool {
        // Where the order must be exact, an opaque block still looks at cells that might lie in front.
        self.done >> block & 1 == 1 && (HELD == 0 || v_max <= self.v_done[block])
    }

    #[inline(always)]
    fn is_all_done(&self) -> bool {
        HELD == 0 && self.done == u64::MAX
    }

    #[inline(always)]
    fn accept(&mut self, compress: impl Compress, fragments: &Fragments) {
        let Fragments { block, is_hit, v_enter, contribution } = *fragments;
        let (mut v_enter, mut contribution) = (*v_enter, *contribution);
        // Farthest first: the newcomer stays where it lies behind, the one it finds there moves on with it.
        for held in self.held[block].iter_mut().rev() {
            for i in 0..LANES {
                let is_behind = is_hit[i] & mask(v_enter[i] <= held.v_enter[i]);
                (v_enter[i], held.v_enter[i]) = exchange(is_behind, v_enter[i], held.v_enter[i]);
                for c in 0..4 {
                    (contribution[c][i], held.contribution[c][i]) =
                        exchange(is_behind, contribution[c][i], held.contribution[c][i]);
                }
            }
        }
        self.blend::<O>(compress, block, is_hit, &v_enter, &contribution);
    }
}

/// Both, exchanged where the mask is set.
#[inline(always)]
fn exchange(mask: u32, a: f32, b: f32) -> (f32, f32) {
    (select(mask, b, a), select(mask, a, b))
}

/// A fragment on its own.
#[derive(Clone, Copy, Debug)]
struct Fragment {
    pixel: u16,
    v_enter: f32,
    contribution: [f32; 4],
}

/// Keeps every fragment of some blocks, then composites each pixel's in the order of their depths: right for any disjoint cells.
#[derive(Default)]
pub(super) struct Collect {
    blocks: u64,
    fragments: Vec<Fragment>,
    fragment_from_sorted: Vec<u32>,
}

impl Collect {
    /// Forgets all fragments and takes those of `blocks`, one bit each.
    pub(super) fn reset(&mut self, blocks: u64) {
        self.blocks = blocks;
        self.fragments.clear();
    }

    /// Writes the pixels of its blocks to `out`, block by block, lane by lane.
    pub(super) fn composite<O: Optics>(&mut self, optics: &O, out: &mut [[f32; 4]; PIXELS]) {
        // Count, scan, write: the fragments of a pixel together, in the order they came.
        let mut starts = [0_u32; PIXELS + 1];
        for fragment in &self.fragments {
            starts[fragment.pixel as usize + 1] += 1;
        }
        for pixel in 0..PIXELS {
            starts[pixel + 1] += starts[pixel];
        }
        let mut places = starts;
        self.fragment_from_sorted.resize(self.fragments.len(), 0);
        for (i, fragment) in self.fragments.iter().enumerate() {
            let place = &mut places[fragment.pixel as usize];
            self.fragment_from_sorted[*place as usize] = i as u32;
            *place += 1;
        }
        let is_mine = |pixel: usize| self.blocks >> (pixel / LANES) & 1 == 1;
        for (pixel, out) in out.iter_mut().enumerate().filter(|&(pixel, _)| is_mine(pixel)) {
            let of_pixel = &mut self.fragment_from_sorted[starts[pixel] as usize..starts[pixel + 1] as usize];
            of_pixel.sort_by(|&a, &b| {
                let v = |i: u32| self.fragments[i as usize].v_enter;
                v(b).total_cmp(&v(a))
            });
            let fragments = of_pixel.iter().map(|&i| self.fragments[i as usize].contribution);
            *out = optics.pixel(fragments.fold(O::CLEAR, O::over));
        }
    }
}

impl<O: Optics> Sink<O> for Collect {
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
        for i in 0..LANES {
            if fragments.is_hit[i] != 0 {
                self.fragments.push(Fragment {
                    pixel: (fragments.block * LANES + i) as u16,
                    v_enter: fragments.v_enter[i],
                    contribution: std::array::from_fn(|c| fragments.contribution[c][i]),
                });
            }
        }
    }
}
