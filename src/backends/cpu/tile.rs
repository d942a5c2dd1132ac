//! One tile: the footprints of its cells against its 4×4 blocks of pixels.
//!
//! In: the tile's cells in order. Out: fragments, sixteen lanes at a time, for a [`Sink`].
//! Sixteen cells are set up at once, one a lane; then each cell is tested against the blocks of its box, one pixel a lane.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::sink::{Fragments, Sink};
use crate::backends::Frame;
use crate::backends::cpu::bins::TILE;
use crate::optics::lanes::{is_any, mask, max, min, select};
use crate::optics::{LANES, Lanes, Optics, PieceSpan, Segments};
use crate::stages::View;
use crate::stages::footprints::planes::{Affine, Batch, Corners, FaceScalar, TileRays};
use crate::stages::sort::radix::{Pair, index_of};

/// Side of a block in pixels.
const BLOCK: usize = 4;
/// Blocks along a tile's side.
const BLOCKS_A_SIDE: usize = TILE as usize / BLOCK;
/// Blocks of a tile.
pub(super) const BLOCKS: usize = BLOCKS_A_SIDE * BLOCKS_A_SIDE;
/// Pixels of a tile.
pub(super) const PIXELS: usize = BLOCKS * LANES;

/// Column and row of each lane in its block. Read from memory, not a constant: a compiler that sees the pattern builds the
/// vectors piece by piece.
#[derive(Clone, Copy)]
struct LaneGrid {
    x: Lanes,
    y: Lanes,
}

impl LaneGrid {
    fn new() -> Self {
        let x = std::array::from_fn(|lane| (lane % BLOCK) as f32);
        Self { x, y: std::array::from_fn(|lane| (lane / BLOCK) as f32) }
    }

    /// What the lanes of a block add to an affine function of the picture position.
    #[inline(always)]
    fn offsets(&self, step_x: f32, step_y: f32) -> Lanes {
        let mut offsets = [0.0; LANES];
        for i in 0..LANES {
            offsets[i] = step_x * self.x[i] + step_y * self.y[i];
        }
        offsets
    }
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
    lanes: LaneGrid,
    /// World length per unit of view depth, per pixel.
    length_world_per_depth: [Lanes; BLOCKS],
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
        Self { frame, rays: TileRays::new(view, x, y, TILE), lanes: LaneGrid::new(), length_world_per_depth }
    }

    pub(super) fn is_perspective(&self) -> bool {
        self.frame.view.is_perspective
    }
}

/// Sends the fragments of the cells of `order` to `sink`.
#[inline(always)]
pub(super) fn composite<O: Optics, S: Sink<O>, const PERSPECTIVE: bool>(
    tile: &TileFrame,
    optics: &O,
    order: &[Pair],
    sink: &mut S,
) {
    let frame = tile.frame;
    let (tets, positive) = (&frame.dataset.tets[..], &frame.dataset.positive);
    let cell_values = frame.cell_values();
    let mut corners = Corners::default();
    let mut batch = Batch::default();
    let mut hits = Hits::new();
    for cells in order.chunks(LANES) {
        if sink.is_all_done() {
            return;
        }
        for (lane, &pair) in cells.iter().enumerate() {
            let cell = index_of(pair) as usize;
            corners.set(lane, tets[cell], frame.vertices, positive.get(cell));
            if let Some(values) = cell_values {
                corners.set_constant(lane, values[cell]);
            }
        }
        batch.set_up(&tile.rays, &corners);
        for lane in 0..cells.len() {
            let span = PieceSpan {
                first: frame.pieces.piece_of(batch.s_min[lane]),
                last: frame.pieces.piece_of(batch.s_max[lane]),
            };
            draw_cell::<O, S, PERSPECTIVE>(tile, optics, (&batch, &corners), lane, span, &mut hits, sink);
        }
    }
}

