//! The voxel: a box whose corner i has x = bit 0, y = bit 1, z = bit 2 of i.

use super::CellKind;

/// VTK code 11.
pub static VOXEL: CellKind = CellKind {
    name: "voxel",
    code: 11,
    corners: 8,
    faces: &[&[2, 0, 4, 6], &[1, 3, 7, 5], &[0, 1, 5, 4], &[3, 2, 6, 7], &[1, 0, 2, 3], &[4, 5, 7, 6]],
};
