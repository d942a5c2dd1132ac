//! A hexahedron by its corners, in the room of two fans: a rasteriser draws its box, and each fragment finds the triangles that
//! its ray crosses.
//!
//! In: a cell, its corners on the picture, its pixel box. Out: a [`HexFan`].
//!
//! For the ends a, b of an edge, relative to the fragment on the picture, a × b tells on which side of the edge the ray runs.
//! A ray that has all three edges of a triangle on one side crosses it, and the three products are the weights of the corners
//! at the point where it does: depth and value there are interpolated, never extrapolated. An edge runs from the vertex of
//! lower number to the other, so that all triangles around it take the same bits to the same side: of two that face the same
//! way a ray through their edge crosses just one.
//!
//! Where a corner lies before the near plane it has no place on the picture. There corners are homogeneous, (x·w, y·w, w), and
//! relative to fragment p they are (x·w − p·w): the products, and weights of w and s instead of v and s·v, are the same.

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3};

use super::{Fan, FanInput};
use crate::cells::HEXAHEDRON;
use crate::columns::HexShape;
use crate::stages::footprints::{PixelBox, PixelBoxes};
use crate::stages::{SceneVertex, ScreenVertex, View};

/// A hexahedron in the room of two [`Fan`]s.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct HexFan {
    /// First column, and from bit 16 on the column after the last; the same for rows.
    pub box_px: [u32; 2],
    /// Largest and smallest stored value: a [`Fan`] has them the other way round, which tells the two apart.
    pub s_range: [f32; 2],
    /// The inverse depth that those of the corners are relative to.
    pub v_origin: f32,
    unused: [u32; 2],
    /// What [`HexFan::HEXAHEDRON`] and the constants after it name, a bit each.
    pub flags: u32,
    /// Column and row relative to the box's first pixel, `v_origin` − v, s·v (parallel rays: s); homogeneous: x·w, y·w, w, s.
    pub corners: [[f32; 4]; 8],
    unused_at_end: [[f32; 4]; 2],
}

const _: () = assert!(size_of::<HexFan>() == HexFan::FANS * size_of::<Fan>());

/// The edges of a hexahedron; after them come the diagonals of its faces.
pub(super) const EDGES: [[u8; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

impl HexFan {
    /// The fans whose room it takes.
    pub const FANS: usize = 2;
    /// Bit k of the flags is set where edge k runs from the vertex of greater number to that of lower: twelve edges, six diagonals.
    pub const REVERSED: u32 = 0;
    /// Six bits from here on: those of [`diagonals`](crate::cells::diagonals).
    pub const DIAGONALS: u32 = 18;
    /// Corners are homogeneous.
    pub const IS_HOMOGENEOUS: u32 = 1 << 24;
    /// The cell has one value, the smallest of its range.
    pub const IS_CONSTANT: u32 = 1 << 25;
    /// Set in all: what a [`PlaneFan`](super::PlaneFan) has in this place is a small number.
    pub const HEXAHEDRON: u32 = 1 << 31;

    /// The cell with vertices `vertex` and the pixels `pixels`; `constant` is its value where it has one.
    pub fn new(
        view: &View,
        pixels: PixelBox,
        (vertex, shape): ([u32; 8], HexShape),
        (vertices, screen): (&[SceneVertex], &[ScreenVertex]),
        constant: Option<f32>,
    ) -> Self {
        let seen = vertex.map(|v| screen[v as usize]);
        let scalars = seen.map(|corner| constant.unwrap_or(corner.scalar));
        let (s_min, s_max) =
            scalars.into_iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), s| (low.min(s), high.max(s)));
        let is_homogeneous = view.is_perspective && seen.iter().any(|corner| corner.depth < view.near);
        let v = seen.map(|corner| view.inverse_depth(corner.depth));
        let v_origin = if is_homogeneous { 0.0 } else { v[0] };
        let [x0, y0] = [pixels.x0, pixels.y0].map(f32::from);
        let corners = std::array::from_fn(|i| {
            if is_homogeneous {
                let [x, y, w] = homogeneous(view, [x0, y0], vertices[vertex[i] as usize]).to_array().map(|x| x as f32);
                return [x, y, w, scalars[i]];
            }
            let q = scalars[i] * if view.is_perspective { v[i] } else { 1.0 };
            [seen[i].x_px - x0, seen[i].y_px - y0, v_origin - v[i], q]
        });
        let [columns, rows] = [[pixels.x0, pixels.x1], [pixels.y0, pixels.y1]]
            .map(|[first, end]| u32::from(first) | u32::from(end) << 16);
        Self {
            box_px: [columns, rows],
            // Apart by more than a GPU may take for 0.
            s_range: [s_max.max(s_min + s_min.abs() * 1e-6 + 1e-30), s_min],
            v_origin,
            flags: flags(vertex, shape, is_homogeneous, s_min >= s_max),
            corners,
            ..Self::default()
        }
    }

    /// The hexahedron that a record holds, if it is one.
    pub fn of_record(record: &[Fan]) -> Option<Self> {
        let fans: &[Fan; Self::FANS] = record.try_into().ok()?;
        let [s_max, s_min] = fans[0].s_range;
        (s_max > s_min).then(|| bytemuck::cast::<_, Self>(*fans)).filter(|fan| fan.flags & Self::HEXAHEDRON != 0)
    }

    /// View depth and stored value where the ray at `at` (column and row relative to the box) enters the cell and where it
    /// leaves it, for each of its parts in it, nearest first; the range of depths that is drawn is not taken into account.
    ///
    /// The twin of `shaders/hexahedra.wgsl`, in f64.
    pub fn parts(&self, view: &View, at: [f64; 2]) -> ArrayVec<[[f64; 2]; 2], 3> {
        let has = |bit: u32| self.flags & bit != 0;
        let is_homogeneous = has(Self::IS_HOMOGENEOUS);
        let corners = self.corners.map(|corner| corner.map(f64::from));
        let relative =
            corners.map(|[x, y, z, _]| DVec2::new(x, y) - DVec2::from(at) * if is_homogeneous { z } else { 1.0 });
        let (mut enter, mut leave) = (ArrayVec::<[f64; 2], 12>::new(), ArrayVec::<[f64; 2], 12>::new());
        for face in 0..6 {
            let diagonal = (self.flags >> (Self::DIAGONALS + face as u32) & 1) as usize;
            for triangle in crate::cells::face_triangles(face, diagonal) {
                let edges = [0, 1, 2].map(|k: usize| [triangle[k], triangle[(k + 1) % 3]]);
                let sides = edges.map(|edge| self.side(edge, face, &relative));
                let [(ab, is_left), (bc, second), (ca, third)] = sides;
                if second != is_left || third != is_left || ab + bc + ca == 0.0 {
                    continue;
                }
                let weights = [bc, ca, ab].map(|product| product / (ab + bc + ca));
                let mix = |k: usize| (0..3).map(|i| weights[i] * corners[usize::from(triangle[i])][k]).sum::<f64>();
                let (depth, value) = if is_homogeneous {
                    (mix(2), mix(3))
                } else if view.is_perspective {
                    let v = f64::from(self.v_origin) - mix(2);
                    (1.0 / v, mix(3) / v)
                } else {
                    (mix(2) - f64::from(self.v_origin), mix(3))
                };
                let [s_max, s_min] = self.s_range.map(f64::from);
                let value = if has(Self::IS_CONSTANT) { s_min } else { value.clamp(s_min, s_max) };
                // Counterclockwise seen from outside is so on the picture, whose rows run down, where the triangle is in front.
                if is_left { leave.push([depth, value]) } else { enter.push([depth, value]) }
            }
        }
        enter.sort_by(|a, b| a[0].total_cmp(&b[0]));
        leave.sort_by(|a, b| a[0].total_cmp(&b[0]));
        enter.into_iter().zip(leave).map(|(enter, leave)| [enter, leave]).take(3).collect()
    }

    /// The product of the ends of an edge of face `face`, and whether the ray passes on the side where it is positive.
    fn side(&self, [i, k]: [u8; 2], face: usize, relative: &[DVec2; 8]) -> (f64, bool) {
        let number = EDGES.iter().position(|edge| *edge == [i, k] || *edge == [k, i]).unwrap_or(EDGES.len() + face);
        let (first, second) = ends(number, self.flags);
        let is_reversed = self.flags >> number & 1 == 1;
        let (first, second) = if is_reversed { (second, first) } else { (first, second) };
        let product = relative[usize::from(first)].perp_dot(relative[usize::from(second)]);
        let is_along = first == i;
        (if is_along { product } else { -product }, (product >= 0.0) == is_along)
    }
}

