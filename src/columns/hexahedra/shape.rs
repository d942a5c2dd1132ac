//! What no view changes of a hexahedron: how its faces are cut, which of them fold inwards, whether planes alone bound it.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use crate::cells::{HEXAHEDRON, diagonals, face_triangles};
use crate::columns::orientation_of;

/// Six diagonals, six folds, and what else is known, a bit each.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct HexShape(u16);

const FOLDS: u32 = 6;
const CONVEX: u16 = 1 << 12;
const MIRRORED: u16 = 1 << 13;
const ABSENT: u16 = 1 << 14;

/// A corner may lie outside a face by this share of the cell's size and still count as inside: the rounding of single precision.
const OUTSIDE: f64 = 1e-6;

/// A cell with less than this share of its size cubed has no volume: single precision does not resolve it.
const FLAT: f64 = 1e-14;

/// The triangles of each face, cut one way and the other.
static TRIANGLES: [[[[u8; 3]; 2]; 2]; 6] = {
    let mut triangles = [[[[0; 3]; 2]; 2]; 6];
    let mut face = 0;
    while face < 6 {
        triangles[face] = [face_triangles(face, 0), face_triangles(face, 1)];
        face += 1;
    }
    triangles
};

impl HexShape {
    /// A cell that is not drawn: hidden, or without volume.
    pub const ABSENT: Self = Self(ABSENT);

    /// The shape of the cell with corners at `p`; its corners are compared by `index`, where coincident points share a number.
    pub fn new(p: [Vec3; 8], index: [u32; 8]) -> Self {
        let diagonals = diagonals_of(index);
        let (volume, size) = volume_and_size(p, diagonals);
        if volume.abs() <= FLAT * size.powi(3) {
            return Self::ABSENT;
        }
        if volume > 0.0 {
            return Self::of_positive(p, index, size);
        }
        Self(Self::of_positive(Self::mirrored(p), Self::mirrored(index), size).0 | MIRRORED)
    }

    fn of_positive(p: [Vec3; 8], index: [u32; 8], size: f64) -> Self {
        Self::cut_along(diagonals_of(index), p, size)
    }

    /// The shape of a cell of positive volume, its faces cut as `diagonals` says.
    fn cut_along(diagonals: u16, p: [Vec3; 8], size: f64) -> Self {
        let mut shape = Self(diagonals);
        for face in 0..6 {
            let [[a, b, c], [.., d]] = shape.triangles(face).map(|triangle| triangle.map(|i| p[usize::from(i)]));
            // Outwards is where (b−a)×(c−a) points: a fourth corner on that side folds the face inwards.
            shape.0 |= u16::from(orientation_of([a, b, c, d]) > 0) << (FOLDS + face as u32);
        }
        if shape.holds_all_corners(p, OUTSIDE * size) { Self(shape.0 | CONVEX) } else { shape }
    }

    /// Whether [`HexShape::new`] could give it to the cell with corners at `p`, turned if it says so: everything but the choice of
    /// the diagonals follows from the corners.
    pub(crate) fn fits(self, p: [Vec3; 8]) -> bool {
        if self.is_absent() {
            return self == Self::ABSENT;
        }
        let diagonals = self.0 & ((1 << FOLDS) - 1);
        let as_listed = if self.is_mirrored() { Self::mirrored(p) } else { p };
        let (volume, _) = volume_and_size(p, diagonals);
        let expected = Self::cut_along(diagonals, p, size_of(as_listed.map(Vec3::as_dvec3)));
        volume > 0.0 && self.0 == expected.0 | (self.0 & MIRRORED)
    }

    /// Whether each corner lies inside the planes of all triangles, but for the two at the ends of an inward fold, which lie
    /// outside each other's.
    fn holds_all_corners(self, p: [Vec3; 8], slack: f64) -> bool {
        (0..6).all(|face| {
            let of_face = HEXAHEDRON.faces[face];
            self.triangles(face).into_iter().all(|triangle| {
                let [a, b, c] = triangle.map(|i| p[usize::from(i)].as_dvec3());
                let n = (b - a).cross(c - a).normalize_or_zero();
                let is_inside = |i: usize| n.dot(p[i].as_dvec3() - a) <= slack;
                (0..8).all(|i| (self.is_concave(face) && of_face.contains(&(i as u8))) || is_inside(i))
            })
        })
    }

    /// Along which diagonal each face is cut: see [`diagonals`].
    #[inline]
    pub fn diagonals(self) -> u8 {
        (self.0 & ((1 << FOLDS) - 1)) as u8
    }

    /// The triangles of face `face`: see [`face_triangles`].
    #[inline]
    pub fn triangles(self, face: usize) -> [[u8; 3]; 2] {
        TRIANGLES[face][usize::from(self.0 >> face & 1)]
    }

    /// The volume of the cell with corners at `p`; 0 where it is not drawn.
    pub fn volume(self, p: [Vec3; 8]) -> f64 {
        if self.is_absent() { 0.0 } else { volume_and_size(p, self.0).0 }
    }

