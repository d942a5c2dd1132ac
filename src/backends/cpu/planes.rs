//! One cell against the rays of a block: where they enter and leave it, and what of its scalar varies among them.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::tile::LaneGrid;
use crate::optics::lanes::{max, min};
use crate::optics::{LANES, Lanes};
use crate::stages::footprints::planes::{Affine, Batch};

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

/// One cell of a batch, for all blocks of the tile.
pub(super) struct CellPlanes {
    /// Front faces first.
    planes: [AffineLanes; 4],
    /// How many planes are front faces.
    pub(super) fronts: usize,
    /// The pixels of the tile that the cell may cover: first column, column after the last, and the same for rows.
    pub(super) sides: [usize; 4],
    v_min: f32,
    /// Inverse depth where the cell is nearest.
    pub(super) v_max: f32,
    /// The scalar along a ray is `base + slope·w`, where perspective has a constant base and parallel rays a constant slope.
    varying: AffineLanes,
    pub(super) constant: f32,
    /// Range of the scalar.
    pub(super) s_min: f32,
    pub(super) s_max: f32,
}

impl CellPlanes {
    /// The cell in lane `lane` of the batch.
    #[inline(always)]
    pub(super) fn new<const PERSPECTIVE: bool>(lanes: &LaneGrid, batch: &Batch, lane: usize) -> Self {
        let mut planes = [AffineLanes { c: 0.0, x: 0.0, y: 0.0, offsets: [0.0; LANES] }; 4];
        let (mut fronts, mut back) = (0_usize, 4_usize);
        for k in 0..4 {
            let is_back = (batch.back_faces[lane] >> k & 1) as usize;
            back -= is_back;
            let place = if is_back == 1 { back } else { fronts };
            planes[place & 3] = AffineLanes::new(lanes, &batch.planes[k], lane);
            fronts += 1 - is_back;
        }
        let (varying, constant) = if PERSPECTIVE { (&batch.slope, &batch.base) } else { (&batch.base, &batch.slope) };
        Self {
            planes,
            fronts,
            sides: [0, 1, 2, 3].map(|k: usize| batch.boxes[k][lane] as usize),
            v_min: batch.v_min[lane],
            v_max: batch.v_max[lane],
            varying: AffineLanes::new(lanes, varying, lane),
            constant: constant.c[lane],
            s_min: batch.s_min[lane],
            s_max: batch.s_max[lane],
        }
    }

    /// Inverse depths of entry and exit along the rays of the block at `origin`, the first `FRONTS` planes being front faces.
    #[inline(always)]
    pub(super) fn cover<const FRONTS: usize>(&self, origin: [f32; 2]) -> (Lanes, Lanes) {
        let p = &self.planes;
        let at_block = [p[0].at(origin), p[1].at(origin), p[2].at(origin), p[3].at(origin)];
        let (mut v_enter, mut v_leave) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let (mut enter, mut leave) = (self.v_max, self.v_min);
            for k in 0..4 {
                let v = at_block[k] + p[k].offsets[i];
                if k < FRONTS {
                    enter = min(v, enter);
                } else {
                    leave = max(v, leave);
                }
            }
            v_enter[i] = enter;
            v_leave[i] = leave;
        }
        (v_enter, v_leave)
    }

    /// What of the scalar varies, along the rays of the block at `origin`.
    #[inline(always)]
    pub(super) fn scalar_at(&self, origin: [f32; 2]) -> Lanes {
        let at_block = self.varying.at(origin);
        let mut varying = [0.0; LANES];
        for i in 0..LANES {
            varying[i] = at_block + self.varying.offsets[i];
        }
        varying
    }
}