impl FanInput<'_> {
    /// Cell `cell`, which has faces of four corners, by these.
    #[inline]
    pub(super) fn of_hexahedron(&self, cell: usize) -> HexFan {
        let number = cell - self.dataset.tets.len();
        let vertex = self.hexahedra.get(number);
        let Some(pixels) = PixelBoxes::new(self.view).of_cell(vertex, self.vertices, self.screen) else {
            return HexFan::default();
        };
        let constant = self.cell_values.map(|values| values[cell]);
        HexFan::new(self.view, pixels, (vertex, self.hexahedra.shape(number)), (self.vertices, self.screen), constant)
    }
}

/// The ends of edge, or diagonal, `number`, as the tables have them.
fn ends(number: usize, flags: u32) -> (u8, u8) {
    if let Some(&[first, second]) = EDGES.get(number) {
        return (first, second);
    }
    let face = number - EDGES.len();
    let first = (flags >> (HexFan::DIAGONALS + face as u32) & 1) as usize;
    (HEXAHEDRON.faces[face][first], HEXAHEDRON.faces[face][first + 2])
}

fn flags(vertex: [u32; 8], shape: HexShape, is_homogeneous: bool, is_constant: bool) -> u32 {
    let diagonals = u32::from(shape.diagonals()) << HexFan::DIAGONALS;
    let is_reversed = |number: &usize| {
        let (first, second) = ends(*number, diagonals);
        vertex[usize::from(first)] > vertex[usize::from(second)]
    };
    let reversed: u32 = (0..EDGES.len() + 6).filter(is_reversed).map(|number| 1 << number).sum();
    let flag = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
    HexFan::HEXAHEDRON
        | reversed
        | diagonals
        | flag(is_homogeneous, HexFan::IS_HOMOGENEOUS)
        | flag(is_constant, HexFan::IS_CONSTANT)
}

/// (x·w, y·w, w) of a vertex, x and y relative to `first_px`.
fn homogeneous(view: &View, first_px: [f32; 2], vertex: SceneVertex) -> DVec3 {
    let from_eye = DVec3::from_array(vertex.position.map(f64::from)) - view.beside().eye;
    let w = from_eye.dot(view.forward);
    let along = |step: DVec3, first: f32| {
        let per_px = step / step.length_squared();
        from_eye.dot(per_px) - (view.corner.dot(per_px) + f64::from(first)) * w
    };
    DVec3::new(along(view.step_x, first_px[0]), along(view.step_y, first_px[1]), w)
}

#[cfg(test)]
mod tests;
