use std::collections::BTreeMap;

use glam::DVec2;

use super::cases::definitions;
use super::overlay::Overlay;
use super::renumber::renumberings;
use super::sides::Sides;
use super::*;
use crate::cells::{HEXAHEDRON, PYRAMID, TETRAHEDRON, VOXEL, WEDGE};
use crate::stages::testing::Random;
use crate::stages::testing::polyhedra::{KINDS, SHAPES, Seen, Shape};

mod paper;

fn classify(seen: &Seen) -> Projection {
    Projections::of(seen.kind).unwrap().classify(&seen.xy(), seen.is_positive)
}

fn name(projection: &Projection) -> &'static str {
    match projection {
        Projection::Whole(placed) => placed.case.name,
        Projection::EdgeOn => "edge_on",
        Projection::Split => "split",
    }
}

#[test]
fn the_renumberings_of_a_kind_are_its_rotations() {
    for (kind, count) in [(&HEXAHEDRON, 24), (&VOXEL, 24), (&WEDGE, 6), (&PYRAMID, 4)] {
        let all = renumberings(kind.faces, kind.faces);
        assert_eq!(all.len(), count, "{}", kind.name);
        for (i, one) in all.iter().enumerate() {
            assert!(!all[..i].contains(one), "{one:?} comes twice");
            let corner = |standard: u8| one.corner_from_standard[usize::from(standard)];
            for (standard, face) in kind.faces.iter().enumerate() {
                let there = kind.faces[usize::from(one.face_from_standard[standard])];
                let turn = there.iter().position(|&c| c == corner(face[0])).unwrap();
                let turned: Vec<u8> = (0..there.len()).map(|i| there[(i + turn) % there.len()]).collect();
                assert_eq!(face.iter().map(|&c| corner(c)).collect::<Vec<u8>>(), turned);
            }
        }
    }
    let from_voxel = renumberings(VOXEL.faces, HEXAHEDRON.faces);
    assert!(from_voxel.iter().any(|one| one.corner_from_standard == [0, 1, 3, 2, 4, 5, 7, 6]));
    assert!(renumberings(WEDGE.faces, PYRAMID.faces).is_empty());
}

/// Every choice of faces that run counterclockwise with one outline, and of a face for each inner corner.
fn all_arrangements(faces: Faces) -> Vec<(Sides, Vec<(u8, u8)>)> {
    let mut all = Vec::new();
    for lid in 0..1_u8 << faces.len() {
        let sides = Sides { faces, lid };
        if !sides.share_one_outline() {
            continue;
        }
        let mut of_these = vec![Vec::new()];
        for corner in 0..sides.corners() {
            let Some(of_lid) = sides.inner(corner) else { continue };
            let with = |inside: &Vec<(u8, u8)>| -> Vec<Vec<(u8, u8)>> {
                sides.faces_of(!of_lid).map(|face| [&inside[..], &[(corner, face)]].concat()).collect()
            };
            of_these = of_these.iter().flat_map(with).collect();
        }
        all.extend(of_these.into_iter().map(|inside| (sides, inside)));
    }
    all
}

/// Lid or bowl, each inner corner with its face, ascending: what tells arrangements of a kind apart.
type Key = (u8, Vec<(u8, u8)>);

/// Arrangements of the kind, both ways round, that are those of a case.
fn arrangements_of_case(kind: &CellKind, case: usize) -> Vec<Key> {
    let definition = &definitions(kind)[case];
    let mut keys = Vec::new();
    for renumbering in renumberings(definition.faces, kind.faces) {
        let (lid, mut inside) = definition.renumbered(&renumbering);
        inside.sort_unstable();
        let all = (1 << kind.faces.len()) - 1;
        keys.extend([lid, all - lid].map(|lid| (lid, inside.clone())));
    }
    keys.sort_unstable();
    keys.dedup();
    keys
}

#[test]
fn the_cases_are_all_there_can_be_and_no_two_are_one() {
    for (kind, count) in KINDS.into_iter().zip([192, 192, 40, 34]) {
        let mut case_from_key: BTreeMap<Key, &str> = BTreeMap::new();
        for (case, definition) in definitions(kind).iter().enumerate() {
            for key in arrangements_of_case(kind, case) {
                let other = case_from_key.insert(key, definition.name);
                assert_eq!(other, None, "{} is another case's", definition.name);
            }
        }
        let all = all_arrangements(kind.faces);
        assert_eq!((all.len(), case_from_key.len()), (count, count), "{}", kind.name);
        for (sides, mut inside) in all {
            assert!(Overlay::new(sides, &inside).is_some(), "{sides:?} {inside:?} has no overlay, or several");
            inside.sort_unstable();
            assert!(case_from_key.contains_key(&(sides.lid, inside)), "{sides:?} is of no case");
        }
        // Euler: a polygon of H sides with V vertices in and on it is cut into 2V − 2 − H triangles.
        for (case, definition) in Projections::of(kind).unwrap().cases().iter().zip(definitions(kind)) {
            let vertices = kind.corners + case.crossings.len();
            let expected = 2 * vertices - 2 - definition.sides().outline().len();
            assert_eq!(case.triangles.len(), expected, "{}", case.name);
        }
    }
}

