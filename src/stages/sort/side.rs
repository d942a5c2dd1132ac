//! On which side of a face the eye lies: exact, and fast where it is plain.
//!
//! The sign of the determinant |b−a, c−a, a−e| (parallel rays: |b−a, c−a, d|). Its value in f64 decides where it exceeds what
//! rounding can do to it, else Shewchuk's predicate: both cells at a face get the same answer, in whatever order they name its vertices.

use glam::DVec3;

use super::Toward;
use crate::stages::classify::FACES;

/// What rounding does to a determinant of differences, relative to the product of its rows' 1-norms: (7 + 56ε)ε with ε = 2⁻⁵³
/// bounds it relative to the sum of its terms' sizes (Shewchuk 1997, `o3derrboundA`), which is no larger; then this product's own.
const ROUNDING: f64 = 8.0 * (0.5 * f64::EPSILON);

/// Positive where the eye lies on the side that (b−a)×(c−a) points to, 0 where the face is seen edge-on.
#[inline]
pub(super) fn side_of_eye([a, b, c]: [DVec3; 3], toward: Toward) -> f64 {
    plain([a, b, c], toward).unwrap_or_else(|| exact([a, b, c], toward))
}

/// The side where its sign is beyond rounding.
#[inline]
fn plain([a, b, c]: [DVec3; 3], toward: Toward) -> Option<f64> {
    let (u, v) = (b - a, c - a);
    let along = match toward {
        Toward::Eye(eye) => a - eye,
        Toward::Along(direction) => direction,
    };
    let determinant = u.cross(v).dot(along);
    let rounding = ROUNDING * norm_1(u) * norm_1(v) * norm_1(along);
    (determinant.abs() > rounding).then_some(-determinant)
}

/// What rounding does to the determinants of a cell's four faces as [`sides_of_eye`] computes them, relative to the same product
/// with the longest edge for both: three of them make the face that lacks the first corner, and their sum is rounded twice.
const ROUNDING_OF_CELL: f64 = 3.0 * 10.0 * (0.5 * f64::EPSILON);

/// The same for the four faces of a tetrahedron with ascending corners, face k opposite to corner k.
#[inline]
pub(super) fn sides_of_eye(corners: [DVec3; 4], toward: Toward) -> [f64; 4] {
    plain_of_cell(corners, toward).unwrap_or_else(|| FACES.map(|face| side_of_eye(face.map(|i| corners[i]), toward)))
}

/// The sides where the signs of all are beyond rounding.
///
/// With the first corner as origin the normals of three faces are cross products of edges, and that of the fourth is
/// (c−b)×(d−b) = c×d − b×d + b×c.
#[inline]
fn plain_of_cell([a, b, c, d]: [DVec3; 4], toward: Toward) -> Option<[f64; 4]> {
    let (p, q, r) = (b - a, c - a, d - a);
    let (along_a, along_b) = match toward {
        Toward::Eye(eye) => (a - eye, b - eye),
        Toward::Along(direction) => (direction, direction),
    };
    let (qr, pr, pq) = (q.cross(r), p.cross(r), p.cross(q));
    let sides = [-(qr - pr + pq).dot(along_b), -qr.dot(along_a), -pr.dot(along_a), -pq.dot(along_a)];
    let longest = norm_1(p).max(norm_1(q)).max(norm_1(r));
    let rounding = ROUNDING_OF_CELL * longest * longest * norm_1(along_a).max(norm_1(along_b));
    let [s, t, u, v] = sides;
    (s.abs().min(t.abs()).min(u.abs().min(v.abs())) > rounding).then_some(sides)
}

