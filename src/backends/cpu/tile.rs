//! One tile: the footprints of its cells against its 4×4 blocks of pixels.
//!
//! In: the tile's cells in order. Out: fragments, sixteen lanes at a time, for a [`Sink`].
//! Sixteen cells are set up at once, one a lane; then each cell is tested against the blocks of its box, one pixel a lane.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::crossed::Crossed;
use super::dispatch::{HexKernels, Hexahedron};
use super::hits::Hits;
use super::planes::CellPlanes;
use super::sink::Sink;
use super::steep::SteepCell;
use crate::backends::cpu::bins::TILE;
use crate::backends::{Frame, OpaquePicture};
use crate::optics::lanes::mask;
use crate::optics::{CellSpan, LANES, Lanes, Mask, Optics};
use crate::stages::View;
use crate::stages::footprints::hexahedra::{HexFootprint, Outline};
use crate::stages::footprints::planes::{Batch, Corners, TileRays};
use crate::stages::sort::radix::{Pair, index_of};

/// Side of a block in pixels.
pub(super) const BLOCK: usize = 4;
/// Blocks along a tile's side.
pub(super) const BLOCKS_A_SIDE: usize = TILE as usize / BLOCK;
/// Blocks of a tile.
pub(super) const BLOCKS: usize = BLOCKS_A_SIDE * BLOCKS_A_SIDE;
/// Pixels of a tile.
pub(super) const PIXELS: usize = BLOCKS * LANES;

/// Column and row of each lane in its block. Read from memory, not a constant: a compiler that sees the pattern builds the
/// vectors piece by piece.
#[derive(Clone, Copy)]
pub(super) struct LaneGrid {
    pub(super) x: Lanes,
    pub(super) y: Lanes,
    /// 1 << lane.
    bit: Mask,
}

impl LaneGrid {
    fn new() -> Self {
        let x = std::array::from_fn(|lane| (lane % BLOCK) as f32);
        Self { x, y: std::array::from_fn(|lane| (lane / BLOCK) as f32), bit: std::array::from_fn(|lane| 1 << lane) }
    }

    /// What the lanes of a block add to an affine function of the picture position.
    #[inline(always)]
    pub(super) fn offsets(&self, step_x: f32, step_y: f32) -> Lanes {
        let mut offsets = [0.0; LANES];
        for i in 0..LANES {
            offsets[i] = step_x * self.x[i] + step_y * self.y[i];
        }
        offsets
    }

    /// A mask from one bit for each lane.
    #[inline(always)]
    pub(super) fn mask(&self, bits: u16) -> Mask {
        let mut is_set = [0; LANES];
        for i in 0..LANES {
            is_set[i] = mask(u32::from(bits) & self.bit[i] != 0);
        }
        is_set
    }
}

/// Column and row of a block's first pixel in the tile.
#[inline(always)]
pub(super) fn origin_of(block: usize) -> [f32; 2] {
    [(block % BLOCKS_A_SIDE * BLOCK) as f32, (block / BLOCKS_A_SIDE * BLOCK) as f32]
}

/// The blocks that a box of the tile's pixels touches: first column, column after the last, and the same for rows.
#[inline(always)]
pub(super) fn blocks_in([x0, x1, y0, y1]: [usize; 4]) -> impl Iterator<Item = usize> {
    let row =
        move |row: usize| (x0 / BLOCK..x1.div_ceil(BLOCK)).map(move |column| (row * BLOCKS_A_SIDE + column) % BLOCKS);
    (y0 / BLOCK..y1.div_ceil(BLOCK)).flat_map(row)
}

/// Column and row in the tile of lane `lane` of block `block`.
fn pixel_of(block: usize, lane: usize) -> [usize; 2] {
    [block % BLOCKS_A_SIDE * BLOCK + lane % BLOCK, block / BLOCKS_A_SIDE * BLOCK + lane / BLOCK]
}

/// The block and lane of the pixel in a column and row of the tile, as one index.
pub(super) fn place_of(column: usize, row: usize) -> usize {
    (row / BLOCK * BLOCKS_A_SIDE + column / BLOCK) * LANES + row % BLOCK * BLOCK + column % BLOCK
}

/// What a tile needs beside its cells.
pub(super) struct TileFrame<'a> {
    frame: &'a Frame<'a>,
    rays: TileRays,
    first_px: [u32; 2],
    pub(super) lanes: LaneGrid,
    /// World length per unit of view depth, per pixel.
    pub(super) length_world_per_depth: [Lanes; BLOCKS],
    /// Inverse depth at which rays end on opaque geometry, where there is any.
    pub(super) limits: Option<Box<[Lanes; BLOCKS]>>,
}

