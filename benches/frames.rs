//! Whole frames: `frame/<mesh>/<model>`, from a camera to the finished picture in memory, a new view each time.
//!
//! `frame/hexahedra`: curvilinear hexahedra whole and split into tetrahedra, 5 to 10 pixels a cell, on the processor and on
//! whatever GPU there is. `frame/bands`: four arrays of extinctions in one pass, and in a pass each. `frame/geometry`: a volume alone, with
//! its surface, edges and points, with triangles of another file, and with a picture of another program, on each backend.
//!
//! Left out: reading and generating meshes, and encoding pictures. With `CELLFAN_BENCH_LARGE` set, also meshes of
//! 1.3 million cells at 1024×1024.

mod support;

use std::sync::Arc;

use cellfan::columns::{Array, Association};
use cellfan::generate::Kind;
use cellfan::geometry::{GeometryOptions, TriangleMesh};
use cellfan::io::StructuredMesh;
use cellfan::optics::Output;
use cellfan::{
    CpuMethod, Dataset, Field, FieldSelection, Model, Points, RenderOptions, Rendered, Renderer, Scene, SortMethod,
    TransferFunction,
};
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

/// Rays from cell to cell beside footprints of the same views, two pictures that differ by rounding.
fn rays(criterion: &mut Criterion) {
    let is_large = std::env::var_os("CELLFAN_BENCH_LARGE").is_some();
    let (cells, side_px) = if is_large { (6_000_000, 1024) } else { (200_000, 200) };
    let mesh = Mesh::generate(Kind::Tets, cells);
    let views: Vec<_> = (0..32).map(|i| mesh.camera(f64::from(i) * 360.0 / 32.0, side_px)).collect();
    let drawn = mesh.dataset.tets.len() as u64;
    let scene = Scene::new(mesh.dataset, mesh.field, &transfer());
    let mut group = criterion.benchmark_group("frame/rays");
    group.sample_size(10).throughput(Throughput::Elements(drawn));
    let mut pictures = Vec::new();
    for (name, cpu_method) in [("footprints", CpuMethod::Footprints), ("rays", CpuMethod::Rays)] {
        let mut renderer = Renderer::new(RenderOptions { cpu_method, ..RenderOptions::default() });
        let first = renderer.render(&scene, &views[0]).expect("the camera is valid");
        check(&first, Model::EmissionAbsorption);
        pictures.push(first.image);
        let mut frame = 0;
        group.bench_function(format!("{name}/{drawn}"), |bencher| {
            bencher.iter(|| {
                frame += 1;
                renderer.render(&scene, &views[frame % views.len()]).expect("the camera is valid")
            });
        });
    }
    group.finish();
    let difference = pictures[0].difference(&pictures[1], [0.0; 4]).expect("they have one size");
    assert!(difference.max < 1e-3 && pictures[0] != pictures[1], "{difference:?}");
}

/// A quarter of a shell of n³ cells, twisted about its axis, with so many arrays of extinctions in cells.
fn curvilinear(n: u32, arrays: u32) -> StructuredMesh {
    let side = n as usize + 1;
    let share = |i: usize| i as f64 / f64::from(n);
    let point = |i: usize| {
        let (x, y, z) = (share(i % side), share(i / side % side), share(i / side / side));
        let (angle, radius) = (std::f64::consts::FRAC_PI_2 * x + 0.8 * z, 0.4 + 0.6 * y);
        [radius * angle.cos(), radius * angle.sin(), z]
    };
    let points = Points::F64((0..side.pow(3)).map(point).collect());
    let array = |k: u32| Array {
        name: format!("band{k}"),
        association: Association::Cell,
        components: 1,
        values: (0..n.pow(3)).map(|cell| f64::from(cell * (2 * k + 3) % 101 + 1) / 100.0).collect::<Vec<_>>().into(),
    };
    StructuredMesh::new(&[[side; 3]], points, (0..arrays).map(array).collect())
        .expect("the points are as many as the dimensions say")
}

