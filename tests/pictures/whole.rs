//! Whole cells in three ways to one picture: footprints, fans on the processor, and every GPU.

use cellfan::{CpuMethod, RenderOptions, Renderer, Scene, SortMethod};

use crate::gpu::{draw, four_views, models};
use crate::gpus::gpus;
use crate::hexahedra::{case, jittered, mixed, twisted_shell};
use crate::meshes::{smooth, stepped};
use crate::parity::{Parity, miss};

#[test]
fn whole_cells_have_parity() {
    let gpus = gpus("whole_cells_have_parity");
    let mut failures = Vec::new();
    let shell = || twisted_shell([15, 4, 5], 1.2);
    let meshes = [
        ("jittered", jittered(6, 0.2), "value", smooth()),
        ("shell", shell(), "value", stepped()),
        ("mixed", mixed(), "value", smooth()),
        ("mixed", mixed(), "cell_value", stepped()),
    ];
    for (mesh, cells, array, transfer) in meshes {
        let case = case(cells, array);
        for (view, camera) in four_views(100, 75) {
            let scene = Scene::new(case.dataset.clone(), case.field.clone(), &transfer);
            for (model, integral) in models() {
                // The same order in all ways.
                let options = RenderOptions { model, integral, sort: SortMethod::Centroid, ..RenderOptions::default() };
                let footprints = Renderer::new(options).render(&scene, &camera).unwrap().image;
                let on_cpu = RenderOptions { cpu_method: CpuMethod::Fans, ..options };
                let fans = Renderer::new(on_cpu).render(&scene, &camera).unwrap().image;
                let on_gpus = gpus.iter().map(|gpu| (gpu.adapter().to_string(), draw(gpu, options, &scene, &camera)));
                for (way, mut image) in std::iter::once(("fans".to_owned(), fans)).chain(on_gpus) {
                    let parity = Parity::of(&footprints, &image, miss(model));
                    let line = format!("{mesh:8} {array:10} {view:9} {model:20} {integral:8} {parity:?} {way}");
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
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}
