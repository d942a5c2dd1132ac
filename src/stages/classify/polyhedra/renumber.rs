//! Renumberings: every way to lay one cell's corners on another's so that faces fall on faces, counterclockwise ones on
//! counterclockwise ones.
//!
//! Those of the hexahedron onto itself are the 24 rotations of the cube; wedges have 6, pyramids 4.

use super::Faces;

/// How a cell's corners and faces are found from those of a standard numbering; entries beyond the cell's corners and
/// faces are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Renumbering {
    /// The cell's corner for each standard corner.
    pub corner_from_standard: [u8; 8],
    /// The cell's face, in its kind's table, for each standard face.
    pub face_from_standard: [u8; 6],
}

/// All renumberings from `standard` to `cell`.
pub(super) fn renumberings(standard: Faces, cell: Faces) -> Vec<Renumbering> {
    let first = standard[0].len();
    let placed = (0..cell.len()).filter(|&image| cell[image].len() == first);
    placed.flat_map(|image| (0..first).filter_map(move |turn| spread(standard, cell, image, turn))).collect()
}

/// The renumbering that lays the first standard face on face `image`, its corner i on that face's corner i + `turn`.
fn spread(standard: Faces, cell: Faces, image: usize, turn: usize) -> Option<Renumbering> {
    let (mut corners, mut faces) = ([None; 8], [None; 6]);
    let mut open = vec![(0, image, turn)];
    while let Some((face, image, turn)) = open.pop() {
        let (here, there) = (standard[face], cell[image]);
        if here.len() != there.len() || faces[face].is_some_and(|known| known != image as u8) {
            return None;
        }
        if faces[face].replace(image as u8).is_some() {
            continue;
        }
        let n = here.len();
        for i in 0..n {
            let (from, to) = ([here[i], here[(i + 1) % n]], [there[(i + turn) % n], there[(i + 1 + turn) % n]]);
            if corners[usize::from(from[0])].replace(to[0]).is_some_and(|known| known != to[0]) {
                return None;
            }
            // The neighbour beyond the edge runs it the other way.
            let (neighbour, at) = locate(standard, [from[1], from[0]])?;
            let (neighbour_image, at_image) = locate(cell, [to[1], to[0]])?;
            let n = cell[neighbour_image].len();
            open.push((neighbour, neighbour_image, (at_image + n - at % n) % n));
        }
    }
    Some(Renumbering {
        corner_from_standard: corners.map(Option::unwrap_or_default),
        face_from_standard: faces.map(Option::unwrap_or_default),
    })
}

/// The face that runs from `a` to `b`, and the place of `a` in it.
fn locate(faces: Faces, [a, b]: [u8; 2]) -> Option<(usize, usize)> {
    let place = |face: &[u8]| (0..face.len()).find(|&i| face[i] == a && face[(i + 1) % face.len()] == b);
    faces.iter().enumerate().find_map(|(index, face)| place(face).map(|i| (index, i)))
}