/// Curvilinear hexahedra as they are and split, on each backend: the order that is chosen for each on the processor, one for both on
/// a GPU; the same picture but for the field inside a cell, which cell data has not.
fn hexahedra(criterion: &mut Criterion) {
    let (n, side_px) = if std::env::var_os("CELLFAN_BENCH_LARGE").is_some() { (100, 400) } else { (40, 160) };
    let scene = |dataset: Dataset| {
        let field = dataset.homogeneous_field();
        Scene::new(dataset, field, &TransferFunction::constant([0.9, 0.7, 0.5], 1.5).expect("it is valid"))
    };
    let whole = curvilinear(n, 0).into_whole_dataset().expect("it is valid");
    let cells = whole.cells() as u64;
    let views: Vec<_> = (0..32).map(|i| framing(&whole, f64::from(i) * 360.0 / 32.0, side_px)).collect();
    let scenes = [("whole", scene(whole)), ("split", scene(curvilinear(n, 0).into_dataset().expect("it is valid")))];
    let mut group = criterion.benchmark_group("frame/hexahedra");
    group.sample_size(10);
    group.throughput(Throughput::ElementsAndBytes { elements: cells, bytes: 32 * cells });
    for (backend, make) in backends() {
        let sort = if backend == "gpu" { SortMethod::Centroid } else { SortMethod::Auto };
        let options = RenderOptions { sort, ..RenderOptions::default() };
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

/// Four arrays of extinctions in cells: one pass draws all, as they come from [`Scene::with_band_arrays`], or one each.
fn bands(criterion: &mut Criterion) {
    let (n, side_px) = if std::env::var_os("CELLFAN_BENCH_LARGE").is_some() { (100, 1024) } else { (32, 256) };
    let mut group = criterion.benchmark_group("frame/bands");
    group.sample_size(10);
    let cells = u64::from(n).pow(3);
    // Eight corners and four extinctions.
    group.throughput(Throughput::ElementsAndBytes { elements: cells, bytes: (32 + 16) * cells });
    let split = curvilinear(n, 4).into_dataset().expect("it is valid");
    let whole = curvilinear(n, 4).into_whole_dataset().expect("it is valid");
    for (cells, dataset) in [("whole", whole), ("split", split)] {
        let views: Vec<_> = (0..32).map(|i| framing(&dataset, f64::from(i) * 360.0 / 32.0, side_px)).collect();
        let field = |k: u32| dataset.field(&FieldSelection::parse(&format!("band{k}"), &dataset.arrays));
        let fields: Vec<Field> = (0..4).map(|k| field(k).expect("it is there")).collect();
        let scene = |fields: &[Field]| {
            let dark = TransferFunction::constant([0.0; 3], 0.0).expect("it is valid");
            let scene = Scene::new(dataset.clone(), fields[0].clone(), &dark);
            scene.with_band_arrays(fields.to_vec()).expect("they are extinctions")
        };
        let options = RenderOptions { model: Model::Absorption, output: Output::Depth, ..RenderOptions::default() };
        let ways = [("one pass", vec![scene(&fields)]), ("a pass each", fields.chunks(1).map(scene).collect())];
        let [together, each] = ways.map(|(way, scenes)| {
            let mut renderer = Renderer::new(options);
            let mut draw = |view: usize| -> Vec<Rendered> {
                let draw = |scene| renderer.render(scene, &views[view]).expect("the camera is valid");
                scenes.iter().map(draw).collect()
            };
            let first = draw(0);
            let mut frame = 0;
            group.bench_function(format!("{cells}/{way}"), |bencher| {
                bencher.iter(|| {
                    frame += 1;
                    draw(frame % views.len())
                });
            });
            first
        });
        assert!(together[0].image.covered([0.0; 4]) > u64::from(side_px).pow(2) / 10, "{cells}: nothing shows");
        for (k, alone) in each.iter().enumerate() {
            let mut pairs = together[0].image.pixels.iter().zip(&alone.image.pixels);
            assert!(
                pairs.all(|(together, alone)| together[k].to_bits() == alone[0].to_bits()),
                "{cells}: band {k} differs"
            );
        }
    }
    group.finish();
}

/// A sphere of triangles around the middle of `dataset`, half as large, with normals.
fn sphere(dataset: &Dataset) -> TriangleMesh {
    let (rings, sides) = (64_u32, 128_u32);
    let (center, radius) = (dataset.origin + dataset.bounds.center(), 0.2 * dataset.diagonal_world());
    let outward = |i: u32| {
        let (ring, side) = (f64::from(i / sides), f64::from(i % sides));
        let (polar, around) = (ring / f64::from(rings), 2.0 * side / f64::from(sides));
        let [(sin, cos), (y, x)] = [polar, around].map(|turns| (turns * std::f64::consts::PI).sin_cos());
        [sin * x, sin * y, cos]
    };
    let vertices = (0..(rings + 1) * sides).map(outward);
    let quads = (0..rings * sides).map(|a| [a, a - a % sides + (a + 1) % sides]);
    TriangleMesh {
        positions: vertices.clone().map(|n| [0, 1, 2].map(|k| center[k] + radius * n[k])).collect(),
        triangles: quads.flat_map(|[a, b]| [[a, b, b + sides], [a, b + sides, a + sides]]).collect(),
        normals: vertices.map(|n| n.map(|component| component as f32)).collect(),
        colors: Vec::new(),
    }
}

/// Opaque geometry: lists are made before the timer starts, and on a GPU sent; they are drawn anew in each frame.
fn geometry(criterion: &mut Criterion) {
    let (cells, side_px) =
        if std::env::var_os("CELLFAN_BENCH_LARGE").is_some() { (1_300_000, 1024) } else { (50_000, 256) };
    let mesh = Mesh::generate(Kind::Tets, cells);
    let views: Vec<_> = (0..32).map(|i| mesh.camera(f64::from(i) * 360.0 / 32.0, side_px)).collect();
    let drawn = mesh.dataset.tets.len() as u64;
    let volume = Scene::new(mesh.dataset, mesh.field, &transfer());
    let (mut triangles, mut picture) = (volume.clone(), volume.clone());
    triangles.add_triangles(&sphere(volume.dataset()), None).expect("it is near");
    let all = GeometryOptions {
        surface: Some([0.5; 3]),
        edges: Some([0.1; 3]),
        points: Some([1.0; 3]),
        ..Default::default()
    };
    let with = |geometry| RenderOptions { geometry, depth: true, ..RenderOptions::default() };
    // What shows the sphere is what it was drawn to.
    let rendered =
        Renderer::new(with(GeometryOptions::NONE)).render(&triangles, &views[0]).expect("the camera is valid");
    picture.set_external(rendered.depth_image().map(Arc::new));
    let mut group = criterion.benchmark_group("frame/geometry");
    group.sample_size(10);
    group.throughput(Throughput::Elements(drawn));
    for (backend, make) in backends() {
        let sort = if backend == "gpu" { SortMethod::Centroid } else { SortMethod::Auto };
        let mut pictures = Vec::new();
        for (name, scene, geometry) in [
            ("none", &volume, GeometryOptions::NONE),
            ("all", &volume, all),
            ("triangles", &triangles, GeometryOptions::NONE),
            ("picture", &picture, GeometryOptions::NONE),
        ] {
            let mut renderer = make(RenderOptions { sort, depth: false, ..with(geometry) });
            pictures.push(renderer.render(scene, &views[0]).expect("the camera is valid").image);
            let mut frame = 0;
            group.bench_function(format!("{name}/{backend}"), |bencher| {
                bencher.iter(|| {
                    frame += 1;
                    renderer.render(scene, &views[frame % views.len()]).expect("the camera is valid")
                });
            });
        }
        for drawn in &pictures[1..] {
            let difference = drawn.difference(&pictures[0], [0.0; 4]).expect("they are of one size");
            assert!(difference.mean > 1e-3, "{backend}: it does not show: {difference:?}");
        }
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

criterion_group!(benches, frames, rays, hexahedra, bands, geometry);
criterion_main!(benches);
