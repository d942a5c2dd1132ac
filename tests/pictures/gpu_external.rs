//! External pictures and triangles on every adapter: the processor's pictures, depths and bands.

use cellfan::backends::gpu::GpuCompositor;
use cellfan::generate::Scheme;
use cellfan::geometry::{GeometryOptions, TriangleMesh};
use cellfan::optics::{BandPoint, BandTable};
use cellfan::{Model, RenderOptions, Rendered, Renderer, Scene, SortMethod};

use crate::check::Case;
use crate::external::{composited, slope};
use crate::geometry::with;
use crate::gpus::gpus;
use crate::meshes::{grid, smooth, three_views};
use crate::parity::{Parity, miss};

fn holds(parity: &Parity) -> bool {
    parity.covered > 1000 && parity.mean <= 2e-4 && parity.within >= 0.9995
}

/// A saddle through the unit cube and out of it, with colours and normals.
fn saddle() -> TriangleMesh {
    let at = |i: u32| f64::from(i) / 8.0;
    let vertices = || (0..9_u32).flat_map(|j| (0..9_u32).map(move |i| (at(i) * 3.0 - 1.0, at(j) * 3.0 - 1.0)));
    let height = |(x, y): (f64, f64)| 0.5 + 0.4 * (x - 0.5) * (y - 0.5);
    let quads = (0..8_u32).flat_map(|j| (0..8_u32).map(move |i| 9 * j + i));
    TriangleMesh {
        positions: vertices().map(|(x, y)| [x, y, height((x, y))]).collect(),
        triangles: quads.flat_map(|a| [[a, a + 1, a + 10], [a, a + 10, a + 9]]).collect(),
        normals: vertices().map(|(x, y)| [-0.4 * (y - 0.5), -0.4 * (x - 0.5), 1.0].map(|n| n as f32)).collect(),
        colors: vertices().map(|(x, y)| [0.5 + 0.2 * x, 0.5 + 0.2 * y, 0.3].map(|c| c as f32)).collect(),
    }
}

#[test]
fn external_pictures_and_triangles_have_parity_with_the_cpu() {
    let gpus = gpus("external_pictures_and_triangles_have_parity_with_the_cpu");
    let case = Case::new(grid(384, Scheme::Six, 0.2), "value");
    let edges = GeometryOptions { edges: Some([0.9, 0.8, 0.1]), ..GeometryOptions::default() };
    let mut failures = Vec::new();
    for (view, camera) in three_views(160, 120) {
        let plain = case.scene(&smooth());
        let picture = composited(&plain, &slope(&camera));
        let mut triangles = plain.clone();
        triangles.add_triangles(&saddle(), None).unwrap();
        let mut both = picture.clone();
        both.add_triangles(&TriangleMesh { colors: Vec::new(), ..saddle() }, Some([0.2, 0.9, 0.4])).unwrap();
        for (name, scene, geometry) in [
            ("picture", &picture, GeometryOptions::NONE),
            ("triangles", &triangles, GeometryOptions::NONE),
            ("all", &both, edges),
        ] {
            for model in Model::ALL {
                let options = RenderOptions { model, depth: true, sort: SortMethod::Centroid, ..with(geometry) };
                let cpu = Renderer::new(options).render(scene, &camera).unwrap();
                for gpu in &gpus {
                    let render = |scene: &Scene| -> Rendered {
                        let mut renderer = Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES);
                        renderer.render(scene, &camera).unwrap()
                    };
                    let mut drawn = render(scene);
                    let parity = Parity::of(&cpu.image, &drawn.image, miss(model));
                    let line = format!("{view:9} {name:9} {model:20} {parity:?}");
                    println!("{line}");
                    if !holds(&parity) {
                        failures.push(line);
                    }
                    let depths = cpu.depth_world.as_ref().unwrap().iter().zip(drawn.depth_world.as_ref().unwrap());
                    let off = depths.filter(|(a, b)| a != b && (*a - *b).abs() > 1e-4 * a.abs()).count();
                    if off > 8 {
                        failures.push(format!("{view:9} {name:9} {model:20} {off} depths differ"));
                    }
                    // The comparison fails on a picture one level off, and on the volume alone.
                    drawn.image.pixels.iter_mut().for_each(|pixel| pixel[2] += 1.0 / 255.0);
                    assert!(!holds(&Parity::of(&cpu.image, &drawn.image, miss(model))), "one level passes");
                    if view == "outside" && model != Model::Mip {
                        assert!(
                            !holds(&Parity::of(&cpu.image, &render(&plain).image, miss(model))),
                            "the volume passes"
                        );
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn triangles_are_sent_once_and_pictures_each_frame() {
    let case = Case::new(grid(384, Scheme::Six, 0.2), "value");
    for gpu in gpus("triangles_are_sent_once_and_pictures_each_frame") {
        let [(_, camera), ..] = three_views(64, 48);
        let mut scene = composited(&case.scene(&smooth()), &slope(&camera));
        scene.add_triangles(&saddle(), None).unwrap();
        let mut renderer = Renderer::on_gpu(RenderOptions::default(), gpu, GpuCompositor::MEMORY_BYTES);
        let mut sent = || renderer.render(&scene, &camera).unwrap().geometry.uploaded_bytes;
        let (triangles, picture) = (128 * (36 + 72), 64 * 48 * 16);
        assert_eq!([sent(), sent(), sent()], [triangles + picture, picture, picture]);
    }
}

#[test]
fn bands_of_light_end_on_what_is_opaque() {
    let case = Case::new(grid(48, Scheme::Six, 0.2), "value");
    let extinctions = |scale: f64| (1..6).map(|k| scale * f64::from(k)).collect();
    let table = vec![
        BandPoint { value: 0.0, extinctions: extinctions(0.3) },
        BandPoint { value: 1.0, extinctions: extinctions(2.0) },
    ];
    let names = ["a", "b", "c", "d", "e"].map(str::to_owned).to_vec();
    let [(_, camera), ..] = three_views(120, 90);
    let scene = case.scene(&smooth()).with_bands(BandTable::new(names, table).unwrap());
    let scene = composited(&scene, &slope(&camera));
    let options = with(GeometryOptions { edges: Some([0.9, 0.8, 0.1]), ..GeometryOptions::default() });
    let cpu = Renderer::new(options).render(&scene, &camera).unwrap();
    for gpu in gpus("bands_of_light_end_on_what_is_opaque") {
        if !gpu.blends_by_channel() {
            continue;
        }
        let drawn = Renderer::on_gpu(options, gpu, GpuCompositor::MEMORY_BYTES).render(&scene, &camera).unwrap();
        let parity = Parity::of(&cpu.image, &drawn.image, 0.0);
        assert!(holds(&parity), "{parity:?}");
        let pairs = cpu.bands.as_ref().unwrap().values.iter().zip(&drawn.bands.as_ref().unwrap().values);
        let off = pairs.filter(|(a, b)| (*a - *b).abs() > 2e-3).count();
        assert!(off <= 10, "{off} values of bands differ");
    }
}
