//! The cells of a tile against its blocks of pixels.
//!
//! In: the tile's cells in order. Out: fragments, sixteen lanes at a time, for a [`Sink`].
//! Sixteen cells are set up at once, one a lane; the rays that meet them are found and packed, shaded, and sent block by block.
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::cell_kernels::{CellKernels, Hexahedron};
use super::crossed::Crossed;
use super::gather::Gather;
use super::hits::Hits;
use super::log::Log;
use super::planes::TetBatch;
use super::simd::Simd;
use super::sink::{Fragments, Sink};
use super::tetrahedra::TetHits;
use super::tile::{BLOCKS, PIXELS, TileFrame};
use crate::optics::{CellSpan, Contribution, LANES, Optics};
use crate::stages::footprints::hexahedra::{HexFootprint, Outline};
use crate::stages::footprints::planes::Corners;
use crate::stages::footprints::polyhedra::PolyFootprint;
use crate::stages::sort::radix::{Pair, index_of, key_of};

/// What compositing a tile needs beside its cells and its sink; kept between tiles and frames.
pub(super) struct Scratch {
    log: Log,
    contributions: Box<[Contribution; BLOCKS]>,
    corners: Corners,
    batch: TetBatch,
    tet_hits: TetHits,
    footprint: HexFootprint,
    polyhedron: PolyFootprint,
    crossed: Crossed,
    hits: Hits,
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            log: Log::default(),
            contributions: bytemuck::zeroed_box(),
            corners: Corners::default(),
            batch: TetBatch::default(),
            tet_hits: TetHits::default(),
            footprint: HexFootprint::default(),
            polyhedron: PolyFootprint::default(),
            crossed: Crossed::default(),
            hits: Hits::default(),
        }
    }
}

/// Batches of cells between two looks at whether the frame is still wanted: some milliseconds where each is a polyhedron that covers the
/// tile, and microseconds as a rule, beside which a look is nothing.
const LOOK: usize = 2;

/// Sends the fragments of the cells of `order` to `sink`.
#[inline(always)]
pub(super) fn composite<O: Optics, S: Sink<O>>(
    tile: &TileFrame,
    optics: &O,
    order: &[Pair],
    kernels: impl CellKernels,
    scratch: &mut Scratch,
    sink: &mut S,
) {
    let dataset = tile.frame.dataset;
    let (hexahedra, first_hexahedron) = (dataset.hexahedra.view(), dataset.tets.len());
    let first_polyhedron = dataset.first_polyhedron();
    let mut gather = Gather::new(tile.frame, order);
    scratch.log.reset();
    for (nth, cells) in order.chunks(LANES).enumerate() {
        if sink.is_all_done() || (nth % LOOK == 0 && tile.frame.control.is_cancelled()) {
            return;
        }
        // Largest values come first, where they count: none of the cells left exceeds this.
        if O::IS_MAXIMUM && sink.is_all_done_at(tile.frame.keys.at_most(key_of(cells[0]))) {
            return;
        }
        let tets = gather.next(&mut scratch.corners);
        if tets > 0 {
            kernels.set_up_tets(&mut scratch.batch, tile, &scratch.corners);
        }
        let cell_of = |lane: usize| index_of(cells[lane]) as usize;
        let mut lane = 0;
        while lane < cells.len() {
            if scratch.log.room() < PIXELS {
                kernels.send::<O, S>(&mut scratch.log, sink);
            }
            if cell_of(lane) >= first_polyhedron {
                composite_polyhedron(tile, optics, cell_of(lane), kernels, scratch, sink);
                lane += 1;
                continue;
            }
            if let Some(hexahedron) = cell_of(lane).checked_sub(first_hexahedron) {
                let hexahedron = Hexahedron {
                    index: cell_of(lane),
                    vertex: gather.hexahedron(hexahedron, nth * LANES + lane),
                    shape: hexahedra.shape(hexahedron),
                    vertices: tile.frame.vertices,
                    constant: tile.frame.cell_values().map(|values| values[cell_of(lane)]),
                };
                composite_hexahedron(tile, optics, &hexahedron, kernels, scratch, sink);
                lane += 1;
                continue;
            }
            let tets = (lane..cells.len()).take_while(|&lane| cell_of(lane) < first_hexahedron).count();
            let Scratch { log, contributions, corners, batch, tet_hits, .. } = &mut *scratch;
            let ([s_min, s_max], length_max) = (batch.s_range(), batch.length_world_max());
            let next = kernels.meet_tets(
                tet_hits,
                tile,
                (batch, corners),
                lane..lane + tets,
                &done_blocks(batch, kernels, sink),
                log,
            );
            for run in tet_hits.runs.iter().filter(|run| run.rays > 0) {
                let span = CellSpan::new(tile.frame.intervals(), s_min[run.lane], s_max[run.lane]);
                let span = span.within(length_max[run.lane]).of_cell(cell_of(run.lane));
                let segments = &tet_hits.segments[run.vectors()];
                let contributions = &mut contributions[..segments.len()];
                optics.contributions(span, segments, contributions);
                for (nth, contribution) in contributions.iter().enumerate() {
                    log.put_contribution(run.first + nth * LANES, contribution);
                }
            }
            lane = next;
            if lane < cells.len() && cell_of(lane) < first_hexahedron {
                // The log was full.
                kernels.send::<O, S>(log, sink);
            }
        }
        kernels.send::<O, S>(&mut scratch.log, sink);
    }
}

