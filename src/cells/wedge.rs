//! The wedge: triangle 0, 1, 2, counterclockwise seen from outside, and 3, 4, 5 opposite.
//!
//! VTK's documentation and table of faces say so; Exodus files and VTK's parametric coordinates run the other way.

use super::CellKind;

/// VTK code 13.
pub static WEDGE: CellKind = CellKind {
    name: "wedge",
    code: 13,
    corners: 6,
    faces: &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]],
};