/// An affine function of the picture position: its value at the tile's first pixel, its steps, and what they add in each
/// lane of a block.
#[derive(Clone, Copy)]
struct AffineLanes {
    c: f32,
    x: f32,
    y: f32,
    offsets: Lanes,
}

impl AffineLanes {
    #[inline(always)]
    fn new(lanes: &LaneGrid, affine: &Affine, lane: usize) -> Self {
        let (x, y) = (affine.x[lane], affine.y[lane]);
        Self { c: affine.c[lane], x, y, offsets: lanes.offsets(x, y) }
    }

    /// The value at the first pixel of the block at (x, y).
    #[inline(always)]
    fn at(&self, [x, y]: [f32; 2]) -> f32 {
        self.c + self.x * x + self.y * y
    }
}

/// The planes of one cell, front faces first; how many are front faces.
#[inline(always)]
fn sort_planes(lanes: &LaneGrid, batch: &Batch, lane: usize) -> ([AffineLanes; 4], usize) {
    let mut sorted = [AffineLanes { c: 0.0, x: 0.0, y: 0.0, offsets: [0.0; LANES] }; 4];
    let (mut front, mut back) = (0_usize, 4_usize);
    for k in 0..4 {
        let is_back = (batch.back_faces[lane] >> k & 1) as usize;
        back -= is_back;
        let place = if is_back == 1 { back } else { front };
        sorted[place & 3] = AffineLanes::new(lanes, &batch.planes[k], lane);
        front += 1 - is_back;
    }
    (sorted, front)
}

/// Entry and exit of each lane's ray, the first `FRONTS` planes being front faces.
#[inline(always)]
fn cover<const FRONTS: usize>(
    planes: &[AffineLanes; 4],
    origin: [f32; 2],
    (v_min, v_max): (f32, f32),
    v_enter: &mut Lanes,
    v_leave: &mut Lanes,
) {
    let at_block = [planes[0].at(origin), planes[1].at(origin), planes[2].at(origin), planes[3].at(origin)];
    for i in 0..LANES {
        let (mut enter, mut leave) = (v_max, v_min);
        for k in 0..4 {
            let v = at_block[k] + planes[k].offsets[i];
            if k < FRONTS {
                enter = min(v, enter);
            } else {
                leave = max(v, leave);
            }
        }
        v_enter[i] = enter;
        v_leave[i] = leave;
    }
}

/// The blocks in which a cell has fragments: found in one pass, shaded in another, so that the passes have no branch that
/// depends on what was just computed.
struct Hits {
    len: usize,
    block: [u8; BLOCKS],
    /// Inverse depths; equal in lanes that miss the cell.
    v_enter: [Lanes; BLOCKS],
    v_leave: [Lanes; BLOCKS],
}

impl Hits {
    fn new() -> Self {
        Self { len: 0, block: [0; BLOCKS], v_enter: [[0.0; LANES]; BLOCKS], v_leave: [[0.0; LANES]; BLOCKS] }
    }

    /// Finds the blocks of a cell whose first `FRONTS` planes are front faces.
    #[inline(always)]
    fn find<O: Optics, S: Sink<O>, const FRONTS: usize>(
        &mut self,
        planes: &[AffineLanes; 4],
        [x0, x1, y0, y1]: [usize; 4],
        v_range: (f32, f32),
        sink: &S,
    ) {
        let mut len = 0;
        for block_y in y0 / BLOCK..y1.div_ceil(BLOCK) {
            for block_x in x0 / BLOCK..x1.div_ceil(BLOCK) {
                let block = block_y * BLOCKS_A_SIDE + block_x;
                if sink.is_done(block, v_range.1) {
                    continue;
                }
                let origin = [(block_x * BLOCK) as f32, (block_y * BLOCK) as f32];
                let (mut v_enter, mut v_leave) = ([0.0; LANES], [0.0; LANES]);
                cover::<FRONTS>(planes, origin, v_range, &mut v_enter, &mut v_leave);
                let mut is_hit = [0; LANES];
                for i in 0..LANES {
                    is_hit[i] = mask(v_enter[i] > v_leave[i]);
                }
                // A lane that misses takes any depth of the cell, with no length: nothing infinite, nothing to mask later.
                let place = len % BLOCKS;
                for i in 0..LANES {
                    self.v_enter[place][i] = select(is_hit[i], v_enter[i], v_range.1);
                    self.v_leave[place][i] = select(is_hit[i], v_leave[i], v_range.1);
                }
                self.block[place] = block as u8;
                len += usize::from(is_any(&is_hit));
            }
        }
        self.len = len;
    }
}

