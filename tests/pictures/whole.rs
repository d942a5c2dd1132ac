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
    let meshes = [("jittered", jittered(9, 0.2)), ("shell", shell()), ("mixed", mixed())];
    for ((mesh, cells), array) in meshes.iter().flat_map(|mesh| ["value", "cell_value"].map(|array| (mesh, array))) {
        let case = case(cells.clone(), array);
        for (view, camera) in four_views(160, 120) {
            for (name, transfer) in [("smooth", smooth()), ("stepped", stepped())] {
                let scene = Scene::new(case.dataset.clone(), case.field.clone(), &transfer);
                for (model, integral) in models() {
                    // The same order in all ways.
                    let options =
                        RenderOptions { model, integral, sort: SortMethod::Centroid, ..RenderOptions::default() };
                    let footprints = Renderer::new(options).render(&scene, &camera).unwrap().image;
                    let on_cpu = RenderOptions { cpu_method: CpuMethod::Fans, ..options };
                    let fans = Renderer::new(on_cpu).render(&scene, &camera).unwrap().image;
                    let on_gpus =
                        gpus.iter().map(|gpu| (gpu.adapter().to_string(), draw(gpu, options, &scene, &camera)));
                    for (way, image) in std::iter::once(("fans".to_owned(), fans)).chain(on_gpus) {
                        let parity = Parity::of(&footprints, &image, miss(model));
                        let line =
                            format!("{mesh:8} {array:10} {view:9} {name:8} {model:20} {integral:8} {parity:?} {way}");
                        println!("{line}");
                        if !parity.holds() {
                            failures.push(line);
                        }
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}
