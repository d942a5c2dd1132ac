//! Whole frames: `frame/<mesh>/<model>`, from a camera to the finished picture in memory, a new view each time.
//!
//! Left out: reading and generating meshes, and encoding pictures. With `CELLFAN_BENCH_LARGE` set, also meshes of
//! 1.3 million cells at 1024×1024.

mod support;

use cellfan::generate::Kind;
use cellfan::{Model, RenderOptions, Rendered, Renderer, Scene};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

use support::{Mesh, transfer};

/// Every cell is accounted for, the picture shows something, and its values are possible.
fn check(rendered: &Rendered, model: Model) {
    let cells = &rendered.cells;
    assert_eq!(
        cells.total,
        cells.drawn + cells.culled_transparent + cells.culled_outside + cells.degenerate + cells.invalid
    );
    let miss = if model == Model::Absorption { [1.0; 4] } else { [0.0; 4] };
    let share = rendered.image.covered(miss) as f64 / rendered.image.pixels.len() as f64;
    assert!(share > 0.1 && share < 0.9, "{share} of the picture is covered");
    let is_possible = |&channel: &f32| channel.is_finite() && channel >= -1e-5;
    assert!(rendered.image.pixels.iter().flatten().all(is_possible));
    if model != Model::Emission {
        assert!(rendered.image.pixels.iter().all(|pixel| pixel[3] <= 1.0));
    }
}

fn frames(criterion: &mut Criterion) {
    let mut sizes = vec![(100_000, 512)];
    if std::env::var_os("CELLFAN_BENCH_LARGE").is_some() {
        sizes.push((1_300_000, 1024));
    }
    for (cells, side_px) in sizes {
        for kind in [Kind::Tets, Kind::Delaunay] {
            let mesh = Mesh::generate(kind, cells);
            let views: Vec<_> = (0..32).map(|i| mesh.camera(f64::from(i) * 360.0 / 32.0, side_px)).collect();
            let (name, drawn) = (kind.name(), mesh.dataset.tets.len() as u64);
            let scene = Scene::new(mesh.dataset, mesh.field, &transfer());
            let mut group = criterion.benchmark_group(format!("frame/{name}"));
            group.sample_size(10);
            group.throughput(Throughput::ElementsAndBytes {
                elements: drawn,
                bytes: drawn * size_of::<[u32; 4]>() as u64,
            });
            for model in Model::ALL {
                let mut renderer = Renderer::new(RenderOptions { model, ..RenderOptions::default() });
                let first = renderer.render(&scene, &views[0]).expect("the camera is valid");
                check(&first, model);
                let mut frame = 0;
                group.bench_function(format!("{model}/{drawn}"), |bencher| {
                    bencher.iter(|| {
                        frame += 1;
                        renderer.render(&scene, &views[frame % views.len()]).expect("the camera is valid")
                    });
                });
                // What the renderer keeps between frames changes no bit.
                let again = renderer.render(&scene, &views[0]).expect("the camera is valid");
                assert!(again.image == first.image, "{name}, {model}: a later frame differs");
            }
            group.finish();
        }
    }
}

criterion_group!(benches, frames);
criterion_main!(benches);
