//! Diagonals: along which one each face of four corners is cut into two triangles.

use super::CellKind;

/// Bit f is set if face f is cut from its second to its fourth corner, clear if from its first to its third, as the kind's
/// table lists them: the diagonal that starts at the corner of lowest `canonical` number, which both cells at a face know.
///
/// # Panics
/// If there are fewer corners than `kind` has.
///
/// ```
/// # use cellfan::cells::{PYRAMID, diagonals};
/// // The base runs 0, 3, 2, 1.
/// assert_eq!(diagonals(&PYRAMID, &[5, 6, 7, 8, 9], |point| point), 0);
/// assert_eq!(diagonals(&PYRAMID, &[6, 5, 7, 8, 9], |point| point), 1);
/// ```
pub fn diagonals(kind: &CellKind, corners: &[u32], canonical: impl Fn(u32) -> u32) -> u8 {
    let corners = &corners[..kind.corners];
    let lowest = |face: &[u8]| (0..face.len()).min_by_key(|&i| canonical(corners[usize::from(face[i])]));
    let is_set = |face: &&[u8]| face.len() == 4 && lowest(face).is_some_and(|first| first % 2 == 1);
    (0..).zip(kind.faces).filter(|(_, face)| is_set(face)).map(|(bit, _)| 1 << bit).sum()
}
