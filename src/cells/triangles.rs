//! The triangles of a hexahedron: each face of four corners is two, cut along one of its diagonals.
//!
//! Wedges, pyramids and collapsed cells are hexahedra some of whose corners coincide ([`hexahedron_of`]): the triangles that
//! repeat a corner have no area, the others are just those of their faces. So one kind stands for all.

use super::{CellKind, HEXAHEDRON, PYRAMID, VOXEL, WEDGE};

/// The ends of a face's diagonal: from its first corner to the third, or from the second to the fourth.
const DIAGONALS: [[usize; 2]; 2] = [[0, 2], [1, 3]];

/// The corners of both triangles of face `face` of a hexahedron, cut as its bit of [`diagonals`](super::diagonals) says, counterclockwise seen from outside. The first two are the
/// ends of the diagonal, in either order, the third is the triangle's own.
pub const fn face_triangles(face: usize, diagonal: usize) -> [[u8; 3]; 2] {
    let corners = HEXAHEDRON.faces[face];
    let [i, k] = DIAGONALS[diagonal];
    let (p, q) = (corners[i], corners[k]);
    // Along p → q the corner after q lies to the left, so p q and that corner run counterclockwise; q p and the other do.
    [[p, q, corners[(k + 1) % 4]], [q, p, corners[(i + 1) % 4]]]
}

/// The cell that a hexahedron is which repeats corners as [`hexahedron_of`] makes it: wedge, pyramid, else hexahedron.
///
/// ```
/// # use cellfan::cells::{WEDGE, kind_of_hexahedron};
/// assert_eq!(kind_of_hexahedron(&[7, 8, 9, 9, 4, 5, 6, 6]), &WEDGE);
/// ```
pub fn kind_of_hexahedron(corners: &[u32; 8]) -> &'static CellKind {
    let repeats = |kind: &CellKind| {
        let places = hexahedron_of(kind).unwrap_or_default();
        (0..8).all(|i| (0..i).all(|j| (corners[i] == corners[j]) == (places[i] == places[j])))
    };
    [&WEDGE, &PYRAMID].into_iter().find(|kind| repeats(kind)).map_or(&HEXAHEDRON, |kind| kind)
}

/// The corners of the hexahedron that a cell of `kind` is, as numbers of its own corners.
///
/// ```
/// # use cellfan::cells::{WEDGE, hexahedron_of};
/// // Counterclockwise from below is clockwise from above.
/// assert_eq!(hexahedron_of(&WEDGE), Some([0, 2, 1, 1, 3, 5, 4, 4]));
/// ```
pub fn hexahedron_of(kind: &CellKind) -> Option<[usize; 8]> {
    [
        (&HEXAHEDRON, [0, 1, 2, 3, 4, 5, 6, 7]),
        (&VOXEL, [0, 1, 3, 2, 4, 5, 7, 6]),
        (&WEDGE, [0, 2, 1, 1, 3, 5, 4, 4]),
        (&PYRAMID, [0, 1, 2, 3, 4, 4, 4, 4]),
    ]
    .into_iter()
    .find_map(|(of, corners)| (of == kind).then_some(corners))
}
