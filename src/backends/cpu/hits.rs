//! Hits: where one cell's fragments are in a tile, and what they contribute.
//!
//! In: the cell's planes and scalar. Out: fragments, block by block, for a [`Sink`].
//! One pass tests blocks of 4×4 pixels and packs the rays that meet the cell, a third of them; a second cuts these to segments
//! and shades them; a third spreads them over the lanes of their blocks again. No branch waits for what was just computed.
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::compress::Compress;
use super::hexahedra::HexHits;
use super::log::Log;
use super::planes::CellPlanes;
use super::sink::{Fragments, Sink};
use super::steep::SteepCell;
use super::tile::{BLOCK, BLOCKS, BLOCKS_A_SIDE, PIXELS, TileFrame, origin_of};
use crate::optics::lanes::{mask, max, min};
use crate::optics::{CellSpan, Contribution, LANES, Lanes, Optics, Segments};

/// The rays of one cell without gaps, and room for sixteen more.
pub(super) type Packed = [f32; PIXELS + LANES];

pub(super) const NO_RAYS: Packed = [0.0; PIXELS + LANES];

/// The rays that meet one cell; kept between cells and frames.
pub(super) struct Hits {
    /// How many blocks, and how many rays.
    blocks: usize,
    pub(super) rays: usize,
    /// Per block: which it is, which of its lanes meet the cell (a bit each), the first of its rays.
    block: [u8; BLOCKS],
    lanes: [u16; BLOCKS],
    first: [u16; BLOCKS],
    /// Per ray: inverse depth at entry and exit, what of the scalar varies from ray to ray, world length per unit of depth.
    pub(super) v_enter: Box<Packed>,
    pub(super) v_leave: Box<Packed>,
    varying: Box<Packed>,
    pub(super) length_world_per_depth: Box<Packed>,
    pub(super) segments: Box<[Segments; BLOCKS]>,
    contributions: Box<[Contribution; BLOCKS]>,
    pub(super) log: Log,
    pub(super) of_hexahedron: HexHits,
}

impl Default for Hits {
    fn default() -> Self {
        Self {
            blocks: 0,
            rays: 0,
            block: [0; BLOCKS],
            lanes: [0; BLOCKS],
            first: [0; BLOCKS],
            v_enter: Box::new(NO_RAYS),
            v_leave: Box::new(NO_RAYS),
            varying: Box::new(NO_RAYS),
            length_world_per_depth: Box::new(NO_RAYS),
            segments: Box::new([Segments::NONE; BLOCKS]),
            contributions: Box::new([[[0.0; LANES]; 4]; BLOCKS]),
            log: Log::default(),
            of_hexahedron: HexHits::default(),
        }
    }
}

impl Hits {
    /// Finds the rays that meet the cell, in the blocks that `sink` still wants.
    #[inline(always)]
    pub(super) fn find<O: Optics, S: Sink<O>>(
        &mut self,
        tile: &TileFrame,
        cell: &CellPlanes,
        compress: impl Compress,
        sink: &S,
    ) {
        match cell.fronts {
            0 => self.find_in_front::<O, S, 0>(tile, cell, compress, sink),
            1 => self.find_in_front::<O, S, 1>(tile, cell, compress, sink),
            2 => self.find_in_front::<O, S, 2>(tile, cell, compress, sink),
            3 => self.find_in_front::<O, S, 3>(tile, cell, compress, sink),
            _ => self.find_in_front::<O, S, 4>(tile, cell, compress, sink),
        }
    }

