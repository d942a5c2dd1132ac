//! The hexahedron: 0, 1, 2, 3 around the bottom, counterclockwise seen from above, 4, 5, 6, 7 above them.

use super::CellKind;

/// VTK code 12.
pub static HEXAHEDRON: CellKind = CellKind {
    name: "hexahedron",
    code: 12,
    corners: 8,
    faces: &[&[0, 4, 7, 3], &[1, 2, 6, 5], &[0, 1, 5, 4], &[3, 7, 6, 2], &[0, 3, 2, 1], &[4, 5, 6, 7]],
};
