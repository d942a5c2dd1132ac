//! Cells: the kinds of cells, their faces, and how they are cut into tetrahedra.
//!
//! In: a VTK cell code and the corners of a cell. Out: its [`CellKind`] and, through [`split`], tetrahedra that agree
//! with those of every neighbour.
//! To add a kind: a file with its table of faces, its line in [`KINDS`] and, for its higher-order relatives, their
//! lines in `codes.rs`.

mod codes;
mod diagonals;
mod hexahedron;
mod prism;
mod pyramid;
mod recognise;
mod split;
mod tetrahedron;
mod triangles;
mod voxel;
mod wedge;

pub use codes::{CellClass, Nodes, classify};
pub use diagonals::diagonals;
pub use hexahedron::HEXAHEDRON;
pub use prism::{HEXAGONAL_PRISM, PENTAGONAL_PRISM};
pub use pyramid::PYRAMID;
pub use recognise::recognise;
pub use split::{split, split_faces};
pub use tetrahedron::{OPPOSITE_FACES, OUTWARD_IF_POSITIVE, TETRAHEDRON};
pub use triangles::{face_triangles, hexahedron_of, kind_of_hexahedron};
pub use voxel::VOXEL;
pub use wedge::WEDGE;

/// A kind of cell that has a volume, in VTK's numbering of corners.
///
/// ```
/// # use cellfan::cells::HEXAHEDRON;
/// assert_eq!((HEXAHEDRON.code, HEXAHEDRON.corners, HEXAHEDRON.faces.len()), (12, 8, 6));
/// ```
#[derive(Debug, PartialEq, Eq)]
pub struct CellKind {
    /// What it is called in messages.
    pub name: &'static str,
    /// Its code in VTK files.
    pub code: u8,
    /// How many corners it has.
    pub corners: usize,
    /// The corners of each face in VTK's order of faces, counterclockwise seen from outside.
    pub faces: &'static [&'static [u8]],
}

/// The kinds that are drawn, by ascending code; polyhedra, which have no table, aside.
pub static KINDS: [&CellKind; 7] =
    [&TETRAHEDRON, &VOXEL, &HEXAHEDRON, &WEDGE, &PYRAMID, &PENTAGONAL_PRISM, &HEXAGONAL_PRISM];

#[cfg(test)]
mod tests;
