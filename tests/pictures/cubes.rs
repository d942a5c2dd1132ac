//! Cubes of a regular grid: against the reference in f64, footprints against fans and GPUs, and what bounds the picture's error.

use cellfan::backends::cpu::InstructionSet;
use cellfan::columns::{Array, Association, Lattice, Volume};
use cellfan::render::{CubeScene, Detail};
use cellfan::{
    Camera, CpuMethod, FieldSelection, Image, Integral, Model, Projection, RenderOptions, Renderer, TransferFunction,
};
use glam::{DMat3, DVec3};

#[cfg(feature = "gpu")]
use crate::gpus::gpus;
use crate::meshes::{smooth, stepped};
use crate::parity::{Parity, miss};
use crate::reference::{Segment, ray_of, shade};

/// Samples from 0 to 1, smooth with plateaus and some noise, in the order of the grid.
fn samples([nx, ny, nz]: [usize; 3]) -> Vec<f32> {
    let mut state = 5_u64;
    let mut noise = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    };
    (0..nx * ny * nz)
        .map(|i| {
            let [x, y, z] =
                [(i % nx, nx), (i / nx % ny, ny), (i / (nx * ny), nz)].map(|(i, n)| i as f32 / n as f32 - 0.5);
            let distance = (x * x + y * y + 0.6 * z * z).sqrt();
            let ripple = 0.5 + 0.3 * (9.0 * distance).cos() + 0.2 * x;
            (if distance > 0.42 { 0.0 } else { ripple + 0.05 * noise() }).clamp(0.0, 1.0)
        })
        .collect()
}

/// Values of cells, or of points, on a sheared grid about one unit wide.
pub(crate) fn volume(dims: [usize; 3], association: Association) -> Volume {
    let side = 1.0 / *dims.iter().max().unwrap() as f64;
    let steps = DMat3::from_cols(DVec3::X, DVec3::new(0.15, 0.9, 0.0), DVec3::new(-0.1, 0.1, 1.1)) * side;
    let points = if association == Association::Cell { dims.map(|side| side + 1) } else { dims };
    let array = Array { name: "v".into(), association, components: 1, values: samples(dims).into() };
    Volume::new(points, Lattice::sheared(DVec3::new(0.2, -0.1, 0.3), steps), vec![array]).unwrap()
}

fn scene(volume: &Volume, transfer: &TransferFunction) -> CubeScene {
    let field = volume.field(&FieldSelection::parse("v", &volume.arrays)).unwrap();
    CubeScene::new(volume, field, transfer).unwrap()
}