/// The same for the triangles p, q, r and q, p, s of a face that is cut from p to q.
///
/// Both share the normal of the plane through the eye and the cut, m = (p−e)×(q−p) (parallel rays: d×(q−p)):
/// |q−p, r−p, p−e| = m·(r−p). A face that is folded upon itself, r and s in one place, bounds nothing and has no sides.
#[inline]
pub(super) fn sides_of_fold([p, q, r, s]: [DVec3; 4], toward: Toward) -> [f64; 2] {
    let along = match toward {
        Toward::Eye(eye) => p - eye,
        Toward::Along(direction) => direction,
    };
    let (cut, to_r, to_s) = (q - p, r - p, s - p);
    let m = along.cross(cut);
    let sides = [-m.dot(to_r), m.dot(to_s)];
    let rounding = ROUNDING * norm_1(along) * norm_1(cut) * norm_1(to_r).max(norm_1(to_s));
    if r == s {
        [0.0; 2]
    } else if sides[0].abs().min(sides[1].abs()) > rounding {
        sides
    } else {
        [side_of_eye([p, q, r], toward), side_of_eye([q, p, s], toward)]
    }
}

#[cold]
fn exact(corners: [DVec3; 3], toward: Toward) -> f64 {
    let coord = |p: DVec3| robust::Coord3D { x: p.x, y: p.y, z: p.z };
    match toward {
        Toward::Eye(eye) => {
            let [a, b, c] = corners.map(coord);
            -robust::orient3d(a, b, c, coord(eye))
        }
        // Differences of positions in f32 are exact but for extremes; at an extreme all orders of the vertices round alike.
        Toward::Along(direction) => {
            let ([a, b, c], is_even) = ascending(corners);
            let side = robust::orient3d(coord(b - a), coord(c - a), coord(direction), coord(DVec3::ZERO));
            if is_even { -side } else { side }
        }
    }
}

/// The corners by their coordinates, and whether that is an even permutation.
fn ascending(mut corners: [DVec3; 3]) -> ([DVec3; 3], bool) {
    let mut is_even = true;
    for (i, k) in [(0, 1), (1, 2), (0, 1)] {
        if corners[i].to_array() > corners[k].to_array() {
            corners.swap(i, k);
            is_even = !is_even;
        }
    }
    (corners, is_even)
}

