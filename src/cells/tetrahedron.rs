//! The tetrahedron: corner 3 lies on the side of 0, 1, 2 from which they run counterclockwise.

use super::CellKind;

/// VTK code 10.
pub static TETRAHEDRON: CellKind =
    CellKind { name: "tetrahedron", code: 10, corners: 4, faces: &[&[0, 1, 3], &[1, 2, 3], &[2, 0, 3], &[0, 2, 1]] };

/// The corners of the face opposite to each corner, ascending: where those of cells ascend, neighbours name a shared face alike.
pub const OPPOSITE_FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];

/// Whether the normal (b−a)×(c−a) of the face a, b, c of [`OPPOSITE_FACES`] points outwards, for a cell with
/// (b−a)×(c−a)·(d−a) > 0; of other cells the opposite is true.
pub const OUTWARD_IF_POSITIVE: [bool; 4] = [true, false, true, false];
