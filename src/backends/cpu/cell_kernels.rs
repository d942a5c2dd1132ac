//! What is done for cells in a tile, compiled for each instruction set.
//!
//! In: the instructions of a set ([`Simd`]). Out: set-up, rays that meet a cell, shading and sending with them, each a function of its own,
//! so that [`composite`](super::composite), which is compiled for each model and sink, holds none of them.
#![expect(
    unsafe_code,
    reason = "a function compiled for more than the baseline may run only where the processor has it"
)]

use std::ops::Range;

use super::composite::send;
use super::hexahedra;
use super::hits::Hits;
use super::log::Log;
use super::planes::TetBatch;
use super::polyhedra;
#[cfg(target_arch = "x86_64")]
use super::simd::{ByAvx2, ByAvx512};
use super::simd::{ByLane, Simd};
use super::sink::Sink;
use super::tetrahedra::{self, TetHits};
use super::tile::{BLOCKS, TileFrame};
use crate::columns::HexShape;
use crate::optics::{CellSpan, Contribution, LANES, Optics};
use crate::stages::SceneVertex;
use crate::stages::footprints::hexahedra::HexFootprint;
use crate::stages::footprints::planes::{Corners, TileRays};
use crate::stages::footprints::polyhedra::PolyFootprint;

/// What is done for cells at more than one place, or whatever the optical model: compiled once for each instruction set, and once more only
/// for what it is generic in.
pub(super) trait CellKernels: Simd {
    /// [`TetBatch::set_up`].
    fn set_up_tets(self, batch: &mut TetBatch, tile: &TileFrame, corners: &Corners);
    /// [`tetrahedra::meet`].
    fn meet_tets(
        self,
        hits: &mut TetHits,
        tile: &TileFrame,
        cells: (&TetBatch, &Corners),
        lanes: Range<usize>,
        done: &[u64; LANES],
        log: &mut Log,
    ) -> usize;
    /// [`HexFootprint::set_up`].
    fn set_up(self, footprint: &mut HexFootprint, rays: &TileRays, hexahedron: &Hexahedron<'_>);
    /// [`hexahedra::meet`].
    fn meet(self, hits: &mut Hits, tile: &TileFrame, cell: &HexFootprint, done: u64);
    /// [`polyhedra::meet`].
    fn meet_polyhedron<const IS_SUM: bool>(self, hits: &mut Hits, tile: &TileFrame, cell: &PolyFootprint, done: u64);
    /// [`Hits::shade`].
    fn shade<O: Optics>(self, hits: &Hits, optics: &O, span: CellSpan, scratch: &mut Shades, log: &mut Log);
    /// [`send`].
    fn send<O: Optics, S: Sink<O>>(self, log: &mut Log, sink: &mut S);
}

/// Room for the contributions of one cell.
type Shades = [Contribution; BLOCKS];

/// A cell of the dataset with its corners among all vertices, and its value where it has one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hexahedron<'a> {
    pub(super) index: usize,
    pub(super) vertex: [u32; 8],
    pub(super) shape: HexShape,
    pub(super) vertices: &'a [SceneVertex],
    pub(super) constant: Option<f32>,
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "each caller compiles it for another instruction set")]
fn set_up(footprint: &mut HexFootprint, rays: &TileRays, hexahedron: &Hexahedron<'_>) {
    let Hexahedron { vertex, shape, vertices, constant, .. } = *hexahedron;
    footprint.set_up(rays, (vertex, shape), vertices, constant);
}

impl CellKernels for ByLane {
    #[inline(never)]
    fn set_up_tets(self, batch: &mut TetBatch, tile: &TileFrame, corners: &Corners) {
        batch.set_up(tile, corners);
    }

    #[inline(never)]
    fn meet_tets(
        self,
        hits: &mut TetHits,
        tile: &TileFrame,
        cells: (&TetBatch, &Corners),
        lanes: Range<usize>,
        done: &[u64; LANES],
        log: &mut Log,
    ) -> usize {
        tetrahedra::meet(hits, tile, cells, lanes, done, self, log)
    }

    #[inline(never)]
    fn set_up(self, footprint: &mut HexFootprint, rays: &TileRays, hexahedron: &Hexahedron<'_>) {
        set_up(footprint, rays, hexahedron);
    }

    #[inline(never)]
    fn meet(self, hits: &mut Hits, tile: &TileFrame, cell: &HexFootprint, done: u64) {
        hexahedra::meet(hits, tile, cell, self, done);
    }

    #[inline(never)]
    fn meet_polyhedron<const IS_SUM: bool>(self, hits: &mut Hits, tile: &TileFrame, cell: &PolyFootprint, done: u64) {
        polyhedra::meet::<IS_SUM>(hits, tile, cell, self, done);
    }

    #[inline(never)]
    fn shade<O: Optics>(self, hits: &Hits, optics: &O, span: CellSpan, scratch: &mut Shades, log: &mut Log) {
        hits.shade(optics, span, scratch, log);
    }

