//! Whole frames: `frame/<mesh>/<model>`, from a camera to the finished picture in memory, a new view each time.
//!
//! `frame/hexahedra`: curvilinear hexahedra whole and split into tetrahedra, 5 to 10 pixels a cell, on the processor and on
//! whatever GPU there is.
//!
//! Left out: reading and generating meshes, and encoding pictures. With `CELLFAN_BENCH_LARGE` set, also meshes of
//! 1.3 million cells at 1024×1024.

mod support;

use cellfan::generate::Kind;
use cellfan::io::StructuredMesh;
use cellfan::{Dataset, Model, Points, RenderOptions, Rendered, Renderer, Scene, SortMethod, TransferFunction};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

use support::{Mesh, framing, transfer};

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

/// A quarter of a shell of n³ cells, twisted about its axis.
fn curvilinear(n: u32) -> StructuredMesh {
    let side = n as usize + 1;
    let share = |i: usize| i as f64 / f64::from(n);
    let point = |i: usize| {
        let (x, y, z) = (share(i % side), share(i / side % side), share(i / side / side));
        let (angle, radius) = (std::f64::consts::FRAC_PI_2 * x + 0.8 * z, 0.4 + 0.6 * y);
        [radius * angle.cos(), radius * angle.sin(), z]
    };
    let points = Points::F64((0..side.pow(3)).map(point).collect());
    StructuredMesh::new(&[[side; 3]], points, Vec::new()).expect("the points are as many as the dimensions say")
}

/// Curvilinear hexahedra as they are and split, on each backend; the same order, and the same picture but for the field
/// inside a cell, which cell data has not.
fn hexahedra(criterion: &mut Criterion) {
    let (n, side_px) = if std::env::var_os("CELLFAN_BENCH_LARGE").is_some() { (100, 400) } else { (40, 160) };
    let scene = |dataset: Dataset| {
        let field = dataset.homogeneous_field();
        Scene::new(dataset, field, &TransferFunction::constant([0.9, 0.7, 0.5], 1.5).expect("it is valid"))
    };
    let whole = curvilinear(n).into_whole_dataset().expect("it is valid");
    let cells = whole.cells() as u64;
    let views: Vec<_> = (0..32).map(|i| framing(&whole, f64::from(i) * 360.0 / 32.0, side_px)).collect();
    let scenes = [("whole", scene(whole)), ("split", scene(curvilinear(n).into_dataset().expect("it is valid")))];
    let options = RenderOptions { sort: SortMethod::Centroid, ..RenderOptions::default() };
    let mut group = criterion.benchmark_group("frame/hexahedra");
    group.sample_size(10);
    group.throughput(Throughput::Elements(cells));
    for (backend, make) in backends() {
        let pictures = scenes.each_ref().map(|(cells, scene)| {
            let mut renderer = make(options);
            let first = renderer.render(scene, &views[0]).expect("the camera is valid").image;
            let mut frame = 0;
            group.bench_function(format!("{cells}/{backend}"), |bencher| {
                bencher.iter(|| {
                    frame += 1;
                    renderer.render(scene, &views[frame % views.len()]).expect("the camera is valid")
                });
            });
            first
        });
        let [a, b] = &pictures;
        assert!(a.covered([0.0; 4]) > a.pixels.len() as u64 / 10, "{backend}: nothing shows");
        let difference = a.difference(b, [0.0; 4]).expect("they are of one size");
        // A rasteriser may give a tetrahedron's outline to the next pixel.
        let is_one = if backend == "gpu" { difference.mean < 1e-4 } else { difference.max < 1e-4 };
        assert!(is_one, "{backend}: {difference:?}");
    }
    group.finish();
}

/// What makes a renderer on some backend.
type Make = Box<dyn Fn(RenderOptions) -> Renderer>;

/// The processor, and the GPU if there is one, with what makes their renderers.
fn backends() -> Vec<(&'static str, Make)> {
    let cpu: Make = Box::new(Renderer::new);
    [("cpu", cpu)].into_iter().chain(gpu().map(|gpu| ("gpu", gpu))).collect()
}

#[cfg(feature = "gpu")]
fn gpu() -> Option<Make> {
    use cellfan::backends::gpu::{Gpu, GpuCompositor};
    match Gpu::open(None) {
        Ok(gpu) => Some(Box::new(move |options| Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES))),
        Err(error) => {
            println!("no GPU is measured: {error}");
            None
        }
    }
}

#[cfg(not(feature = "gpu"))]
fn gpu() -> Option<Make> {
    None
}

criterion_group!(benches, frames, hexahedra);
criterion_main!(benches);
