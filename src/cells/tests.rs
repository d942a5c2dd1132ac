use std::collections::BTreeMap;

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::columns::{Points, canonical_from_point};

/// The corners of each kind as a convex cell of known volume, in VTK's order and orientation.
fn unit_cell(kind: &CellKind) -> (Vec<DVec3>, f64) {
    let p = |x: i32, y: i32, z: i32| DVec3::new(x.into(), y.into(), z.into());
    match kind.code {
        10 => (vec![p(0, 0, 0), p(1, 0, 0), p(0, 1, 0), p(0, 0, 1)], 1.0 / 6.0),
        11 => ((0..8).map(|i| p(i & 1, i >> 1 & 1, i >> 2)).collect(), 1.0),
        12 => {
            let around = [(0, 0), (1, 0), (1, 1), (0, 1)];
            ((0..8).map(|i: i32| p(around[i as usize % 4].0, around[i as usize % 4].1, i / 4)).collect(), 1.0)
        }
        13 => (vec![p(0, 0, 0), p(0, 1, 0), p(1, 0, 0), p(0, 0, 1), p(0, 1, 1), p(1, 0, 1)], 0.5),
        14 => (vec![p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0), p(0, 0, 1)], 1.0 / 3.0),
        15 => prism(&[(0, 0), (2, 0), (3, 1), (2, 2), (0, 2)], 5.0),
        16 => prism(&[(0, 0), (2, 0), (3, 1), (2, 2), (0, 2), (-1, 1)], 6.0),
        code => unreachable!("no cell for {code}"),
    }
}

/// Of height 1 over a polygon that runs counterclockwise.
fn prism(base: &[(i32, i32)], area: f64) -> (Vec<DVec3>, f64) {
    let level = |z: i32| base.iter().map(move |&(x, y)| DVec3::new(x.into(), y.into(), z.into()));
    (level(0).chain(level(1)).collect(), area)
}

fn volume([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).cross(c - a).dot(d - a) / 6.0
}

fn tets_of(kind: &CellKind, points: &[u32]) -> Vec<[u32; 4]> {
    let mut tets = Vec::new();
    split(kind, points, |point| point, |tet| tets.push(tet));
    tets
}

/// The triangles that only one tetrahedron has, with ascending vertices.
fn boundary(tets: &[[u32; 4]]) -> Vec<[u32; 3]> {
    let mut times = BTreeMap::new();
    for tet in tets {
        for skipped in 0..4 {
            let mut face: Vec<u32> = (0..4).filter(|&i| i != skipped).map(|i| tet[i]).collect();
            face.sort_unstable();
            *times.entry([face[0], face[1], face[2]]).or_insert(0) += 1;
        }
    }
    assert!(times.values().all(|&n| n <= 2), "a triangle has three sides: {tets:?}");
    times.into_iter().filter(|&(_, n)| n == 1).map(|(face, _)| face).collect()
}

/// The rule, written out for a face: from its lowest vertex.
fn rule(face: &[u32]) -> Vec<[u32; 3]> {
    let first = (0..face.len()).min_by_key(|&i| face[i]).unwrap();
    let corner = |i: usize| face[(first + i) % face.len()];
    let mut triangles: Vec<[u32; 3]> = (1..face.len() - 1).map(|i| [corner(0), corner(i), corner(i + 1)]).collect();
    for triangle in &mut triangles {
        triangle.sort_unstable();
    }
    triangles
}

fn any_kind() -> impl Strategy<Value = &'static CellKind> {
    (0..KINDS.len()).prop_map(|i| KINDS[i])
}

/// Distinct numbers for up to twelve corners.
fn numbering() -> impl Strategy<Value = Vec<u32>> {
    Just((100..112).collect::<Vec<u32>>()).prop_shuffle()
}

#[test]
fn faces_close_the_cell_and_point_outwards() {
    for kind in KINDS {
        let (points, expected) = unit_cell(kind);
        assert_eq!(points.len(), kind.corners, "{}", kind.name);
        // Divergence theorem: the cones from a point outside over outward faces add up to the volume.
        let eye = DVec3::new(3.0, -2.0, 5.0);
        let corner = |i: u8| points[usize::from(i)];
        let mut edges = BTreeMap::new();
        let mut sum = 0.0;
        for face in kind.faces {
            for i in 1..face.len() - 1 {
                sum += volume([eye, corner(face[0]), corner(face[i]), corner(face[i + 1])]);
            }
            for i in 0..face.len() {
                *edges.entry((face[i], face[(i + 1) % face.len()])).or_insert(0) += 1;
            }
        }
        assert!((sum - expected).abs() < 1e-12, "{}: {sum}", kind.name);
        assert!(edges.iter().all(|(&(a, b), &n)| n == 1 && edges.contains_key(&(b, a))), "{}: open", kind.name);
    }
}

#[test]
fn codes_of_the_table_classify_as_themselves() {
    for kind in KINDS {
        assert_eq!(classify(kind.code), CellClass::Volume { kind, nodes: Nodes::Linear });
    }
    let drawn = (0..=255).filter(|&code| matches!(classify(code), CellClass::Volume { .. })).count();
    assert_eq!(drawn, 7 + 9 + 12);
}

#[test]
fn kinds_split_into_as_many_tetrahedra_as_triangles_away_from_the_apex() {
    let numbers = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11];
    let counts = KINDS.map(|kind| tets_of(kind, &numbers[..kind.corners]).len());
    assert_eq!(counts, [1, 6, 6, 3, 2, 9, 12]);
}

