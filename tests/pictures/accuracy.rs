//! A thousand random pixels against the reference: mean error at most 1e-4, largest at most 2e-3, in every channel.

use cellfan::generate::Scheme;
use cellfan::{CpuMethod, Integral, Model, RenderOptions, SortMethod, TetMesh};

use crate::check::Case;
use crate::meshes::{grid, random_delaunay, smooth, steep, stepped, three_views};

const PIXELS: usize = 1000;

/// Every view, transfer function and model of one mesh.
fn check(name: &str, mesh: TetMesh) {
    let case = Case::new(mesh, "value");
    let mut failures = Vec::new();
    for (view, camera) in three_views(320, 256) {
        let rays = case.random_rays(&camera, 2024, 2 * PIXELS);
        for (transfer_name, transfer) in [("smooth", smooth()), ("steep", steep()), ("stepped", stepped())] {
            let methods = [CpuMethod::Footprints, CpuMethod::Rays];
            for (model, cpu_method) in Model::ALL.into_iter().flat_map(|model| methods.map(|method| (model, method))) {
                let options = RenderOptions { model, cpu_method, ..RenderOptions::default() };
                let image = case.render(options, &transfer, &camera).image;
                let errors = rays.errors(&image, model, &transfer, PIXELS);
                let line = format!("{name:16} {view:9} {transfer_name:8} {model:20} {cpu_method:?} {errors}");
                println!("{line}");
                assert_eq!(errors.pixels, PIXELS, "{line}: too few covered pixels");
                if !errors.are_small() {
                    failures.push(line);
                }
            }
        }
    }
    assert!(failures.is_empty(), "{} cells:\n{}", case.dataset.tets.len(), failures.join("\n"));
}

#[test]
fn delaunay_mesh() {
    check("delaunay", random_delaunay(30_000));
}

#[test]
fn grid_of_six_regular() {
    check("six, regular", grid(20_000, Scheme::Six, 0.0));
}

#[test]
fn grid_of_six_jittered() {
    check("six, jittered", grid(20_000, Scheme::Six, 0.25));
}

#[test]
fn grid_of_five_regular() {
    check("five, regular", grid(20_000, Scheme::Five, 0.0));
}

#[test]
fn grid_of_five_jittered() {
    check("five, jittered", grid(20_000, Scheme::Five, 0.25));
}

/// The comparison fails where it must: a coarser integral, no order, one channel off by one level of 255.
#[test]
fn the_comparison_can_fail() {
    let case = Case::new(random_delaunay(4000), "value");
    let transfer = smooth();
    let model = Model::EmissionAbsorption;
    for (view, camera) in three_views(128, 128) {
        let rays = case.random_rays(&camera, 3, PIXELS);
        let right = case.render(RenderOptions::default(), &transfer, &camera).image;
        let errors = rays.errors(&right, model, &transfer, PIXELS);
        println!("{view:9} exact       {errors}");
        assert!(errors.are_small(), "{view}: {errors}");

        let average = RenderOptions { integral: Integral::Average, ..RenderOptions::default() };
        let unsorted = RenderOptions { sort: SortMethod::None, ..RenderOptions::default() };
        for (what, options) in [("average", average), ("unsorted", unsorted)] {
            let errors = rays.errors(&case.render(options, &transfer, &camera).image, model, &transfer, PIXELS);
            println!("{view:9} {what:11} {errors}");
            assert!(!errors.are_small(), "{view}: {what} passes, {errors}");
        }
        for channel in 0..4 {
            let mut changed = right.clone();
            changed.pixels.iter_mut().for_each(|pixel| pixel[channel] += 1.0 / 255.0);
            let errors = rays.errors(&changed, model, &transfer, PIXELS);
            assert!(!errors.are_small(), "{view}: one level in channel {channel} passes, {errors}");
            // One pixel alone is found by the largest error.
            let mut changed = right.clone();
            let (x, y) = rays.pixels[500];
            changed.pixels[(y * camera.width + x) as usize][channel] += 1.0 / 255.0;
            let errors = rays.errors(&changed, model, &transfer, PIXELS);
            assert_eq!((errors.are_small(), errors.max_at), (false, (x, y)), "{view}: {errors}");
        }
    }
}
