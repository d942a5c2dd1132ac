//! `stage/composite`: the tile compositor, from bins to pixels, and the fans' rasteriser; all threads.
//!
//! Timed is the stage's own part of each frame, as the frame's profile has it.

use std::time::Duration;

use cellfan::generate::Kind;
use cellfan::{CpuMethod, Model, RenderOptions, Renderer, Scene};
use criterion::Criterion;

use crate::seen::{SIDE_PX, throughput};
use crate::support::{Mesh, transfer};

pub(crate) fn bench_composite(criterion: &mut Criterion) {
    let mesh = Mesh::generate(Kind::Delaunay, 100_000);
    let views: Vec<_> = (0..16).map(|i| mesh.camera(f64::from(i) * 22.5, SIDE_PX)).collect();
    let scene = Scene::new(mesh.dataset, mesh.field, &transfer());
    let mut group = criterion.benchmark_group("stage/composite");
    group.sample_size(10);
    for (name, cpu_method) in [("tiles", CpuMethod::Footprints), ("fans", CpuMethod::Fans)] {
        for model in [Model::EmissionAbsorption, Model::Absorption] {
            let mut renderer = Renderer::new(RenderOptions { model, cpu_method, ..RenderOptions::default() });
            let first = renderer.render(&scene, &views[0]).expect("the camera is valid");
            let stage = *first.profile.get("composite").expect("every frame is composited");
            throughput(&mut group, first.cells.drawn, (stage.bytes / first.cells.drawn) as usize);
            let mut frame = 0;
            group.bench_function(format!("{name}/{model}"), |b| {
                b.iter_custom(|frames| {
                    let mut elapsed = Duration::ZERO;
                    for _ in 0..frames {
                        frame += 1;
                        let rendered =
                            renderer.render(&scene, &views[frame % views.len()]).expect("the camera is valid");
                        let stage = rendered.profile.get("composite").expect("every frame is composited");
                        elapsed += Duration::from_secs_f64(stage.duration_ms * 1e-3);
                    }
                    elapsed
                });
            });
            let again = renderer.render(&scene, &views[0]).expect("the camera is valid");
            assert!(again.image == first.image, "{name}, {model}: a later frame differs");
            let miss = if model == Model::Absorption { [1.0; 4] } else { [0.0; 4] };
            assert!(first.image.covered(miss) > first.image.pixels.len() as u64 / 10, "{name}, {model}");
        }
    }
}
