//! `classify` of cubes: which of its faces the eye sees, and how its corners map to those of a standard cube.
//!
//! In: how far the eye is beyond each face ([`GridEye::beyond_faces`](crate::columns::GridEye::beyond_faces)). Out: a class, a rotation
//! to the class's standard view, the topological case. The three largest numbers tell all; table look-ups, no branch on corners.
//!
//! Corner i has x = bit 0, y = bit 1, z = bit 2 of i; faces 0 to 5 are x−, x+, y−, y+, z−, z+. In the standard views of classes 1, 2 and
//! 3a the face that is seen best is 5, and then 0, and then 3; in that of 3b it is 0, and then 5, and then 3. All tables follow from the
//! 24 rotations of the cube.
//!
//! Source: Schussman and Max 2001, sections 3 to 5.

/// By how many of its faces the eye sees a cube, and in 3a and 3b which way round it sees them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CubeClass {
    /// One face.
    One,
    /// Two faces.
    Two,
    /// Three faces, counterclockwise from the one that is seen best.
    ThreeA,
    /// Three faces, clockwise.
    ThreeB,
}

impl CubeClass {
    /// All classes.
    pub const ALL: [Self; 4] = [Self::One, Self::Two, Self::ThreeA, Self::ThreeB];

    /// Its name in STATS.json.
    pub fn name(self) -> &'static str {
        ["cube_1", "cube_2", "cube_3a", "cube_3b"][self as usize]
    }

    /// Triangles of its two fans.
    pub const fn triangles(self) -> usize {
        if matches!(self, Self::One) { 10 } else { 12 }
    }
}

/// The topologically distinct projections of a cube (the paper's figures 1 and 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the paper's names")]
pub enum TopologicalCase {
    Case10,
    Case11,
    Case12,
    Case20a,
    Case20b,
    Case21a,
    Case21b,
    Case30a,
    Case30b,
    Case30c,
}

impl TopologicalCase {
    /// All cases.
    pub const ALL: [Self; 10] = [
        Self::Case10,
        Self::Case11,
        Self::Case12,
        Self::Case20a,
        Self::Case20b,
        Self::Case21a,
        Self::Case21b,
        Self::Case30a,
        Self::Case30b,
        Self::Case30c,
    ];

    /// The case of the three largest numbers, descending; the first is positive.
    fn of([first, second, third]: [f64; 3]) -> Self {
        match (second > 0.0, third > 0.0) {
            (false, _) if second < 0.0 => Self::Case10,
            (false, _) if third < 0.0 => Self::Case11,
            (false, _) => Self::Case12,
            (true, false) if third < 0.0 => {
                if first > second {
                    Self::Case20a
                } else {
                    Self::Case20b
                }
            }
            (true, false) => {
                if first > second {
                    Self::Case21a
                } else {
                    Self::Case21b
                }
            }
            (true, true) if first > second => Self::Case30a,
            (true, true) if second > third => Self::Case30b,
            (true, true) => Self::Case30c,
        }
    }
}

/// How a cube is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassifiedCube {
    /// Its class.
    pub class: CubeClass,
    /// Its case.
    pub case: TopologicalCase,
    /// The face that is seen best.
    pub face: u8,
    /// The cube's corner at the place of each corner of the class's standard view.
    pub corner_from_standard: &'static [u8; 8],
}

/// A rotation of the cube: where corners and faces go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Rotation {
    corners: [u8; 8],
    faces: [u8; 6],
}

impl Rotation {
    /// Axis a goes to axis `axes[a]`, its ends exchanged where bit a of `flips` is set.
    const fn new(axes: [usize; 3], flips: usize) -> Self {
        let mut rotation = Self { corners: [0; 8], faces: [0; 6] };
        let mut axis = 0;
        while axis < 3 {
            let flip = flips >> axis & 1;
            let mut side = 0;
            while side < 2 {
                rotation.faces[2 * axis + side] = (2 * axes[axis] + (side ^ flip)) as u8;
                side += 1;
            }
            let mut corner = 0;
            while corner < 8 {
                rotation.corners[corner] |= (((corner >> axis & 1) ^ flip) << axes[axis]) as u8;
                corner += 1;
            }
            axis += 1;
        }
        rotation
    }

