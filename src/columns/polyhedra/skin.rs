//! The faces of one polyhedron put right: no corner twice in a row, all counterclockwise seen from outside, every edge twice.
//!
//! Faces are compared by canonical points, so that coincident ones are one; a face of fewer than three has no area and bounds
//! nothing. Files that do not say which way their faces run are turned: across an edge, from face to face.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

/// A polyhedron whose faces close it.
#[derive(Debug)]
pub(super) struct Skin {
    /// The points around each face, the lowest canonical one first, counterclockwise seen from outside.
    pub(super) faces: Vec<Vec<u32>>,
    /// Whether the file's faces ran the other way.
    pub(super) is_mirrored: bool,
}

/// A cell that has no inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flaw {
    /// No volume.
    Flat,
    /// An edge between two of its points is not in two faces.
    Open([u32; 2]),
}

/// A cell with less than this share of its size cubed has no volume, as in [`HexShape`](super::super::HexShape).
const FLAT: f64 = 1e-14;

impl Skin {
    /// Of the faces of a cell whose points are compared by `canonical` and stand at `position`.
    pub(super) fn new<'a>(
        faces: impl Iterator<Item = &'a [u32]>,
        canonical: impl Fn(u32) -> u32,
        position: impl Fn(u32) -> Vec3,
    ) -> Result<Self, Flaw> {
        let mut faces: Vec<Vec<u32>> =
            faces.map(|face| without_repeats(face, &canonical)).filter(|face| face.len() > 2).collect();
        if faces.is_empty() {
            return Err(Flaw::Flat);
        }
        if let Some(edge) = open_edge(&faces, &canonical) {
            orient(&mut faces, &canonical, edge)?;
        }
        for face in &mut faces {
            let lowest = (0..face.len()).min_by_key(|&i| canonical(face[i])).unwrap_or(0);
            face.rotate_left(lowest);
        }
        let (volume, size) = volume_and_size(&faces, position);
        if volume.abs() <= FLAT * size.powi(3) {
            return Err(Flaw::Flat);
        }
        let is_mirrored = volume < 0.0;
        if is_mirrored {
            for face in &mut faces {
                face[1..].reverse();
            }
        }
        Ok(Self { faces, is_mirrored })
    }
}

/// The points around a face, none of them where the one before it is.
fn without_repeats(face: &[u32], canonical: impl Fn(u32) -> u32) -> Vec<u32> {
    let is_repeat = |i: usize| canonical(face[i]) == canonical(face[(i + face.len() - 1) % face.len()]);
    (0..face.len()).filter(|&i| !is_repeat(i)).map(|i| face[i]).collect()
}

/// The edges of a face, one after the other.
fn edges(face: &[u32], canonical: impl Fn(u32) -> u32) -> impl Iterator<Item = [u32; 2]> {
    (0..face.len()).map(move |i| [face[i], face[(i + 1) % face.len()]].map(&canonical))
}

/// An edge that faces do not run along as often one way as the other.
fn open_edge(faces: &[Vec<u32>], canonical: impl Fn(u32) -> u32) -> Option<[u32; 2]> {
    let mut balance: HashMap<[u32; 2], i32> = HashMap::new();
    for [a, b] in faces.iter().flat_map(|face| edges(face, &canonical)) {
        *balance.entry([a.min(b), a.max(b)]).or_insert(0) += if a < b { 1 } else { -1 };
    }
    balance.into_iter().filter(|&(_, sum)| sum != 0).map(|(edge, _)| edge).min()
}

