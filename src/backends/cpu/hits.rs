//! The rays that meet one hexahedron, packed.
//!
//! In: blocks of pixels and the rays found in them, by [`hexahedra`](super::hexahedra),
//! [`polyhedra`](super::polyhedra) and, one by one, [`parts`](super::parts). Out: their
//! fragments, in the [`Log`].
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::hexahedra::HexHits;
use super::log::Log;
use super::polyhedra::PolyHits;
use super::tile::{BLOCKS, PIXELS};
use crate::optics::{CellSpan, Contribution, LANES, Lanes, Optics, Segments};

/// The rays of one cell without gaps, and room for sixteen more.
pub(super) type Packed = [f32; PIXELS + LANES];

pub(super) const NO_RAYS: Packed = [0.0; PIXELS + LANES];

/// The rays that meet one cell; kept between cells and frames.
pub(super) struct Hits {
    /// How many blocks, and how many rays.
    blocks: usize,
    pub(super) rays: usize,
    /// Per block: which it is, which of its lanes meet the cell (a bit each).
    block: [u8; BLOCKS],
    lanes: [u16; BLOCKS],
    /// Per ray: inverse depth at entry and exit, world length per unit of depth.
    pub(super) v_enter: Box<Packed>,
    pub(super) v_leave: Box<Packed>,
    pub(super) length_world_per_depth: Box<Packed>,
    pub(super) segments: Box<[Segments; BLOCKS]>,
    pub(super) of_hexahedron: HexHits,
    pub(super) of_polyhedron: PolyHits,
}

impl Default for Hits {
    fn default() -> Self {
        Self {
            blocks: 0,
            rays: 0,
            block: [0; BLOCKS],
            lanes: [0; BLOCKS],
            v_enter: Box::new(NO_RAYS),
            v_leave: Box::new(NO_RAYS),
            length_world_per_depth: Box::new(NO_RAYS),
            segments: Box::new([Segments::NONE; BLOCKS]),
            of_hexahedron: HexHits::default(),
            of_polyhedron: PolyHits::default(),
        }
    }
}

impl Hits {
    /// The `nth` block of the cell is `block`, in which `lanes` meet it.
    #[inline(always)]
    pub(super) fn begin_block(&mut self, nth: usize, block: usize, lanes: u16) {
        let place = nth % BLOCKS;
        (self.block[place], self.lanes[place]) = (block as u8, lanes);
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

    /// Shades the segments; the fragments follow those that the log's group has.
    #[inline(always)]
    pub(super) fn shade<O: Optics>(
        &self,
        optics: &O,
        span: CellSpan,
        contributions: &mut [Contribution; BLOCKS],
        log: &mut Log,
    ) {
        let vectors = self.rays.div_ceil(LANES);
        optics.contributions(span, &self.segments[..vectors], &mut contributions[..vectors]);
        let mut end = log.end();
        let first = end.fragments;
        for (vector, contribution) in contributions[..vectors].iter().enumerate() {
            *log.v_enter_mut(first + vector * LANES) = get(&self.v_enter, vector * LANES);
            log.put_contribution(first + vector * LANES, contribution);
        }
        for hit in 0..self.blocks {
            log.record(&mut end, self.block[hit] as usize, self.lanes[hit]);
        }
        log.set_end(end);
    }
}

/// Sixteen numbers from place `first` on.
#[inline(always)]
pub(super) fn get(packed: &Packed, first: usize) -> Lanes {
    *packed[first.min(PIXELS)..].first_chunk().expect("there are sixteen more")
}

/// Puts sixteen numbers at place `first` and on.
#[inline(always)]
pub(super) fn put(packed: &mut Packed, first: usize, lanes: &Lanes) {
    *packed[first.min(PIXELS)..].first_chunk_mut().expect("there is room for sixteen more") = *lanes;
}
