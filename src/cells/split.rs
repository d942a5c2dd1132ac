//! Splits a cell into tetrahedra that agree with its neighbours'.
//!
//! Every face is cut by itself: from its vertex of lowest index, which both cells at the face know. The cell's own
//! lowest vertex is the lowest in every face that it touches, so a fan of tetrahedra from there to the triangles of the
//! other faces has just those cuts on all faces. (Dompierre, Labbé, Vallet and Camarero, "How to subdivide pyramids,
//! prisms and hexahedra into tetrahedra", 1999; they tabulate the cases, here the rule itself is run.)

use arrayvec::ArrayVec;

use super::{CellKind, HEXAGONAL_PRISM};

/// Hands the tetrahedra of a cell to `out`, positively oriented where the cell is.
///
/// `corners` are the file's points of the cell; `canonical` gives the number by which a point is compared (the same for
/// coincident points). A tetrahedron that repeats a canonical point has no volume and is dropped.
///
/// # Panics
/// If there are fewer corners than `kind` has.
///
/// ```
/// # use cellfan::cells::{PYRAMID, split};
/// let mut tets = Vec::new();
/// split(&PYRAMID, &[5, 6, 7, 8, 9], |point| point, |tet| tets.push(tet));
/// assert_eq!(tets, [[5, 6, 7, 9], [5, 7, 8, 9]]);
/// ```
pub fn split(kind: &CellKind, corners: &[u32], canonical: impl Fn(u32) -> u32, out: impl FnMut([u32; 4])) {
    let corners = &corners[..kind.corners];
    let faces = kind.faces.iter().map(|face| -> ArrayVec<u32, MOST_CORNERS> {
        face.iter().map(|&corner| corners[usize::from(corner)]).collect()
    });
    split_faces(faces, canonical, out);
}

/// Corners of a face of any kind.
const MOST_CORNERS: usize = HEXAGONAL_PRISM.faces[0].len();

/// The same for a cell with these faces, each counterclockwise seen from outside: right for convex cells, and for all that a
/// fan from their lowest point fills.
pub fn split_faces<F: AsRef<[u32]>>(
    faces: impl Iterator<Item = F> + Clone,
    canonical: impl Fn(u32) -> u32,
    mut out: impl FnMut([u32; 4]),
) {
    let lowest = |of: F| of.as_ref().iter().copied().min_by_key(|&point| canonical(point));
    let Some(apex) = faces.clone().filter_map(lowest).min_by_key(|&point| canonical(point)) else { return };
    for face in faces {
        let face = face.as_ref();
        let corner = |i: usize| face[i % face.len()];
        if (0..face.len()).any(|i| canonical(corner(i)) == canonical(apex)) {
            continue;
        }
        let Some(first) = (0..face.len()).min_by_key(|&i| canonical(corner(i))) else { continue };
        for i in 1..face.len() - 1 {
            let tet = [apex, corner(first), corner(first + i), corner(first + i + 1)];
            let [_, a, b, c] = tet.map(&canonical);
            if a != b && b != c && c != a {
                out(tet);
            }
        }
    }
}