/// From outside, along parallel rays, and from inside.
pub(crate) fn views(scene: &CubeScene, [width, height]: [u32; 2]) -> [(&'static str, Camera); 3] {
    let corners = scene.grid().corners_world();
    let middle = corners.iter().sum::<DVec3>() / 8.0;
    let outside = Camera::framing(&corners, 33.0, 21.0, width, height);
    let parallel = Camera { projection: Projection::Orthographic { height_world: 1.4 }, ..outside.clone() };
    let inside = Camera {
        projection: Projection::Perspective { fov_degrees: 70.0 },
        ..Camera::looking_at(middle + DVec3::new(0.11, 0.07, -0.04), corners[6], width, height)
    };
    [("outside", outside), ("parallel", parallel), ("inside", inside)]
}

/// The parts of a ray in all boxes of one sample, nearest first.
pub(crate) fn segments(scene: &CubeScene, camera: &Camera, [x, y]: [u32; 2]) -> Vec<Segment> {
    let ray = ray_of(camera, f64::from(x) + 0.5, f64::from(y) + 0.5);
    let (grid, field) = (scene.grid(), scene.field());
    let to_grid = grid.lattice.grid_from_world();
    let (origin, direction) = (to_grid.transform_point3(ray.origin), to_grid.transform_vector3(ray.direction));
    let corners = grid.corners_world();
    let near = 1e-6 * corners.iter().map(|corner| corner.distance(corners[0])).fold(0.0, f64::max);
    let [nx, ny, nz] = field.dims;
    let mut segments = Vec::new();
    for cell in 0..nx * ny * nz {
        let low = DVec3::new((cell % nx) as f64, (cell / nx % ny) as f64, (cell / (nx * ny)) as f64);
        let (a, b) = ((low - origin) / direction, (low + 1.0 - origin) / direction);
        let (enter, leave) = (a.min(b).max_element().max(near), a.max(b).min_element());
        if enter < leave {
            let value = field.values.get(cell);
            let length_world = (leave - enter) * ray.direction.length();
            segments.push(Segment { w: [enter, leave], s: [value; 2], length_world, cell });
        }
    }
    segments.sort_by(|a, b| a.w[0].total_cmp(&b.w[0]));
    segments
}

pub(crate) fn draw(options: RenderOptions, scene: &CubeScene, detail: Detail, camera: &Camera) -> (Image, u64) {
    let (rendered, stats) = Renderer::new(options).render_cubes(scene, detail, camera).unwrap();
    assert_eq!(rendered.order.exactness, cellfan::profile::Exactness::Exact);
    (rendered.image, stats.cubes)
}

#[test]
fn cubes_are_the_reference_of_constant_cells() {
    let mut failures = Vec::new();
    for association in [Association::Cell, Association::Point] {
        let volume = volume([19, 22, 13], association);
        for (transfer, name) in [(smooth(), "smooth"), (stepped(), "stepped")] {
            let scene = scene(&volume, &transfer);
            for (view, camera) in views(&scene, [120, 90]) {
                let pixels: Vec<[u32; 2]> = (0..150).map(|i| [i * 7919 % 120, i * 104_729 % 90]).collect();
                let segments: Vec<Vec<Segment>> =
                    pixels.iter().map(|&pixel| segments(&scene, &camera, pixel)).collect();
                for model in Model::ALL {
                    let expected: Vec<[f64; 4]> =
                        segments.iter().map(|segments| shade(model, &transfer, segments)).collect();
                    for cpu_method in [CpuMethod::Footprints, CpuMethod::Fans] {
                        let options =
                            RenderOptions { model, cpu_method, stop_transmittance: 0.0, ..RenderOptions::default() };
                        let (image, cubes) = draw(options, &scene, Detail::Error(0.0), &camera);
                        let errors = |shift: f64| {
                            let of_pixel = pixels
                                .iter()
                                .zip(&expected)
                                .filter(|(_, expected)| **expected != [f64::from(miss(model)); 4]);
                            let of_pixel: Vec<f64> = of_pixel
                                .map(|(&[x, y], expected)| {
                                    let found = image.pixel(x, y);
                                    (0..4)
                                        .map(|c| (f64::from(found[c]) + shift - expected[c]).abs())
                                        .fold(0.0, f64::max)
                                })
                                .collect();
                            let mean = of_pixel.iter().sum::<f64>() / of_pixel.len() as f64;
                            (of_pixel.len(), mean, of_pixel.into_iter().fold(0.0, f64::max))
                        };
                        let (count, mean, largest) = errors(0.0);
                        let line = format!(
                            "{association:?} {name} {view:8} {model:20} {cpu_method:?}: {cubes} cubes, {count} pixels, mean {mean:.1e}, largest {largest:.1e}"
                        );
                        println!("{line}");
                        if !(count > 20 && mean <= 1e-4 && largest <= 2e-3) {
                            failures.push(line);
                        }
                        assert!(errors(1.0 / 255.0).1 > 1e-4, "one level passes");
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn cubes_by_footprints_fans_and_gpus_are_one_picture() {
    let mut failures = Vec::new();
    let volume = volume([37, 30, 41], Association::Point);
    for (name, transfer) in [("smooth", smooth()), ("stepped", stepped())] {
        let scene = scene(&volume, &transfer);
        for (view, camera) in views(&scene, [140, 110]) {
            for (model, integral) in [
                (Model::EmissionAbsorption, Integral::Exact),
                (Model::EmissionAbsorption, Integral::Texture),
                (Model::Absorption, Integral::Exact),
                (Model::Emission, Integral::Exact),
                (Model::Mip, Integral::Exact),
            ] {
                for error in [0.1, 0.4] {
                    let options = RenderOptions { model, integral, ..RenderOptions::default() };
                    let (footprints, cubes) = draw(options, &scene, Detail::Error(error), &camera);
                    let fans = draw(
                        RenderOptions { cpu_method: CpuMethod::Fans, ..options },
                        &scene,
                        Detail::Error(error),
                        &camera,
                    );
                    let others = vec![("fans".to_owned(), fans.0)];
                    #[cfg(feature = "gpu")]
                    let others = others.into_iter().chain(
                        gpus("cubes_by_footprints_fans_and_gpus_are_one_picture").into_iter().map(|gpu| {
                            let adapter = gpu.adapter().to_string();
                            let memory = cellfan::backends::gpu::GpuCompositor::MEMORY_BYTES;
                            let mut renderer = Renderer::on_gpu(options, gpu, memory);
                            (adapter, renderer.render_cubes(&scene, Detail::Error(error), &camera).unwrap().0.image)
                        }),
                    );
                    for (way, mut image) in others {
                        let parity = Parity::of(&footprints, &image, miss(model));
                        let line =
                            format!("{name} {view:8} {model:20} {integral:8} {error}: {cubes} cubes {parity:?} {way}");
                        println!("{line}");
                        if !parity.holds() {
                            failures.push(line);
                        }
                        image.pixels.iter_mut().for_each(|pixel| pixel[2] += 1.0 / 255.0);
                        assert!(!Parity::of(&footprints, &image, miss(model)).holds(), "one level passes");
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

fn largest_difference(a: &Image, b: &Image) -> f32 {
    let pairs = a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn the_error_of_the_picture_stays_below_its_bound() {
    let volume = volume([40, 33, 29], Association::Cell);
    let mut coarser = 0;
    for transfer in [smooth(), stepped()] {
        let scene = scene(&volume, &transfer);
        for (view, camera) in views(&scene, [90, 70]) {
            for model in Model::ALL {
                let options = RenderOptions { model, stop_transmittance: 0.0, ..RenderOptions::default() };
                let (exact, all) = draw(options, &scene, Detail::Error(0.0), &camera);
                let mut last = all;
                for bound in [0.0, 0.004, 0.05, 0.2, 0.6, 1.5] {
                    let (image, cubes) = draw(options, &scene, Detail::PictureError(bound), &camera);
                    let found = largest_difference(&exact, &image);
                    println!("{view:8} {model:20} within {bound}: {found:.1e}, {cubes} of {all} cubes");
                    assert!(f64::from(found) <= bound + 1e-4, "{view} {model}: {found} is not within {bound}");
                    // A tighter bound never takes fewer cubes.
                    assert!(cubes <= last);
                    last = cubes;
                }
                coarser += usize::from(last < all * 9 / 10);
                // Negative control: a plain tolerance does not bound it.
                let (coarse, _) = draw(options, &scene, Detail::Error(1.0), &camera);
                assert!(largest_difference(&exact, &coarse) > 0.05);
            }
        }
    }
    assert!(coarser >= 12, "only {coarser} of 24 pictures take fewer cubes");
}

#[test]
fn budgets_of_cubes_and_of_time_are_kept_and_a_view_that_stands_still_gets_finer() {
    let volume = volume([40, 33, 29], Association::Cell);
    let scene = scene(&volume, &smooth());
    let [(_, camera), ..] = views(&scene, [60, 40]);
    let all = draw(RenderOptions::default(), &scene, Detail::Error(0.0), &camera).1;
    for cubes in [1, 100, 3000, 1_000_000] {
        let (_, found) = draw(RenderOptions::default(), &scene, Detail::Cubes(cubes), &camera);
        assert!(found <= cubes && found <= all);
        assert!(cubes < all || found == all);
    }
    // All the time in the world: everything at once. A moment: little, and then more and more.
    assert_eq!(draw(RenderOptions::default(), &scene, Detail::BudgetMs(1e6), &camera).1, all);
    let mut renderer = Renderer::new(RenderOptions::default());
    let mut last = 0;
    for frame in 0..40 {
        let (_, stats) = renderer.render_cubes(&scene, Detail::BudgetMs(1e-3), &camera).unwrap();
        assert!(frame > 0 || stats.cubes < 500, "{stats:?}");
        assert!(frame < 2 || stats.cubes >= last, "{stats:?} after {last}");
        last = stats.cubes;
    }
    assert_eq!(last, all);
    // The view moves: as before.
    let (_, stats) = renderer.render_cubes(&scene, Detail::BudgetMs(1e-3), &camera.orbited(5.0)).unwrap();
    assert!(stats.cubes < all);
}

#[test]
fn cubes_are_the_same_bytes_for_any_threads_instruction_set_and_region() {
    let volume = volume([31, 26, 35], Association::Point);
    let scene = scene(&volume, &smooth());
    for (_, camera) in views(&scene, [130, 100]) {
        for cpu_method in [CpuMethod::Footprints, CpuMethod::Fans] {
            let options = RenderOptions { cpu_method, ..RenderOptions::default() };
            let (whole, _) = draw(options, &scene, Detail::Error(0.05), &camera);
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let (image, _) = pool.install(|| draw(options, &scene, Detail::Error(0.05), &camera));
                assert_eq!(image, whole, "{threads} threads");
            }
            for set in InstructionSet::available() {
                let options = RenderOptions { instruction_set: Some(set), ..options };
                assert_eq!(draw(options, &scene, Detail::Error(0.05), &camera).0, whole, "{}", set.name());
            }
            let region = cellfan::Region { x0: 41, y0: 13, x1: 107, y1: 77 };
            let of_region = Camera { region: Some(region), ..camera.clone() };
            let (part, _) = draw(options, &scene, Detail::Error(0.05), &of_region);
            for (x, y) in (13..77).flat_map(|y| (41..107).map(move |x| (x, y))) {
                assert_eq!(part.pixel(x - 41, y - 13), whole.pixel(x, y), "{cpu_method:?} {x}, {y}");
            }
        }
    }
}

#[test]
fn bad_details_are_refused() {
    let volume = volume([5, 4, 3], Association::Cell);
    let scene = scene(&volume, &smooth());
    let [(_, camera), ..] = views(&scene, [20, 20]);
    let mut renderer = Renderer::new(RenderOptions::default());
    for detail in
        [Detail::Error(-0.1), Detail::PictureError(f64::NAN), Detail::BudgetMs(0.0), Detail::BudgetMs(f64::INFINITY)]
    {
        assert!(renderer.render_cubes(&scene, detail, &camera).is_err(), "{detail:?}");
    }
    let mut budgeted = Renderer::new(RenderOptions { memory_bytes: Some(1 << 30), ..RenderOptions::default() });
    assert!(budgeted.render_cubes(&scene, Detail::Error(0.0), &camera).is_err());
}