#[inline(always)]
fn draw_cell<O: Optics, S: Sink<O>, const PERSPECTIVE: bool>(
    tile: &TileFrame,
    optics: &O,
    (batch, corners): (&Batch, &Corners),
    lane: usize,
    span: PieceSpan,
    hits: &mut Hits,
    sink: &mut S,
) {
    let (planes, fronts) = sort_planes(&tile.lanes, batch, lane);
    let scalar = ScalarLanes::new::<PERSPECTIVE>(&tile.lanes, batch, lane);
    let steep = (batch.is_steep[lane] != 0).then(|| SteepCell::new(tile, batch, corners, lane));
    let v_range = (batch.v_min[lane], batch.v_max[lane]);
    let side = |k: usize| batch.boxes[k][lane] as usize;
    let sides = [side(0), side(1), side(2), side(3)];
    match fronts {
        0 => hits.find::<O, S, 0>(&planes, sides, v_range, sink),
        1 => hits.find::<O, S, 1>(&planes, sides, v_range, sink),
        2 => hits.find::<O, S, 2>(&planes, sides, v_range, sink),
        3 => hits.find::<O, S, 3>(&planes, sides, v_range, sink),
        _ => hits.find::<O, S, 4>(&planes, sides, v_range, sink),
    }
    for hit in 0..hits.len {
        let hit = hit % BLOCKS;
        let block = hits.block[hit] as usize % BLOCKS;
        let (v_enter, v_leave) = (hits.v_enter[hit], hits.v_leave[hit]);
        let origin = [(block % BLOCKS_A_SIDE * BLOCK) as f32, (block / BLOCKS_A_SIDE * BLOCK) as f32];
        let mut is_hit = [0; LANES];
        for i in 0..LANES {
            is_hit[i] = mask(v_enter[i] > v_leave[i]);
        }
        let lengths = &tile.length_world_per_depth[block];
        let mut segments = scalar.segments::<PERSPECTIVE>(origin, &v_enter, &v_leave, lengths);
        if let Some(steep) = &steep {
            // By value: what a call could see would have to stay in memory for all cells.
            segments = steep.corrected::<PERSPECTIVE>(tile, origin, (v_enter, v_leave), segments);
        }
        let mut contribution = [[0.0; LANES]; 4];
        optics.contribution(span, &segments, &mut contribution);
        sink.accept(&Fragments { block, is_hit: &is_hit, v_enter: &v_enter, contribution: &contribution });
    }
}

/// The scalar of one cell along the rays of a block: `base + slope·w`, where perspective has a constant base and parallel rays
/// a constant slope.
struct ScalarLanes {
    varying: AffineLanes,
    constant: f32,
    s_min: f32,
    s_max: f32,
}

impl ScalarLanes {
    #[inline(always)]
    fn new<const PERSPECTIVE: bool>(lanes: &LaneGrid, batch: &Batch, lane: usize) -> Self {
        let (varying, constant) = if PERSPECTIVE { (&batch.slope, &batch.base) } else { (&batch.base, &batch.slope) };
        Self {
            varying: AffineLanes::new(lanes, varying, lane),
            constant: constant.c[lane],
            s_min: batch.s_min[lane],
            s_max: batch.s_max[lane],
        }
    }

