//! Prisms and polyhedra: against the reference, closed forms, and the same cells as other kinds.

use std::collections::HashMap;

use cellfan::backends::cpu::InstructionSet;
use cellfan::columns::{CellMesh, FaceLists};
use cellfan::generate::{Settings, honeycomb, voronoi};
use cellfan::io::{Compression, UnstructuredMesh, open_mesh, write_vtu};
use cellfan::profile::Exactness;
use cellfan::{
    Camera, CpuMethod, Dataset, FieldSelection, Integral, Model, RenderOptions, Renderer, SortMethod, TransferFunction,
};
use glam::DVec3;

use crate::budget::assert_same_at_any_budget;
use crate::check::Case;
use crate::hexahedra::{jittered, mesh};
use crate::meshes::{chord_of_unit_cube, point, smooth, three_views};

pub(crate) fn case(dataset: Dataset, array: &str) -> Case {
    let field = dataset.field(&FieldSelection::parse(array, &dataset.arrays)).unwrap();
    Case::of(dataset, field)
}

const WITHOUT_MIP: [Model; 3] = [Model::EmissionAbsorption, Model::Absorption, Model::Emission];

pub(crate) fn settings(cells: u64, jitter: f64) -> Settings {
    Settings { cells, jitter, seed: 3, ..Settings::default() }
}

pub(crate) fn generated(mesh: cellfan::Result<CellMesh>) -> Dataset {
    Dataset::from_cells(mesh.unwrap()).unwrap()
}

/// Random pixels of all models: mean at most 1e-4, largest at most 2e-3.
fn check(name: &str, case: &Case, transfer: &TransferFunction, views: &[(&str, Camera)]) {
    check_models(name, case, transfer, views, &Model::ALL);
}

