//! Cells as face planes, in the room of a fan, so that each fragment evaluates the planes itself: where vertices lie before the
//! near plane or far outside the picture, triangles would be cut or rounded; where an optical model shows every pixel of an
//! outline, a rasteriser's rounding of vertices would move it.
//!
//! In: a cell and its pixel box. Out: a [`PlaneFan`]; a rasteriser draws its box as a fan of four triangles.

use bytemuck::{Pod, Zeroable};

use super::Fan;
use crate::stages::footprints::PixelBox;
use crate::stages::footprints::planes::{Affine, Batch, Corners, TileRays};
use crate::stages::{SceneVertex, View};

/// A cell as [`Batch`] has it, relative to the first pixel of its box.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct PlaneFan {
    /// First column, and from bit 16 on the column after the last; the same for rows.
    pub box_px: [u32; 2],
    /// Largest and smallest stored value: a [`Fan`] has them the other way round, which tells the two apart.
    pub s_range: [f32; 2],
    /// Smallest and largest inverse depth of the cell within the view's range.
    pub v_range: [f32; 2],
    /// The scalar along a ray is base + slope·w; this is the one that is constant on the picture: base, along parallel rays slope.
    pub constant: f32,
    /// How many planes are front faces; they come first.
    pub fronts: u32,
    /// The inverse depth of each face's plane at the first pixel, per column, per row; fourth: what varies of the scalar, the same three.
    pub planes: [[f32; 4]; 4],
}

const _: () = assert!(size_of::<PlaneFan>() == size_of::<Fan>());

impl PlaneFan {
    /// The cell `tet` with the pixels `pixels`, and whether its gradient is too steep for values by depth
    /// ([`Batch::is_steep`]); `constant` is its value where it has one.
    pub fn new(
        view: &View,
        pixels: PixelBox,
        (tet, is_positive): ([u32; 4], bool),
        vertices: &[SceneVertex],
        constant: Option<f32>,
    ) -> (Self, bool) {
        let PixelBox { x0, x1, y0, y1 } = pixels;
        let rays = TileRays::new(view, x0.into(), y0.into(), (x1 - x0).max(y1 - y0).into());
        let mut corners = Corners::<1>::default();
        corners.set(0, tet, vertices, is_positive);
        if let Some(value) = constant {
            corners.set_constant(0, value);
        }
        let mut batch = Batch::<1>::default();
        batch.set_up(&rays, &corners);

        let first = |affine: &Affine<1>| [affine.c[0], affine.x[0], affine.y[0]];
        let (varying, constant) =
            if view.is_perspective { (&batch.slope, &batch.base) } else { (&batch.base, &batch.slope) };
        let varying = first(varying);
        let is_back = |face: usize| batch.back_faces[0] >> face & 1 == 1;
        let mut faces = [0, 1, 2, 3];
        faces.sort_by_key(|&face| is_back(face));
        let plane = |k: usize| {
            let [c, x, y] = first(&batch.planes[faces[k]]);
            [c, x, y, varying.get(k).copied().unwrap_or(0.0)]
        };
        let (s_min, s_max) = (batch.s_min[0], batch.s_max[0]);
        let fan = Self {
            box_px: [u32::from(x0) | u32::from(x1) << 16, u32::from(y0) | u32::from(y1) << 16],
            // Apart by more than a GPU may take for 0.
            s_range: [s_max.max(s_min + s_min.abs() * 1e-6 + 1e-30), s_min],
            v_range: [batch.v_min[0], batch.v_max[0]],
            constant: constant.c[0],
            fronts: faces.iter().filter(|&&face| !is_back(face)).count() as u32,
            planes: std::array::from_fn(plane),
        };
        (fan, batch.is_steep[0] != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::footprints::PixelBoxes;
    use crate::stages::project::{project, scene_vertices};
    use crate::stages::testing::{Random, corners, depths_in_cell, random_cells, ray, views};

    #[test]
    fn planes_give_the_depths_at_which_a_ray_meets_the_cell() {
        let dataset = random_cells(3000, 0.3, &mut Random::new(5));
        let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
        let (mut met, mut worst) = (0, 0.0_f64);
        for view in views(&dataset, 64, 48) {
            let mut screen = Vec::new();
            project(&view, &vertices, &mut screen);
            for cell in 0..dataset.tets.len() {
                let tet = dataset.tets.get(cell);
                let Some(pixels) = PixelBoxes::new(&view).of_cell(tet, &vertices, &screen) else { continue };
                let (fan, _) = PlaneFan::new(&view, pixels, (tet, dataset.positive.get(cell)), &vertices, None);
                assert!(fan.s_range[0] > fan.s_range[1]);
                let (x, y) = (u32::from(pixels.x0 + pixels.x1) / 2, u32::from(pixels.y0 + pixels.y1) / 2);
                let at = [(x - u32::from(pixels.x0)) as f32, (y - u32::from(pixels.y0)) as f32];
                let on_plane = |k: usize| fan.planes[k][0] + fan.planes[k][1] * at[0] + fan.planes[k][2] * at[1];
                let fronts = fan.fronts as usize;
                let enter = (0..fronts).map(on_plane).fold(fan.v_range[1], f32::min);
                let leave = (fronts..4).map(on_plane).fold(fan.v_range[0], f32::max);
                let (near, far) =
                    depths_in_cell(&view, ray(&view, x.into(), y.into()), corners(&dataset, &vertices, cell));
                let (near, far) = (near.max(f64::from(view.near)), far.min(f64::from(view.far)));
                let depth = |v: f32| f64::from(if view.is_perspective { 1.0 / v } else { -v });
                let length = if enter > leave { depth(leave) - depth(enter) } else { 0.0 };
                worst = worst.max((length - (far - near).max(0.0)).abs());
                met += usize::from(enter > leave);
            }
        }
        println!("{met} cells met, largest error {worst:.2e} scene units");
        assert!(met > 2000 && worst < 1e-3, "{met} {worst}");
    }
}
