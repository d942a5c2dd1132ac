//! Tetrahedra in a tile: which rays meet them, and the segments they have in them.
//!
//! In: sixteen cells, set up, and which of their blocks take no fragments. Out: fragments in the [`Log`], their segments here.
//! Each step is taken for all rays of some cells before the next one: blocks are listed, rays found and packed, then cut to
//! segments. No step waits for what the one before has just stored, and none has a branch that cannot be foretold.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use std::ops::Range;

use arrayvec::ArrayVec;

use super::log::{GROUP, Log};
use super::planes::TetBatch;
use super::simd::Simd;
use super::steep::SteepCell;
use super::tile::{BLOCKS, BLOCKS_A_SIDE, TileFrame};
use crate::optics::lanes::{mask, max, min, select};
use crate::optics::{LANES, Lanes, Segments};
use crate::stages::footprints::planes::{Affine, Corners};

/// Blocks listed at once, and room for those of one more cell and for a vector that begins at the last.
const LISTED: usize = GROUP / LANES;
/// Rays of some cells without gaps, and room for sixteen more.
type Packed = [f32; GROUP + LANES];
/// Vectors of sixteen segments: a cell's begin with a new one.
const VECTORS: usize = GROUP / LANES + LANES;

/// The blocks of a box of so many columns, row by row, relative to its first.
static STEPS: [[u8; LANES]; BLOCKS_A_SIDE] = {
    let mut steps = [[0; LANES]; BLOCKS_A_SIDE];
    let mut columns = 1;
    while columns <= BLOCKS_A_SIDE {
        let mut i = 0;
        while i < LANES {
            steps[columns - 1][i] = (i / columns * BLOCKS_A_SIDE + i % columns) as u8;
            i += 1;
        }
        columns += 1;
    }
    steps
};

/// The rays that meet one cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// Which cell of the batch it is.
    pub(super) lane: usize,
    /// The first of its fragments in the group, how many it has, and the first vector of its segments.
    pub(super) first: usize,
    pub(super) rays: usize,
    pub(super) vector: usize,
    /// Its blocks among those listed.
    listed: (usize, usize),
}

impl Run {
    /// The vectors of its segments.
    #[inline(always)]
    pub(super) fn vectors(&self) -> Range<usize> {
        self.vector..self.vector + self.rays.div_ceil(LANES)
    }
}

/// The rays that meet some tetrahedra; kept between cells and frames.
pub(super) struct TetHits {
    pub(super) runs: ArrayVec<Run, LANES>,
    pub(super) segments: Box<[Segments]>,
    /// Blocks to look at: of which cell of the batch, which of the tile; then the first ray found in it.
    listed: usize,
    lane: Box<[u8; LISTED + LANES]>,
    block: Box<[u8; LISTED + LANES]>,
    first: Box<[u16; LISTED + LANES]>,
    /// Which lanes of the block meet the cell, a bit each.
    lanes: Box<[u16; LISTED + LANES]>,
    /// Per ray: inverse depth at exit, what of the scalar varies from ray to ray, world length per unit of depth.
    v_leave: Box<Packed>,
    varying: Box<Packed>,
    length_world_per_depth: Box<Packed>,
}

impl Default for TetHits {
    fn default() -> Self {
        Self {
            runs: ArrayVec::new(),
            segments: vec![Segments::NONE; VECTORS].into_boxed_slice(),
            listed: 0,
            lane: Box::new([0; LISTED + LANES]),
            block: Box::new([0; LISTED + LANES]),
            first: Box::new([0; LISTED + LANES]),
            lanes: Box::new([0; LISTED + LANES]),
            v_leave: bytemuck::zeroed_box(),
            varying: bytemuck::zeroed_box(),
            length_world_per_depth: bytemuck::zeroed_box(),
        }
    }
}

/// Finds the rays that meet the cells of the batch in `lanes` and cuts them to segments, as many cells as the log has room for; the
/// first cell that was left. Nothing in the blocks of a cell that are `done`.
#[inline(always)]
pub(super) fn meet(
    hits: &mut TetHits,
    tile: &TileFrame,
    (batch, corners): (&TetBatch, &Corners),
    lanes: Range<usize>,
    done: &[u64; LANES],
    simd: impl Simd,
    log: &mut Log,
) -> usize {
    let next = hits.list(batch, lanes, done, log.room());
    let first = log.end().fragments;
    if batch.is_any_odd {
        hits.find::<true>(tile, batch, simd, log);
    } else {
        hits.find::<false>(tile, batch, simd, log);
    }
    hits.divide(first, log.end().fragments);
    if tile.is_perspective() {
        hits.cut::<true>(tile, (batch, corners), log);
    } else {
        hits.cut::<false>(tile, (batch, corners), log);
    }
    next
}