/// The same of some models.
fn check_models(name: &str, case: &Case, transfer: &TransferFunction, views: &[(&str, Camera)], models: &[Model]) {
    let mut failures = Vec::new();
    for (view, camera) in views {
        let rays = case.random_rays(camera, 5, 600);
        for &model in models {
            let rendered = case.render(RenderOptions { model, ..RenderOptions::default() }, transfer, camera);
            assert_eq!(rendered.order.exactness, Exactness::Exact);
            let errors = rays.errors(&rendered.image, model, transfer, 600);
            let line = format!("{name:28} {view:9} {model:20} {errors} {:?}", rendered.order.violations);
            println!("{line}");
            if errors.pixels < 50 || !errors.are_small() {
                failures.push(line);
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn truncated_octahedra_and_voronoi_cells_are_the_reference() {
    for (name, dataset) in [
        ("octahedra", generated(honeycomb(&settings(189, 0.0)))),
        ("bent octahedra", generated(honeycomb(&settings(189, 0.3)))),
        ("voronoi", generated(voronoi(&settings(300, 0.0)))),
    ] {
        assert_eq!(dataset.polyhedra.len(), dataset.cells());
        for array in ["value", "cell_value"] {
            check(&format!("{name}, {array}"), &case(dataset.clone(), array), &smooth(), &three_views(200, 160));
        }
    }
}

/// The check can fail: another mesh's picture.
#[test]
fn another_mesh_is_not_the_reference() {
    let (one, other) = (generated(voronoi(&settings(100, 0.0))), generated(voronoi(&settings(101, 0.0))));
    let [(_, camera), ..] = three_views(100, 80);
    let rays = case(one, "cell_value").random_rays(&camera, 5, 300);
    let image = case(other, "cell_value").render(RenderOptions::default(), &smooth(), &camera).image;
    assert!(!rays.errors(&image, Model::EmissionAbsorption, &smooth(), 300).are_small());
}

/// Hexagons side by side, every other cut into two pentagons, in three layers in the unit cube.
pub(crate) fn prisms() -> UnstructuredMesh {
    let (mut points, mut cells) = (Vec::new(), Vec::new());
    let mut known: HashMap<[i64; 3], u32> = HashMap::new();
    let mut point = |x: f64, y: f64, z: f64| {
        // A little aside, so that sides are not along the axes, and the layers bend.
        let p = DVec3::new(x + 0.05 * y, y, z + 0.02 * (9.0 * x).sin() * (7.0 * y).cos());
        let key = [x, y, z].map(|c| (c * 1e6).round() as i64);
        *known.entry(key).or_insert_with(|| {
            points.push(p);
            points.len() as u32 - 1
        })
    };
    for layer in 0..3 {
        let z = [f64::from(layer) / 3.0, f64::from(layer + 1) / 3.0];
        for j in 0..5 {
            for i in 0..5 {
                let center = [(f64::from(i) + 0.5 * f64::from(j % 2) + 0.5) * 0.17, (f64::from(j) + 0.7) * 0.15];
                // Corners at ±30° and so on; edges at 0° and 180° stand upright.
                let corner = |k: i32| {
                    let angle = std::f64::consts::FRAC_PI_3 * (f64::from(k) + 0.5);
                    [center[0] + 0.17 / 3.0_f64.sqrt() * angle.cos(), center[1] + 0.1 * angle.sin()]
                };
                let half = |a: [f64; 2], b: [f64; 2]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
                let mut add = |code: u8, around: &[[f64; 2]]| {
                    let level = z.map(|z| around.iter().map(|&[x, y]| point(x, y, z)).collect::<Vec<u32>>());
                    cells.push((code, level.concat()));
                };
                let c: Vec<[f64; 2]> = (0..6).map(corner).collect();
                if (i + j + layer) % 2 == 0 {
                    add(16, &c);
                } else {
                    let (right, left) = (half(c[5], c[0]), half(c[2], c[3]));
                    add(15, &[right, c[0], c[1], c[2], left]);
                    add(15, &[left, c[3], c[4], c[5], right]);
                }
            }
        }
    }
    mesh(&points, &cells)
}

#[test]
fn prisms_are_the_reference() {
    let dataset = prisms().into_whole_dataset().unwrap();
    assert_eq!((dataset.polyhedra.len(), dataset.counts.unsupported, dataset.counts.inverted), (38 + 2 * 37, 0, 0));
    for array in ["value", "cell_value"] {
        check(&format!("prisms, {array}"), &case(dataset.clone(), array), &smooth(), &three_views(200, 160));
    }
    // Cut into tetrahedra they fill the same space.
    let volume = |dataset: &Dataset| (0..dataset.cells()).map(|cell| dataset.volume_world(cell)).sum::<f64>();
    let cut = prisms().into_dataset().unwrap();
    assert_eq!((cut.tets.len(), cut.counts.unsupported), (38 * 12 + 74 * 9, 0));
    assert!((volume(&cut) - volume(&dataset)).abs() < 1e-6);
}

/// Hexahedra some of which a file calls polyhedra.
#[test]
fn hexahedra_among_polyhedra_are_hexahedra() {
    let hexahedra = jittered(7, 0.3);
    let mut mixed = hexahedra.clone();
    let mut faces = FaceLists::default();
    for cell in 0..mixed.cells() {
        if cell % 3 > 0 {
            mixed.types.to_mut()[cell] = 42;
            let corners = hexahedra.cell(cell).unwrap();
            for (k, face) in cellfan::cells::HEXAHEDRON.faces.iter().enumerate() {
                let mut around: Vec<u32> = face.iter().map(|&i| corners[usize::from(i)]).collect();
                // Files need not say which way faces run, nor where they begin.
                around.rotate_left(k % 4);
                if cell % 2 == 0 && k % 2 == 0 {
                    around.reverse();
                }
                faces.push_face(&around);
            }
        }
        faces.end_cell();
    }
    mixed.faces = faces;
    for array in ["value", "cell_value"] {
        let (of, expected) =
            (mixed.clone().into_whole_dataset().unwrap(), hexahedra.clone().into_whole_dataset().unwrap());
        // Where the first face looks inwards, all are turned.
        assert_eq!((of.hexahedra.len(), of.polyhedra.len(), of.counts.inverted), (115, 228, 114));
        let (of, expected) = (case(of, array), case(expected, array));
        for (view, camera) in three_views(120, 96) {
            for model in Model::ALL {
                let options = RenderOptions { model, ..RenderOptions::default() };
                let [a, b] = [&of, &expected].map(|case| case.render(options, &smooth(), &camera).image);
                let difference = a.difference(&b, [0.0; 4]).unwrap();
                println!("{array:10} {view:9} {model:20} {difference:?}");
                assert!(difference.mean < 1e-5 && difference.max < 2e-3, "{array}, {view}, {model}: {difference:?}");
            }
        }
    }
}

/// Three angles of five cubes each, which a ray may meet twice; `turn` says at which corners their caps' fans begin.
pub(crate) fn angles(turn: usize) -> UnstructuredMesh {
    let outline = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]];
    let (mut points, mut lists, mut types) = (Vec::new(), FaceLists::default(), Vec::new());
    for (number, at) in [[0.0, 0.0, 0.0], [0.45, 0.1, 0.3], [0.1, 0.5, 0.6]].into_iter().enumerate() {
        let first = points.len() as u32;
        let corner = |k: usize| (k + turn * number) % 6;
        for z in [0.0, 0.3] {
            points.extend((0..6).map(|k| {
                let [x, y] = outline[corner(k)];
                DVec3::from_array(at) + DVec3::new(0.15 * f64::from(x), 0.15 * f64::from(y), z + 0.01 * f64::from(x))
            }));
        }
        lists.push_face(&[5, 4, 3, 2, 1, 0].map(|k| first + k));
        lists.push_face(&[6, 7, 8, 9, 10, 11].map(|k| first + k));
        for k in 0..6 {
            lists.push_face(&[k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6].map(|k| first + k));
        }
        lists.end_cell();
        types.push((42, (first..first + 12).collect()));
    }
    let mut mesh = mesh(&points, &types);
    mesh.faces = lists;
    mesh
}

#[test]
fn cells_that_are_not_convex_are_the_reference() {
    // A fan that begins where not all of a cap is seen has triangles that overlap: right for lengths, but with values of its own.
    for (turn, arrays, cut) in [(0, &["value", "cell_value"][..], 3), (2, &["cell_value"], 1)] {
        let dataset = angles(turn).into_whole_dataset().unwrap();
        let volumes: Vec<f64> = (0..3).map(|cell| dataset.volume_world(cell)).collect();
        assert!(volumes.iter().all(|volume| (volume - 5.0 * 0.15 * 0.15 * 0.3).abs() < 1e-7), "{volumes:?}");
        for array in arrays {
            // Beside a cap whose triangles overlap the reference meets a cell for no length: a largest value of its own.
            let models = if turn == 0 { &Model::ALL[..] } else { &WITHOUT_MIP };
            let (name, case) = (format!("angles, {array}"), case(dataset.clone(), array));
            check_models(&name, &case, &smooth(), &three_views(200, 160), models);
        }
        // Into tetrahedra those are cut whose lowest corner sees all.
        let counts = angles(turn).into_dataset().unwrap().counts;
        assert_eq!((counts.split, counts.unsupported), (cut, 3 - cut));
    }
}

/// Every ray through the cube is as long in the cells as in the cube.
#[test]
fn a_homogeneous_mesh_is_watertight() {
    let dataset = generated(voronoi(&settings(500, 0.0)));
    let field = dataset.homogeneous_field();
    let case = Case::of(dataset, field);
    let transfer = TransferFunction::new(vec![point(0.0, [1.0; 3], 1.5)]).unwrap();
    for (view, camera) in three_views(160, 120) {
        for model in [Model::EmissionAbsorption, Model::Absorption, Model::Emission] {
            let image = case.render(RenderOptions { model, ..RenderOptions::default() }, &transfer, &camera).image;
            let (mut largest, mut met) = (0.0_f64, 0);
            for (x, y) in (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (x, y))) {
                let depth = 1.5 * chord_of_unit_cube(&camera, x, y, 0.0);
                let expected = match model {
                    Model::Absorption => (-depth).exp(),
                    Model::Emission => depth,
                    _ => -(-depth).exp_m1(),
                };
                let found = image.pixel(x, y)[if model == Model::Emission { 0 } else { 3 }];
                largest = largest.max((f64::from(found) - expected).abs());
                met += u32::from(depth > 0.0);
            }
            println!("{view:9} {model:20} {largest:.1e} over {met}");
            assert!(largest < 1e-5 && met > 4000, "{view}, {model}: {largest}");
        }
    }
}

/// Some places where the eye may be in a mesh of the unit cube: on corners of its cells, on edges, on faces.
pub(crate) fn places_on_cells(dataset: &Dataset) -> Vec<DVec3> {
    let at = |v: u32| DVec3::from_array(dataset.positions[v as usize].map(f64::from));
    let is_inner = |p: &DVec3| (0..3).all(|axis| (0.3..0.7).contains(&(*p + dataset.origin)[axis]));
    let faces: Vec<Vec<u32>> = (0..dataset.polyhedra.len())
        .flat_map(|cell| dataset.polyhedra.view().faces(cell).map(|face| face.around.to_vec()))
        .chain((0..dataset.hexahedra.len()).map(|cell| dataset.hexahedra.view().get(cell)[..4].to_vec()))
        .collect();
    let middle = |corners: &[u32]| corners.iter().map(|&v| at(v)).sum::<DVec3>() / corners.len() as f64;
    let mut places: Vec<DVec3> = Vec::new();
    for corners in [1, 2, 3] {
        // A triangle of a face is flat.
        let inner: Vec<DVec3> = faces.iter().map(|face| middle(&face[..corners])).filter(is_inner).collect();
        places.extend(inner.iter().step_by((inner.len() / 3).max(1)).take(3));
    }
    places.into_iter().map(|place| place + dataset.origin).collect()
}

/// With the eye on a corner, an edge or a face of cells, the edges there have no side for any ray.
#[test]
fn an_eye_on_a_corner_sees_all_cells_around_it() {
    for (name, dataset) in [
        ("voronoi", generated(voronoi(&settings(100, 0.0)))),
        ("grid", jittered(6, 0.0).into_whole_dataset().unwrap()),
        ("jittered", jittered(6, 0.3).into_whole_dataset().unwrap()),
    ] {
        let field = dataset.homogeneous_field();
        let places = places_on_cells(&dataset);
        assert_eq!(places.len(), 9);
        let case = Case::of(dataset, field);
        let transfer = TransferFunction::new(vec![point(0.0, [1.0; 3], 1.5)]).unwrap();
        for (place, model) in places.into_iter().zip([Model::EmissionAbsorption, Model::Absorption].into_iter().cycle())
        {
            let [_, (_, mut camera), _] = three_views(60, 48);
            camera.eye = place;
            let image = case.render(RenderOptions { model, ..RenderOptions::default() }, &transfer, &camera).image;
            for (x, y) in (0..48).flat_map(|y| (0..60).map(move |x| (x, y))) {
                let through = (-1.5 * chord_of_unit_cube(&camera, x, y, 0.0)).exp();
                let expected = if model == Model::Absorption { through } else { 1.0 - through };
                let found = f64::from(image.pixel(x, y)[3]);
                assert!(
                    (found - expected).abs() < 1e-4,
                    "{name}, {place}, {model}, ({x}, {y}): {found} for {expected}"
                );
            }
        }
    }
}

#[test]
fn any_budget_and_instruction_set_gives_the_same_bytes() {
    let dataset = generated(honeycomb(&settings(500, 0.3)));
    for array in ["value", "cell_value"] {
        let case = case(dataset.clone(), array);
        for (view, camera) in three_views(130, 100) {
            for model in [Model::EmissionAbsorption, Model::Emission] {
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

/// Roettger and Ertl's three passes: a step of a length, times how many cells a ray meets, is what they lose.
#[test]
fn lengths_in_eight_bits_are_near_the_exact_ones() {
    let case = case(generated(honeycomb(&settings(189, 0.0))), "cell_value");
    let [(_, camera), ..] = three_views(200, 160);
    let draw = |model, integral| {
        case.render(RenderOptions { model, integral, ..RenderOptions::default() }, &smooth(), &camera).image
    };
    let [exact, rounded] = [Integral::Exact, Integral::Pcp].map(|integral| draw(Model::Emission, integral));
    let difference = exact.difference(&rounded, [0.0; 4]).unwrap();
    println!("{difference:?}");
    assert!((1e-5..5e-3).contains(&difference.mean), "{difference:?}");
    let [exact, same] = [Integral::Exact, Integral::Pcp].map(|integral| draw(Model::Mip, integral));
    assert!(exact.pixels == same.pixels);
    let options = RenderOptions { integral: Integral::Pcp, ..RenderOptions::default() };
    let error = Renderer::new(options).render(&case.scene(&smooth()), &camera).unwrap_err().to_string();
    assert!(error.contains("--integral") && error.contains("emission or mip"), "{error}");
}

#[test]
fn a_written_mesh_is_read_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.vtu");
    let mesh = voronoi(&settings(60, 0.0)).unwrap();
    for compression in [Compression::None, Compression::Zlib] {
        write_vtu(&path, &UnstructuredMesh::from_cells(&mesh), compression).unwrap();
        let cellfan::io::Mesh::Unstructured(back) = open_mesh(&path).unwrap() else { panic!("cells of any kinds") };
        assert_eq!(back.faces, mesh.polyhedra);
        let [a, b] = [back.into_whole_dataset().unwrap(), generated(Ok(mesh.clone()))].map(|dataset| {
            let [(_, camera), ..] = three_views(60, 48);
            case(dataset, "value").render(RenderOptions::default(), &smooth(), &camera).image
        });
        assert!(a.pixels == b.pixels);
    }
}

#[test]
fn what_cannot_be_drawn_so_is_refused() {
    let case = case(generated(voronoi(&settings(20, 0.0))), "value");
    let [(_, camera), ..] = three_views(40, 32);
    let plain = RenderOptions::default();
    for (options, expected) in [
        (RenderOptions { cpu_method: CpuMethod::Fans, sort: SortMethod::Centroid, ..plain }, "--cpu-method"),
        (RenderOptions { sort: SortMethod::Topological, ..plain }, "--sort"),
        (RenderOptions { check_order: true, ..plain }, "--check-order"),
    ] {
        let error = Renderer::new(options).render(&case.scene(&smooth()), &camera).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}
