//! Run-time dispatch: the same kernel compiled for several instruction sets, chosen by what the processor offers.
//!
//! The kernels use no fused or reordered operations, so that every instruction set gives the same bits.
#![expect(
    unsafe_code,
    reason = "a function compiled for more than the baseline may run only where the processor has it"
)]

use std::ops::Range;

use super::composite::{Scratch, composite, send};
use super::cubes::{BinnedCube, CubeTile};
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
use crate::backends::Frame;
use crate::columns::HexShape;
use crate::optics::{CellSpan, Contribution, LANES, Optics};
use crate::stages::SceneVertex;
use crate::stages::footprints::hexahedra::HexFootprint;
use crate::stages::footprints::planes::{Corners, TileRays};
use crate::stages::footprints::polyhedra::PolyFootprint;
use crate::stages::footprints::{BoxLanes, PixelBoxes};
use crate::stages::sort::KeyMaker;
use crate::stages::sort::radix::Pair;

/// An instruction set that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// What every processor of the target has (SSE2 on x86-64, NEON on aarch64).
    Baseline,
    /// AVX2, with the bit counts that its processors have.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 F, BW, DQ, VL, and AVX2.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl InstructionSet {
    /// Those this processor has, best first.
    pub fn available() -> Vec<Self> {
        let mut sets = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            let has_avx2 = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("popcnt")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2");
            if has_avx2
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
            {
                sets.push(Self::Avx512);
            }
            if has_avx2 {
                sets.push(Self::Avx2);
            }
        }
        sets.push(Self::Baseline);
        sets
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => "avx512",
        }
    }
}

/// The kernels of one instruction set that this processor has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernels {
    pub(super) set: InstructionSet,
}

impl Kernels {
    /// The kernels for `set`, or for the best set there is where the processor lacks it.
    pub(super) fn new(set: Option<InstructionSet>) -> Self {
        let available = InstructionSet::available();
        let set = set.filter(|set| available.contains(set)).unwrap_or(available[0]);
        Self { set }
    }

    /// [`composite`] for this instruction set.
    pub(super) fn composite<O: Optics, S: Sink<O>>(
        self,
        tile: &TileFrame,
        optics: &O,
        order: &[Pair],
        scratch: &mut Scratch,
        sink: &mut S,
    ) {
        match self.set {
            InstructionSet::Baseline => composite(tile, optics, order, ByLane, scratch, sink),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `Kernels::new`, the only constructor, keeps a set only if `available` detected its features.
            InstructionSet::Avx2 => unsafe { composite_avx2(tile, optics, order, scratch, sink) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            InstructionSet::Avx512 => unsafe { composite_avx512(tile, optics, order, scratch, sink) },
        }
    }
}

impl Kernels {
    /// [`PixelBoxes::of_lanes`] for this instruction set.
    pub(super) fn boxes(self, boxes: &PixelBoxes, corners: &Corners, found: &mut BoxLanes) {
        match self.set {
            InstructionSet::Baseline => boxes.of_lanes(corners, found),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx2 => unsafe { boxes_avx2(boxes, corners, found) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx512 => unsafe { boxes_avx512(boxes, corners, found) },
        }
    }

    /// [`KeyMaker::of_lanes`] for this instruction set.
    pub(super) fn keys(self, keys: &KeyMaker, corners: &Corners, key: &mut [u32; LANES]) {
        match self.set {
            InstructionSet::Baseline => keys.of_lanes(corners, key),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx2 => unsafe { keys_avx2(keys, corners, key) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx512 => unsafe { keys_avx512(keys, corners, key) },
        }
    }

    /// [`CubeTile::composite`] for this instruction set.
    pub(super) fn cubes<O: Optics>(self, tile: &mut CubeTile, frame: &Frame, optics: &O, cubes: &[BinnedCube]) {
        match self.set {
            InstructionSet::Baseline => tile.composite(frame, optics, cubes),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx2 => unsafe { cubes_avx2(tile, frame, optics, cubes) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as in `composite`.
            InstructionSet::Avx512 => unsafe { cubes_avx512(tile, frame, optics, cubes) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
fn cubes_avx2<O: Optics>(tile: &mut CubeTile, frame: &Frame, optics: &O, cubes: &[BinnedCube]) {
    tile.composite(frame, optics, cubes);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2")]
fn cubes_avx512<O: Optics>(tile: &mut CubeTile, frame: &Frame, optics: &O, cubes: &[BinnedCube]) {
    tile.composite(frame, optics, cubes);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
fn boxes_avx2(boxes: &PixelBoxes, corners: &Corners, found: &mut BoxLanes) {
    boxes.of_lanes(corners, found);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2")]
fn boxes_avx512(boxes: &PixelBoxes, corners: &Corners, found: &mut BoxLanes) {
    boxes.of_lanes(corners, found);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
fn keys_avx2(keys: &KeyMaker, corners: &Corners, key: &mut [u32; LANES]) {
    keys.of_lanes(corners, key);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2")]
fn keys_avx512(keys: &KeyMaker, corners: &Corners, key: &mut [u32; LANES]) {
    keys.of_lanes(corners, key);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
fn composite_avx2<O: Optics, S: Sink<O>>(
    tile: &TileFrame,
    optics: &O,
    order: &[Pair],
    scratch: &mut Scratch,
    sink: &mut S,
) {
    // SAFETY: this function itself may run only where the processor has AVX2.
    composite(tile, optics, order, unsafe { ByAvx2::new() }, scratch, sink);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2")]
fn composite_avx512<O: Optics, S: Sink<O>>(
    tile: &TileFrame,
    optics: &O,
    order: &[Pair],
    scratch: &mut Scratch,
    sink: &mut S,
) {
    // SAFETY: this function itself may run only where the processor has AVX-512 F.
    composite(tile, optics, order, unsafe { ByAvx512::new() }, scratch, sink);
}

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
