//! The cases: for each kind the ways in which its projection is divided, one representative each, in a standard numbering.
//!
//! A case is which faces lie on one side, and in which face of the other side each inner corner lies; everything else is
//! found from that (`overlay.rs`), and every other numbering of it by a rotation (`renumber.rs`).
//! Sources: hexahedra: Max 2006, sections 3 and 4, in the paper's numbering, which is VTK's; for count 0 that around the
//! octagon of its figure 12. Wedges and pyramids: all there are, by the same rule.

use super::Faces;
use super::overlay::{Crossing, Overlay};
use super::renumber::Renumbering;
use super::sides::Sides;
use crate::cells::{CellKind, HEXAHEDRON, PYRAMID, VOXEL, WEDGE};

/// One way in which a cell's projection is divided into triangles; vertices are the corners of its standard numbering,
/// then the crossings.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name in STATS.json.
    pub name: &'static str,
    /// Its place among the cases of its kind.
    pub index: usize,
    /// For each corner the face that lies behind or before it, if it is inside the outline.
    pub inner: Vec<Option<Inner>>,
    /// The edges that cross, one vertex each.
    pub crossings: Vec<Crossing>,
    /// The triangles, all turning the same way, as indices of vertices.
    pub triangles: Vec<[u8; 3]>,
}

impl Case {
    /// No case has more vertices: a hexahedron's eight corners and four crossings.
    pub const VERTICES_MAX: usize = 12;
}

/// An inner corner: of which side it is, and where it lies on the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inner {
    /// Whether the corner belongs to the lid; else to the bowl.
    pub of_lid: bool,
    /// The face of the other side that contains it, in the standard numbering.
    pub face: u8,
}

/// What is written down of a case: faces are named by their corners.
pub(super) struct Definition {
    pub name: &'static str,
    /// The faces of the standard numbering, counterclockwise seen from outside.
    pub faces: Faces,
    lid: &'static [&'static [u8]],
    /// In which face an inner corner lies, where there is more than one on the other side.
    inside: &'static [(u8, &'static [u8])],
}

/// Eight corners around an octagon; the lid's inner edges are 03 and 47, the bowl's 16 and 25 (Max 2006, figure 12).
static OCTAGON: [&[u8]; 6] = [&[0, 1, 2, 3], &[0, 3, 4, 7], &[4, 5, 6, 7], &[0, 7, 6, 1], &[1, 6, 5, 2], &[2, 5, 4, 3]];

const fn hexahedron(
    name: &'static str,
    lid: &'static [&'static [u8]],
    inside: &'static [(u8, &'static [u8])],
) -> Definition {
    Definition { name, faces: HEXAHEDRON.faces, lid, inside }
}

const fn wedge(
    name: &'static str,
    lid: &'static [&'static [u8]],
    inside: &'static [(u8, &'static [u8])],
) -> Definition {
    Definition { name, faces: WEDGE.faces, lid, inside }
}

const fn pyramid(
    name: &'static str,
    lid: &'static [&'static [u8]],
    inside: &'static [(u8, &'static [u8])],
) -> Definition {
    Definition { name, faces: PYRAMID.faces, lid, inside }
}

/// Max 2006, figures 12, 5 to 9, 11 and 10. The number is that of corners inside one face.
static HEXAHEDRA: [Definition; 8] = [
    Definition { name: "count0", faces: &OCTAGON, lid: &[&[0, 1, 2, 3], &[0, 3, 4, 7], &[4, 5, 6, 7]], inside: &[] },
    hexahedron("count1", AROUND_1, &[(7, &[0, 1, 2, 3]), (1, &[4, 5, 6, 7])]),
    hexahedron("count1_a", AROUND_1, &[(7, &[0, 1, 2, 3]), (1, &[0, 3, 7, 4])]),
    hexahedron("count1_b", AROUND_1, &[(7, &[0, 1, 2, 3]), (1, &[2, 3, 7, 6])]),
    hexahedron("count1_c", &[&[0, 1, 2, 3], &[1, 2, 6, 5]], &[(7, &[0, 1, 2, 3]), (4, &[1, 2, 6, 5])]),
    hexahedron("count1_d", &[&[0, 1, 2, 3], &[0, 1, 5, 4]], &[(7, &[0, 1, 2, 3]), (6, &[0, 1, 5, 4])]),
    hexahedron("count2", &[&[0, 1, 2, 3], &[0, 1, 5, 4]], &[(7, &[0, 1, 2, 3]), (6, &[0, 1, 2, 3])]),
    hexahedron("count4", &[&[0, 1, 2, 3]], &[]),
];