impl<'a> TileFrame<'a> {
    pub(super) fn new(frame: &'a Frame<'a>, [x, y]: [u32; 2]) -> Self {
        let view: &View = frame.view;
        let mut length_world_per_depth = [[0.0; LANES]; BLOCKS];
        for (block, lengths) in length_world_per_depth.iter_mut().enumerate() {
            for (lane, length) in lengths.iter_mut().enumerate() {
                let [column, row] = pixel_of(block, lane);
                *length = view.length_world_per_depth(f64::from(x) + column as f64, f64::from(y) + row as f64) as f32;
            }
        }
        Self {
            frame,
            rays: TileRays::new(view, x, y, TILE),
            first_px: [x, y],
            lanes: LaneGrid::new(),
            length_world_per_depth,
            limits: frame.limits().map(|picture| limits_of(picture, [x, y])),
        }
    }

    pub(super) fn is_perspective(&self) -> bool {
        self.frame.view.is_perspective
    }
}

/// Where the rays of the tile at `first_px` end.
fn limits_of(picture: &OpaquePicture, first_px: [u32; 2]) -> Box<[Lanes; BLOCKS]> {
    let [first_x, first_y] = first_px.map(|first| first as usize);
    let mut limits = Box::new([[f32::NEG_INFINITY; LANES]; BLOCKS]);
    for (block, lanes) in limits.iter_mut().enumerate() {
        for (lane, limit) in lanes.iter_mut().enumerate() {
            let [column, row] = pixel_of(block, lane);
            *limit = picture.limit(first_x + column, first_y + row);
        }
    }
    limits
}

/// Sends the fragments of the cells of `order` to `sink`.
#[inline(always)]
pub(super) fn composite<O: Optics, S: Sink<O>, const PERSPECTIVE: bool>(
    tile: &TileFrame,
    optics: &O,
    order: &[Pair],
    compress: impl HexKernels,
    hits: &mut Hits,
    sink: &mut S,
) {
    let frame = tile.frame;
    let (tets, positive) = (frame.dataset.tets.view(), frame.dataset.positive.view());
    let (hexahedra, first_hexahedron) = (frame.dataset.hexahedra.view(), frame.dataset.tets.len());
    let cell_values = frame.cell_values();
    hits.log.reset();
    let mut corners = Corners::default();
    let mut batch = Batch::default();
    let mut of_hexahedron = Default::default();
    for cells in order.chunks(LANES) {
        if sink.is_all_done() {
            return;
        }
        let mut has_tets = false;
        for (lane, &pair) in cells.iter().enumerate() {
            let cell = index_of(pair) as usize;
            if cell >= first_hexahedron {
                continue;
            }
            has_tets = true;
            corners.set(lane, tets.get(cell), frame.vertices, positive.get(cell));
            if let Some(values) = cell_values {
                corners.set_constant(lane, values[cell]);
            }
        }
        if has_tets {
            batch.set_up(&tile.rays, &corners);
        }
        for (lane, &pair) in cells.iter().enumerate() {
            let index = index_of(pair) as usize;
            if let Some(hexahedron) = index.checked_sub(first_hexahedron) {
                let (vertex, shape) = (hexahedra.get(hexahedron), hexahedra.shape(hexahedron));
                let constant = cell_values.map(|values| values[index]);
                let hexahedron = Hexahedron { index, vertex, shape, vertices: frame.vertices, constant };
                composite_hexahedron(tile, optics, &hexahedron, compress, (hits, &mut of_hexahedron), sink);
                continue;
            }
            let cell = CellPlanes::new::<PERSPECTIVE>(&tile.lanes, &batch, lane);
            hits.find::<O, S>(tile, &cell, compress, sink);
            hits.cut::<PERSPECTIVE>(&cell);
            if batch.is_steep[lane] != 0 {
                let steep = SteepCell::new(&tile.rays, &batch, &corners, lane);
                hits.correct::<PERSPECTIVE>(tile, &steep);
            }
            hits.shade(optics, CellSpan::new(frame.intervals(), cell.s_min, cell.s_max).of_cell(index));
            hits.send::<O, S>(tile, compress, sink);
        }
    }
}

/// Sends the fragments of a hexahedron to `sink`.
#[inline(always)]
fn composite_hexahedron<O: Optics, S: Sink<O>>(
    tile: &TileFrame,
    optics: &O,
    hexahedron: &Hexahedron<'_>,
    kernels: impl HexKernels,
    (hits, (footprint, crossed)): (&mut Hits, &mut (HexFootprint, Crossed)),
    sink: &mut S,
) {
    kernels.set_up(footprint, &tile.rays, hexahedron);
    let done = blocks_in(footprint.sides).filter(|&block| sink.is_done(block, footprint.v_max));
    let done = done.fold(0, |done, block| done | 1 << block);
    let span = CellSpan::new(tile.frame.intervals(), footprint.s_min, footprint.s_max).of_cell(hexahedron.index);
    if footprint.outline == Outline::Simple {
        kernels.meet(hits, tile, footprint, done);
        hits.shade(optics, span);
        hits.send::<O, S>(tile, kernels, sink);
        return;
    }
    crossed.find((tile.frame.view, tile.first_px, tile.limits.as_deref()), hexahedron, footprint);
    for nth in 0..crossed.most() {
        crossed.put(nth, tile, hits, done);
        hits.shade(optics, span);
        hits.send::<O, S>(tile, kernels, sink);
    }
}
