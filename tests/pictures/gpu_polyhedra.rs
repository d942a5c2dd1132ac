//! Prisms and polyhedra on GPUs: the pictures of the CPU, from outside, from inside, and from corners of cells.

use cellfan::backends::gpu::{Gpu, GpuCompositor};
use cellfan::generate::{honeycomb, voronoi};
use cellfan::profile::Exactness;
use cellfan::stages::fans::Faces;
use cellfan::{Camera, Dataset, Model, RenderOptions, Renderer, SortMethod, TransferFunction, io};
use glam::DVec3;

use crate::check::Case;
use crate::common::data_folder;
use crate::gpu::draw;
use crate::gpus::gpus;
use crate::hexahedra::jittered;
use crate::meshes::{chord_of_unit_cube, point, smooth, three_views};
use crate::parity::{Parity, miss};
use crate::polyhedra::{angles, case, generated, places_on_cells, prisms, settings};

/// Both pictures of a view, in the same order of cells, and whether the comparison can fail.
fn compare(name: &str, case: &Case, transfer: &TransferFunction, camera: &Camera, gpu: &Gpu) -> Vec<String> {
    let mut failures = Vec::new();
    for model in Model::ALL {
        let options = RenderOptions { model, sort: SortMethod::Centroid, ..RenderOptions::default() };
        let cpu = case.render(options, transfer, camera).image;
        let image = draw(gpu, options, &case.scene(transfer), camera);
        let parity = Parity::of(&cpu, &image, miss(model));
        let line = format!("{name:40} {model:20} {parity:?}");
        println!("{line} {}", gpu.adapter());
        // From the middle of a mesh with a hollow, few rays may meet it.
        if cpu.covered([miss(model); 4]) > 1000 && !parity.holds() {
            failures.push(line);
        }
        let mut changed = image;
        changed.pixels.iter_mut().for_each(|pixel| pixel[2] += 1.0 / 255.0);
        assert!(!Parity::of(&cpu, &changed, miss(model)).holds(), "one level passes");
    }
    failures
}

