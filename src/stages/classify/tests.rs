use glam::Vec3;

use super::*;

/// An orthographic eye at z = +∞ looking down −z; x right, y down on paper is −y in space.
fn project(p: Vec3) -> Vec2 {
    Vec2::new(p.x, -p.y)
}

fn is_positive([a, b, c, d]: [Vec3; 4]) -> bool {
    (b - a).cross(c - a).dot(d - a) > 0.0
}

fn classified(corners: [Vec3; 4]) -> Classified {
    classify(corners.map(project), is_positive(corners))
}

/// Every order of four vertices.
fn orders() -> impl Iterator<Item = [usize; 4]> {
    (0..256).map(|i| [i & 3, i >> 2 & 3, i >> 4 & 3, i >> 6]).filter(|o| (0..4).all(|k| o.contains(&k)))
}

#[test]
fn class1_names_the_inner_vertex_and_its_side() {
    for (z, in_front) in [(1.0, true), (-1.0, false)] {
        let corners = [Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 0.0), Vec3::new(1.0, 1.0, z)];
        for order in orders() {
            let found = classified(order.map(|i| corners[i]));
            assert_eq!(found.class, ProjectionClass::Class1);
            assert_eq!((order[found.roles[0] as usize], found.inner_is_front), (3, in_front));
        }
    }
}

#[test]
fn class2_names_the_front_edge_first() {
    let corners =
        [Vec3::new(-1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0), Vec3::new(0.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
    for order in orders() {
        let found = classified(order.map(|i| corners[i]));
        assert_eq!(found.class, ProjectionClass::Class2);
        let front: Vec<usize> = found.roles[..2].iter().map(|&role| order[role as usize]).collect();
        assert!(front.contains(&0) && front.contains(&1));
    }
}

#[test]
fn class3_one_face_edge_on() {
    for (z, in_front) in [(1.0, true), (-1.0, false)] {
        // Vertex 3 projects onto the edge from 0 to 1.
        let corners = [Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 0.0, z)];
        for order in orders() {
            let found = classified(order.map(|i| corners[i]));
            assert_eq!((found.class, found.inner_is_front), (ProjectionClass::Class3, in_front));
            let roles = found.roles.map(|role| order[role as usize]);
            assert_eq!((roles[0], roles[2]), (3, 2), "the vertex on the edge, and the one opposite to it");
        }
    }
}

#[test]
fn class4_two_faces_edge_on() {
    let corners = [Vec3::ZERO, Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
    for order in orders() {
        let found = classified(order.map(|i| corners[i]));
        assert_eq!(found.class, ProjectionClass::Class4);
        assert_eq!([order[found.roles[0] as usize], order[found.roles[1] as usize]], [3, 0], "front, then back");
    }
}

#[test]
fn classify_edge_on_cell_covers_nothing() {
    let line = [0.0, 1.0, 2.0, 3.0].map(|x| Vec2::new(x, 2.0 * x));
    assert_eq!(classify(line, true).class, ProjectionClass::EdgeOn);
}

#[test]
fn the_facing_of_a_shared_face_is_opposite_for_its_two_cells() {
    let [a, b, c] = [Vec3::new(0.3, 0.1, 0.0), Vec3::new(1.3, 0.4, 0.2), Vec3::new(0.2, 1.5, 0.4)];
    let (above, below) = (Vec3::new(0.5, 0.6, 2.0), Vec3::new(0.4, 0.5, -3.0));
    let of = |tet: [Vec3; 4]| facing(tet.map(project), is_positive(tet))[3];
    assert_eq!(of([a, b, c, above]), -of([a, b, c, below]));
    assert_eq!(of([a, b, c, below]), 1, "seen from above, the lower cell shows the shared face");
}
