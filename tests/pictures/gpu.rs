//! The GPU backend on every adapter: the pictures of the CPU, whatever the ring, the texture or the end of the device.

use std::path::Path;

use cellfan::backends::gpu::{Gpu, GpuCompositor};
use cellfan::columns::NumericColumn;
use cellfan::generate::Scheme;
use cellfan::{
    Camera, Dataset, FieldSelection, Image, Integral, Model, RenderOptions, Renderer, Scene, SortMethod,
    TransferFunction, io,
};
use glam::DVec3;

use crate::check::Case;
use crate::common::data_folder;
use crate::gpus::gpus;
use crate::meshes::{frame_unit_cube, grid, random_delaunay, smooth, stepped, three_views};
use crate::parity::{Parity, miss};

pub(crate) fn draw(gpu: &Gpu, options: RenderOptions, scene: &Scene, camera: &Camera) -> Image {
    let mut renderer = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES);
    renderer.render(scene, camera).unwrap().image
}

fn scene(case: &Case, transfer: &TransferFunction) -> Scene {
    Scene::new(case.dataset.clone(), case.field.clone(), transfer)
}

/// Along rays from a point and parallel ones, from outside and from inside.
pub(crate) fn four_views(width: u32, height: u32) -> [(&'static str, Camera); 4] {
    let [outside, inside, parallel] = three_views(width, height);
    let parallel_inside =
        ("sliced", Camera { eye: DVec3::splat(0.5), target: DVec3::new(0.9, 0.2, 0.7), ..parallel.1.clone() });
    [outside, inside, parallel, parallel_inside]
}

/// Models with the integrals that they have.
pub(crate) fn models() -> impl Iterator<Item = (Model, Integral)> {
    let papers = [Integral::Average, Integral::Texture].map(|integral| (Model::EmissionAbsorption, integral));
    Model::ALL.into_iter().map(|model| (model, Integral::Exact)).chain(papers)
}

#[test]
fn parity_with_the_cpu() {
    let gpus = gpus("parity_with_the_cpu");
    let mut failures = Vec::new();
    for array in ["value", "cell_value"] {
        let case = Case::new(random_delaunay(20_000), array);
        for (view, camera) in four_views(200, 150) {
            for (name, transfer) in [("smooth", smooth()), ("stepped", stepped())] {
                let scene = scene(&case, &transfer);
                for (model, integral) in models() {
                    // On a Delaunay mesh the order of both is right, and the same.
                    let options =
                        RenderOptions { model, integral, sort: SortMethod::Power, ..RenderOptions::default() };
                    let cpu = Renderer::new(options).render(&scene, &camera).unwrap().image;
                    for gpu in &gpus {
                        let image = draw(gpu, options, &scene, &camera);
                        let parity = Parity::of(&cpu, &image, miss(model));
                        let line = format!("{array:10} {view:9} {name:8} {model:20} {integral:8} {parity:?}");
                        println!("{line} {}", gpu.adapter());
                        if !parity.holds() {
                            failures.push(line);
                        }
                        // The comparison fails on a picture one level off, and on one drawn in another order.
                        let mut changed = image;
                        changed.pixels.iter_mut().for_each(|pixel| pixel[2] += 1.0 / 255.0);
                        assert!(!Parity::of(&cpu, &changed, miss(model)).holds(), "one level passes");
                        if !model.is_order_free() {
                            let options = RenderOptions { sort: SortMethod::None, ..options };
                            let unsorted = draw(gpu, options, &scene, &camera);
                            assert!(!Parity::of(&cpu, &unsorted, miss(model)).holds(), "no order passes");
                        }
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

/// Meshes of the shared data that have cells with a volume.
fn meshes(folder: &Path) -> Vec<(String, Dataset)> {
    let mut meshes = Vec::new();
    for room in ["classic", "derived", "unstructured"] {
        let mut paths: Vec<_> =
            std::fs::read_dir(folder.join(room)).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        for path in paths.iter().filter(|path| path.extension().is_some_and(|end| end == "vtu" || end == "vtk")) {
            // Other kinds of grids are refused, surfaces hold nothing to draw.
            if let Ok(dataset) = io::open(path) {
                meshes.push((path.file_name().unwrap().to_string_lossy().into_owned(), dataset));
            }
        }
    }
    meshes
}

#[test]
fn real_meshes() {
    let Some(folder) = data_folder("gpu::real_meshes") else { return };
    let gpus = gpus("gpu::real_meshes");
    let mut failures = Vec::new();
    let (mut drawn, mut without_order) = (0, 0);
    let meshes = meshes(&folder);
    assert!(meshes.len() >= 25, "{}", meshes.len());
    for (file, dataset) in meshes {
        let array = dataset.arrays.first().map(|array| array.name.clone());
        let field = match array {
            Some(name) => dataset.field(&FieldSelection::parse(&name, &dataset.arrays)).ok(),
            None => None,
        };
        let field = field.unwrap_or_else(|| dataset.homogeneous_field());
        let diagonal = dataset.diagonal_world();
        let transfer = smooth().stretched(field.range).unwrap_or_else(|_| smooth());
        let transfer = transfer.scaled_extinction(2.0 / diagonal).unwrap();
        let corners = dataset.bounds.corners().map(|corner| dataset.origin + corner.as_dvec3());
        let outside = Camera::framing(&corners, 37.0, 22.0, 256, 200);
        let center = dataset.center_world();
        let inside = Camera { eye: center, target: center + DVec3::new(1.0, 0.4, 0.3) * diagonal, ..outside.clone() };
        let scene = Scene::new(dataset, field, &transfer);
        for (view, camera) in [("outside", outside), ("inside", inside)] {
            let models = if view == "outside" { &Model::ALL[..] } else { &Model::ALL[..1] };
            for &model in models {
                let options = RenderOptions { model, ..RenderOptions::default() };
                for gpu in &gpus {
                    let render = |options| {
                        let mut renderer = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES);
                        let drawn = renderer.render(&scene, &camera).unwrap();
                        (drawn.image, drawn.order.cycles.unwrap_or(0))
                    };
                    // Right on both; where cells have no order the same one on both, right or not.
                    let (mut image, cycles) = render(options);
                    let mut order = options;
                    if cycles > 0 {
                        order.sort = SortMethod::Centroid;
                        image = render(order).0;
                        without_order += 1;
                    }
                    drawn += 1;
                    let cpu = Renderer::new(order).render(&scene, &camera).unwrap().image;
                    let parity = Parity::of(&cpu, &image, miss(model));
                    let line = format!("{file:44} {view:8} {model:20} {cycles} cycles {parity:?}");
                    println!("{line} {}", gpu.adapter());
                    // From the middle of a mesh with a hollow, few rays may meet it.
                    if cpu.covered([miss(model); 4]) > 1000 && !parity.holds() {
                        failures.push(line);
                    }
                }
            }
        }
    }
    assert!(2 * without_order <= drawn, "{without_order} of {drawn} pictures have cycles");
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn any_ring_gives_the_same_picture() {
    let case = Case::new(random_delaunay(30_000), "value");
    let (scene, camera) = (scene(&case, &smooth()), frame_unit_cube(20.0, 30.0, 64, 64));
    for gpu in gpus("any_ring_gives_the_same_picture") {
        let picture = 64 * 64 * 57;
        let draw = |ring: u64| {
            let mut renderer = Renderer::on_gpu(RenderOptions::default(), gpu.clone(), picture + ring);
            let [first, second] = [0, 1].map(|_| renderer.render(&scene, &camera).unwrap());
            assert!(first.image.pixels == second.image.pixels, "two frames of one renderer");
            (first.image.pixels, first.cells.drawn)
        };
        // All fans take 2.9 MB: one slot, and 3 to 6 slots of 11 to 22 kB, again and again.
        let (whole, small) = (draw(64 << 20), draw(1 << 16));
        assert!(whole.1 > 29_000);
        assert!(whole == small, "{}", gpu.adapter());
        let mut renderer = Renderer::on_gpu(RenderOptions::default(), gpu.clone(), picture);
        let error = renderer.render(&scene, &camera).unwrap_err().to_string();
        assert!(error.contains("--gpu-memory"), "{error}");
    }
}

#[test]
fn pictures_without_cells_and_of_other_sizes_follow_each_other() {
    let case = Case::new(grid(2000, Scheme::Six, 0.2), "value");
    let scene = scene(&case, &smooth());
    for gpu in gpus("pictures_without_cells_and_of_other_sizes_follow_each_other") {
        for model in Model::ALL {
            let options = RenderOptions { model, sort: SortMethod::Power, ..RenderOptions::default() };
            let mut renderer = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES);
            let mut cpu = Renderer::new(options);
            for [width, height] in [[64, 48], [64, 48], [31, 77], [1, 1], [300, 200]] {
                let camera = frame_unit_cube(20.0, 30.0, width, height);
                let [a, b] = [&mut cpu, &mut renderer].map(|renderer| renderer.render(&scene, &camera).unwrap());
                assert_eq!(a.cells.drawn, b.cells.drawn);
                let mean = Parity::of(&a.image, &b.image, miss(model)).mean;
                assert!(mean < 5e-4, "{model} {width}x{height}: {mean}");
                let away = Camera { target: camera.eye * 2.0 - camera.target, ..camera };
                let image = renderer.render(&scene, &away).unwrap().image;
                assert_eq!(image.covered([miss(model); 4]), 0, "{model}: nothing is behind the eye");
            }
        }
    }
}

#[test]
fn a_callers_texture_holds_the_picture() {
    let case = Case::new(grid(5000, Scheme::Six, 0.2), "value");
    let (scene, camera) = (scene(&case, &smooth()), frame_unit_cube(20.0, 30.0, 70, 50));
    for gpu in gpus("a_callers_texture_holds_the_picture") {
        let (device, queue) = gpu.device_and_queue();
        let own = Gpu::from_device(device.clone(), queue.clone());
        let options = RenderOptions { sort: SortMethod::Power, ..RenderOptions::default() };
        let mut renderer = Renderer::on_gpu(options, own, GpuCompositor::MEMORY_BYTES);
        let texture = |width| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width, height: 50, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        };
        let target = texture(70);
        let rendered = renderer.render_to_texture(&scene, &camera, &target).unwrap();
        assert!(rendered.cells.drawn > 4000 && rendered.image.pixels.is_empty());
        let expected = renderer.render(&scene, &camera).unwrap().image;
        assert!(expected.covered([0.0; 4]) > 1000);

        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 512 * 50,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(512), rows_per_image: None };
        let copy = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(target.as_image_copy(), copy, target.size());
        queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
        device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        let bytes = buffer.get_mapped_range(..).unwrap();
        for (i, pixel) in expected.pixels.iter().enumerate() {
            let at = i / 70 * 512 + i % 70 * 4;
            for channel in 0..4 {
                let off = f32::from(bytes[at + channel]) - 255.0 * pixel[channel].clamp(0.0, 1.0);
                assert!(off.abs() < 0.51, "pixel {i}: {off}");
            }
        }
        let error = renderer.render_to_texture(&scene, &camera, &texture(71)).unwrap_err();
        assert!(error.to_string().contains("70x50"), "{error}");
    }
}

#[test]
fn a_device_that_is_gone_is_an_error() {
    let case = Case::new(grid(2000, Scheme::Six, 0.2), "value");
    let (scene, camera) = (scene(&case, &smooth()), frame_unit_cube(20.0, 30.0, 64, 64));
    for gpu in gpus("a_device_that_is_gone_is_an_error") {
        let mut renderer = Renderer::on_gpu(RenderOptions::default(), gpu.clone(), GpuCompositor::MEMORY_BYTES);
        renderer.render(&scene, &camera).unwrap();
        gpu.device_and_queue().0.destroy();
        for size in [64, 80] {
            let error = renderer.render(&scene, &frame_unit_cube(20.0, 30.0, size, 64)).unwrap_err();
            assert!(error.is_device(), "{error}");
        }
    }
}

/// Adapters of discrete GPUs are fed through staging buffers, and some blend in 16 bits only: a device without the features shows both.
#[test]
fn a_device_without_features_draws_through_copies_and_in_16_bits() {
    let case = Case::new(random_delaunay(20_000), "value");
    let camera = frame_unit_cube(20.0, 30.0, 64, 64);
    // The largest number of 16 bits is 65,504.
    let large = {
        let mut mesh = random_delaunay(20_000);
        for array in &mut mesh.arrays {
            let scaled = (0..array.values.len()).map(|i| 1e6 * array.values.get(i)).collect::<Vec<_>>();
            array.values = NumericColumn::F64(scaled.into());
        }
        let case = Case::new(mesh, "value");
        scene(&case, &smooth().stretched((0.0, 1e6)).unwrap())
    };
    let scene = scene(&case, &smooth());
    if gpus("a_device_without_features_draws_through_copies_and_in_16_bits").is_empty() {
        return;
    }
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    for adapter in pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all())) {
        let open = |required_features| {
            let required_limits = adapter.limits();
            let descriptor =
                wgpu::DeviceDescriptor { required_features, required_limits, ..wgpu::DeviceDescriptor::default() };
            let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
            Gpu::from_device(device, queue)
        };
        let options = RenderOptions { sort: SortMethod::Power, ..RenderOptions::default() };
        // Copies change nothing; 64 KiB beside the picture make many slices.
        let [mapped, copied] = [wgpu::Features::MAPPABLE_PRIMARY_BUFFERS, wgpu::Features::empty()].map(|more| {
            let features = (wgpu::Features::FLOAT32_BLENDABLE | more) & adapter.features();
            let mut renderer = Renderer::on_gpu(options, open(features), 64 * 64 * 57 + (1 << 16));
            renderer.render(&scene, &camera).unwrap().image
        });
        assert!(mapped.covered([0.0; 4]) > 1000 && mapped.pixels == copied.pixels);

        let half = open(wgpu::Features::empty());
        assert!(!half.blends_in_32_bits());
        let image = draw(&half, options, &scene, &camera);
        let parity = Parity::of(&mapped, &image, 0.0);
        println!("16 bits: {parity:?}");
        assert!(parity.mean > 1e-6 && parity.mean < 1e-2, "{parity:?}");

        let options = RenderOptions { model: Model::Mip, ..options };
        let [whole, halved] = [&scene, &large].map(|scene| draw(&half, options, scene, &camera));
        let parity = Parity::of(&whole, &halved, 0.0);
        assert!(whole.covered([0.0; 4]) > 1000 && parity.mean < 1e-3, "{parity:?}");
    }
}
