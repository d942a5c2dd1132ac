//! Fans of hexahedra, voxels, wedges and pyramids: the triangles of a classified cell.
//!
//! In: a [`Placed`] cell, its projected corners, the diagonals of its faces. Out: [`CellFans`]: the vertices of its case
//! with entry and exit, and the case's triangles, which are one list for all cells of the case. O(1), no allocation.
//!
//! Entry and exit at a vertex (Max 2006, sections 3, 4 and 7): on the outline they are one; at a crossing they are points
//! of a front and of a back edge; at an inner corner one is the corner, the other a point of the face that contains it, in
//! the triangle on its side of the diagonal. (v, q) are affine on the picture over every planar face, so over every
//! triangle they are exact for cells with planar faces. Where a face is warped they are interpolated within the triangle, and
//! on a cell that is folded there the exit may lie before the entry.

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, Vec2};

use crate::cells::CellKind;
use crate::stages::classify::polyhedra::{Case, Crossing, Placed, share_to_crossing};

/// A projected corner of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProjectedCorner {
    /// Column and row in pixels.
    pub position_px: Vec2,
    /// Inverse depth v and q = s·v (parallel rays: q = s).
    pub vq: Vec2,
}

/// A vertex of a cell's triangles as a rasteriser reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct FanVertex {
    /// Column and row in pixels.
    pub position_px: [f32; 2],
    /// Inverse depth v and q = s·v (parallel rays: s) where the ray through the vertex enters.
    pub front: [f32; 2],
    /// The same where it leaves.
    pub back: [f32; 2],
}

/// The triangles of one cell.
#[derive(Clone, Debug, PartialEq)]
pub struct CellFans {
    /// The corners in the case's standard numbering, then the crossings.
    pub vertices: ArrayVec<FanVertex, { Case::VERTICES_MAX }>,
    /// Indices of vertices; all triangles of a cell turn the same way.
    pub triangles: &'static [[u8; 3]],
}

impl CellFans {
    /// The triangles of a placed cell; `corners` are in its kind's order, bit f of `diagonals` is that of
    /// [`diagonals`](crate::cells::diagonals).
    ///
    /// # Panics
    /// If there are fewer corners than the kind has.
    ///
    /// ```
    /// # use cellfan::{cells::VOXEL, stages::classify::polyhedra::{Projection, Projections}};
    /// # use cellfan::stages::fans::polyhedra::{CellFans, ProjectedCorner};
    /// // A frustum along parallel rays (v = −depth): the face at depth 1 contains that at depth 3.
    /// let corners: [_; 8] = std::array::from_fn(|i| ProjectedCorner {
    ///     position_px: (glam::Vec2::new((i & 1) as f32, (i >> 1 & 1) as f32) - 0.5) * if i < 4 { 4.0 } else { 2.0 },
    ///     vq: glam::Vec2::new(if i < 4 { -1.0 } else { -3.0 }, 0.0),
    /// });
    /// let table = Projections::of(&VOXEL).expect("voxels have a table");
    /// let Projection::Whole(placed) = table.classify(&corners.map(|corner| corner.position_px), true) else { panic!() };
    /// let fans = CellFans::new(&placed, &corners, 0);
    /// let thickest = fans.vertices.iter().map(|vertex| vertex.front[0] - vertex.back[0]).fold(0.0, f32::max);
    /// assert_eq!(thickest, 2.0);
    /// ```
    #[inline]
    pub fn new(placed: &Placed, corners: &[ProjectedCorner], diagonals: u8) -> Self {
        let standard = &placed.renumbering.corner_from_standard;
        let at = |corner: u8| corners[usize::from(standard[usize::from(corner)])];
        let vertex = |position_px: Vec2, [lid, bowl]: [Vec2; 2]| {
            let [front, back] = if placed.lid_is_front { [lid, bowl] } else { [bowl, lid] };
            FanVertex { position_px: position_px.to_array(), front: front.to_array(), back: back.to_array() }
        };
        let mut vertices = ArrayVec::new();
        for (corner, inner) in (0..).zip(&placed.case.inner) {
            let ProjectedCorner { position_px, vq } = at(corner);
            let lid_bowl = match inner {
                None => [vq, vq],
                Some(inner) => {
                    let face = placed.renumbering.face_from_standard[usize::from(inner.face)];
                    let opposite = on_face(placed.kind, corners, face, diagonals >> face & 1 == 1, position_px);
                    if inner.of_lid { [vq, opposite] } else { [opposite, vq] }
                }
            };
            vertices.push(vertex(position_px, lid_bowl));
        }
        for Crossing { lid, bowl } in &placed.case.crossings {
            let (lid, bowl) = (lid.map(at), bowl.map(at));
            let [on_lid, on_bowl] = [along(lid, bowl), along(bowl, lid)];
            vertices.push(vertex(on_lid.position_px, [on_lid.vq, on_bowl.vq]));
        }
        Self { vertices, triangles: &placed.case.triangles }
    }
}

fn position(corner: ProjectedCorner) -> DVec2 {
    corner.position_px.as_dvec2()
}

/// Twice the area of a triangle, with its sign.
#[inline]
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// The point of an edge where it crosses another.
#[inline]
fn along([a, b]: [ProjectedCorner; 2], other: [ProjectedCorner; 2]) -> ProjectedCorner {
    let t = share_to_crossing([a, b].map(position), other.map(position));
    let lerp = |a: Vec2, b: Vec2| a.as_dvec2().lerp(b.as_dvec2(), t).as_vec2();
    ProjectedCorner { position_px: lerp(a.position_px, b.position_px), vq: lerp(a.vq, b.vq) }
}

/// (v, q) at picture position `p` of a face, cut along the diagonal from its second corner if `from_second`, else from its
/// first.
#[inline]
fn on_face(kind: &CellKind, corners: &[ProjectedCorner], face: u8, from_second: bool, p: Vec2) -> Vec2 {
    let face = kind.faces[usize::from(face)];
    let at = |i: usize| corners[usize::from(face[i % face.len()])];
    let first = usize::from(from_second && face.len() == 4);
    let xy = |i: usize| position(at(i));
    let (a, c, p) = (xy(first), xy(first + 2), p.as_dvec2());
    // The triangle a b c has p if b and p lie on one side of a c.
    let second = if face.len() == 4 && area(a, c, p) * area(a, c, xy(first + 1)) < 0.0 { 3 } else { 1 };
    let triangle = [first, first + second, first + 2].map(at);
    let b = position(triangle[1]);
    let whole = area(a, b, c);
    if whole == 0.0 {
        // Seen edge-on: the end that p is at, or next to.
        let distance = |corner: &&ProjectedCorner| position(**corner).distance_squared(p);
        let nearest = triangle.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        return nearest.unwrap_or(&triangle[0]).vq;
    }
    let weights = [area(p, b, c), area(a, p, c), area(a, b, p)].map(|part| part / whole);
    let weighted = triangle.iter().zip(weights).map(|(corner, weight)| corner.vq.as_dvec2() * weight);
    weighted.sum::<DVec2>().as_vec2()
}

#[cfg(test)]
mod tests;