#[test]
fn parity_of_polyhedra() {
    let gpus = gpus("parity_of_polyhedra");
    let mut failures = Vec::new();
    for (name, dataset) in [
        ("octahedra", generated(honeycomb(&settings(189, 0.0)))),
        ("bent octahedra", generated(honeycomb(&settings(189, 0.3)))),
        ("voronoi", generated(voronoi(&settings(300, 0.0)))),
        ("prisms", prisms().into_whole_dataset().unwrap()),
        ("angles", angles(0).into_whole_dataset().unwrap()),
    ] {
        for array in ["value", "cell_value"] {
            let case = case(dataset.clone(), array);
            for (view, camera) in three_views(140, 110) {
                for gpu in &gpus {
                    failures.extend(compare(&format!("{name}, {array}, {view}"), &case, &smooth(), &camera, gpu));
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

/// Whatever order cells are drawn in, what is wrong is found and drawn again.
#[test]
fn polyhedra_are_exact_in_their_order() {
    for (name, dataset) in
        [("voronoi", generated(voronoi(&settings(300, 0.0)))), ("prisms", prisms().into_whole_dataset().unwrap())]
    {
        let case = case(dataset, "cell_value");
        for (view, camera) in three_views(140, 110) {
            let cpu = case.render(RenderOptions::default(), &smooth(), &camera).image;
            for gpu in gpus("polyhedra_are_exact_in_their_order") {
                let render = |sort| {
                    let options = RenderOptions { sort, ..RenderOptions::default() };
                    let mut renderer = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES);
                    renderer.render(&case.scene(&smooth()), &camera).unwrap()
                };
                let drawn = render(SortMethod::Auto);
                let parity = Parity::of(&cpu, &drawn.image, 0.0);
                println!("{name:10} {view:9} {parity:?} {:?}", drawn.order);
                assert_eq!(drawn.order.exactness, Exactness::Exact);
                assert!(parity.holds(), "{name}, {view}: {parity:?}");
                assert!(!Parity::of(&cpu, &render(SortMethod::None).image, 0.0).holds(), "no order passes");
            }
        }
    }
}

/// Each ray from a corner is as long in the cells as in the cube.
#[test]
fn an_eye_on_a_corner_on_a_gpu() {
    for (name, dataset) in [
        ("voronoi", generated(voronoi(&settings(100, 0.0)))),
        ("jittered", jittered(6, 0.3).into_whole_dataset().unwrap()),
    ] {
        let (field, places) = (dataset.homogeneous_field(), places_on_cells(&dataset));
        let case = Case::of(dataset, field);
        let transfer = TransferFunction::new(vec![point(0.0, [1.0; 3], 1.5)]).unwrap();
        for gpu in gpus("an_eye_on_a_corner_on_a_gpu") {
            for &place in &places {
                let [_, (_, mut camera), _] = three_views(60, 48);
                camera.eye = place;
                let options = RenderOptions { model: Model::Absorption, ..RenderOptions::default() };
                let image = draw(&gpu, options, &case.scene(&transfer), &camera);
                for (x, y) in (0..48).flat_map(|y| (0..60).map(move |x| (x, y))) {
                    let expected = (-1.5 * chord_of_unit_cube(&camera, x, y, 0.0)).exp();
                    let found = f64::from(image.pixel(x, y)[3]);
                    assert!((found - expected).abs() < 1e-4, "{name}, {place}, ({x}, {y}): {found} for {expected}");
                }
            }
        }
    }
}

#[test]
fn real_polyhedra_on_a_gpu() {
    let Some(folder) = data_folder("real_polyhedra_on_a_gpu") else { return };
    let gpus = gpus("real_polyhedra_on_a_gpu");
    let mut failures = Vec::new();
    let open = |file: &str| -> Dataset { io::open_mesh(&folder.join(file)).unwrap().into_whole_dataset().unwrap() };
    for (file, array) in [
        ("unstructured/PentaHexa.vtk", "scalar2"),
        ("unstructured/supportedElements.vtk", "attribute"),
        ("unstructured/pebi3d_with_properties.vtu", "DENSITY"),
        ("unstructured/pebi3d_with_properties.vtu", "GLOBAL_IDS_POINTS"),
        ("time/openfoam_box", "p"),
    ] {
        let case = case(open(file), array);
        let ((low, high), diagonal) = (case.field.range, case.dataset.diagonal_world());
        // A little wider, so that no whole number stands on a step.
        let transfer = smooth().stretched((low - 0.0137 * (high - low), high)).unwrap();
        let transfer = transfer.scaled_extinction(2.0 / diagonal).unwrap();
        let outside = Camera::framing(&case.dataset.corners_world(), 37.0, 22.0, 160, 120);
        let center = case.dataset.center_world() + DVec3::new(0.001_37, -0.002_11, 0.000_93) * diagonal;
        let inside = Camera { eye: center, target: center + DVec3::new(1.0, 0.4, 0.3) * diagonal, ..outside.clone() };
        for gpu in &gpus {
            for (view, camera) in [("outside", &outside), ("inside", &inside)] {
                failures.extend(compare(&format!("{file}, {array}, {view}"), &case, &transfer, camera, gpu));
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn polyhedra_take_a_slot_of_any_size() {
    let case = case(generated(voronoi(&settings(500, 0.0))), "value");
    let [(_, camera), ..] = three_views(64, 64);
    for gpu in gpus("polyhedra_take_a_slot_of_any_size") {
        let draw = |ring: u64| {
            let mut renderer = Renderer::on_gpu(RenderOptions::default(), gpu.clone(), 64 * 64 * 57 + ring);
            renderer.render(&case.scene(&smooth()), &camera).unwrap().image.pixels
        };
        assert!(draw(64 << 20) == draw(1 << 16), "{}", gpu.adapter());
        let options = RenderOptions { faces: Faces::Fan, ..RenderOptions::default() };
        let mut renderer = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES);
        let error = renderer.render(&case.scene(&smooth()), &camera).unwrap_err().to_string();
        assert!(error.contains("--faces"), "{error}");
    }
}
