//! Real meshes, not convex and of all shapes of cells, against the reference.

use cellfan::{Camera, Dataset, FieldSelection, Model, Projection, RenderOptions, io};
use glam::DVec3;

use crate::check::{Case, Errors};
use crate::common::data_folder;
use crate::meshes::{smooth, stepped};

/// File and array.
const MESHES: &[(&str, &str)] = &[
    ("classic/spx.vtk", "scalars"),
    ("classic/post.vtk", "Pressure"),
    ("derived/hand.vtu", "dist_centroid"),
    ("derived/sf10.vtu", "depth"),
    ("derived/spx_off.vtu", "scalar"),
];

/// Cells with faces of four corners: structured, listed, mixed with others; twisted, left-handed, collapsed.
const WHOLE: &[(&str, &str)] = &[
    ("classic/bluntfin.vts", "Density"),
    ("classic/combxyz.bin", "Density"),
    ("classic/postxyz.bin", "StagnationEnergy"),
    ("curvilinear/SampleStructGrid.vtk", "cell:scalars"),
    ("curvilinear/office.binary.vtk", "scalars"),
    ("regular/RectGrid2.vtk", "scalars"),
    ("unstructured/box_hybrid_mesh.vtu", "attribute"),
    ("unstructured/disk_out_ref.vtu", "Temp"),
    ("unstructured/fire_ug.vtu", "t"),
    ("unstructured/lv_passive_hex.vtu", "VonMises_stress"),
    ("unstructured/notch_stress_fixed.vtk", "Nodal Stress-normed"),
];

/// The errors of three views of `case`, two transfer functions and some models, one line each.
fn errors_of(case: &Case, rays: usize, models: &[Model]) -> Vec<(String, Errors)> {
    let ((low, high), diagonal) = (case.field.range, case.dataset.diagonal_world());
    // A little wider, so that no whole number stands on a step.
    let range = (low - 0.0137 * (high - low), high);
    let outside = Camera::framing(&case.dataset.corners_world(), 37.0, 22.0, 320, 256);
    let parallel = Camera { projection: Projection::Orthographic { height_world: 0.8 * diagonal }, ..outside.clone() };
    // Not on a corner or a side of a cell, as the middle of a regular mesh is.
    let center = case.dataset.center_world() + DVec3::new(0.001_37, -0.002_11, 0.000_93) * diagonal;
    let inside = Camera { eye: center, target: center + DVec3::new(1.0, 0.4, 0.3) * diagonal, ..outside.clone() };
    let mut lines = Vec::new();
    for (view, camera) in [("outside", outside), ("parallel", parallel), ("inside", inside)] {
        let rays = case.random_rays(&camera, 77, rays);
        for (name, transfer) in [("smooth", smooth()), ("stepped", stepped())] {
            let transfer = transfer.stretched(range).unwrap().scaled_extinction(2.0 / diagonal).unwrap();
            for &model in models {
                let options = RenderOptions { model, ..RenderOptions::default() };
                let rendered = case.render(options, &transfer, &camera);
                let errors = rays.errors(&rendered.image, model, &transfer, usize::MAX);
                println!("{view:9} {name:8} {model:20} {errors}  {:?}", rendered.order);
                lines.push((format!("{view:9} {name:8} {model:20} {errors}"), errors));
            }
        }
    }
    lines
}

fn case(dataset: Dataset, array: &str) -> Case {
    let field = dataset.field(&FieldSelection::parse(array, &dataset.arrays)).unwrap();
    Case::of(dataset, field)
}

