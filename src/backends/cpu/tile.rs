//! One tile: its 4×4 blocks of pixels, and what of the view it needs.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use crate::backends::cpu::bins::TILE;
use crate::backends::{Frame, OpaquePicture};
use crate::optics::{LANES, Lanes};
use crate::stages::View;
use crate::stages::footprints::planes::TileRays;
use crate::stages::footprints::polyhedra::ExactRays;

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
    /// Columns in the tile of the lanes of a block, by the block's column; rows likewise.
    pub(super) columns: [Lanes; BLOCKS_A_SIDE],
    pub(super) rows: [Lanes; BLOCKS_A_SIDE],
}

impl LaneGrid {
    fn new() -> Self {
        let x: Lanes = std::array::from_fn(|lane| (lane % BLOCK) as f32);
        let y: Lanes = std::array::from_fn(|lane| (lane / BLOCK) as f32);
        let along = |axis: Lanes| std::array::from_fn(|block| axis.map(|offset| (block * BLOCK) as f32 + offset));
        Self { x, y, columns: along(x), rows: along(y) }
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
}

/// Column and row of a block's first pixel in the tile.
#[inline(always)]
pub(super) fn origin_of(block: usize) -> [f32; 2] {
    [(block % BLOCKS_A_SIDE * BLOCK) as f32, (block / BLOCKS_A_SIDE * BLOCK) as f32]
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
    pub(super) frame: &'a Frame<'a>,
    pub(super) rays: TileRays,
    pub(super) exact_rays: ExactRays,
    pub(super) first_px: [u32; 2],
    pub(super) lanes: LaneGrid,
    /// World length per unit of view depth, per pixel.
    pub(super) length_world_per_depth: [Lanes; BLOCKS],
    /// The largest of them.
    length_world_per_depth_max: f32,
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
        let largest = length_world_per_depth.as_flattened().iter().copied().fold(0.0, f32::max);
        Self {
            frame,
            rays: TileRays::new(view, x, y, TILE),
            exact_rays: ExactRays::new(view, x, y),
            first_px: [x, y],
            lanes: LaneGrid::new(),
            length_world_per_depth,
            length_world_per_depth_max: largest,
            limits: frame.limits().map(|picture| limits_of(picture, [x, y])),
        }
    }

    /// World length that no ray of the tile exceeds between two inverse depths, the farther one first.
    #[inline(always)]
    pub(super) fn length_world_max(&self, [v_min, v_max]: [f32; 2]) -> f32 {
        let depth = if self.is_perspective() { (v_max - v_min) / (v_max * v_min) } else { v_max - v_min };
        depth * self.length_world_per_depth_max
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
