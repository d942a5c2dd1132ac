//! Cells with faces of four corners, whole: against the reference, closed forms, and their neighbours.

use std::collections::HashMap;

use cellfan::backends::cpu::InstructionSet;
use cellfan::cells::{HEXAHEDRON, PYRAMID, WEDGE};
use cellfan::columns::{Array, Association, NumericColumn};
use cellfan::io::{StructuredMesh, UnstructuredMesh};
use cellfan::optics::{BandPoint, BandTable};
use cellfan::{
    Camera, Dataset, Field, FieldSelection, Model, Points, RenderOptions, Renderer, Scene, TransferFunction,
};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::budget::assert_same_at_any_budget;
use crate::check::Case;
use crate::meshes::{Random, point, smooth, three_views};

/// Cells of any kinds with the point array `value` and the cell array `cell_value`.
pub(crate) fn mesh(points: &[DVec3], cells: &[(u8, Vec<u32>)]) -> UnstructuredMesh {
    let mut offsets = vec![0];
    for (_, corners) in cells {
        offsets.push(offsets[offsets.len() - 1] + corners.len() as u64);
    }
    let array = |name: &str, association, values: Vec<f64>| Array {
        name: name.to_owned(),
        association,
        components: 1,
        values: NumericColumn::from(values),
    };
    let value = |p: &DVec3| 0.5 + 0.5 * (5.0 * p.x + 3.0 * p.y).sin() * (4.0 * p.z - p.x).cos();
    let middle = |corners: &[u32]| corners.iter().map(|&v| points[v as usize]).sum::<DVec3>() / corners.len() as f64;
    UnstructuredMesh {
        points: Points::F32(points.iter().map(|p| p.as_vec3().to_array()).collect()),
        types: cells.iter().map(|(code, _)| *code).collect(),
        offsets: offsets.into(),
        connectivity: cells.iter().flat_map(|(_, corners)| corners.iter().copied()).collect(),
        arrays: vec![
            array("value", Association::Point, points.iter().map(value).collect()),
            array("cell_value", Association::Cell, cells.iter().map(|(_, corners)| value(&middle(corners))).collect()),
        ],
        ..UnstructuredMesh::empty()
    }
}

/// `n` cells each way; where `place` puts the points of the unit cube.
pub(crate) fn hex_grid(n: [u32; 3], mut place: impl FnMut(DVec3) -> DVec3) -> (Vec<DVec3>, Vec<(u8, Vec<u32>)>) {
    let [ni, nj, nk] = n.map(|n| n + 1);
    let all = (0..nk).flat_map(|k| (0..nj).flat_map(move |j| (0..ni).map(move |i| [i, j, k])));
    let points = all
        .clone()
        .map(|ijk| place(DVec3::from_array([0, 1, 2].map(|axis| f64::from(ijk[axis]) / f64::from(n[axis])))));
    let points = points.collect();
    let index = |i: u32, j: u32, k: u32| i + ni * (j + nj * k);
    let cells = all.filter(|&[i, j, k]| i < n[0] && j < n[1] && k < n[2]).map(|[i, j, k]| {
        let around = |k: u32| [index(i, j, k), index(i + 1, j, k), index(i + 1, j + 1, k), index(i, j + 1, k)];
        (HEXAHEDRON.code, [around(k), around(k + 1)].concat())
    });
    (points, cells.collect())
}

