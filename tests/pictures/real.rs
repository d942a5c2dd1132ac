//! Real meshes, not convex and of all shapes of cells, against the reference.

use cellfan::{Camera, FieldSelection, Model, Projection, RenderOptions, io};
use glam::DVec3;

use crate::check::Case;
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

#[test]
fn real_meshes() {
    let Some(folder) = data_folder("real_meshes") else { return };
    let mut failures = Vec::new();
    for (file, array) in MESHES {
        let dataset = io::open(&folder.join(file)).unwrap();
        let field = dataset.field(&FieldSelection::parse(array, &dataset.arrays)).unwrap();
        let (range, diagonal) = (field.range, dataset.diagonal_world());
        let corners = dataset.bounds.corners().map(|corner| dataset.origin + corner.as_dvec3());
        let case = Case::of(dataset, field);
        let outside = Camera::framing(&corners, 37.0, 22.0, 320, 256);
        let parallel =
            Camera { projection: Projection::Orthographic { height_world: 0.8 * diagonal }, ..outside.clone() };
        let center = case.dataset.center_world();
        let inside = Camera { eye: center, target: center + DVec3::new(1.0, 0.4, 0.3) * diagonal, ..outside.clone() };
        for (view, camera) in [("outside", outside), ("parallel", parallel), ("inside", inside)] {
            let rays = case.random_rays(&camera, 77, 500);
            for (name, transfer) in [("smooth", smooth()), ("stepped", stepped())] {
                let transfer = transfer.stretched(range).unwrap().scaled_extinction(2.0 / diagonal).unwrap();
                for model in Model::ALL {
                    let options = RenderOptions { model, ..RenderOptions::default() };
                    let rendered = case.render(options, &transfer, &camera);
                    let errors = rays.errors(&rendered.image, model, &transfer, usize::MAX);
                    let line = format!("{file:20} {view:9} {name:8} {model:20} {errors}");
                    println!("{line}  {:?}", rendered.order);
                    // From the middle of a mesh with a hollow, few rays may meet it.
                    if errors.pixels > 0 && !errors.are_small() {
                        failures.push(line);
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}
