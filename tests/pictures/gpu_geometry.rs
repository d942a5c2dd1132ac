//! Opaque geometry on every adapter: the processor's pictures, sent once, into textures too.

use cellfan::backends::gpu::GpuCompositor;
use cellfan::generate::Scheme;
use cellfan::geometry::GeometryOptions;
use cellfan::{Camera, Model, Region, RenderOptions, Renderer, SortMethod};

use crate::check::Case;
use crate::geometry::{cases, everything, with};
use crate::gpu::draw;
use crate::gpus::gpus;
use crate::meshes::{frame_unit_cube, grid, smooth, three_views};
use crate::parity::{Parity, miss};

/// As [`Parity::holds`]; of 7,000 pixels one on an outline, which a GPU places to 1/256 pixel, may be opaque or nothing.
fn holds(parity: &Parity) -> bool {
    parity.covered > 1000 && parity.mean <= 2e-4 && parity.within >= 0.9995
}

#[test]
fn geometry_has_parity_with_the_cpu() {
    let gpus = gpus("geometry_has_parity_with_the_cpu");
    let mut failures = Vec::new();
    for (mesh, case, transfer) in cases() {
        let scene = case.scene(&transfer);
        for (view, camera) in three_views(160, 120) {
            for (name, geometry) in everything() {
                for model in Model::ALL {
                    let options = RenderOptions { model, sort: SortMethod::Centroid, ..with(geometry) };
                    let cpu = Renderer::new(options).render(&scene, &camera).unwrap().image;
                    for gpu in &gpus {
                        let mut image = draw(gpu, options, &scene, &camera);
                        let parity = Parity::of(&cpu, &image, miss(model));
                        let line = format!("{mesh:12} {view:9} {name:8} {model:20} {parity:?}");
                        println!("{line}");
                        if !holds(&parity) {
                            failures.push(line);
                        }
                        // The comparison fails on a picture one level off, and on one whose rays do not end.
                        image.pixels.iter_mut().for_each(|pixel| pixel[2] += 1.0 / 255.0);
                        assert!(!holds(&Parity::of(&cpu, &image, miss(model))), "one level passes");
                        // From inside an opaque volume hides it, and a largest value what is behind it.
                        if view == "outside" && model != Model::Mip {
                            let options = RenderOptions { geometry: GeometryOptions::NONE, ..options };
                            let volume = draw(gpu, options, &scene, &camera);
                            assert!(!holds(&Parity::of(&cpu, &volume, miss(model))), "the volume alone passes");
                        }
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn lists_are_sent_once() {
    let case = Case::new(grid(3000, Scheme::Six, 0.2), "value");
    let (scene, other) = (case.scene(&smooth()), case.scene(&smooth()));
    let [_, _, (_, both)] = everything();
    for gpu in gpus("lists_are_sent_once") {
        let mut renderer = Renderer::on_gpu(with(both), gpu, GpuCompositor::MEMORY_BYTES);
        let mut frame = |scene, camera: &Camera| renderer.render(scene, camera).unwrap().geometry;
        let views = three_views(64, 48);
        let first = frame(&scene, &views[0].1);
        assert!(first.triangles > 0 && first.lines > 0 && first.points > 0, "{first:?}");
        assert_eq!(first.bytes, 36 * first.triangles + 24 * first.lines + 12 * first.points);
        assert_eq!(first.uploaded_bytes, first.bytes);
        // Other views and sizes, transfer functions, bring nothing new.
        for (_, camera) in &views {
            assert_eq!(frame(&scene, camera).uploaded_bytes, 0);
        }
        assert_eq!(frame(&scene, &frame_unit_cube(80.0, -10.0, 100, 20)).uploaded_bytes, 0);
        // Another mesh does.
        assert_eq!(frame(&other, &views[0].1).uploaded_bytes, first.bytes);
    }
}

#[test]
fn late_tiles_and_textures_show_geometry_too() {
    let case = Case::new(grid(3000, Scheme::Six, 0.2), "value");
    let (scene, camera) = (case.scene(&smooth()), frame_unit_cube(37.0, 22.0, 160, 120));
    let [_, _, (_, both)] = everything();
    let options = RenderOptions { sort: SortMethod::Exact, ..with(both) };
    let cpu = Renderer::new(options).render(&scene, &camera).unwrap().image;
    for gpu in gpus("late_tiles_and_textures_show_geometry_too") {
        let exact = draw(&gpu, options, &scene, &camera);
        let parity = Parity::of(&cpu, &exact, 0.0);
        assert!(holds(&parity), "{parity:?}");
        // The same in a part of the picture.
        let camera_of_part = Camera { region: Some(Region { x0: 37, y0: 21, x1: 118, y1: 67 }), ..camera.clone() };
        let part = draw(&gpu, options, &scene, &camera_of_part);
        let pixels = (0..46).flat_map(|y| (0..81).map(move |x| (x, y)));
        let off = pixels.filter(|&(x, y)| {
            let pairs = part.pixel(x, y).into_iter().zip(exact.pixel(37 + x, 21 + y));
            pairs.into_iter().any(|(a, b)| (a - b).abs() > 1e-4)
        });
        assert!(off.count() <= 4);
        let (device, _) = gpu.device_and_queue();
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 160, height: 120, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let mut renderer = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES);
        let drawn = renderer.render_to_texture(&scene, &camera, &texture).unwrap();
        assert!(drawn.geometry.uploaded_bytes > 0);
        // Lists count as memory of the device.
        let mut renderer = Renderer::on_gpu(options, gpu.clone(), 160 * 120 * 57 + 70_000);
        let refused = renderer.render(&scene, &camera).unwrap_err().to_string();
        assert!(refused.contains("--gpu-memory"), "{refused}");
    }
}