#[test]
fn real_meshes() {
    let Some(folder) = data_folder("real_meshes") else { return };
    let mut failures = Vec::new();
    for (file, array) in MESHES {
        println!("{file}");
        let lines = errors_of(&case(io::open(&folder.join(file)).unwrap(), array), 500, &Model::ALL);
        // From the middle of a mesh with a hollow, few rays may meet it.
        let failed = lines.into_iter().filter(|(_, errors)| errors.pixels > 0 && !errors.are_small());
        failures.extend(failed.map(|(line, _)| format!("{file:20} {line}")));
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn real_meshes_whole() {
    let Some(folder) = data_folder("real_meshes_whole") else { return };
    let mut failures = Vec::new();
    for (file, array) in WHOLE {
        println!("{file}");
        let dataset = io::open_mesh(&folder.join(file)).unwrap().into_whole_dataset().unwrap();
        assert!(dataset.hexahedra.len() > 500, "{file}");
        let lines = errors_of(&case(dataset, array), 120, &[Model::EmissionAbsorption, Model::Mip]);
        let failed = lines
            .into_iter()
            .filter(|(_, Errors { pixels, mean, max, .. })| *pixels > 0 && (*mean > 2e-4 || *max > 5e-3));
        failures.extend(failed.map(|(line, _)| format!("{file:20} {line}")));
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

/// Prisms and polyhedra.
const POLYHEDRA: &[(&str, &str)] = &[
    ("unstructured/PentaHexa.vtk", "scalar2"),
    ("unstructured/PentaHexa.vtk", "scalar1"),
    ("unstructured/supportedElements.vtk", "attribute"),
    ("unstructured/pebi3d_with_properties.vtu", "DENSITY"),
    ("unstructured/pebi3d_with_properties.vtu", "GLOBAL_IDS_POINTS"),
];

#[test]
fn real_polyhedra() {
    let Some(folder) = data_folder("real_polyhedra") else { return };
    let mut failures = Vec::new();
    for (file, array) in POLYHEDRA {
        println!("{file} {array}");
        let dataset = io::open_mesh(&folder.join(file)).unwrap().into_whole_dataset().unwrap();
        assert!(!dataset.polyhedra.is_empty() && dataset.counts.unsupported == 0, "{file}");
        let lines = errors_of(&case(dataset, array), 120, &Model::ALL);
        assert!(lines.iter().any(|(_, errors)| errors.pixels > 50), "{file} is blank");
        let failed = lines.into_iter().filter(|(_, errors)| errors.pixels > 0 && !errors.are_small());
        failures.extend(failed.map(|(line, _)| format!("{file:20} {array:20} {line}")));
    }
    // Times of a case, the last of which has points of its own.
    let case = folder.join("time/openfoam_box");
    for time in [0.0, 4.0] {
        let dataset = io::open_mesh(&io::openfoam_time(&case, time).unwrap()).unwrap().into_whole_dataset().unwrap();
        assert_eq!((dataset.cells(), dataset.hexahedra.len()), (7200, 7200));
        let field = dataset.field(&FieldSelection::parse("U", &dataset.arrays)).unwrap();
        let corners = dataset.corners_world();
        let transfer = smooth().stretched(field.range).unwrap();
        let options = RenderOptions { model: Model::Emission, ..RenderOptions::default() };
        let of = Case::of(dataset, field).render(options, &transfer, &Camera::framing(&corners, 35.0, 20.0, 64, 48));
        assert!(of.image.covered([0.0; 4]) > 500);
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

/// The middle of the mesh is a corner of its cells, hexahedra and prisms: the picture is that from a hair aside.
#[test]
fn an_eye_on_a_corner_of_a_real_mesh() {
    let Some(folder) = data_folder("an_eye_on_a_corner_of_a_real_mesh") else { return };
    let path = folder.join("unstructured/pebi3d_with_properties.vtu");
    let case = case(io::open_mesh(&path).unwrap().into_whole_dataset().unwrap(), "DENSITY");
    let (dataset, diagonal) = (&case.dataset, case.dataset.diagonal_world());
    let center = dataset.center_world();
    let corner = |v: usize| dataset.origin + DVec3::from_array(dataset.positions[v].map(f64::from));
    let nearest = (0..dataset.positions.len())
        .map(corner)
        .min_by(|a, b| a.distance_squared(center).total_cmp(&b.distance_squared(center)));
    println!("{} hexahedra, {} polyhedra, {center} {nearest:?}", dataset.hexahedra.len(), dataset.polyhedra.len());
    let transfer = smooth().stretched(case.field.range).unwrap().scaled_extinction(2.0 / diagonal).unwrap();
    for eye in [Some(center), nearest].into_iter().flatten() {
        let camera = Camera::looking_at(eye, eye + DVec3::new(1.0, 0.4, 0.3), 320, 256);
        let aside = DVec3::new(1.3e-7, -2.1e-7, 0.9e-7) * diagonal;
        let beside = Camera { eye: eye + aside, target: camera.target + aside, ..camera.clone() };
        let rays = case.random_rays(&beside, 77, 600);
        for model in Model::ALL {
            let options = RenderOptions { model, ..RenderOptions::default() };
            let errors = rays.errors(&case.render(options, &transfer, &camera).image, model, &transfer, usize::MAX);
            println!("{model:20} {errors}");
            assert!(errors.are_small() && errors.pixels > 300, "{model}: {errors}");
        }
    }
}

/// Blocks and listed cells, with arrays that the other lacks.
#[test]
fn real_meshes_of_two_kinds_in_a_multi_block_file() {
    let Some(data) = data_folder("real_meshes_of_two_kinds") else { return };
    let data = data.canonicalize().unwrap();
    let block = |file: &str| format!("<Block><DataSet file='{}'/></Block>", data.join(file).display());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("both.vtm");
    let blocks = ["classic/bluntfin.vts", "unstructured/disk_out_ref.vtu"].map(block).concat();
    let kind = "vtkMultiBlockDataSet";
    std::fs::write(&path, format!("<VTKFile type='{kind}'><{kind}>{blocks}</{kind}></VTKFile>")).unwrap();
    let dataset = io::open_mesh(&path).unwrap().into_whole_dataset().unwrap();
    let (fin, disk) = (37_479, 7472);
    assert_eq!(dataset.counts.in_file, fin + disk);
    for (array, without) in [("Density", disk), ("Temp", fin)] {
        let case = case(dataset.clone(), array);
        assert!(case.field.invalid.abs_diff(without) < 10, "{array}: {}", case.field.invalid);
        let lines = errors_of(&case, 120, &[Model::EmissionAbsorption]);
        assert!(lines.iter().map(|(_, errors)| errors.pixels).sum::<usize>() > 300, "{array}");
        let mut failed = lines.iter().filter(|(_, errors)| errors.mean > 2e-4 || errors.max > 5e-3);
        assert!(failed.next().is_none(), "{array}: {lines:?}");
    }
}