fn norm_1(a: DVec3) -> f64 {
    a.x.abs() + a.y.abs() + a.z.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::testing::Random;

    #[test]
    fn the_filter_decides_as_the_exact_predicate_does() {
        let mut random = Random::new(11);
        let (mut is_plain, mut edge_on) = (0, 0);
        for i in 0..200_000 {
            let mut point = || random.point().as_vec3().as_dvec3();
            let [a, b, c] = [point(), point(), point()];
            // Along the face but for some ulp: every scale from far beyond rounding to nothing.
            let off = if i % 7 == 0 { 0.0 } else { (-60.0 * random.unit()).exp2() };
            let (s, t) = (random.unit(), random.unit());
            let in_plane = (b - a) * s + (c - a) * t;
            let aside = (b - a).cross(c - a) * (off * (random.unit() - 0.5));
            for toward in [Toward::Eye(a + in_plane + aside), Toward::Along(in_plane + aside)] {
                let (fast, slow) = (side_of_eye([a, b, c], toward), exact([a, b, c], toward));
                assert!((fast > 0.0) == (slow > 0.0) && (fast < 0.0) == (slow < 0.0), "{toward:?}: {fast} {slow}");
                is_plain += i32::from(plain([a, b, c], toward).is_some());
                edge_on += i32::from(slow == 0.0);
            }
        }
        assert!((100_000..300_000).contains(&is_plain) && edge_on > 10, "{is_plain} plain, {edge_on} edge-on");
    }

    #[test]
    fn all_faces_of_a_cell_are_decided_as_each_alone() {
        let mut random = Random::new(12);
        let mut in_one_go = 0;
        for i in 0..100_000 {
            let mut point = || random.point().as_vec3().as_dvec3();
            let mut cell = [point(), point(), point(), point()];
            if i % 3 == 0 {
                // A sliver.
                cell[3] = cell[0] + (cell[1] - cell[0]) * 0.3 + (cell[2] - cell[0]) * 0.4 + point() * 1e-12;
            }
            let [s, t] = [random.unit(), random.unit()];
            let of_face = [i, i + 1, i + 2].map(|k| cell[k % 4]);
            let in_plane = (of_face[1] - of_face[0]) * s + (of_face[2] - of_face[0]) * t;
            let aside = random.point() * (-60.0 * random.unit()).exp2();
            for toward in [Toward::Eye(of_face[0] + in_plane + aside), Toward::Along(in_plane + aside)] {
                let fast = sides_of_eye(cell, toward);
                in_one_go += i32::from(plain_of_cell(cell, toward).is_some());
                for (k, face) in FACES.iter().enumerate() {
                    let slow = exact(face.map(|i| cell[i]), toward);
                    assert!(
                        (fast[k] > 0.0) == (slow > 0.0) && (fast[k] < 0.0) == (slow < 0.0),
                        "{fast:?}, {k}: {slow}"
                    );
                }
            }
        }
        assert!((50_000..190_000).contains(&in_one_go), "{in_one_go}");
    }

    #[test]
    fn both_triangles_of_a_face_are_decided_as_each_alone() {
        let mut random = Random::new(13);
        let mut differ = 0;
        for i in 0..100_000 {
            let mut point = || random.point().as_vec3().as_dvec3();
            let [p, q, r] = [point(), point(), point()];
            let s = if i % 3 == 0 { p + q - r } else { point() };
            let [a, b] = [random.unit(), random.unit()];
            let aside = random.point() * (-60.0 * random.unit()).exp2();
            let in_plane = (q - p) * a + (r - p) * b + aside;
            for toward in [Toward::Eye(p + in_plane), Toward::Along(in_plane)] {
                let fast = sides_of_fold([p, q, r, s], toward);
                let slow = [exact([p, q, r], toward), exact([q, p, s], toward)];
                assert_eq!(fast.map(|side| side.partial_cmp(&0.0)), slow.map(|side| side.partial_cmp(&0.0)));
                // In the other cell's order.
                let other = sides_of_fold([q, p, r, s], toward).map(|side| (-side).partial_cmp(&0.0));
                assert_eq!(other, slow.map(|side| side.partial_cmp(&0.0)));
                differ += i32::from(slow[0] * slow[1] < 0.0);
                let folded_upon_itself = sides_of_fold([p, q, r, r], toward);
                assert!(folded_upon_itself.iter().all(|side| side.abs() < f64::MIN_POSITIVE));
            }
        }
        assert!((20_000..180_000).contains(&differ), "{differ}");
    }

    #[test]
    fn the_order_of_vertices_turns_the_sign_and_nothing_else() {
        // Coordinates so far apart that their differences are rounded.
        let corners = [DVec3::new(1.0, 3e-12, 0.5), DVec3::new(1e-13, 1.0, 7e-14), DVec3::new(-3.0, 1e-20, 1e-9)];
        let direction = (corners[1] - corners[0]) * 0.3 + (corners[2] - corners[0]) * 0.6;
        for toward in [Toward::Along(direction), Toward::Eye(direction)] {
            let [a, b, c] = corners;
            let side = exact([a, b, c], toward).total_cmp(&0.0);
            for [p, q, r] in [[b, c, a], [c, a, b]] {
                assert_eq!(exact([p, q, r], toward).total_cmp(&0.0), side);
                assert_eq!(exact([q, p, r], toward).total_cmp(&0.0), side.reverse());
            }
        }
    }

    #[test]
    fn the_normal_points_to_the_positive_side() {
        let face = [DVec3::ZERO, DVec3::X, DVec3::Y];
        for (height, sign) in [(2.0, 1.0), (-2.0, -1.0), (0.0, 0.0)] {
            let eye = DVec3::new(0.2, 0.3, height);
            assert_eq!(side_of_eye(face, Toward::Eye(eye)).partial_cmp(&0.0), sign.partial_cmp(&0.0));
            assert_eq!(side_of_eye(face, Toward::Along(-DVec3::Z * height)).partial_cmp(&0.0), sign.partial_cmp(&0.0));
        }
    }
}
