//! The tetrahedron: corner 3 lies on the side of 0, 1, 2 from which they run counterclockwise.

use super::CellKind;

/// VTK code 10.
pub static TETRAHEDRON: CellKind =
    CellKind { name: "tetrahedron", code: 10, corners: 4, faces: &[&[0, 1, 3], &[1, 2, 3], &[2, 0, 3], &[0, 2, 1]] };