/// The blocks that take no fragments of each cell of the batch.
#[inline(always)]
fn done_blocks<O: Optics, S: Sink<O>>(batch: &TetBatch, simd: impl Simd, sink: &S) -> [u64; LANES] {
    let mut done = [0; LANES];
    if sink.is_any_done() {
        let ([_, v_max], [_, s_max]) = (batch.v_range(), batch.s_range());
        for lane in 0..LANES {
            done[lane] = sink.done_at(simd, v_max[lane], s_max[lane]);
        }
    }
    done
}

/// Shades the fragments of a hexahedron.
#[inline(always)]
fn composite_hexahedron<O: Optics, S: Sink<O>>(
    tile: &TileFrame,
    optics: &O,
    hexahedron: &Hexahedron<'_>,
    kernels: impl CellKernels,
    scratch: &mut Scratch,
    sink: &mut S,
) {
    let Scratch { log, contributions, footprint, crossed, hits, .. } = scratch;
    kernels.set_up(footprint, &tile.rays, hexahedron);
    let done = if sink.is_any_done() { sink.done_at(kernels, footprint.v_max, footprint.s_max) } else { 0 };
    let span = CellSpan::new(tile.frame.intervals(), footprint.s_min, footprint.s_max);
    let span = span.within(tile.length_world_max([footprint.v_min, footprint.v_max])).of_cell(hexahedron.index);
    if footprint.outline == Outline::Simple {
        kernels.meet(hits, tile, footprint, done);
        kernels.shade(hits, optics, span, contributions, log);
        return;
    }
    crossed.find((tile.frame.view, tile.first_px, tile.limits.as_deref()), hexahedron, footprint);
    for nth in 0..crossed.parts.most() {
        if log.room() < PIXELS {
            kernels.send::<O, S>(log, sink);
        }
        crossed.parts.put(nth, tile, hits, done);
        kernels.shade(hits, optics, span, contributions, log);
    }
}

/// Shades the fragments of the polyhedron that is cell `index` of the dataset.
#[inline(always)]
fn composite_polyhedron<O: Optics, S: Sink<O>>(
    tile: &TileFrame,
    optics: &O,
    index: usize,
    kernels: impl CellKernels,
    scratch: &mut Scratch,
    sink: &mut S,
) {
    let Scratch { log, contributions, polyhedron: footprint, hits, .. } = scratch;
    let (dataset, constant) = (tile.frame.dataset, tile.frame.cell_values().map(|values| values[index]));
    let cell = (&dataset.polyhedra.view(), index - dataset.first_polyhedron());
    footprint.set_up((&tile.rays, &tile.exact_rays), cell, tile.frame.vertices, constant);
    let done = if sink.is_any_done() { sink.done_at(kernels, footprint.v_max, footprint.s_max) } else { 0 };
    let span = CellSpan::new(tile.frame.intervals(), footprint.s_min, footprint.s_max);
    let span = span.within(tile.length_world_max([footprint.v_min, footprint.v_max])).of_cell(index);
    if constant.is_some() && !O::IS_ORDERED {
        kernels.meet_polyhedron::<true>(hits, tile, footprint, done);
    } else {
        kernels.meet_polyhedron::<false>(hits, tile, footprint, done);
    }
    kernels.shade(hits, optics, span, contributions, log);
    if hits.of_polyhedron.parts.most() > 0 {
        let parts = std::mem::take(&mut hits.of_polyhedron.parts);
        for nth in 0..parts.most() {
            if log.room() < PIXELS {
                kernels.send::<O, S>(log, sink);
            }
            parts.put(nth, tile, hits, done);
            kernels.shade(hits, optics, span, contributions, log);
        }
        hits.of_polyhedron.parts = parts;
    }
}

/// Gives the fragments of the log's group to `sink`, and begins the next group.
#[inline(always)]
pub(super) fn send<O: Optics, S: Sink<O>>(simd: impl Simd, log: &mut Log, sink: &mut S) {
    for number in log.group() {
        let (record, v_enter, packed) = log.get(number);
        let mut contribution = [[0.0; LANES]; 4];
        for c in 0..O::CHANNELS {
            contribution[c] = simd.expand(record.lanes, &packed[c], O::CLEAR[c]);
        }
        let v_enter = simd.expand(record.lanes, &v_enter, f32::INFINITY);
        let fragments = Fragments {
            block: record.block as usize % BLOCKS,
            number,
            lanes: record.lanes,
            v_enter: &v_enter,
            contribution: &contribution,
        };
        sink.accept(simd, &fragments, log);
    }
    log.begin_group();
}
