//! What is made of one tetrahedron, a cell or a part of one: its fan, the fans of its parts behind the near plane, or its planes.

use arrayvec::ArrayVec;
use glam::{Vec2, Vec3};

use super::classes::{Projected, fan};
use super::{Fan, FanInput, PlaneFan, PlanesFor};
use crate::columns::orientation_of;
use crate::stages::classify::{ProjectionClass, classify};
use crate::stages::footprints::PixelBoxes;
use crate::stages::near::{self, Corner};

/// A tetrahedron.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tet {
    /// Its vertices, ascending.
    vertex: [u32; 4],
    is_positive: bool,
    /// Its value, where it has one.
    constant: Option<f32>,
}

#[cfg(test)]
impl Tet {
    pub(super) fn vertices(&self) -> [u32; 4] {
        self.vertex
    }
}

/// The fans of one tetrahedron, and their classes; planes have none.
pub(super) type TetFans = ArrayVec<(Option<ProjectionClass>, Fan), 3>;

impl FanInput<'_> {
    /// Cell `cell`, which is a tetrahedron.
    #[inline]
    pub(super) fn tet(&self, cell: u32) -> Tet {
        let cell = cell as usize;
        let constant = self.cell_values.map(|values| values[cell]);
        Tet { vertex: self.dataset.tets.get(cell), is_positive: self.dataset.positive.get(cell), constant }
    }

    /// A part of another cell, whose value is `constant` where it has one.
    pub(super) fn part(&self, mut vertex: [u32; 4], constant: Option<f32>) -> Tet {
        vertex.sort_unstable();
        let positions = vertex.map(|v| Vec3::from_array(self.vertices[v as usize].position));
        Tet { vertex, is_positive: orientation_of(positions) > 0, constant }
    }

    /// Whether it needs care.
    #[inline]
    pub(super) fn is_near_tet(&self, tet: &Tet) -> bool {
        self.has_near_cells && tet.vertex.iter().any(|&v| self.is_near(&self.screen[v as usize]))
    }

    /// How many fans it has.
    #[inline]
    pub(super) fn fans_of(&self, tet: &Tet) -> usize {
        if self.planes_for == PlanesFor::NoCells && self.is_near_tet(tet) { self.of_cut_tet(tet).len() } else { 1 }
    }

    /// Its fans.
    #[inline]
    pub(super) fn of_tet(&self, tet: &Tet) -> TetFans {
        let is_near = self.is_near_tet(tet);
        if is_near && self.planes_for == PlanesFor::NoCells {
            return self.of_cut_tet(tet);
        }
        if (is_near || self.planes_for == PlanesFor::AllCells)
            && let Some(fan) = self.of_planes(tet, is_near)
        {
            return std::iter::once((None, fan)).collect();
        }
        let (projected, scalars) = self.corners(tet);
        let (class, fan) = self.of_corners(projected, scalars, tet.is_positive);
        std::iter::once((Some(class), fan)).collect()
    }

    /// The projected corners, and their scalars.
    #[inline]
    fn corners(&self, tet: &Tet) -> ([Vec3; 4], [f32; 4]) {
        let corners = tet.vertex.map(|v| self.screen[v as usize]);
        (
            corners.map(|corner| Vec3::new(corner.x_px, corner.y_px, corner.depth)),
            corners.map(|corner| tet.constant.unwrap_or(corner.scalar)),
        )
    }

    /// The fan between projected corners.
    #[inline]
    fn of_corners(&self, projected: [Vec3; 4], scalars: [f32; 4], is_positive: bool) -> (ProjectionClass, Fan) {
        let classified = classify(projected.map(Vec3::truncate), is_positive);
        let records = std::array::from_fn(|k| {
            let Vec3 { x, y, z: w } = projected[k];
            let v = self.view.inverse_depth(w);
            Projected { xy: Vec2::new(x, y), v, q: scalars[k] * if self.view.is_perspective { v } else { 1.0 } }
        });
        let fold = |of: fn(f32, f32) -> f32| of(of(scalars[0], scalars[1]), of(scalars[2], scalars[3]));
        (classified.class, fan(classified, records, [fold(f32::min), fold(f32::max)]))
    }

    /// The parts that lie behind the near plane.
    #[cold]
    fn of_cut_tet(&self, tet: &Tet) -> TetFans {
        let (projected, scalars) = self.corners(tet);
        let corners = tet.vertex.map(|v| self.vertices[v as usize].position);
        let corners = std::array::from_fn(|k| Corner {
            position: Vec3::from_array(corners[k]),
            scalar: scalars[k],
            depth: projected[k].z,
        });
        let mut parts = [corners; 3];
        let count = near::cut(corners, self.view.near, &mut parts);
        let of_part = |part: &[Corner; 4]| {
            let projected = part.map(|corner| self.projection.project(corner.position));
            let scalars = part.map(|corner| corner.scalar);
            let (class, fan) = self.of_corners(projected, scalars, tet.is_positive);
            (Some(class), fan)
        };
        parts[..count].iter().map(of_part).collect()
    }

    /// Its planes; none for a sliver behind the near plane, which has a fan.
    fn of_planes(&self, tet: &Tet, is_near: bool) -> Option<Fan> {
        let Some(pixels) = PixelBoxes::new(self.view).of_cell(tet.vertex, self.vertices, self.screen) else {
            return Some(Fan::default());
        };
        let of = (tet.vertex, tet.is_positive);
        let (fan, is_steep) = PlaneFan::new(self.view, pixels, of, self.vertices, tet.constant);
        (is_near || !is_steep).then(|| bytemuck::cast(fan))
    }
}