#[test]
fn hexahedron_collapsed_to_a_wedge_loses_its_flat_tetrahedra() {
    // Corner 3 coincides with 0 and 7 with 4: a prism over the triangles 0 1 2 and 4 5 6.
    let (mut points, _) = unit_cell(&HEXAHEDRON);
    points[3] = points[0];
    points[7] = points[4];
    let canonical = canonical_from_point(&Points::F64(points.iter().map(DVec3::to_array).collect()));
    assert_eq!(canonical, [0, 1, 2, 0, 4, 5, 6, 4]);
    let mut tets = Vec::new();
    split(&HEXAHEDRON, &[0, 1, 2, 3, 4, 5, 6, 7], |p| canonical[p as usize], |tet| tets.push(tet));
    assert_eq!(tets.len(), 3);
    let sum: f64 = tets.iter().map(|tet| volume(tet.map(|p| points[p as usize]))).sum();
    assert!((sum - 0.5).abs() < 1e-12);
}

#[test]
fn cell_collapsed_to_a_face_has_no_tetrahedron() {
    let canonical = |point: u32| point % 4;
    split(&HEXAHEDRON, &[0, 1, 2, 3, 4, 5, 6, 7], canonical, |tet| panic!("{tet:?} has no volume"));
}

#[test]
fn canonical_points_are_the_lowest_of_those_that_coincide() {
    let points = [[0.0, 1.0, 2.0], [5.0, 0.0, 0.0], [-0.0, 1.0, 2.0], [f64::NAN, 0.0, 0.0], [5.0, 0.0, 0.0]];
    assert_eq!(canonical_from_point(&Points::F64(points.to_vec())), [0, 1, 0, 3, 1]);
}

proptest! {
    #[test]
    fn volumes_add_up(kind in any_kind(), numbers in numbering(), a in prop::array::uniform9(-1.0..1.0_f64)) {
        let (points, expected) = unit_cell(kind);
        let map = glam::DMat3::from_cols_array(&a);
        let tets = tets_of(kind, &numbers[..kind.corners]);
        let position = |number: u32| map * points[numbers.iter().position(|&n| n == number).unwrap()];
        let volumes: Vec<f64> = tets.iter().map(|tet| volume(tet.map(position))).collect();
        let determinant = map.determinant();
        prop_assert!((volumes.iter().sum::<f64>() - expected * determinant).abs() < 1e-12);
        prop_assert!(volumes.iter().all(|v| v * determinant.signum() >= 0.0), "orientation is the cell's");
    }

    #[test]
    fn volumes_of_bent_cells_are_those_of_the_cut_faces(
        kind in any_kind(), numbers in numbering(), bend in prop::collection::vec(-0.2..0.2_f64, 36),
    ) {
        let (mut points, _) = unit_cell(kind);
        for (point, by) in points.iter_mut().zip(bend.chunks(3)) {
            *point += DVec3::from_slice(by);
        }
        let position = |number: u32| points[numbers.iter().position(|&n| n == number).unwrap()];
        let sum: f64 = tets_of(kind, &numbers[..kind.corners]).iter().map(|tet| volume(tet.map(position))).sum();
        let mut expected = 0.0;
        for face in kind.faces {
            let face: Vec<u32> = face.iter().map(|&i| numbers[usize::from(i)]).collect();
            let first = (0..face.len()).min_by_key(|&i| face[i]).unwrap();
            for i in 1..face.len() - 1 {
                let triangle = [first, first + i, first + i + 1].map(|i| position(face[i % face.len()]));
                expected += volume([DVec3::ZERO, triangle[0], triangle[1], triangle[2]]);
            }
        }
        prop_assert!((sum - expected).abs() < 1e-12);
    }

    #[test]
    fn every_face_is_cut_as_the_rule_says(kind in any_kind(), numbers in numbering()) {
        let mut expected: Vec<[u32; 3]> = kind
            .faces
            .iter()
            .flat_map(|face| rule(&face.iter().map(|&i| numbers[usize::from(i)]).collect::<Vec<_>>()))
            .collect();
        expected.sort_unstable();
        prop_assert_eq!(boundary(&tets_of(kind, &numbers[..kind.corners])), expected);
    }

    /// Cells of any two kinds glued at a face: the triangles between them are shared, none is left over.
    #[test]
    fn neighbours_agree_on_their_face(
        a in any_kind(), b in any_kind(), face_a in any::<prop::sample::Index>(), turn in 0..4_usize,
        numbers in Just((0..24).collect::<Vec<u32>>()).prop_shuffle(),
    ) {
        let face_a = a.faces[face_a.index(a.faces.len())];
        let Some(face_b) = b.faces.iter().find(|face| face.len() == face_a.len()) else { return Ok(()) };
        let cell_a = &numbers[..a.corners];
        let mut cell_b = numbers[12..12 + b.corners].to_vec();
        let shared: Vec<u32> = face_a.iter().map(|&i| cell_a[usize::from(i)]).collect();
        for (i, &corner) in face_b.iter().enumerate() {
            cell_b[usize::from(corner)] = shared[(2 * shared.len() + turn - i) % shared.len()];
        }
        let (tets_a, tets_b) = (boundary(&tets_of(a, cell_a)), boundary(&tets_of(b, &cell_b)));
        let common = tets_a.iter().filter(|triangle| tets_b.contains(triangle)).count();
        prop_assert_eq!(common, face_a.len() - 2);
    }
}