    /// Whether the triangles of face `face` fold inwards.
    #[inline]
    pub fn is_concave(self, face: usize) -> bool {
        self.0 >> (FOLDS + face as u32) & 1 == 1
    }

    /// Whether planes alone bound the cell: every corner lies inside all faces.
    #[inline]
    pub fn is_convex(self) -> bool {
        self.0 & CONVEX != 0
    }

    /// Whether the file's corners run the other way round.
    #[inline]
    pub fn is_mirrored(self) -> bool {
        self.0 & MIRRORED != 0
    }

    /// Whether the cell is not drawn.
    #[inline]
    pub fn is_absent(self) -> bool {
        self.0 & ABSENT != 0
    }

    /// The same cell seen in a mirror: bottom and top change places.
    #[inline]
    pub fn mirrored<T: Copy>([a, b, c, d, e, f, g, h]: [T; 8]) -> [T; 8] {
        [e, f, g, h, a, b, c, d]
    }
}

/// Along which diagonal each face is cut.
fn diagonals_of(index: [u32; 8]) -> u16 {
    u16::from(diagonals(&HEXAHEDRON, &index, |index| index))
}

/// Signed volume between the triangles, and the largest distance of a corner from the first.
fn volume_and_size(p: [Vec3; 8], diagonals: u16) -> (f64, f64) {
    let p = p.map(Vec3::as_dvec3);
    let q = p.map(|corner| corner - p[0]);
    let of_triangle = |triangle: [u8; 3]| {
        let [a, b, c]: [DVec3; 3] = triangle.map(|i| q[usize::from(i)]);
        a.dot(b.cross(c))
    };
    let of_face = |face: usize| HexShape(diagonals).triangles(face).map(of_triangle).iter().sum::<f64>();
    ((0..6).map(of_face).sum::<f64>() / 6.0, size_of(p))
}

/// The largest distance of a corner from the first.
fn size_of(p: [DVec3; 8]) -> f64 {
    p.iter().fold(0.0, |size: f64, corner| size.max((*corner - p[0]).length()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> [Vec3; 8] {
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
            .map(|p: [u8; 3]| Vec3::from_array(p.map(f32::from)))
    }

    const INDEX: [u32; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

    #[test]
    fn a_cube_is_convex_whichever_way_its_corners_run() {
        let shape = HexShape::new(cube(), INDEX);
        assert!(shape.is_convex() && !shape.is_mirrored() && !shape.is_absent());
        assert!((0..6).all(|face| !shape.is_concave(face)));
        let mirrored = HexShape::new(HexShape::mirrored(cube()), INDEX);
        assert!(mirrored.is_convex() && mirrored.is_mirrored());
        let flat = cube().map(|p| p * Vec3::new(1.0, 1.0, 0.0));
        assert!(HexShape::new(flat, INDEX).is_absent());
    }

    #[test]
    fn a_corner_pushed_in_folds_its_faces_inwards_or_outwards_as_the_diagonal_has_it() {
        // Corner 6 is an end of the diagonals of faces 1 (1-6) and 5 (4-6), and the tip of a triangle of face 3 (2-7).
        for (push, is_concave) in [(-0.1, true), (0.1, false)] {
            let mut p = cube();
            p[6] += Vec3::splat(push);
            let shape = HexShape::new(p, INDEX);
            let folds: Vec<bool> = (0..6).map(|face| shape.is_concave(face)).collect();
            assert_eq!(folds, [false, is_concave, false, !is_concave, false, is_concave]);
            assert!(shape.is_convex());
        }
        // Pushed through the opposite corner, nothing holds any more.
        let mut p = cube();
        p[6] = Vec3::splat(-0.5);
        assert!(!HexShape::new(p, INDEX).is_convex());
    }

    #[test]
    fn neighbours_cut_their_face_alike() {
        // Faces 1 (+x) of one cell and 0 (−x) of the next, corner by corner the same points.
        let (left, right) = ([10, 3, 7, 12, 11, 9, 2, 14], [3, 20, 21, 7, 9, 22, 23, 2]);
        let ends = |index: [u32; 8], face: usize| {
            let shape = HexShape(diagonals_of(index));
            let [[p, q, _], _] = shape.triangles(face);
            let mut ends = [p, q].map(|i| index[usize::from(i)]);
            ends.sort_unstable();
            ends
        };
        assert_eq!(ends(left, 1), ends(right, 0));
        assert!(ends(left, 1).contains(&2));
    }

    #[test]
    fn triangles_of_all_faces_close_the_cell() {
        for bits in 0..64 {
            let shape = HexShape(bits);
            let mut edges: Vec<[u8; 2]> = Vec::new();
            for face in 0..6 {
                for [a, b, c] in shape.triangles(face) {
                    edges.extend([[a, b], [b, c], [c, a]]);
                }
            }
            assert!(edges.iter().all(|&[a, b]| edges.contains(&[b, a])));
            assert!((volume_and_size(cube(), bits).0 - 1.0).abs() < 1e-12);
        }
    }
}
