//! Sixteen tetrahedra, one a lane, ready to be met by rays: front faces first, and the blocks that each may cover.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::steep::SteepCell;
use super::tile::{BLOCK, BLOCKS_A_SIDE, TileFrame};
use crate::optics::lanes::{mask, select};
use crate::optics::{LANES, Mask};
use crate::stages::footprints::planes::{Affine, Batch, Corners, PerCell, TileRays};

/// What rays need to know of sixteen tetrahedra.
pub(super) struct TetBatch {
    batch: Batch,
    /// Inverse depths of the faces' planes: front faces, then back faces.
    planes: [Affine; 4],
    /// Whether each of them is a back face.
    pub(super) is_back: [Mask; 4],
    /// Whether a cell has front or back faces alone, as one without volume may.
    pub(super) is_any_odd: bool,
    /// The blocks of the tile that a cell may cover: the first one, how many columns, how many blocks.
    pub(super) first_block: [u8; LANES],
    pub(super) columns: [u8; LANES],
    pub(super) blocks: [u8; LANES],
    /// No ray is longer in a cell.
    length_world_max: PerCell,
    is_perspective: bool,
}

impl Default for TetBatch {
    fn default() -> Self {
        Self {
            batch: Batch::default(),
            planes: [Affine::ZERO; 4],
            is_back: [[0; LANES]; 4],
            is_any_odd: false,
            first_block: [0; LANES],
            columns: [0; LANES],
            blocks: [0; LANES],
            length_world_max: [0.0; LANES],
            is_perspective: true,
        }
    }
}

impl TetBatch {
    /// Sets up the cells whose corners are in `corners`; unused lanes hold any finite cell.
    #[inline(always)]
    pub(super) fn set_up(&mut self, tile: &TileFrame, corners: &Corners) {
        self.is_perspective = tile.is_perspective();
        self.batch.set_up(&tile.rays, corners);
        for i in 0..LANES {
            self.length_world_max[i] = tile.length_world_max([self.batch.v_min[i], self.batch.v_max[i]]);
        }
        self.sort_faces();
        self.find_blocks();
    }

    /// Front faces before back faces, by a network.
    #[inline(always)]
    fn sort_faces(&mut self) {
        let mut planes = self.batch.planes;
        let mut is_back = [[0; LANES]; 4];
        for k in 0..4 {
            for i in 0..LANES {
                is_back[k][i] = mask(self.batch.back_faces[i] >> k & 1 != 0);
            }
        }
        for (a, b) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
            let (p, q) = (is_back[a], is_back[b]);
            let mut swap = [0; LANES];
            for i in 0..LANES {
                swap[i] = p[i] & !q[i];
                is_back[a][i] = p[i] & q[i];
                is_back[b][i] = p[i] | q[i];
            }
            let (p, q) = (planes[a], planes[b]);
            (planes[a].c, planes[b].c) = exchanged(&swap, &p.c, &q.c);
            (planes[a].x, planes[b].x) = exchanged(&swap, &p.x, &q.x);
            (planes[a].y, planes[b].y) = exchanged(&swap, &p.y, &q.y);
        }
        let mut odd = 0;
        for i in 0..LANES {
            odd |= is_back[0][i] | !is_back[3][i];
        }
        (self.planes, self.is_back, self.is_any_odd) = (planes, is_back, odd != 0);
    }

    #[inline(always)]
    fn find_blocks(&mut self) {
        let side = BLOCK as i32;
        for i in 0..LANES {
            let boxes = &self.batch.boxes;
            let (x0, x1) = (boxes[0][i] as i32, boxes[1][i] as i32);
            let (y0, y1) = (boxes[2][i] as i32, boxes[3][i] as i32);
            let (column, row) = (x0 / side, y0 / side);
            let (columns, rows) = (((x1 + side - 1) / side - column).max(0), ((y1 + side - 1) / side - row).max(0));
            self.first_block[i] = (row * BLOCKS_A_SIDE as i32 + column) as u8;
            (self.columns[i], self.blocks[i]) = (columns as u8, (columns * rows) as u8);
        }
    }

    /// The faces' planes, and what of the scalar varies from ray to ray: along a ray it is `base + slope·w`, where perspective has a
    /// constant base and parallel rays a constant slope.
    #[inline(always)]
    pub(super) fn affine(&self) -> [&Affine; 5] {
        let [a, b, c, d] = &self.planes;
        [a, b, c, d, if self.is_perspective { &self.batch.slope } else { &self.batch.base }]
    }

    /// What of the scalar is the same for all rays.
    #[inline(always)]
    pub(super) fn constant(&self) -> &PerCell {
        if self.is_perspective { &self.batch.base.c } else { &self.batch.slope.c }
    }

    /// Inverse depths between which each cell lies.
    #[inline(always)]
    pub(super) fn v_range(&self) -> [&PerCell; 2] {
        [&self.batch.v_min, &self.batch.v_max]
    }

    /// Values between which each cell's lie.
    #[inline(always)]
    pub(super) fn s_range(&self) -> [&PerCell; 2] {
        [&self.batch.s_min, &self.batch.s_max]
    }

    /// World lengths that no ray exceeds in each cell.
    #[inline(always)]
    pub(super) fn length_world_max(&self) -> &PerCell {
        &self.length_world_max
    }

    /// The cell in `lane`, if it is steep.
    #[inline(always)]
    pub(super) fn steep(&self, rays: &TileRays, corners: &Corners, lane: usize) -> Option<SteepCell> {
        (self.batch.is_steep[lane] != 0).then(|| SteepCell::new(rays, &self.batch, corners, lane))
    }
}

/// Two numbers per cell, exchanged in the lanes to swap.
#[inline(always)]
fn exchanged(swap: &Mask, p: &PerCell, q: &PerCell) -> (PerCell, PerCell) {
    let (mut first, mut second) = (*p, *q);
    for i in 0..LANES {
        first[i] = select(swap[i], q[i], p[i]);
        second[i] = select(swap[i], p[i], q[i]);
    }
    (first, second)
}