impl TetHits {
    /// Lists the blocks of cells that may have `room` fragments together.
    #[inline(always)]
    fn list(&mut self, batch: &TetBatch, lanes: Range<usize>, done: &[u64; LANES], room: usize) -> usize {
        self.runs.clear();
        let mut listed = 0;
        for lane in lanes.clone() {
            let (first, columns, blocks) =
                (batch.first_block[lane], batch.columns[lane] as usize, batch.blocks[lane] as usize);
            if (listed + blocks) * LANES > room {
                self.listed = listed;
                return lane;
            }
            let begin = listed;
            self.lane[listed..listed + LANES].fill(lane as u8);
            self.step(listed, first, columns);
            listed += blocks;
            if blocks > LANES {
                listed = self.list_many(begin, lane, (first, columns, blocks));
            }
            if done[lane] != 0 {
                let mut kept = begin;
                for i in begin..listed {
                    self.block[kept] = self.block[i];
                    kept += usize::from(done[lane] >> self.block[i] & 1 == 0);
                }
                listed = kept;
            }
            self.runs.push(Run { lane, first: 0, rays: 0, vector: 0, listed: (begin, listed) });
        }
        self.listed = listed;
        lanes.end
    }

    /// Lists sixteen blocks of a box.
    #[inline(always)]
    fn step(&mut self, listed: usize, first: u8, columns: usize) {
        let steps = &STEPS[columns.wrapping_sub(1) % BLOCKS_A_SIDE];
        for i in 0..LANES {
            self.block[listed + i] = first.wrapping_add(steps[i]) % BLOCKS as u8;
        }
    }

    /// Lists the blocks of a larger box; how many are listed then.
    #[inline(never)]
    fn list_many(&mut self, begin: usize, lane: usize, (first, columns, blocks): (u8, usize, usize)) -> usize {
        let rows = LANES / columns;
        let (mut listed, end) = (begin, begin + blocks);
        let mut row = 0;
        while listed < end {
            self.step(listed, first + (row * BLOCKS_A_SIDE) as u8, columns);
            listed += rows * columns;
            row += rows;
        }
        self.lane[begin..end].fill(lane as u8);
        end
    }

    /// Finds the rays that meet the cells in the blocks listed. `ANY`: a cell may have front or back faces alone.
    #[inline(always)]
    fn find<const ANY: bool>(&mut self, tile: &TileFrame, batch: &TetBatch, simd: impl Simd, log: &mut Log) {
        let (affine, [v_min, v_max]) = (batch.affine(), batch.v_range());
        let mut end = log.end();
        for at in 0..self.listed.min(LISTED) {
            let (lane, block) = (self.lane[at] as usize % LANES, self.block[at] as usize % BLOCKS);
            let (column, row) = (&tile.lanes.columns[block % BLOCKS_A_SIDE], &tile.lanes.rows[block / BLOCKS_A_SIDE]);
            let (column, row) = (simd.load(column), simd.load(row));
            let on = |of: &Affine| {
                let along = simd.add(simd.splat(of.c[lane]), simd.mul(simd.splat(of.x[lane]), column));
                simd.add(along, simd.mul(simd.splat(of.y[lane]), row))
            };
            let (mut v_enter, mut v_leave) = (simd.splat(v_max[lane]), simd.splat(v_min[lane]));
            for k in 0..4 {
                let v = on(affine[k]);
                // The first face is a front face, the last a back face.
                let is_back = simd.splat_mask(batch.is_back[k][lane]);
                if ANY || k < 3 {
                    let v = if ANY || k > 0 { simd.select(is_back, simd.splat(f32::INFINITY), v) } else { v };
                    v_enter = simd.min(v, v_enter);
                }
                if ANY || k > 0 {
                    let v = if ANY || k < 3 { simd.select(is_back, v, simd.splat(f32::NEG_INFINITY)) } else { v };
                    v_leave = simd.max(v, v_leave);
                }
            }
            if let Some(limits) = &tile.limits {
                v_leave = simd.max(simd.load(&limits[block]), v_leave);
            }
            let varying = on(affine[4]);
            let lanes = simd.bits_where_less(v_leave, v_enter);
            let ray = end.fragments;
            simd.store(simd.pack(lanes, v_enter), log.v_enter_mut(ray));
            simd.store(simd.pack(lanes, v_leave), room(&mut self.v_leave, ray));
            simd.store(simd.pack(lanes, varying), room(&mut self.varying, ray));
            let lengths = simd.load(&tile.length_world_per_depth[block]);
            simd.store(simd.pack(lanes, lengths), room(&mut self.length_world_per_depth, ray));
            (self.first[at], self.lanes[at]) = (ray as u16, lanes);
            log.record(&mut end, block, lanes);
        }
        log.set_end(end);
        self.first[self.listed] = end.fragments as u16;
    }