    /// How many faces stay where they are: more, the less it turns.
    const fn faces_kept(&self) -> usize {
        let (mut kept, mut face) = (0, 0);
        while face < 6 {
            if self.faces[face] as usize == face {
                kept += 1;
            }
            face += 1;
        }
        kept
    }
}

/// The tables of all classes.
struct Tables {
    /// The rotation that brings face 5 to the first face and face 0 to the second (figure 8); the identity where there is none.
    by_faces: [[Rotation; 6]; 6],
    /// Of those that bring face 5 to this one, that which turns least; of two half turns that about x (figure 7).
    by_face: [Rotation; 6],
}

static TABLES: Tables = {
    const PERMUTATIONS: [([usize; 3], usize); 6] =
        [([0, 1, 2], 0), ([1, 2, 0], 0), ([2, 0, 1], 0), ([0, 2, 1], 1), ([2, 1, 0], 1), ([1, 0, 2], 1)];
    let identity = Rotation::new([0, 1, 2], 0);
    let mut tables = Tables { by_faces: [[identity; 6]; 6], by_face: [identity; 6] };
    let mut number = 0;
    while number < 6 * 8 {
        let ((axes, is_odd), flips) = (PERMUTATIONS[number / 8], number % 8);
        number += 1;
        // Odd permutations and flips are reflections; an even number of them is a rotation.
        if (is_odd + flips.count_ones() as usize).is_multiple_of(2) {
            let rotation = Rotation::new(axes, flips);
            tables.by_faces[rotation.faces[5] as usize][rotation.faces[0] as usize] = rotation;
        }
    }
    let mut first = 0;
    while first < 6 {
        let (mut second, mut most) = (0, 0);
        while second < 6 {
            let rotation = tables.by_faces[first][second];
            let kept = 1 + rotation.faces_kept();
            if first / 2 != second / 2 && kept > most {
                tables.by_face[first] = rotation;
                most = kept;
            }
            second += 1;
        }
        first += 1;
    }
    tables
};

