//! Whole cells as the papers draw them: the triangles of a case, in the room of four fans; cells with a face that is concave or
//! crosses itself on the picture, and those that need care, as tetrahedra.
//!
//! In: a cell with faces of four corners. Out: a [`CaseFan`], or the parts of the cell, farthest first.
//! On a warped face, depth and value are interpolated within a triangle of the case, which is not on the face: neighbours may
//! overlap or leave gaps (Max 2006, section 7 and figure 15). [`HexFan`](super::HexFan) is exact there.

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec2, Vec3};

use super::polyhedra::{CellFans, FanVertex, ProjectedCorner};
use super::tetrahedra::Tet;
use super::{Fan, FanInput, is_far_outside};
use crate::camera::Region;
use crate::cells::{CellKind, HEXAHEDRON, PYRAMID, WEDGE};
use crate::columns::{HexShape, split_hexahedron};
use crate::stages::View;
use crate::stages::classify::CellClass;
use crate::stages::classify::polyhedra::{Case, Projection, Projections};

/// The triangles of a whole cell in the room of four [`Fan`]s.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct CaseFan {
    triangle_count: u32,
    unused: u32,
    /// Smallest and largest stored value of the cell.
    pub s_range: [f32; 2],
    /// The vertices of the cell's case.
    pub vertices: [FanVertex; Case::VERTICES_MAX],
    /// Three vertices each, four bits a vertex, the first lowest; those after the last are 0.
    pub(crate) triangles: [u16; CaseFan::TRIANGLES_MAX],
    unused_at_end: [u32; 11],
    /// [`CaseFan::MARK`], where other records have 0.
    pub(crate) mark: u32,
}

const _: () = assert!(size_of::<CaseFan>() == CaseFan::FANS * size_of::<Fan>());

/// What is drawn of a whole cell.
pub(super) enum Drawn {
    /// Nothing.
    EdgeOn,
    /// The triangles of its case.
    Case(CellClass, Box<CaseFan>),
    /// Tetrahedra, farthest first.
    Parts(Box<ArrayVec<Tet, PARTS_MAX>>),
}

/// The triangles that do not touch a corner: six, or, of a cell that is cut against the rule, all.
pub(super) const PARTS_MAX: usize = 12;

impl CaseFan {
    /// The fans whose room it takes.
    pub const FANS: usize = 4;
    /// No case has more triangles.
    pub const TRIANGLES_MAX: usize = 16;
    const MARK: u32 = 1;

    pub(super) fn new(fans: &CellFans, s_range: [f32; 2]) -> Self {
        let mut record =
            Self { s_range, triangle_count: fans.triangles.len() as u32, mark: Self::MARK, ..Self::default() };
        record.vertices[..fans.vertices.len()].copy_from_slice(&fans.vertices);
        for (packed, triangle) in record.triangles.iter_mut().zip(fans.triangles) {
            *packed = triangle.iter().rev().fold(0, |bits, &vertex| bits << 4 | u16::from(vertex));
        }
        record
    }

    /// What a record holds, if it is one.
    pub fn of_record(record: &[Fan]) -> Option<Self> {
        let fans: &[Fan; Self::FANS] = record.try_into().ok()?;
        Some(bytemuck::cast::<_, Self>(*fans)).filter(|record| record.mark == Self::MARK)
    }

    /// Its triangles.
    pub fn triangles(&self) -> impl Iterator<Item = [FanVertex; 3]> {
        let vertices = |packed: &u16| [0, 4, 8].map(|bit| self.vertices[usize::from(packed >> bit & 15)]);
        self.triangles[..self.triangle_count as usize].iter().map(vertices)
    }
}

