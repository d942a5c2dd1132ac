//! Steep cells: slivers, whose gradient would magnify the rounding of a depth.

use crate::optics::lanes::{max, min};
use crate::stages::footprints::planes::{Affine, Batch, Corners, FaceScalar, TileRays};

/// A cell whose values at entry and exit come from the faces met there.
pub(super) struct SteepCell {
    /// Plane (at the tile's first pixel, per column, per row) and scalar of each face, and whether it is back-facing.
    faces: [([f32; 3], FaceScalar, bool); 4],
    s_min: f32,
    s_max: f32,
}

impl SteepCell {
    #[inline(never)]
    pub(super) fn new(rays: &TileRays, batch: &Batch, corners: &Corners, lane: usize) -> Self {
        let scalars = FaceScalar::of_cell(rays, corners, lane);
        let faces = std::array::from_fn(|k| {
            let Affine { c, x, y } = &batch.planes[k];
            ([c[lane], x[lane], y[lane]], scalars[k], batch.back_faces[lane] >> k & 1 == 1)
        });
        Self { faces, s_min: batch.s_min[lane], s_max: batch.s_max[lane] }
    }

    /// The values where the ray at (x, y) enters and leaves, at inverse depths `v`; none for an end on no face, as for an eye in
    /// the cell. A ray that `is_cut` ends before its exit: the value there is the one on the way between both faces.
    pub(super) fn values<const PERSPECTIVE: bool>(
        &self,
        [x, y]: [f32; 2],
        v: [f32; 2],
        is_cut: bool,
    ) -> [Option<f32>; 2] {
        let depth = |v: f32| if PERSPECTIVE { 1.0 / v } else { -v };
        // Entry is the front face with the smallest v, exit the back face with the largest.
        let (mut farthest_entry, mut nearest_exit) = (f32::INFINITY, f32::NEG_INFINITY);
        let mut values = [None; 2];
        for &([c, dx, dy], face, is_back) in &self.faces {
            let on_plane = c + dx * x + dy * y;
            let w = depth(if is_back && is_cut { on_plane } else { v[usize::from(is_back)] });
            let value = Some(min(max(face.at(x, y, w), self.s_min), self.s_max));
            if is_back && on_plane > nearest_exit {
                (nearest_exit, values[1]) = (on_plane, value);
            } else if !is_back && on_plane < farthest_entry {
                (farthest_entry, values[0]) = (on_plane, value);
            }
        }
        if is_cut {
            let [w0, w1, w_exit] = [v[0], v[1], nearest_exit].map(depth);
            values[1] = match values {
                [Some(enter), Some(exit)] if w_exit > w1 => Some(enter + (exit - enter) * ((w1 - w0) / (w_exit - w0))),
                [_, exit] => exit,
            };
        }
        values
    }
}
