//! Regions on GPUs: that part of the whole picture, as equal as a rasteriser makes it, also where the whole is larger than a texture.

use cellfan::backends::gpu::GpuCompositor;
use cellfan::stages::fans::Faces;
use cellfan::{Camera, Error, Image, Model, Region, RenderOptions, Renderer, SortMethod, TransferFunction};

use crate::check::Case;
use crate::gpu::{draw, four_views, models};
use crate::gpus::gpus;
use crate::hexahedra::{case, twisted_shell};
use crate::meshes::{frame_unit_cube, grid, point, random_delaunay, smooth, stepped, three_views};
use crate::order::three_bars;
use crate::region::{crop, differing, within};

/// Channels of all pixels that are further apart than 2e-3, and the largest difference.
fn apart(a: &Image, b: &Image) -> (usize, f32) {
    let differences = a.pixels.iter().flatten().zip(b.pixels.iter().flatten()).map(|(a, b)| (a - b).abs());
    let of = |(many, most): (usize, f32), d: f32| (many + usize::from(d.is_nan() || d > 2e-3), most.max(d));
    differences.fold((0, 0.0), of)
}

const REGIONS: [[u32; 4]; 5] =
    [[0, 0, 200, 150], [64, 32, 128, 96], [51, 40, 171, 133], [7, 3, 90, 149], [101, 77, 102, 78]];

#[test]
fn parts_of_every_model_and_view() {
    let gpus = gpus("parts_of_every_model_and_view");
    let cases = [
        (Case::new(random_delaunay(20_000), "value"), smooth()),
        (case(twisted_shell([15, 4, 5], 1.2), "value"), stepped()),
    ];
    for gpu in &gpus {
        let (mut pixels, mut unequal, mut wrong, mut largest) = (0, 0, 0, 0.0_f32);
        for (case, transfer) in &cases {
            let scene = case.scene(transfer);
            for (view, camera) in four_views(200, 150) {
                for (model, integral) in models() {
                    let sort = SortMethod::Centroid;
                    let options = RenderOptions { model, integral, sort, ..RenderOptions::default() };
                    let mut renderer = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES);
                    let whole = renderer.render(&scene, &camera).unwrap().image;
                    for region in REGIONS.map(Region::from) {
                        let mut found = renderer.render(&scene, &within(&camera, region)).unwrap().image;
                        let expected = crop(&whole, region);
                        let (many, most) = apart(&found, &expected);
                        if many > 0 {
                            println!("{view}, {model} {integral}, {region}: {many} channels, {most:.1e}");
                        }
                        pixels += found.pixels.len();
                        unequal += differing(&found, &expected);
                        wrong += many;
                        largest = largest.max(most);
                        // A picture one level off is told.
                        found.pixels.iter_mut().for_each(|pixel| pixel[2] += 1.0 / 255.0);
                        assert!(apart(&found, &expected).0 >= found.pixels.len() / 2);
                    }
                }
            }
        }
        println!("{unequal} of {pixels} pixels differ, by {largest:.1e} at most; {wrong} channels by more than 2e-3");
        assert!((wrong as f64) < 1e-4 * pixels as f64, "{wrong} of {pixels}");
    }
}

#[test]
fn late_tiles_of_a_region() {
    let case = three_bars();
    let color = |s: f64, color| point(s, color, 8.0);
    let colors = vec![color(0.0, [1.0, 0.1, 0.1]), color(1.0, [0.1, 1.0, 0.1]), color(2.0, [0.1, 0.1, 1.0])];
    let transfer = TransferFunction::new(colors).unwrap();
    let scene = case.scene(&transfer);
    let camera = Camera::looking_at([0.3, 0.2, 12.0].into(), [0.0; 3].into(), 150, 140);
    let options = RenderOptions::default();
    let rays = case.all_rays(&camera);
    for gpu in gpus("late_tiles_of_a_region") {
        let mut renderer = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES);
        let whole = renderer.render(&scene, &camera).unwrap();
        assert!(rays.errors(&whole.image, Model::EmissionAbsorption, &transfer, usize::MAX).are_small());
        let mut redone = 0;
        for region in [[0, 0, 150, 140], [33, 5, 150, 139], [50, 37, 101, 103], [64, 64, 96, 96], [5, 70, 149, 71]] {
            let region = Region::from(region);
            let found = renderer.render(&scene, &within(&camera, region)).unwrap();
            let (many, most) = apart(&found.image, &crop(&whole.image, region));
            println!("{region}: {:?}, {most:.1e}", found.order);
            assert!(many <= 4, "{region}: {many} channels are off by up to {most}");
            assert!(found.order.tiles_redone <= whole.order.tiles_redone);
            redone += found.order.tiles_redone;
        }
        assert!(redone > 2 * whole.order.tiles_redone);
    }
}

#[test]
fn parts_of_a_picture_that_no_texture_holds() {
    let side = Camera::MAX_SIDE;
    let case = Case::new(grid(10_000, cellfan::generate::Scheme::Six, 0.25), "value");
    let scene = case.scene(&smooth());
    let options = RenderOptions { faces: Faces::Exact, sort: SortMethod::Power, ..RenderOptions::default() };
    for gpu in gpus("parts_of_a_picture_that_no_texture_holds") {
        for camera in [frame_unit_cube(37.0, 22.0, side, side), three_views(side, side)[2].1.clone()] {
            let error = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES).render(&scene, &camera);
            let error = error.unwrap_err();
            assert!(matches!(error, Error::Option { .. } | Error::OutOfMemory { .. }), "{error}");
            for [x0, y0] in [[16_284, 16_294], [10_922, 17_385]] {
                let camera = within(&camera, Region { x0, y0, x1: x0 + 130, y1: y0 + 91 });
                let image = draw(&gpu, options, &scene, &camera);
                let expected = Renderer::new(options).render(&scene, &camera).unwrap().image;
                let (many, most) = apart(&image, &expected);
                println!("{x0},{y0}: {many} channels by more than 2e-3, {most:.1e} at most");
                assert!(expected.covered([0.0; 4]) > 10_000 && many < 50, "{many} channels, up to {most}");
            }
        }
    }
}