    /// Field values and world lengths of the rays between inverse depths `v_enter` and `v_leave`.
    #[inline(always)]
    fn segments<const PERSPECTIVE: bool>(
        &self,
        origin: [f32; 2],
        v_enter: &Lanes,
        v_leave: &Lanes,
        length_world_per_depth: &Lanes,
    ) -> Segments {
        let at_block = self.varying.at(origin);
        let mut segments = Segments { enter: [0.0; LANES], leave: [0.0; LANES], length_world: [0.0; LANES] };
        for i in 0..LANES {
            let varying = at_block + self.varying.offsets[i];
            let (v0, v1) = (v_enter[i], v_leave[i]);
            // w1 − w0 = (v0 − v1) / (v0 v1): a difference of reciprocals would cancel.
            let reciprocal = if PERSPECTIVE { 1.0 / (v0 * v1) } else { 1.0 };
            let (w0, w1) = if PERSPECTIVE { (v1 * reciprocal, v0 * reciprocal) } else { (-v0, -v1) };
            let (s0, s1) = if PERSPECTIVE {
                (self.constant + varying * w0, self.constant + varying * w1)
            } else {
                (varying + self.constant * w0, varying + self.constant * w1)
            };
            // A sliver's gradient is steep: rounding must not leave the cell's range.
            segments.enter[i] = min(max(s0, self.s_min), self.s_max);
            segments.leave[i] = min(max(s1, self.s_min), self.s_max);
            segments.length_world[i] = (v0 - v1) * reciprocal * length_world_per_depth[i];
        }
        segments
    }
}

/// A cell whose gradient would magnify the rounding of a depth: the values at entry and exit come from the faces met there.
struct SteepCell {
    /// Plane (at the tile's first pixel, per column, per row) and scalar of each face, and whether it is back-facing.
    faces: [([f32; 3], FaceScalar, bool); 4],
    s_min: f32,
    s_max: f32,
}

impl SteepCell {
    #[inline(never)]
    fn new(tile: &TileFrame, batch: &Batch, corners: &Corners, lane: usize) -> Self {
        let scalars = FaceScalar::of_cell(&tile.rays, corners, lane);
        let faces = std::array::from_fn(|k| {
            let Affine { c, x, y } = &batch.planes[k];
            ([c[lane], x[lane], y[lane]], scalars[k], batch.back_faces[lane] >> k & 1 == 1)
        });
        Self { faces, s_min: batch.s_min[lane], s_max: batch.s_max[lane] }
    }

    #[inline(never)]
    fn corrected<const PERSPECTIVE: bool>(
        &self,
        tile: &TileFrame,
        origin: [f32; 2],
        (v_enter, v_leave): (Lanes, Lanes),
        mut segments: Segments,
    ) -> Segments {
        // Entry is the front face with the smallest v, exit the back face with the largest; an eye in the cell has no entry.
        let (mut nearest_exit, mut farthest_entry) = ([f32::NEG_INFINITY; LANES], [f32::INFINITY; LANES]);
        for &([c, dx, dy], face, is_back) in &self.faces {
            for i in 0..LANES {
                let (x, y) = (origin[0] + tile.lanes.x[i], origin[1] + tile.lanes.y[i]);
                let v = c + dx * x + dy * y;
                let at = if is_back { v_leave[i] } else { v_enter[i] };
                let w = if PERSPECTIVE { 1.0 / at } else { -at };
                let value = min(max(face.at(x, y, w), self.s_min), self.s_max);
                if is_back {
                    let is_exit = mask(v > nearest_exit[i]);
                    nearest_exit[i] = select(is_exit, v, nearest_exit[i]);
                    segments.leave[i] = select(is_exit, value, segments.leave[i]);
                } else {
                    let is_entry = mask(v < farthest_entry[i]);
                    farthest_entry[i] = select(is_entry, v, farthest_entry[i]);
                    segments.enter[i] = select(is_entry, value, segments.enter[i]);
                }
            }
        }
        segments
    }
}
