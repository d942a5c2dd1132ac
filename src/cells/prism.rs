//! Prisms over a pentagon and a hexagon: the base counterclockwise seen from the top, then the corners above it.

use super::CellKind;

/// VTK code 15.
pub static PENTAGONAL_PRISM: CellKind = CellKind {
    name: "pentagonal prism",
    code: 15,
    corners: 10,
    faces: &[
        &[0, 4, 3, 2, 1],
        &[5, 6, 7, 8, 9],
        &[0, 1, 6, 5],
        &[1, 2, 7, 6],
        &[2, 3, 8, 7],
        &[3, 4, 9, 8],
        &[4, 0, 5, 9],
    ],
};

/// VTK code 16.
pub static HEXAGONAL_PRISM: CellKind = CellKind {
    name: "hexagonal prism",
    code: 16,
    corners: 12,
    faces: &[
        &[0, 5, 4, 3, 2, 1],
        &[6, 7, 8, 9, 10, 11],
        &[0, 1, 7, 6],
        &[1, 2, 8, 7],
        &[2, 3, 9, 8],
        &[3, 4, 10, 9],
        &[4, 5, 11, 10],
        &[5, 0, 6, 11],
    ],
};
