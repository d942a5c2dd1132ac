//! The slow twin for hexahedra: the tests of Max 2006 as they are written down there, sections 2 to 4 — convexity, count of
//! contained corners, and then which of the new vertices are found.

use glam::{DVec2, IVec3};

use crate::cells::HEXAHEDRON;
use crate::stages::testing::polyhedra::Seen;

/// The 24 rotations of the cube, as turns of its corners in space: entry i is where corner i comes to lie.
fn rotations() -> Vec<[usize; 8]> {
    let corners: [IVec3; 8] = std::array::from_fn(|i| {
        let [x, y] = [[0, 0], [1, 0], [1, 1], [0, 1]][i % 4];
        IVec3::new(2 * x - 1, 2 * y - 1, 2 * (i as i32 / 4) - 1)
    });
    let axes = [IVec3::X, IVec3::Y, IVec3::Z, -IVec3::X, -IVec3::Y, -IVec3::Z];
    let frames = axes.iter().flat_map(|&x| axes.iter().map(move |&y| (x, y))).filter(|(x, y)| x.dot(*y) == 0);
    let turned = |(x, y): (IVec3, IVec3)| {
        let turn = |p: IVec3| x * p.x + y * p.y + x.cross(y) * p.z;
        corners.map(|corner| corners.iter().position(|&other| other == turn(corner)).unwrap())
    };
    frames.map(turned).collect()
}

/// The name of the case, or "split".
pub(super) fn name(seen: &Seen) -> &'static str {
    let p: Vec<DVec2> = seen.corners.iter().map(|corner| corner.truncate()).collect();
    let side = |a: usize, b: usize, c: usize| (p[b] - p[a]).perp_dot(p[c] - p[a]) > 0.0;
    let faces = HEXAHEDRON.faces.iter().map(|face| [0, 1, 2, 3].map(|i| usize::from(face[i])));
    let faces: Vec<[usize; 4]> = faces.collect();
    let mut contained = Vec::new();
    for face in &faces {
        let edges = [0, 1, 2, 3].map(|i| (face[i], face[(i + 1) % 4], face[(i + 2) % 4], face[(i + 3) % 4]));
        if edges.iter().any(|&(a, b, c, d)| side(a, b, c) != side(a, b, d)) {
            return "split";
        }
        let is_inside =
            |&v: &usize| !face.contains(&v) && edges.iter().all(|&(a, b, c, _)| side(a, b, v) == side(a, b, c));
        if contained.is_empty() {
            contained.extend((0..8).filter(is_inside).map(|v| (*face, v)));
        }
    }
    let crosses =
        |[a, b]: [usize; 2], [c, d]: [usize; 2]| side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b);
    match contained[..] {
        [] => "count0",
        [(face, inner)] => {
            let is_standard = |r: &[usize; 8]| r[7] == inner && face.iter().all(|v| r[..4].contains(v));
            let r = rotations().into_iter().find(is_standard).expect("a rotation brings the inner corner to 7");
            let found = |e: [usize; 2], f: [usize; 2]| crosses(e.map(|v| r[v]), f.map(|v| r[v]));
            match (found([7, 4], [0, 1]), found([7, 6], [1, 2])) {
                (true, true) => "count1",
                (false, true) if found([7, 4], [1, 5]) => "count1_a",
                (true, false) if found([7, 6], [1, 5]) => "count1_b",
                (false, true) if found([1, 2], [4, 0]) => "count1_c",
                (true, false) if found([0, 1], [2, 6]) => "count1_d",
                _ => "another count1",
            }
        }
        [_, _] => "count2",
        [_, _, _] => "count3",
        _ => "count4",
    }
}
