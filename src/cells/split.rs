//! Splits a cell into tetrahedra that agree with its neighbours'.
//!
//! Every face is cut by itself: from its vertex of lowest index, which both cells at the face know. The cell's own
//! lowest vertex is the lowest in every face that it touches, so a fan of tetrahedra from there to the triangles of the
//! other faces has just those cuts on all faces. (Dompierre, Labbé, Vallet and Camarero, "How to subdivide pyramids,
//! prisms and hexahedra into tetrahedra", 1999; they tabulate the cases, here the rule itself is run.)

use super::CellKind;

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
pub fn split(kind: &CellKind, corners: &[u32], canonical: impl Fn(u32) -> u32, mut out: impl FnMut([u32; 4])) {
    let corners = &corners[..kind.corners];
    let lowest = |of: &mut dyn Iterator<Item = u32>| of.min_by_key(|&point| canonical(point));
    let Some(apex) = lowest(&mut corners.iter().copied()) else { return };
    for face in kind.faces {
        let corner = |i: usize| corners[usize::from(face[i % face.len()])];
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