    /// The same, where the first `FRONTS` planes are front faces.
    #[inline(always)]
    fn find_in_front<O: Optics, S: Sink<O>, const FRONTS: usize>(
        &mut self,
        tile: &TileFrame,
        cell: &CellPlanes,
        compress: impl Compress,
        sink: &S,
    ) {
        let [x0, x1, y0, y1] = cell.sides;
        let (mut blocks, mut rays) = (0, 0);
        for block_y in y0 / BLOCK..y1.div_ceil(BLOCK) {
            for block_x in x0 / BLOCK..x1.div_ceil(BLOCK) {
                let block = (block_y * BLOCKS_A_SIDE + block_x) % BLOCKS;
                if sink.is_done(block, cell.v_max) {
                    continue;
                }
                let (v_enter, mut v_leave) = cell.cover::<FRONTS>(origin_of(block));
                if let Some(limits) = &tile.limits {
                    for i in 0..LANES {
                        v_leave[i] = max(v_leave[i], limits[block][i]);
                    }
                }
                let mut is_hit = [0; LANES];
                for i in 0..LANES {
                    is_hit[i] = mask(v_enter[i] > v_leave[i]);
                }
                let lanes = compress.bits(&is_hit);
                self.begin_block(blocks, block, lanes, rays);
                put(&mut self.v_enter, rays, &compress.compress(lanes, &v_enter));
                put(&mut self.v_leave, rays, &compress.compress(lanes, &v_leave));
                put(&mut self.varying, rays, &compress.compress(lanes, &cell.scalar_at(origin_of(block))));
                let lengths = &tile.length_world_per_depth[block];
                put(&mut self.length_world_per_depth, rays, &compress.compress(lanes, lengths));
                blocks += usize::from(lanes != 0);
                rays += lanes.count_ones() as usize;
            }
        }
        self.end_blocks(blocks, rays, cell.v_max);
    }

    /// The `nth` block of the cell is `block`, in which `lanes` meet it, the first of them ray `ray`.
    #[inline(always)]
    pub(super) fn begin_block(&mut self, nth: usize, block: usize, lanes: u16, ray: usize) {
        let place = nth % BLOCKS;
        (self.block[place], self.lanes[place], self.first[place]) = (block as u8, lanes, ray as u16);
    }

    /// The cell has so many blocks and rays.
    #[inline(always)]
    pub(super) fn end_blocks(&mut self, blocks: usize, rays: usize, v_max: f32) {
        // What is left of the last sixteen takes a depth of the cell, and no length: nothing infinite, nothing to mask later.
        put(&mut self.v_enter, rays, &[v_max; LANES]);
        put(&mut self.v_leave, rays, &[v_max; LANES]);
        (self.blocks, self.rays) = (blocks.min(BLOCKS), rays.min(PIXELS));
    }

    /// Ray `ray` has the segment between inverse depths `v` with values `s` at its ends.
    pub(super) fn put_ray(
        &mut self,
        ray: usize,
        v: [f32; 2],
        s: [f32; 2],
        length_world_per_depth: f32,
        is_perspective: bool,
    ) {
        let product = if is_perspective { v[0] * v[1] } else { 1.0 };
        self.v_enter[ray] = v[0];
        let (segments, lane) = (&mut self.segments[ray / LANES % BLOCKS], ray % LANES);
        if lane == 0 {
            *segments = Segments { enter: [s[0]; LANES], leave: [s[1]; LANES], length_world: [0.0; LANES] };
        }
        (segments.enter[lane], segments.leave[lane]) = (s[0], s[1]);
        segments.length_world[lane] = (v[0] - v[1]) / product * length_world_per_depth;
    }

    /// The cell has so many blocks and rays, whose segments are known.
    pub(super) fn end_parts(&mut self, blocks: usize, rays: usize) {
        (self.blocks, self.rays) = (blocks.min(BLOCKS), rays.min(PIXELS));
    }

    /// Cuts the rays to segments.
    #[inline(always)]
    pub(super) fn cut<const PERSPECTIVE: bool>(&mut self, cell: &CellPlanes) {
        for (vector, segments) in self.segments[..self.rays.div_ceil(LANES)].iter_mut().enumerate() {
            let of = |packed: &Packed| get(packed, vector * LANES);
            let (v_enter, v_leave, varying) = (of(&self.v_enter), of(&self.v_leave), of(&self.varying));
            let length_world_per_depth = of(&self.length_world_per_depth);
            let mut cut = Segments::NONE;
            for i in 0..LANES {
                let (v0, v1) = (v_enter[i], v_leave[i]);
                // w1 − w0 = (v0 − v1) / (v0 v1): a difference of reciprocals would cancel.
                let reciprocal = if PERSPECTIVE { 1.0 / (v0 * v1) } else { 1.0 };
                let (w0, w1) = if PERSPECTIVE { (v1 * reciprocal, v0 * reciprocal) } else { (-v0, -v1) };
                let (s0, s1) = if PERSPECTIVE {
                    (cell.constant + varying[i] * w0, cell.constant + varying[i] * w1)
                } else {
                    (varying[i] + cell.constant * w0, varying[i] + cell.constant * w1)
                };
                // A sliver's gradient is steep: rounding must not leave the cell's range.
                cut.enter[i] = min(max(s0, cell.s_min), cell.s_max);
                cut.leave[i] = min(max(s1, cell.s_min), cell.s_max);
                cut.length_world[i] = (v0 - v1) * reciprocal * length_world_per_depth[i];
            }
            *segments = cut;
        }
    }