#[test]
fn every_case_occurs_and_hexahedra_are_named_as_by_the_papers_tests() {
    let mut random = Random::new(6);
    for kind in KINDS {
        let mut by_case: BTreeMap<&str, u64> = BTreeMap::new();
        for (shape, cells) in SHAPES {
            for _ in 0..cells {
                let seen = Seen::random(kind, shape, &mut random);
                let found = name(&classify(&seen));
                // The paper splits cells with corners in one place.
                if kind.code == HEXAHEDRON.code && !matches!(shape, Shape::Collapsed(_)) {
                    assert_eq!(found, paper::name(&seen), "{seen:?}");
                }
                *by_case.entry(found).or_default() += 1;
            }
        }
        println!("{}: {by_case:?}", kind.name);
        for definition in definitions(kind) {
            assert!(by_case.get(definition.name).is_some_and(|&cells| cells > 0), "no {}", definition.name);
        }
    }
}

/// Whether a point lies inside a convex polygon of either orientation.
fn contains(polygon: &[DVec2], p: DVec2) -> bool {
    let n = polygon.len();
    let areas = (0..n).map(|i| (polygon[(i + 1) % n] - polygon[i]).perp_dot(p - polygon[i]));
    let (mut left, mut right) = (false, false);
    for area in areas {
        left |= area < 0.0;
        right |= area > 0.0;
    }
    left != right
}

#[test]
fn each_side_of_a_whole_cell_covers_the_same_points_once() {
    let mut random = Random::new(7);
    for kind in KINDS {
        let mut checked = 0;
        for (shape, cells) in SHAPES {
            for _ in 0..cells / 10 {
                let seen = Seen::random(kind, shape, &mut random);
                let Projection::Whole(_) = classify(&seen) else { continue };
                let areas = seen.face_areas();
                for _ in 0..5 {
                    let at = |i: f64| seen.corners[(i * kind.corners as f64) as usize].truncate();
                    let (a, b) = (at(random.unit()), at(random.unit()));
                    let p = a.lerp(b, random.unit()) + random.point().truncate();
                    let on_side = |clockwise: bool| {
                        let is_on_side = |area: f64| area != 0.0 && (area > 0.0) == clockwise;
                        let faces = (0..kind.faces.len()).filter(|&face| is_on_side(areas[face]));
                        faces.filter(|&face| contains(&seen.face(face), p)).count()
                    };
                    let [clockwise, counterclockwise] = [true, false].map(on_side);
                    assert!(clockwise == counterclockwise && clockwise <= 1, "{p} of {seen:?}");
                    checked += clockwise;
                }
            }
        }
        assert!(checked > 10_000, "{}: {checked} points", kind.name);
    }
}

#[test]
fn classify_without_a_case() {
    let square = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let hexahedron = |top: [Vec2; 4]| {
        let table = Projections::of(&HEXAHEDRON).unwrap();
        name(&table.classify(&[square, top].concat(), true))
    };
    assert_eq!(hexahedron(square), "count4", "two faces behind each other, the others edge-on");
    let [a, b, c, d] = square.map(|corner| 0.5 * corner + 0.1);
    assert_eq!(hexahedron([a, b, c, d]), "count4");
    assert_eq!(hexahedron([a, c, b, d]), "split", "a face that crosses itself");
    assert_eq!(hexahedron([a, b, a.lerp(c, 0.2), d]), "split", "a concave face");
    for cell in [[Vec2::ZERO; 8], [Vec2::NAN; 8], std::array::from_fn(|i| Vec2::splat((i % 4 / 2) as f32))] {
        assert_eq!(name(&Projections::of(&HEXAHEDRON).unwrap().classify(&cell, true)), "edge_on");
    }
    // On a line, but 0, 1, 2, 3 run back and forth.
    let zigzag = [0.0, 2.0, 1.0, 3.0, 0.0, 2.0, 1.0, 3.0].map(Vec2::splat);
    assert_eq!(name(&Projections::of(&HEXAHEDRON).unwrap().classify(&zigzag, true)), "split");
    assert!(Projections::of(&TETRAHEDRON).is_none());
}
