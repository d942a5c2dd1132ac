//! Wavelength bands on every adapter: optical depths of long rays, and the CPU's pictures pass by pass.

use cellfan::backends::gpu::{Gpu, GpuCompositor};
use cellfan::generate::Scheme;
use cellfan::image::BandImage;
use cellfan::optics::{BandPoint, BandTable, Output};
use cellfan::{Dataset, Image, Model, RenderOptions, Rendered, Renderer, Scene, SortMethod};

use crate::bands::{DEPTH, bar, beside_the_diagonal, dark, depths_of_bar, six_bands, three_bands};
use crate::check::Case;
use crate::gpus::gpus;
use crate::meshes::{frame_unit_cube, grid, random_delaunay, smooth, three_views};
use crate::parity::Parity;

fn draw(gpu: &Gpu, options: RenderOptions, scene: &Scene, camera: &cellfan::Camera) -> Rendered {
    let mut renderer = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES);
    renderer.render(scene, camera).unwrap()
}

#[test]
fn depths_of_long_rays_are_right_to_a_ten_thousandth() {
    let camera = beside_the_diagonal();
    let table = six_bands();
    let scenes = [
        ("bar", Case::new(bar(1500), "value").scene(&dark()).with_bands(table.clone()), depths_of_bar(&table)),
        (
            "grid",
            {
                let dataset = Dataset::from_tets(grid(200_000, Scheme::Six, 0.2)).unwrap();
                let field = dataset.homogeneous_field();
                Scene::new(dataset, field, &dark())
                    .with_bands(BandTable::constant(vec![0.01, 1.0, 3.0, 5.0, 9.0]).unwrap())
            },
            vec![0.01, 1.0, 3.0, 5.0, 9.0],
        ),
    ];
    for gpu in gpus("depths_of_long_rays_are_right_to_a_ten_thousandth") {
        for (name, scene, expected) in &scenes {
            let picture = draw(&gpu, DEPTH, scene, &camera).bands.unwrap();
            let of_pixel = |bands: &[f32]| -> f64 {
                let off =
                    bands.iter().zip(expected).map(|(&found, expected)| (f64::from(found) / expected - 1.0).abs());
                off.fold(0.0, f64::max)
            };
            let worst = picture.values.chunks_exact(expected.len()).map(of_pixel).fold(0.0, f64::max);
            println!("{name} on {}: {worst:.1e} relative", gpu.adapter());
            assert!(worst < 1e-4, "{name}: {worst}");
            // The comparison fails where the bands stand in another order.
            let turned: Vec<f32> = picture.pixel(5, 5).iter().rev().copied().collect();
            assert!(of_pixel(&turned) > 0.1);
        }
    }
}

/// Intensities of four of a picture's bands as channels.
fn channels(picture: &BandImage, bands: [usize; 4], output: Output) -> Image {
    let intensity = |value: f32| if output == Output::Depth { (-value).exp() } else { value };
    let of_pixel = |pixel: &[f32]| bands.map(|band| intensity(pixel[band]));
    let pixels = picture.values.chunks_exact(picture.names.len()).map(of_pixel).collect();
    Image { width: picture.width, height: picture.height, pixels }
}

#[test]
fn all_passes_are_those_of_the_cpu() {
    for gpu in gpus("all_passes_are_those_of_the_cpu") {
        for array in ["value", "cell_value"] {
            let case = Case::new(random_delaunay(20_000), array);
            let in_bands = case.scene(&dark()).with_bands(six_bands());
            for (view, camera) in three_views(200, 150) {
                for output in Output::ALL {
                    let options = RenderOptions { output, ..DEPTH };
                    let cpu = Renderer::new(options).render(&in_bands, &camera).unwrap();
                    let drawn = draw(&gpu, options, &in_bands, &camera);
                    assert_eq!(cpu.cells.drawn, drawn.cells.drawn);
                    let [cpu, drawn] = [cpu, drawn].map(|rendered| rendered.bands.unwrap());
                    let parity = |of_cpu, of_gpu| {
                        Parity::of(&channels(&cpu, of_cpu, output), &channels(&drawn, of_gpu, output), 1.0)
                    };
                    for bands in [[0, 1, 2, 3], [2, 3, 4, 5]] {
                        let parity = parity(bands, bands);
                        println!("{array:10} {view:9} {output:9} {bands:?} {parity:?}");
                        assert!(parity.holds(), "{array} {view} {output} {bands:?}: {parity:?}");
                    }
                    let swapped = parity([0, 1, 2, 3], [1, 0, 2, 3]);
                    assert!(!swapped.holds(), "exchanged bands pass");
                }
            }
        }
    }
}

#[test]
fn each_channel_is_dimmed_by_its_own_band() {
    for gpu in gpus("each_channel_is_dimmed_by_its_own_band").into_iter().filter(Gpu::blends_by_channel) {
        for array in ["value", "cell_value"] {
            let case = Case::new(random_delaunay(20_000), array);
            let scene = case.scene(&smooth()).with_bands(three_bands());
            let options = RenderOptions { sort: SortMethod::Power, ..RenderOptions::default() };
            for (view, camera) in three_views(200, 150) {
                let cpu = Renderer::new(options).render(&scene, &camera).unwrap().image;
                let image = draw(&gpu, options, &scene, &camera).image;
                let parity = Parity::of(&cpu, &image, 0.0);
                println!("{array:10} {view:9} {parity:?} {}", gpu.adapter());
                assert!(parity.holds(), "{array} {view}: {parity:?}");
                let options = RenderOptions { sort: SortMethod::None, ..options };
                let unsorted = draw(&gpu, options, &scene, &camera).image;
                assert!(!Parity::of(&cpu, &unsorted, 0.0).holds(), "no order passes");
            }
        }
    }
}

#[test]
fn a_device_that_cannot_is_an_error_and_a_texture_takes_no_bands() {
    let Some(gpu) = gpus("a_device_that_cannot_is_an_error_and_a_texture_takes_no_bands").into_iter().next() else {
        return;
    };
    let case = Case::new(grid(1000, Scheme::Six, 0.0), "value");
    let camera = frame_unit_cube(20.0, 30.0, 16, 16);
    let points = vec![BandPoint { value: 0.0, extinctions: vec![1.0; 3] }];
    let table = BandTable::new(["r", "g", "b"].map(String::from).to_vec(), points).unwrap();
    let scene = case.scene(&smooth()).with_bands(table);

    let (device, _) = gpu.device_and_queue();
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 16, height: 16, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let options = RenderOptions { model: Model::Absorption, ..RenderOptions::default() };
    let mut renderer = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES);
    let error = renderer.render_to_texture(&scene, &camera, &texture).unwrap_err().to_string();
    assert!(error.contains("a texture holds no bands"), "{error}");

    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    for adapter in pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all())) {
        let required_features = adapter.features() & wgpu::Features::FLOAT32_BLENDABLE;
        let descriptor = wgpu::DeviceDescriptor {
            required_features,
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
        let plain = Gpu::from_device(device, queue);
        assert!(!plain.blends_by_channel());
        let mut renderer = Renderer::on_gpu(RenderOptions::default(), plain, GpuCompositor::MEMORY_BYTES);
        let error = renderer.render(&scene, &camera).unwrap_err().to_string();
        assert!(error.starts_with("--backend gpu: ") && error.contains("--bands"), "{error}");
    }
}