    /// Gives each cell its rays.
    #[inline(always)]
    fn divide(&mut self, first: usize, end: usize) {
        let mut vector = 0;
        for run in &mut self.runs {
            let (begin, past) = (self.first[run.listed.0] as usize, self.first[run.listed.1] as usize);
            (run.first, run.rays, run.vector) = (begin, past - begin, vector);
            vector += run.rays.div_ceil(LANES);
        }
        debug_assert!(self.runs.iter().map(|run| run.rays).sum::<usize>() == end - first);
    }

    /// Cuts the rays to segments.
    #[inline(always)]
    fn cut<const PERSPECTIVE: bool>(&mut self, tile: &TileFrame, (batch, corners): (&TetBatch, &Corners), log: &Log) {
        let (constant, [s_min, s_max]) = (batch.constant(), batch.s_range());
        for run in 0..self.runs.len() {
            let run = self.runs[run];
            let (constant, s_min, s_max) = (constant[run.lane], s_min[run.lane], s_max[run.lane]);
            for (nth, vector) in run.vectors().enumerate() {
                let ray = run.first + nth * LANES;
                let (v_enter, v_leave) = (log.v_enter(ray), get(&self.v_leave, ray));
                let (varying, lengths) = (get(&self.varying, ray), get(&self.length_world_per_depth, ray));
                let in_cell = run.rays - nth * LANES;
                let mut cut = Segments::NONE;
                for i in 0..LANES {
                    // What is left of the last sixteen is another cell's, or nobody's: no length.
                    let is_mine = mask(i < in_cell);
                    let (v0, v1) = (select(is_mine, v_enter[i], 1.0), select(is_mine, v_leave[i], 1.0));
                    // w1 − w0 = (v0 − v1) / (v0 v1): a difference of reciprocals would cancel.
                    let reciprocal = if PERSPECTIVE { 1.0 / (v0 * v1) } else { 1.0 };
                    let (w0, w1) = if PERSPECTIVE { (v1 * reciprocal, v0 * reciprocal) } else { (-v0, -v1) };
                    let (s0, s1) = if PERSPECTIVE {
                        (constant + varying[i] * w0, constant + varying[i] * w1)
                    } else {
                        (varying[i] + constant * w0, varying[i] + constant * w1)
                    };
                    // A sliver's gradient is steep: rounding must not leave the cell's range.
                    cut.enter[i] = min(max(s0, s_min), s_max);
                    cut.leave[i] = min(max(s1, s_min), s_max);
                    cut.length_world[i] = (v0 - v1) * reciprocal * lengths[i];
                }
                self.segments[vector % VECTORS] = cut;
            }
            if let Some(steep) = batch.steep(&tile.rays, corners, run.lane) {
                self.correct::<PERSPECTIVE>(tile, &steep, run, log);
            }
        }
    }

    /// Takes the scalar of a steep cell from its faces.
    #[inline(never)]
    fn correct<const PERSPECTIVE: bool>(&mut self, tile: &TileFrame, steep: &SteepCell, run: Run, log: &Log) {
        let mut ray = 0;
        for at in run.listed.0..run.listed.1 {
            let (block, lanes) = (self.block[at] as usize, self.lanes[at]);
            let (columns, rows) = (&tile.lanes.columns[block % BLOCKS_A_SIDE], &tile.lanes.rows[block / BLOCKS_A_SIDE]);
            for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
                let v = [log.v_enter(run.first + ray)[0], self.v_leave[run.first + ray]];
                let segments = &mut self.segments[run.vector + ray / LANES];
                let is_cut = tile.limits.as_ref().is_some_and(|limits| v[1] <= limits[block][lane]);
                let [enter, leave] = steep.values::<PERSPECTIVE>([columns[lane], rows[lane]], v, is_cut);
                segments.enter[ray % LANES] = enter.unwrap_or(segments.enter[ray % LANES]);
                segments.leave[ray % LANES] = leave.unwrap_or(segments.leave[ray % LANES]);
                ray += 1;
            }
        }
    }
}

/// Sixteen numbers from place `first` on.
#[inline(always)]
fn get(packed: &Packed, first: usize) -> Lanes {
    *packed[first.min(GROUP)..].first_chunk().expect("there are sixteen more")
}

/// The room for sixteen numbers at place `first` and on.
#[inline(always)]
fn room(packed: &mut Packed, first: usize) -> &mut Lanes {
    packed[first.min(GROUP)..].first_chunk_mut().expect("there is room for sixteen more")
}