/// The unit cube, inner points moved by up to `jitter` cells.
pub(crate) fn jittered(n: u32, jitter: f64) -> UnstructuredMesh {
    let mut random = Random(11);
    let (points, cells) = hex_grid([n; 3], |p| {
        let inner = |x: f64| if x > 1e-9 && x < 1.0 - 1e-9 { jitter / f64::from(n) } else { 0.0 };
        let mut moved = || (random.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        p + DVec3::new(inner(p.x) * moved(), inner(p.y) * moved(), inner(p.z) * moved())
    });
    mesh(&points, &cells)
}

pub(crate) fn case(mesh: UnstructuredMesh, array: &str) -> Case {
    let dataset = mesh.into_whole_dataset().unwrap();
    let field = dataset.field(&FieldSelection::parse(array, &dataset.arrays)).unwrap();
    Case::of(dataset, field)
}

/// Random pixels of all views and models: mean at most 2e-4, largest at most 5e-3.
fn check(name: &str, case: &Case, transfer: &TransferFunction, views: &[(&str, Camera)]) {
    let mut failures = Vec::new();
    for (view, camera) in views {
        let rays = case.random_rays(camera, 5, 1000);
        for model in Model::ALL {
            let rendered = case.render(RenderOptions { model, ..RenderOptions::default() }, transfer, camera);
            let errors = rays.errors(&rendered.image, model, transfer, 1000);
            let line = format!("{name:24} {view:9} {model:20} {errors} {:?}", rendered.order.violations);
            println!("{line}");
            if errors.pixels < 500 || errors.mean > 2e-4 || errors.max > 5e-3 {
                failures.push(line);
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
pub(crate) fn jittered_hexahedra_are_the_reference() {
    for (n, jitter) in [(8, 0.0), (10, 0.15), (9, 0.4)] {
        for array in ["value", "cell_value"] {
            let case = case(jittered(n, jitter), array);
            assert_eq!(case.dataset.hexahedra.len(), (n * n * n) as usize);
            check(&format!("{n}³ by {jitter}, {array}"), &case, &smooth(), &three_views(200, 160));
        }
    }
}

/// A cylinder shell of 300 cells, its top turned against its bottom.
pub(crate) fn twisted_shell(n: [u32; 3], turn: f64) -> UnstructuredMesh {
    let (points, cells) = hex_grid(n, |p| {
        let angle = std::f64::consts::PI * p.x + turn * p.z;
        let radius = 0.5 + 0.5 * p.y;
        DVec3::new(radius * angle.cos(), radius * angle.sin(), 2.0 * p.z)
    });
    mesh(&points, &cells)
}

/// Blocks without a list of corners are the cells that are listed.
#[test]
fn structured_blocks_are_the_listed_cells() {
    let [ni, nj, nk] = [15, 4, 5];
    let listed = twisted_shell([ni, nj, nk], 1.2);
    let arrays = listed.arrays.clone();
    let dims = [ni, nj, nk].map(|cells| cells as usize + 1);
    let blocks = StructuredMesh::new(&[dims], listed.points.clone(), arrays).unwrap().into_whole_dataset().unwrap();
    assert_eq!(blocks.hexahedra.owned_bytes(), u64::from(ni * nj * nk) * 2 + 20);
    let corners = blocks.corners_world();
    let camera = Camera::framing(&corners, 20.0, 25.0, 120, 96);
    for array in ["value", "cell_value"] {
        let of = |dataset: Dataset| {
            let field = dataset.field(&FieldSelection::parse(array, &dataset.arrays)).unwrap();
            let scene = Scene::new(dataset, field, &smooth());
            Renderer::new(RenderOptions::default()).render(&scene, &camera).unwrap()
        };
        let (a, b) = (of(blocks.clone()), of(listed.clone().into_whole_dataset().unwrap()));
        assert_eq!((a.cells.drawn, b.cells.drawn), (300, 300));
        let difference = a.image.difference(&b.image, [0.0; 4]).unwrap();
        assert!(a.image.covered([0.0; 4]) > 2000 && difference.max < 1e-5, "{array}: {difference:?}");
    }
}

#[test]
fn any_budget_and_instruction_set_gives_the_same_bytes() {
    for array in ["value", "cell_value"] {
        let case = case(jittered(12, 0.3), array);
        for (view, camera) in three_views(130, 170) {
            for model in [Model::EmissionAbsorption, Model::Mip] {
                let options = RenderOptions { model, ..RenderOptions::default() };
                assert_same_at_any_budget(&case, &smooth(), &camera, options, &format!("{array}, {view}, {model}"));
                let of = |set| {
                    let options = RenderOptions { instruction_set: Some(set), ..options };
                    case.render(options, &smooth(), &camera).image
                };
                let baseline = of(InstructionSet::Baseline);
                for set in InstructionSet::available() {
                    assert!(of(set).pixels == baseline.pixels, "{array}, {view}, {model}: {}", set.name());
                }
            }
        }
    }
}

/// Bands have pieces of their own: on cell data, whole and split cells are one field.
#[test]
fn bands_of_whole_cells_are_those_of_split_ones() {
    let extinctions = |value: f64| (0..5).map(|band| 3.0 * (value * (7.0 + f64::from(band))).sin().powi(2)).collect();
    let points =
        (0..=40).map(|i| f64::from(i) / 40.0).map(|value| BandPoint { value, extinctions: extinctions(value) });
    let names = (0..5).map(|band| format!("band {band}")).collect();
    let table = BandTable::new(names, points.collect()).unwrap();
    let [(_, camera), ..] = three_views(100, 80);
    let draw = |dataset: Dataset| {
        let field = dataset.field(&FieldSelection::parse("cell_value", &dataset.arrays)).unwrap();
        let scene = Scene::new(dataset, field, &smooth()).with_bands(table.clone());
        let options = RenderOptions { model: Model::Absorption, ..RenderOptions::default() };
        Renderer::new(options).render(&scene, &camera).unwrap().bands.unwrap()
    };
    let whole = draw(jittered(8, 0.2).into_whole_dataset().unwrap());
    let split = draw(jittered(8, 0.2).into_dataset().unwrap());
    let off = whole.values.iter().zip(&split.values).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(whole.values.iter().filter(|&&value| value < 0.9).count() > 5000 && off < 1e-5, "{off}");
}

/// Every ray through a homogeneous shell, however its faces fold.
#[test]
fn a_twisted_shell_has_no_artefacts() {
    for (n, turn) in [([15, 4, 5], 0.0), ([15, 4, 5], 1.2), ([15, 4, 5], 3.0)] {
        let dataset = twisted_shell(n, turn).into_whole_dataset().unwrap();
        let field: Field = dataset.homogeneous_field();
        let case = Case::of(dataset, field);
        let transfer = TransferFunction::new(vec![point(0.0, [0.9, 0.7, 0.5], 1.5)]).unwrap();
        let corners = case.dataset.corners_world();
        for (azimuth, elevation) in [(20.0, 25.0), (130.0, -40.0)] {
            let camera = Camera::framing(&corners, azimuth, elevation, 120, 96);
            let rays = case.all_rays(&camera);
            for model in [Model::EmissionAbsorption, Model::Absorption] {
                let rendered = case.render(RenderOptions { model, ..RenderOptions::default() }, &transfer, &camera);
                let errors = rays.errors(&rendered.image, model, &transfer, usize::MAX);
                println!("turned by {turn}: {model:20} {errors}");
                assert!(errors.pixels > 2000 && errors.max < 1e-4, "turned by {turn}: {errors}");
            }
        }
    }
}

/// The length of each ray of a picture between the faces that belong to one cell only: what all cells together have of it.
fn lengths_between_outer_faces(dataset: &Dataset, camera: &Camera) -> Vec<f64> {
    let hexahedra = dataset.hexahedra.view();
    let mut faces: HashMap<[u32; 4], Option<(usize, usize)>> = HashMap::new();
    for (cell, face) in (0..hexahedra.len()).flat_map(|cell| (0..6).map(move |face| (cell, face))) {
        let mut corners = [0, 1, 2, 3].map(|i| hexahedra.get(cell)[usize::from(HEXAHEDRON.faces[face][i])]);
        corners.sort_unstable();
        faces.entry(corners).and_modify(|of| *of = None).or_insert(Some((cell, face)));
    }
    let at = |v: u32| dataset.origin + Vec3::from_array(dataset.positions[v as usize]).as_dvec3();
    let triangles = faces.into_values().flatten().flat_map(|(cell, face)| {
        let corners = hexahedra.get(cell);
        hexahedra.shape(cell).triangles(face).map(|triangle| triangle.map(|i| at(corners[usize::from(i)])))
    });
    let triangles: Vec<[DVec3; 3]> = triangles.collect();
    let frame = camera.frame().unwrap();
    let length = |pixel: u32| {
        let ray = frame.ray(f64::from(pixel % camera.width), f64::from(pixel / camera.width));
        let (o, d) = (ray.origin, ray.direction);
        let crossings = triangles.iter().filter_map(|[a, b, c]| {
            // Möller and Trumbore, signed: positive where the ray leaves.
            let (ab, ac) = (b - a, c - a);
            let n = ab.cross(ac);
            let p = o + d * ((a - o).dot(n) / d.dot(n)) - a;
            let [u, v] = [p.cross(ac).dot(n), ab.cross(p).dot(n)].map(|part| part / n.length_squared());
            (u >= 0.0 && v >= 0.0 && u + v < 1.0).then(|| (p + a - o).length() * d.dot(n).signum())
        });
        crossings.sum()
    };
    (0..camera.width * camera.height).into_par_iter().map(length).collect()
}

/// As many cells as in the paper (Max 2006, figure 15), each ray.
#[test]
fn a_fine_twisted_shell_has_no_artefacts() {
    let dataset = twisted_shell([100, 20, 70], 1.2).into_whole_dataset().unwrap();
    assert_eq!(dataset.hexahedra.len(), 140_000);
    let camera = Camera::framing(&dataset.corners_world(), 20.0, 25.0, 160, 120);
    let lengths = lengths_between_outer_faces(&dataset, &camera);
    let extinction = 1.5;
    let transfer = TransferFunction::new(vec![point(0.0, [0.9, 0.7, 0.5], extinction)]).unwrap();
    let case = Case::of(dataset.clone(), dataset.homogeneous_field());
    let picture = case.render(RenderOptions::default(), &transfer, &camera).image;
    let errors = picture.pixels.iter().zip(&lengths).map(|(pixel, length)| {
        let opacity = 1.0 - (-extinction * length).exp();
        (f64::from(pixel[3]) - opacity).abs()
    });
    let (worst, covered) = (errors.fold(0.0, f64::max), lengths.iter().filter(|&&length| length > 1e-3).count());
    println!("{covered} pixels, largest error {worst:.1e}");
    assert!(covered > 3000 && worst < 1e-4, "{covered} pixels, {worst}");
}

/// Pyramids in one mesh with hexahedra.
pub(crate) fn mixed() -> UnstructuredMesh {
    let mut random = Random(3);
    let (points, hexahedra) = hex_grid([6; 3], |p| {
        p + DVec3::from_array([0; 3].map(|_: i32| (random.next() >> 11) as f64 / (1_u64 << 53) as f64 * 0.04))
    });
    let mut points = points;
    let mut cells = Vec::new();
    for (i, (code, c)) in hexahedra.into_iter().enumerate() {
        if i % 3 == 0 {
            cells.push((code, c));
            continue;
        }
        // Around a middle of its own, so that its faces stay as they are.
        let middle = points.len() as u32;
        points.push(c.iter().map(|&v| points[v as usize]).sum::<DVec3>() / 8.0);
        for face in HEXAHEDRON.faces {
            // Seen from the middle a face runs clockwise: turned, it is the base of a pyramid.
            let [a, b, d, e] = [3, 2, 1, 0].map(|k: usize| c[usize::from(face[k])]);
            cells.push((PYRAMID.code, vec![a, b, d, e, middle]));
        }
    }
    mesh(&points, &cells)
}

/// Wedges and pyramids in one mesh with hexahedra.
#[test]
fn mixed_cells_are_the_reference() {
    for array in ["value", "cell_value"] {
        check(&format!("pyramids, {array}"), &case(mixed(), array), &smooth(), &three_views(200, 160));
    }

    // A hexagon's fan of wedges, and their mirror images.
    let ring = |z: f64| (0..6).map(move |i| (f64::from(i) * std::f64::consts::FRAC_PI_3, z));
    let mut points = vec![DVec3::new(0.5, 0.5, 0.1), DVec3::new(0.5, 0.5, 0.9)];
    points.extend(ring(0.1).chain(ring(0.8)).map(|(a, z)| DVec3::new(0.5 + 0.4 * a.cos(), 0.5 + 0.4 * a.sin(), z)));
    let cells: Vec<_> = (0..6)
        .map(|i| {
            let (a, b) = (2 + i, 2 + (i + 1) % 6);
            let corners = vec![0, a, b, 1, a + 6, b + 6];
            let mirrored = vec![1, a + 6, b + 6, 0, a, b];
            (WEDGE.code, if i % 2 == 0 { corners } else { mirrored })
        })
        .collect();
    let case = case(mesh(&points, &cells), "value");
    assert_eq!((case.dataset.hexahedra.len(), case.dataset.counts.inverted), (6, 3));
    check("wedges", &case, &smooth(), &three_views(200, 160));
}
