//! The pyramid: 0, 1, 2, 3 around the base, counterclockwise seen from the tip, which is 4.

use super::CellKind;

/// VTK code 14.
pub static PYRAMID: CellKind = CellKind {
    name: "pyramid",
    code: 14,
    corners: 5,
    faces: &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
};