/// Classifies a cube that the eye is so far beyond the faces of; `None` where it is beyond none: it is in the cube.
///
/// ```
/// use cellfan::stages::classify::cubes::{CubeClass, TopologicalCase, classify};
/// // The paper's example: face 3 towards the eye, whose corner 0 stands where the standard cube has corner 2.
/// let found = classify([-0.5, -0.5, -3.0, 2.0, -0.5, -0.5]).expect("the eye is outside");
/// assert_eq!((found.class, found.case, found.face), (CubeClass::One, TopologicalCase::Case10, 3));
/// assert_eq!([2, 3, 7, 6, 4, 0, 3].map(|i: usize| found.corner_from_standard[i]), [0, 1, 3, 2, 6, 4, 1]);
/// ```
#[inline]
pub fn classify(beyond: [f64; 6]) -> Option<ClassifiedCube> {
    // Of opposite faces one at most is seen: the larger number of each axis.
    let of_axis = |axis: usize| {
        let (below, above) = (beyond[2 * axis], beyond[2 * axis + 1]);
        if above > below { (above, 2 * axis as u8 + 1) } else { (below, 2 * axis as u8) }
    };
    let [mut first, mut second, mut third] = [of_axis(0), of_axis(1), of_axis(2)];
    if second.0 > first.0 {
        (first, second) = (second, first);
    }
    if third.0 > second.0 {
        (second, third) = (third, second);
    }
    if second.0 > first.0 {
        (first, second) = (second, first);
    }
    if first.0.is_nan() || first.0 <= 0.0 {
        return None;
    }
    let [f0, f1, f2] = [first.1, second.1, third.1].map(usize::from);
    let by_two = &TABLES.by_faces[f0][f1];
    let (class, rotation) = if second.0 <= 0.0 {
        (CubeClass::One, &TABLES.by_face[f0])
    } else if third.0 <= 0.0 {
        (CubeClass::Two, by_two)
    } else if usize::from(by_two.faces[3]) == f2 {
        (CubeClass::ThreeA, by_two)
    } else {
        (CubeClass::ThreeB, &TABLES.by_faces[f1][f0])
    };
    let case = TopologicalCase::of([first.0, second.0, third.0]);
    Some(ClassifiedCube { class, case, face: first.1, corner_from_standard: &rotation.corners })
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "zeros and largest values are exact")]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::columns::GridEye;
    use crate::stages::testing::Random;
    use glam::DVec3;

    /// Figure 7 as printed, by `f0`.
    const FIGURE_7: [[u8; 8]; 6] = [
        [1, 5, 3, 7, 0, 4, 2, 6],
        [4, 0, 6, 2, 5, 1, 7, 3],
        [2, 3, 6, 7, 0, 1, 4, 5],
        [4, 5, 0, 1, 6, 7, 2, 3],
        [6, 7, 4, 5, 2, 3, 0, 1],
        [0, 1, 2, 3, 4, 5, 6, 7],
    ];

    /// Figure 8 as printed, `f0`, `f1` and the row.
    const FIGURE_8: [([usize; 2], [u8; 8]); 24] = [
        ([0, 2], [5, 7, 1, 3, 4, 6, 0, 2]),
        ([0, 3], [3, 1, 7, 5, 2, 0, 6, 4]),
        ([0, 4], [1, 5, 3, 7, 0, 4, 2, 6]),
        ([0, 5], [7, 3, 5, 1, 6, 2, 4, 0]),
        ([1, 2], [0, 2, 4, 6, 1, 2, 5, 7]),
        ([1, 3], [6, 4, 2, 0, 7, 5, 3, 1]),
        ([1, 4], [2, 6, 0, 4, 3, 7, 1, 5]),
        ([1, 5], [4, 0, 6, 2, 5, 1, 7, 3]),
        ([2, 0], [2, 3, 6, 7, 0, 1, 4, 5]),
        ([2, 1], [7, 6, 3, 2, 5, 4, 1, 0]),
        ([2, 4], [3, 7, 2, 6, 1, 5, 0, 4]),
        ([2, 5], [6, 2, 7, 3, 4, 0, 5, 1]),
        ([3, 0], [4, 5, 0, 1, 6, 7, 2, 3]),
        ([3, 1], [1, 0, 5, 4, 3, 2, 7, 6]),
        ([3, 4], [0, 4, 1, 5, 2, 6, 3, 7]),
        ([3, 5], [5, 1, 4, 0, 7, 3, 6, 2]),
        ([4, 0], [6, 7, 4, 5, 2, 3, 0, 1]),
        ([4, 1], [5, 4, 7, 6, 1, 0, 3, 2]),
        ([4, 2], [4, 6, 5, 7, 0, 2, 1, 3]),
        ([4, 3], [7, 5, 6, 4, 3, 1, 2, 0]),
        ([5, 0], [0, 1, 2, 3, 4, 5, 6, 7]),
        ([5, 1], [3, 2, 1, 0, 7, 6, 5, 4]),
        ([5, 2], [1, 3, 0, 2, 5, 7, 4, 6]),
        ([5, 3], [2, 0, 3, 1, 6, 4, 7, 5]),
    ];

    /// The triples of class 3a as printed.
    const CLASS_3A: [usize; 24] = [
        24, 52, 43, 35, 142, 153, 134, 125, 240, 214, 205, 251, 350, 315, 341, 304, 413, 430, 421, 402, 503, 512, 520,
        531,
    ];

    #[test]
    fn figure_7_is_made_of_rotations() {
        for (face, printed) in FIGURE_7.into_iter().enumerate() {
            assert_eq!(TABLES.by_face[face].corners, printed, "f0 = {face}");
        }
    }

    #[test]
    fn figure_8_is_made_of_rotations_but_for_one_row() {
        let differing: Vec<_> = FIGURE_8
            .into_iter()
            .map(|([f0, f1], printed)| ([f0, f1], printed, TABLES.by_faces[f0][f1].corners))
            .filter(|(_, printed, rotation)| printed != rotation)
            .collect();
        // It repeats corner 2 where corner 3 belongs.
        assert_eq!(differing, [([1, 2], [0, 2, 4, 6, 1, 2, 5, 7], [0, 2, 4, 6, 1, 3, 5, 7])]);
    }

    #[test]
    fn the_list_of_class_3a_is_that_of_the_rotations() {
        let is_right_handed = |f0: usize, f1: usize, f2: usize| usize::from(TABLES.by_faces[f0][f1].faces[3]) == f2;
        for (f0, f1, f2) in (0..216).map(|i| (i / 36, i / 6 % 6, i % 6)) {
            if f0 / 2 != f1 / 2 && f1 / 2 != f2 / 2 && f0 / 2 != f2 / 2 {
                assert_eq!(CLASS_3A.contains(&(100 * f0 + 10 * f1 + f2)), is_right_handed(f0, f1, f2), "{f0}{f1}{f2}");
            }
        }
    }

    #[test]
    fn all_ten_cases_are_found_and_counted() {
        // Eyes on a lattice around the cube from 0 to 1, on the planes of its faces and symmetric ones among them, and random ones.
        let places = [-2.0, -1.0, -0.5, 0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0];
        let lattice = (0..1000).map(|i| DVec3::new(places[i % 10], places[i / 10 % 10], places[i / 100]));
        let mut random = Random::new(3);
        let random = (0..1000).map(|_| random.point() * 4.0);
        let unit = [DVec3::ZERO, DVec3::ONE];
        let (mut counts, mut inside) = (HashMap::new(), 0);
        for eye in lattice.chain(random) {
            let beyond = GridEye::At(eye).beyond_faces(unit);
            let seen = beyond.iter().filter(|&&beyond| beyond > 0.0).count();
            let Some(found) = classify(beyond) else {
                assert_eq!(seen, 0);
                inside += 1;
                continue;
            };
            assert_eq!(seen, [1, 2, 3, 3][found.class as usize]);
            let positive = beyond.iter().copied().filter(|&beyond| beyond > 0.0).collect::<Vec<_>>();
            assert_eq!(beyond[usize::from(found.face)], positive.iter().copied().fold(0.0, f64::max));
            // The names: how many are positive, how many zero.
            let zero = beyond.iter().filter(|&&beyond| beyond == 0.0).count();
            let name = format!("{:?}", found.case);
            assert_eq!(name[4..6], format!("{seen}{zero}"), "{eye}");
            *counts.entry(found.case).or_insert(0) += 1;
        }
        assert_eq!(counts.len(), 10, "{counts:?}");
        println!("{inside} eyes inside, {counts:?}");
        // Of random eyes none is degenerate.
        assert!(TopologicalCase::ALL.iter().all(|case| counts[case] > 0) && inside > 0);
        let degenerate: i32 = counts
            .iter()
            .filter(|(case, _)| {
                !matches!(case, TopologicalCase::Case10 | TopologicalCase::Case20a | TopologicalCase::Case30a)
            })
            .map(|(_, count)| count)
            .sum();
        assert!(degenerate < 1000);
    }

    #[test]
    fn the_eye_that_cannot_be_placed_is_in_no_class() {
        assert_eq!(classify([f64::NAN; 6]), None);
        assert_eq!(classify([-0.5; 6]), None);
        assert_eq!(classify([0.0, -1.0, -0.5, -0.5, -0.5, -0.5]), None);
    }
}