/// Turns faces until each edge is run along once each way.
fn orient(faces: &mut [Vec<u32>], canonical: impl Fn(u32) -> u32, open: [u32; 2]) -> Result<(), Flaw> {
    let mut faces_at: HashMap<[u32; 2], Vec<(usize, bool)>> = HashMap::new();
    for (number, face) in faces.iter().enumerate() {
        for [a, b] in edges(face, &canonical) {
            faces_at.entry([a.min(b), a.max(b)]).or_default().push((number, a < b));
        }
    }
    let more_or_fewer = faces_at.iter().filter(|(_, faces)| faces.len() != 2).map(|(&edge, _)| edge).min();
    if let Some(edge) = more_or_fewer {
        return Err(Flaw::Open(edge));
    }
    let mut is_turned: Vec<Option<bool>> = vec![None; faces.len()];
    for first in 0..faces.len() {
        if is_turned[first].is_some() {
            continue;
        }
        is_turned[first] = Some(false);
        let mut next = vec![first];
        while let Some(number) = next.pop() {
            let turned = is_turned[number].unwrap_or(false);
            for [a, b] in edges(&faces[number], &canonical) {
                let both = &faces_at[&[a.min(b), a.max(b)]];
                let (other, ascends) = if both[0].0 == number { both[1] } else { both[0] };
                // They must run opposite ways once both are turned as they are.
                let must = ((a < b) == ascends) != turned;
                match is_turned[other] {
                    None => {
                        is_turned[other] = Some(must);
                        next.push(other);
                    }
                    Some(known) if known != must => return Err(Flaw::Open(open)),
                    Some(_) => {}
                }
            }
        }
    }
    for (face, _) in faces.iter_mut().zip(is_turned).filter(|(_, turned)| *turned == Some(true)) {
        face.reverse();
    }
    Ok(())
}

/// Signed volume between the triangles of all faces, and the largest distance of a corner from the first.
fn volume_and_size(faces: &[Vec<u32>], position: impl Fn(u32) -> Vec3) -> (f64, f64) {
    let first = position(faces[0][0]).as_dvec3();
    let at = |point: u32| position(point).as_dvec3() - first;
    let (mut volume, mut size) = (0.0, 0.0_f64);
    for face in faces {
        let a = at(face[0]);
        let mut b = at(face[1]);
        size = size.max(a.length()).max(b.length());
        for &point in &face[2..] {
            let c: DVec3 = at(point);
            volume += a.dot(b.cross(c));
            size = size.max(c.length());
            b = c;
        }
    }
    (volume / 6.0, size)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Vec<Vec<u32>> {
        crate::cells::HEXAHEDRON.faces.iter().map(|face| face.iter().map(|&i| u32::from(i)).collect()).collect()
    }

    fn place(i: u32) -> Vec3 {
        let [x, y, z] = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
            [i as usize % 8]
            .map(|x: u8| f32::from(x));
        Vec3::new(x, y, z)
    }

    fn skin(faces: &[Vec<u32>]) -> Result<Skin, Flaw> {
        Skin::new(faces.iter().map(Vec::as_slice), |point| point % 8, place)
    }

    #[test]
    fn faces_that_run_any_way_are_turned_outwards() {
        let expected = skin(&cube()).unwrap();
        assert!(!expected.is_mirrored);
        for turned in 0..64_u32 {
            let mut faces = cube();
            for (face, _) in faces.iter_mut().zip(0..).filter(|&(_, k)| turned >> k & 1 == 1) {
                face.reverse();
            }
            assert_eq!(skin(&faces).unwrap().faces, expected.faces, "{turned:06b}");
        }
        assert!(expected.faces.iter().all(|face| face.iter().min() == face.first()));
    }

    #[test]
    fn coincident_and_missing_corners() {
        // Points 8 to 15 stand where 0 to 7 do; a face of two has no area.
        let mut faces = cube();
        faces[2] = vec![8, 1, 9, 13, 4];
        faces.push(vec![0, 8]);
        faces[2][3] = 5;
        let skin_of = skin(&faces).unwrap();
        assert_eq!(skin_of.faces.len(), 6);
        // Without its bottom it is open, at the bottom's lowest edge.
        faces.remove(4);
        assert_eq!(skin(&faces).unwrap_err(), Flaw::Open([0, 1]));
        let flat: Vec<Vec<u32>> = vec![vec![0, 1, 2, 3], vec![3, 2, 1, 0]];
        assert_eq!(skin(&flat).unwrap_err(), Flaw::Flat);
        assert_eq!(skin(&[]).unwrap_err(), Flaw::Flat);
    }
}