/// The three faces at corner 1 of a hexahedron.
const AROUND_1: &[&[u8]] = &[&[0, 1, 2, 3], &[0, 1, 5, 4], &[1, 2, 6, 5]];

static WEDGES: [Definition; 5] = [
    wedge("wedge0", &[&[0, 1, 4, 3], &[1, 2, 5, 4]], &[]),
    wedge("wedge1_triangle", &[&[0, 1, 2], &[0, 1, 4, 3]], &[(5, &[0, 1, 2])]),
    wedge("wedge1_quadrilateral", &[&[0, 1, 2], &[0, 1, 4, 3]], &[(5, &[0, 1, 4, 3])]),
    wedge("wedge2", &[&[0, 1, 4, 3]], &[]),
    wedge("wedge3", &[&[0, 1, 2]], &[]),
];

/// Left and right are mirror images: the inner corner lies in the one or the other of two neighbouring triangles.
static PYRAMIDS: [Definition; 5] = [
    pyramid("pyramid0", &[&[0, 1, 2, 3], &[0, 1, 4]], &[]),
    pyramid("pyramid1_base", &[&[0, 1, 2, 3]], &[]),
    pyramid("pyramid1_left", &[&[0, 1, 4], &[1, 2, 4]], &[(3, &[0, 1, 4])]),
    pyramid("pyramid1_right", &[&[0, 1, 4], &[1, 2, 4]], &[(3, &[1, 2, 4])]),
    pyramid("pyramid2", &[&[0, 1, 4]], &[]),
];

/// The cases of a kind; none for kinds that are classified otherwise.
pub(super) fn definitions(kind: &CellKind) -> &'static [Definition] {
    match kind.code {
        code if code == VOXEL.code || code == HEXAHEDRON.code => &HEXAHEDRA,
        code if code == WEDGE.code => &WEDGES,
        code if code == PYRAMID.code => &PYRAMIDS,
        _ => &[],
    }
}

/// The face with these corners.
fn face_of(faces: Faces, corners: &[u8]) -> Option<u8> {
    let is_it = |face: &&[u8]| face.len() == corners.len() && face.iter().all(|corner| corners.contains(corner));
    faces.iter().position(is_it).map(|face| face as u8)
}

impl Definition {
    /// The two sides in the standard numbering.
    pub(super) fn sides(&self) -> Sides {
        let bits = self.lid.iter().filter_map(|corners| face_of(self.faces, corners)).map(|face| 1 << face);
        Sides { faces: self.faces, lid: bits.sum() }
    }

    /// Each inner corner, and the face of the other side in which it lies.
    pub(super) fn inside(&self) -> Vec<(u8, u8)> {
        let sides = self.sides();
        let named = |corner: u8| self.inside.iter().find(|(inner, _)| *inner == corner).map(|(_, face)| *face);
        let face = |corner: u8, of_lid: bool| match named(corner) {
            Some(corners) => face_of(self.faces, corners),
            None => sides.faces_of(!of_lid).next(),
        };
        let place = |corner| sides.inner(corner).and_then(|of_lid| Some((corner, face(corner, of_lid)?)));
        (0..sides.corners()).filter_map(place).collect()
    }

    /// The lid, and where each inner corner lies, on a cell in another numbering.
    pub(super) fn renumbered(&self, to_cell: &Renumbering) -> (u8, Vec<(u8, u8)>) {
        let corner = |corner: u8| to_cell.corner_from_standard[usize::from(corner)];
        let face = |face: u8| to_cell.face_from_standard[usize::from(face)];
        let lid = self.sides().faces_of(true).map(|of_lid| 1 << face(of_lid)).sum();
        (lid, self.inside().into_iter().map(|(inner, lies_in)| (corner(inner), face(lies_in))).collect())
    }

    /// The case in full; `None` if no projection is like that.
    pub(super) fn case(&self, index: usize) -> Option<Case> {
        let (sides, inside) = (self.sides(), self.inside());
        let Overlay { crossings, triangles } = Overlay::new(sides, &inside)?;
        let face = |corner| inside.iter().find(|(inner, _)| *inner == corner).map(|&(_, face)| face);
        let inner = |corner| Some(Inner { of_lid: sides.inner(corner)?, face: face(corner)? });
        Some(Case { name: self.name, index, inner: (0..sides.corners()).map(inner).collect(), crossings, triangles })
    }
}