    /// Takes the scalar of a steep cell from its faces.
    #[inline(never)]
    pub(super) fn correct<const PERSPECTIVE: bool>(&mut self, tile: &TileFrame, steep: &SteepCell) {
        let lanes = &tile.lanes;
        let mut ray = 0;
        for hit in 0..self.blocks {
            let block = self.block[hit] as usize % BLOCKS;
            let [x, y] = origin_of(block);
            for lane in (0..LANES).filter(|lane| self.lanes[hit] >> lane & 1 == 1) {
                let v = [self.v_enter[ray], self.v_leave[ray]];
                let segments = &mut self.segments[ray / LANES];
                let is_cut = tile.limits.as_ref().is_some_and(|limits| v[1] <= limits[block][lane]);
                let at = [x + lanes.x[lane], y + lanes.y[lane]];
                let [enter, leave] = steep.values::<PERSPECTIVE>(at, v, is_cut);
                segments.enter[ray % LANES] = enter.unwrap_or(segments.enter[ray % LANES]);
                segments.leave[ray % LANES] = leave.unwrap_or(segments.leave[ray % LANES]);
                ray += 1;
            }
        }
    }

    /// Shades the segments.
    #[inline(always)]
    pub(super) fn shade<O: Optics>(&mut self, optics: &O, span: CellSpan) {
        let vectors = self.rays.div_ceil(LANES);
        optics.contributions(span, &self.segments[..vectors], &mut self.contributions[..vectors]);
        self.log.begin_cell();
        for (vector, contribution) in self.contributions[..vectors].iter().enumerate() {
            self.log.put(vector * LANES, &get(&self.v_enter, vector * LANES), contribution);
        }
        self.log.end_cell(self.rays);
    }

    /// Gives the fragments to `sink`.
    #[inline(always)]
    pub(super) fn send<O: Optics, S: Sink<O>>(&mut self, tile: &TileFrame, compress: impl Compress, sink: &mut S) {
        for hit in 0..self.blocks {
            let (lanes, first) = (self.lanes[hit], self.first[hit] as usize);
            let ray = self.log.ray(first);
            let (v_enter, packed) = self.log.get(ray);
            let mut contribution = [[0.0; LANES]; 4];
            for c in 0..4 {
                contribution[c] = compress.expand(lanes, &packed[c], O::CLEAR[c]);
            }
            let v_enter = compress.expand(lanes, &v_enter, 0.0);
            let block = self.block[hit] as usize % BLOCKS;
            let is_hit = tile.lanes.mask(lanes);
            let fragments =
                Fragments { block, lanes, ray, is_hit: &is_hit, v_enter: &v_enter, contribution: &contribution };
            sink.accept(compress, &fragments, &mut self.log);
        }
    }
}

/// Sixteen numbers from place `first` on.
#[inline(always)]
pub(super) fn get(packed: &Packed, first: usize) -> Lanes {
    let mut lanes = [0.0; LANES];
    lanes.copy_from_slice(&packed[first.min(PIXELS)..][..LANES]);
    lanes
}

/// Puts sixteen numbers at place `first` and on.
#[inline(always)]
pub(super) fn put(packed: &mut Packed, first: usize, lanes: &Lanes) {
    packed[first.min(PIXELS)..][..LANES].copy_from_slice(lanes);
}
