//! The same bytes for any number of threads, and from frame to frame.

use cellfan::generate::Scheme;
use cellfan::{CpuMethod, Image, Model, RenderOptions, Renderer};

use crate::check::Case;
use crate::meshes::{grid, smooth, three_views};

/// Bits, so that NaN would be equal to itself and 0 differ from −0.
fn bits(image: &Image) -> Vec<[u32; 4]> {
    image.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    // More than two blocks of cells, the order not the power order everywhere.
    let mesh = grid(12_000, Scheme::Six, 0.25);
    let draw = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let case = Case::new(mesh.clone(), "value");
            let mut images = Vec::new();
            for (view, camera) in three_views(170, 130) {
                for model in Model::ALL {
                    for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays, CpuMethod::Fans] {
                        let options = RenderOptions { model, cpu_method, ..RenderOptions::default() };
                        let image = case.render(options, &smooth(), &camera).image;
                        images.push((format!("{view} {model} {cpu_method:?}"), bits(&image)));
                    }
                }
            }
            images
        })
    };
    let one = draw(1);
    assert!(one.iter().all(|(_, image)| image.iter().any(|pixel| *pixel != image[0])), "blank");
    for threads in [2, 3, 7] {
        for ((what, expected), (_, found)) in one.iter().zip(draw(threads)) {
            let differ = expected.iter().zip(&found).filter(|(a, b)| a != b).count();
            assert_eq!(differ, 0, "{what}: {differ} pixels differ with {threads} threads");
        }
    }
}

#[test]
fn the_first_frame_is_the_second_also_after_another_view() {
    let case = Case::new(grid(6000, Scheme::Five, 0.25), "value");
    let mut scene = case.scene(&smooth());
    let [(_, outside), (_, inside), (_, parallel)] = three_views(150, 90);
    // Another size too: fewer tiles, then more.
    let small = cellfan::Camera { width: 40, height: 33, ..inside.clone() };
    for model in Model::ALL {
        for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays, CpuMethod::Fans] {
            let mut renderer = Renderer::new(RenderOptions { model, cpu_method, ..RenderOptions::default() });
            let first = bits(&renderer.render(&scene, &outside).unwrap().image);
            assert_eq!(bits(&renderer.render(&scene, &outside).unwrap().image), first, "{model} {cpu_method:?}");
            let mut others = Vec::new();
            for other in [&inside, &small, &parallel] {
                others.push(bits(&renderer.render(&scene, other).unwrap().image));
                let again = bits(&renderer.render(&scene, &outside).unwrap().image);
                assert!(again == first, "{model} {cpu_method:?}: the picture changed after another view");
            }
            assert_ne!(others[0], first);
            // A fresh renderer agrees with the used one.
            let mut fresh = Renderer::new(RenderOptions { model, cpu_method, ..RenderOptions::default() });
            assert!(bits(&fresh.render(&scene, &parallel).unwrap().image) == others[2], "{model} {cpu_method:?}");
            // Another transfer function and back.
            scene.set_transfer(&crate::meshes::steep());
            let steep = bits(&renderer.render(&scene, &outside).unwrap().image);
            scene.set_transfer(&smooth());
            assert_ne!(steep, first);
            assert!(bits(&renderer.render(&scene, &outside).unwrap().image) == first, "{model} {cpu_method:?}");
        }
    }
}
