use glam::{DMat3, Vec3};

use super::*;
use crate::columns::{Array, Association, CellCounts, CellMesh, Dataset, NumericColumn, Points};
use crate::stages::footprints::PixelBoxes;
use crate::stages::project::{project, scene_vertices};
use crate::stages::testing::{Random, ray, views};

/// Separate hexahedra of about half a unit, jittered and twisted, in the cube from −1 to 1.
fn random_hexahedra(count: u32, random: &mut Random) -> Dataset {
    let mut points = Vec::new();
    for _ in 0..count {
        let (center, angle) = (random.point(), 1.2 * random.unit());
        for corner in [[0, 0], [1, 0], [1, 1], [0, 1]].iter().flat_map(|&[x, y]| [[x, y, 0], [x, y, 1]]) {
            let p = DVec3::from_array(corner.map(f64::from)) - 0.5 + random.point() * 0.08;
            points.push((center + DMat3::from_rotation_z(p.z * angle) * p * 0.5).to_array());
        }
    }
    let values = (0..points.len()).map(|_| random.unit()).collect::<Vec<_>>();
    let array = Array {
        name: "value".into(),
        association: Association::Point,
        components: 1,
        values: NumericColumn::F64(values.into()),
    };
    // Bottom and top stand side by side.
    let corners = |i: u32| [0, 2, 4, 6, 1, 3, 5, 7].map(|k| 8 * i + k);
    Dataset::from_cells(CellMesh {
        points: Points::F64(points),
        tets: Vec::new().into(),
        file_from_tet: Vec::new().into(),
        hexahedra: (0..count).map(corners).collect(),
        file_from_hexahedron: (0..count).collect(),
        arrays: vec![array],
        counts: CellCounts { in_file: count.into(), ..CellCounts::default() },
        ..CellMesh::empty()
    })
    .unwrap()
}

/// Depth and value where a ray crosses a triangle, and whether it leaves there, by Möller and Trumbore.
fn crossing((o, d): (DVec3, DVec3), [a, b, c]: [DVec3; 3], s: [f64; 3]) -> Option<([f64; 2], bool)> {
    let (ab, ac) = (b - a, c - a);
    let n = ab.cross(ac);
    let w = (a - o).dot(n) / d.dot(n);
    let p = o + d * w - a;
    let [u, v] = [p.cross(ac).dot(n), ab.cross(p).dot(n)].map(|part| part / n.length_squared());
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| ([w, s[0] + u * (s[1] - s[0]) + v * (s[2] - s[0])], d.dot(n) > 0.0))
}

#[test]
fn parts_are_those_between_the_triangles_that_the_ray_crosses() {
    let dataset = random_hexahedra(1500, &mut Random::new(5));
    let field = dataset.field(&crate::columns::FieldSelection::parse("value", &dataset.arrays)).unwrap();
    let vertices = scene_vertices(&dataset, &field);
    let hexahedra = dataset.hexahedra.view();
    assert!((0..hexahedra.len()).filter(|&cell| !hexahedra.shape(cell).is_convex()).count() > 100);
    let (mut parts, mut twice, mut homogeneous, mut worst) = (0, 0, 0, [0.0_f64; 2]);
    for view in views(&dataset, 96, 64) {
        let mut screen = Vec::new();
        project(&view, &vertices, &mut screen);
        for cell in 0..hexahedra.len() {
            let (vertex, shape) = (hexahedra.get(cell), hexahedra.shape(cell));
            let Some(pixels) = PixelBoxes::new(&view).of_cell(vertex, &vertices, &screen) else { continue };
            let fan = HexFan::new(&view, pixels, (vertex, shape), (&vertices, &screen), None);
            let [x, y] = [pixels.x0.midpoint(pixels.x1), pixels.y0.midpoint(pixels.y1)];
            let ray = ray(&view, x.into(), y.into());
            let corner = |i: u8| vertices[vertex[usize::from(i)] as usize];
            let triangles = (0..6).flat_map(|face| shape.triangles(face));
            let mut expected: Vec<_> = triangles
                .filter_map(|triangle| {
                    let p = triangle.map(|i| Vec3::from_array(corner(i).position).as_dvec3());
                    crossing(ray, p, triangle.map(|i| f64::from(corner(i).scalar)))
                })
                .collect();
            expected.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
            let found = fan.parts(&view, [f64::from(x - pixels.x0), f64::from(y - pixels.y0)]);
            assert_eq!(2 * found.len(), expected.len(), "cell {cell}");
            for (found, expected) in found.iter().flatten().zip(&expected) {
                worst = std::array::from_fn(|k| worst[k].max((found[k] - expected.0[k]).abs()));
            }
            assert!(expected.iter().enumerate().all(|(i, (_, leaves))| *leaves == (i % 2 == 1)));
            parts += found.len();
            twice += usize::from(found.len() > 1);
            homogeneous += usize::from(fan.flags & HexFan::IS_HOMOGENEOUS != 0 && !found.is_empty());
        }
    }
    println!("{parts} parts, {twice} rays with more than one, {homogeneous} cells before the eye, errors {worst:?}");
    assert!(parts > 2000 && twice > 10 && homogeneous > 20, "{parts} {twice} {homogeneous}");
    assert!(worst[0] < 1e-3 && worst[1] < 1e-2, "{worst:?}");
}