impl FanInput<'_> {
    /// What is drawn of cell `cell`, which has faces of four corners.
    pub(super) fn of_whole_cell(&self, cell: usize) -> Drawn {
        let number = cell - self.dataset.tets.len();
        let (vertex, shape) = (self.hexahedra.get(number), self.hexahedra.shape(number));
        let constant = self.cell_values.map(|values| values[cell]);
        let seen = vertex.map(|v| self.screen[v as usize]);
        // Parts and case are not the same picture where a face is warped: regions have those of the whole.
        let whole = Region::whole(self.view.size_px);
        if seen.iter().any(|corner| corner.depth < self.view.near || is_far_outside(whole, corner)) {
            return Drawn::Parts(Box::new(self.parts(vertex, shape, constant)));
        }
        let (kind, hexahedron_corners) = kind_of(vertex);
        let corner = |&corner: &u8| {
            let seen = self.screen[vertex[usize::from(corner)] as usize];
            let v = self.view.inverse_depth(seen.depth);
            let s = constant.unwrap_or(seen.scalar);
            ProjectedCorner {
                position_px: seen.xy(),
                vq: Vec2::new(v, if self.view.is_perspective { s * v } else { s }),
            }
        };
        let corners: ArrayVec<ProjectedCorner, 8> = hexahedron_corners.iter().map(corner).collect();
        let xy: ArrayVec<Vec2, 8> = corners.iter().map(|corner| corner.position_px).collect();
        // A cell that is positive in space is so on the picture.
        let placed = match Projections::of(kind).map(|projections| projections.classify(&xy, true)) {
            Some(Projection::Whole(placed)) => placed,
            Some(Projection::EdgeOn) => return Drawn::EdgeOn,
            Some(Projection::Split) | None => return Drawn::Parts(Box::new(self.parts(vertex, shape, constant))),
        };
        let fans = CellFans::new(&placed, &corners, diagonals_of(kind, &hexahedron_corners, vertex, shape));
        let scalars = vertex.iter().map(|&v| constant.unwrap_or(self.screen[v as usize].scalar));
        let s_range = scalars.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], s| [low.min(s), high.max(s)]);
        Drawn::Case(CellClass::of_case(kind, placed.case), Box::new(CaseFan::new(&fans, s_range)))
    }

    /// The tetrahedra of a cell, cut as its faces are, farthest first.
    pub(super) fn parts(&self, vertex: [u32; 8], shape: HexShape, constant: Option<f32>) -> ArrayVec<Tet, PARTS_MAX> {
        let at = |v: u32| Vec3::from_array(self.vertices[v as usize].position);
        let first_there = |v: u32| vertex.into_iter().filter(|&other| at(other) == at(v)).min().unwrap_or(v);
        let mut parts: ArrayVec<[u32; 4], PARTS_MAX> = split_hexahedron(vertex, shape, first_there).collect();
        let mut ordered = ArrayVec::new();
        while !parts.is_empty() {
            // One that no other stands behind; if there is none, the cell is turned inside out and any will do.
            let is_farthest = |part: &[u32; 4]| {
                !parts.iter().any(|other| is_behind(self.view, other.map(|v| (v, at(v))), part.map(|v| (v, at(v)))))
            };
            let next = parts.iter().position(is_farthest).unwrap_or(0);
            ordered.push(self.part(parts.remove(next), constant));
        }
        ordered
    }
}

/// Whether a tetrahedron shares a face with another and lies behind it; vertices with their positions.
fn is_behind(view: &View, part: [(u32, Vec3); 4], other: [(u32, Vec3); 4]) -> bool {
    let is_shared = |(vertex, _): &(u32, Vec3)| other.iter().any(|(of_other, _)| of_other == vertex);
    let position = |(_, p): (u32, Vec3)| p.as_dvec3();
    let mut shared: ArrayVec<DVec3, 4> = part.into_iter().filter(is_shared).map(position).collect();
    let own = part.into_iter().find(|vertex| !is_shared(vertex)).map(position);
    let (Some(own), Some(c), Some(b), Some(a)) = (own, shared.pop(), shared.pop(), shared.pop()) else { return false };
    let n = (b - a).cross(c - a);
    let to_eye = if view.is_perspective { view.eye - a } else { -view.forward };
    n.dot(to_eye) * n.dot(own - a) < 0.0
}

/// The kind that a hexahedron with coinciding corners is, and which of its corners are the kind's.
fn kind_of(v: [u32; 8]) -> (&'static CellKind, ArrayVec<u8, 8>) {
    let are_one = |corners: [usize; 4]| corners.iter().all(|&corner| v[corner] == v[corners[0]]);
    let (kind, corners): (&CellKind, &[u8]) = if are_one([4, 5, 6, 7]) {
        (&PYRAMID, &[0, 1, 2, 3, 4])
    } else if are_one([0, 1, 2, 3]) {
        // Its base is on top: seen from the tip it runs the other way round.
        (&PYRAMID, &[7, 6, 5, 4, 0])
    } else if v[2] == v[3] && v[6] == v[7] {
        // VTK's wedges have their first triangle run the other way round than a hexahedron its bottom.
        (&WEDGE, &[4, 5, 6, 0, 1, 2])
    } else {
        (&HEXAHEDRON, &[0, 1, 2, 3, 4, 5, 6, 7])
    };
    (kind, corners.iter().copied().collect())
}

/// Along which diagonal each face of the kind is cut, as the hexahedron's are.
fn diagonals_of(kind: &CellKind, corners: &[u8], vertex: [u32; 8], shape: HexShape) -> u8 {
    if kind == &HEXAHEDRON {
        return shape.diagonals();
    }
    let number = |corner: u8| vertex[usize::from(corner)];
    let is_second = |face: &&[u8]| {
        let [.., d] = face else { return false };
        let (b, all) = (face[1], face.iter().map(|&corner| number(corners[usize::from(corner)])));
        let ends = [b, *d].map(|corner| number(corners[usize::from(corner)]));
        let all: ArrayVec<u32, 4> = all.collect();
        (0..6).any(|of_hexahedron| {
            let is_it = all.iter().all(|v| HEXAHEDRON.faces[of_hexahedron].iter().any(|&c| number(c) == *v));
            let [[p, q, _], _] = shape.triangles(of_hexahedron);
            let cut = [number(p), number(q)];
            is_it && (cut == ends || cut == [ends[1], ends[0]])
        })
    };
    (0..).zip(kind.faces).filter(|(_, face)| face.len() == 4 && is_second(face)).map(|(bit, _)| 1 << bit).sum()
}

#[cfg(test)]
mod tests;