    #[inline(never)]
    fn send<O: Optics, S: Sink<O>>(self, log: &mut Log, sink: &mut S) {
        send::<O, S>(self, log, sink);
    }
}

macro_rules! cell_kernels {
    ($by:ty, $features:literal, $set_up_tets:ident, $meet_tets:ident, $set_up:ident, $meet:ident, $meet_polyhedron:ident, $shade:ident, $send:ident) => {
        #[cfg(target_arch = "x86_64")]
        impl CellKernels for $by {
            fn set_up_tets(self, batch: &mut TetBatch, tile: &TileFrame, corners: &Corners) {
                // SAFETY: whoever made `self` vouched for the processor.
                unsafe { $set_up_tets(batch, tile, corners) }
            }

            fn meet_tets(
                self,
                hits: &mut TetHits,
                tile: &TileFrame,
                cells: (&TetBatch, &Corners),
                lanes: Range<usize>,
                done: &[u64; LANES],
                log: &mut Log,
            ) -> usize {
                // SAFETY: as above.
                unsafe { $meet_tets(self, hits, (tile, cells), lanes, done, log) }
            }

            fn set_up(self, footprint: &mut HexFootprint, rays: &TileRays, hexahedron: &Hexahedron<'_>) {
                // SAFETY: as above.
                unsafe { $set_up(footprint, rays, hexahedron) }
            }

            fn meet(self, hits: &mut Hits, tile: &TileFrame, cell: &HexFootprint, done: u64) {
                // SAFETY: as above.
                unsafe { $meet(self, hits, tile, cell, done) }
            }

            fn meet_polyhedron<const IS_SUM: bool>(
                self,
                hits: &mut Hits,
                tile: &TileFrame,
                cell: &PolyFootprint,
                done: u64,
            ) {
                // SAFETY: as above.
                unsafe { $meet_polyhedron::<IS_SUM>(self, hits, tile, cell, done) }
            }

            fn shade<O: Optics>(self, hits: &Hits, optics: &O, span: CellSpan, scratch: &mut Shades, log: &mut Log) {
                // SAFETY: as above.
                unsafe { $shade(hits, optics, span, scratch, log) }
            }

            fn send<O: Optics, S: Sink<O>>(self, log: &mut Log, sink: &mut S) {
                // SAFETY: as above.
                unsafe { $send::<O, S>(self, log, sink) }
            }
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = $features)]
        fn $set_up_tets(batch: &mut TetBatch, tile: &TileFrame, corners: &Corners) {
            batch.set_up(tile, corners);
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = $features)]
        fn $meet_tets(
            by: $by,
            hits: &mut TetHits,
            (tile, cells): (&TileFrame, (&TetBatch, &Corners)),
            lanes: Range<usize>,
            done: &[u64; LANES],
            log: &mut Log,
        ) -> usize {
            tetrahedra::meet(hits, tile, cells, lanes, done, by, log)
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = $features)]
        fn $set_up(footprint: &mut HexFootprint, rays: &TileRays, hexahedron: &Hexahedron<'_>) {
            set_up(footprint, rays, hexahedron);
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = $features)]
        fn $meet(by: $by, hits: &mut Hits, tile: &TileFrame, cell: &HexFootprint, done: u64) {
            hexahedra::meet(hits, tile, cell, by, done);
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = $features)]
        fn $meet_polyhedron<const IS_SUM: bool>(
            by: $by,
            hits: &mut Hits,
            tile: &TileFrame,
            cell: &PolyFootprint,
            done: u64,
        ) {
            polyhedra::meet::<IS_SUM>(hits, tile, cell, by, done);
        }

        #[cfg(target_arch = "x86_64")]
        #[inline(never)]
        #[target_feature(enable = $features)]
        fn $shade<O: Optics>(hits: &Hits, optics: &O, span: CellSpan, scratch: &mut Shades, log: &mut Log) {
            hits.shade(optics, span, scratch, log);
        }

        #[cfg(target_arch = "x86_64")]
        #[inline(never)]
        #[target_feature(enable = $features)]
        fn $send<O: Optics, S: Sink<O>>(by: $by, log: &mut Log, sink: &mut S) {
            send::<O, S>(by, log, sink);
        }
    };
}

cell_kernels!(
    ByAvx2,
    "avx2,popcnt,bmi1,bmi2",
    set_up_tets_avx2,
    meet_tets_avx2,
    set_up_avx2,
    meet_avx2,
    meet_polyhedron_avx2,
    shade_avx2,
    send_avx2
);
cell_kernels!(
    ByAvx512,
    "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2",
    set_up_tets_avx512,
    meet_tets_avx512,
    set_up_avx512,
    meet_avx512,
    meet_polyhedron_avx512,
    shade_avx512,
    send_avx512
);
