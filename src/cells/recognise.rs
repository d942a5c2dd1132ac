//! Recognises the kind of a cell that is given by its faces.

use arrayvec::ArrayVec;

use super::{CellKind, HEXAHEDRON, PYRAMID, TETRAHEDRON, WEDGE};

/// The kind whose faces `faces` are, and the cell's corners in its order; nothing where there is no such kind.
///
/// Faces run counterclockwise seen from outside, from any corner on, and come in any order. Only kinds with up to eight corners are
/// looked for.
///
/// ```
/// # use cellfan::cells::{WEDGE, recognise};
/// let faces: [&[u32]; 5] = [&[7, 8, 9], &[3, 5, 4], &[8, 7, 3, 4], &[4, 5, 9, 8], &[9, 5, 3, 7]];
/// let (kind, corners) = recognise(&faces.into_iter()).unwrap();
/// assert_eq!((kind, &corners[..]), (&WEDGE, &[7, 8, 9, 3, 4, 5][..]));
/// assert!(recognise(&faces.into_iter().skip(1)).is_none());
/// ```
pub fn recognise<'a>(
    faces: &(impl ExactSizeIterator<Item = &'a [u32]> + Clone),
) -> Option<(&'static CellKind, ArrayVec<u32, 8>)> {
    let with = |corners: usize| faces.clone().filter(move |face| face.len() == corners).count();
    let kind = match (faces.len(), with(3), with(4)) {
        (4, 4, 0) => &TETRAHEDRON,
        (5, 4, 1) => &PYRAMID,
        (5, 2, 3) => &WEDGE,
        (6, 0, 6) => &HEXAHEDRON,
        _ => return None,
    };
    // The first corners of a kind are around one of its faces: a wedge's seen from outside, the others' from inside.
    let around = faces.clone().find(|face| face.len() == if kind == &WEDGE || kind == &TETRAHEDRON { 3 } else { 4 })?;
    let mut corners: ArrayVec<u32, 8> = around.iter().copied().collect();
    if kind != &WEDGE {
        corners.reverse();
    }
    let above = |corner: u32| {
        let next = |face: &[u32]| {
            let at = face.iter().position(|&other| other == corner)?;
            let beside = [face[(at + 1) % face.len()], face[(at + face.len() - 1) % face.len()]];
            beside.into_iter().find(|other| !around.contains(other))
        };
        faces.clone().find_map(next)
    };
    for i in 0..around.len() {
        let corner = above(corners[i])?;
        if corners.len() < kind.corners {
            corners.push(corner);
        }
    }
    let is_face = |face: &&[u8]| {
        let of = |i: usize| corners[usize::from(face[i % face.len()])];
        let is_turned = |other: &[u32]| {
            let turn = (0..face.len()).find(|&turn| of(turn) == other[0]);
            other.len() == face.len() && turn.is_some_and(|turn| (0..face.len()).all(|i| of(turn + i) == other[i]))
        };
        faces.clone().any(is_turned)
    };
    (corners.len() == kind.corners && kind.faces.iter().all(is_face)).then_some((kind, corners))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_found_however_its_faces_are_listed() {
        for kind in [&TETRAHEDRON, &PYRAMID, &WEDGE, &HEXAHEDRON] {
            for turn in 0..24_usize {
                let mut faces: Vec<Vec<u32>> =
                    kind.faces.iter().map(|face| face.iter().map(|&i| 10 + u32::from(i)).collect()).collect();
                faces.rotate_left(turn % kind.faces.len());
                for (k, face) in faces.iter_mut().enumerate() {
                    let by = (turn + k) % face.len();
                    face.rotate_left(by);
                }
                let (found, corners) = recognise(&faces.iter().map(Vec::as_slice)).unwrap();
                assert_eq!(found, kind);
                let mut sorted = corners.clone();
                sorted.sort_unstable();
                assert_eq!(sorted.as_slice(), &(10..10 + kind.corners as u32).collect::<Vec<_>>()[..]);
                // Seen from inside it is no such cell.
                for face in &mut faces {
                    face.reverse();
                }
                let mirrored = recognise(&faces.iter().map(Vec::as_slice));
                assert!(mirrored.is_none_or(|(_, corners)| corners != sorted), "{}", kind.name);
                faces[0][0] = 99;
                assert!(recognise(&faces.iter().map(Vec::as_slice)).is_none());
            }
        }
    }
}
