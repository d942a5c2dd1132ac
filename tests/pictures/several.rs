//! Several meshes in one picture: one order for all cells, no seam between meshes that touch, overlaps as they are defined.

use std::path::PathBuf;

use cellfan::generate::Scheme;
use cellfan::io::{self, Compression, Mesh, StructuredMesh, UnstructuredMesh, write_vtu};
use cellfan::profile::Exactness;
use cellfan::{
    Camera, Dataset, FieldSelection, Image, Model, Points, RenderOptions, Renderer, Scene, SortMethod, TetMesh,
    TransferFunction,
};
use glam::DVec3;

use crate::check::Case;
use crate::meshes::{Random, chord_of_unit_cube, grid, moved, point, random_delaunay, smooth, three_views};
use crate::topological::{combs, part, rings};

fn unstructured(mesh: &TetMesh) -> Mesh {
    UnstructuredMesh::from_tets(mesh).into()
}

fn join(meshes: impl IntoIterator<Item = Mesh>) -> Mesh {
    Mesh::join(meshes.into_iter().enumerate().map(|(i, mesh)| (PathBuf::from(i.to_string()), mesh)).collect()).unwrap()
}

fn case(dataset: Dataset) -> Case {
    let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays)).unwrap();
    Case::of(dataset, field)
}

/// The two as pictures, the one drawn over the other.
fn one_after_the_other(meshes: [&TetMesh; 2], transfer: &TransferFunction, camera: &Camera) -> Image {
    let [mut over, under] = meshes.map(|mesh| {
        let dataset = Dataset::from_tets(mesh.clone()).unwrap();
        let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays)).unwrap();
        Renderer::new(RenderOptions::default()).render(&Scene::new(dataset, field, transfer), camera).unwrap().image
    });
    for (over, under) in over.pixels.iter_mut().zip(&under.pixels) {
        let through = 1.0 - over[3];
        *over = std::array::from_fn(|k| over[k] + through * under[k]);
    }
    over
}

/// Two files whose cells hide each other: each is in front somewhere.
#[test]
fn meshes_of_two_files_are_in_one_order() {
    let center = DVec3::splat(0.5);
    let shell = |p: DVec3| p.distance(center) > 0.4;
    let ball = |p: DVec3| p.distance(center) < 0.2;
    let upper = |p: DVec3| p.z > 0.8 || ((p.x * 7.0).floor() as i32 % 2 != 0 && p.z > 0.2);
    let pairs: [(&str, [TetMesh; 2]); 3] = [
        ("rings", {
            let all = random_delaunay(30_000);
            [true, false].map(|first| part(all.clone(), |p| rings(p) && ring_of(p) == first))
        }),
        ("combs", {
            let all = random_delaunay(8000);
            [true, false].map(|first| part(all.clone(), |p| combs(p) && upper(p) == first))
        }),
        ("in a cavity", [part(random_delaunay(12_000), shell), part(random_delaunay(11_000), ball)]),
    ];
    let transfer = smooth().scaled_extinction(3.0).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (name, meshes) in pairs {
        let paths = [0, 1].map(|i| folder.path().join(format!("{name} {i}.vtu")));
        for (path, mesh) in paths.iter().zip(&meshes) {
            write_vtu(path, &UnstructuredMesh::from_tets(mesh), Compression::None).unwrap();
        }
        let case = case(io::open_all(&paths).unwrap());
        assert_eq!(case.dataset.tets.len(), meshes.iter().map(|mesh| mesh.tets.len()).sum::<usize>(), "{name}");
        for (view, camera) in three_views(96, 72) {
            let rays = case.all_rays(&camera);
            for sort in [SortMethod::Auto, SortMethod::Topological] {
                let rendered = case.render(RenderOptions { sort, ..RenderOptions::default() }, &transfer, &camera);
                let errors = rays.errors(&rendered.image, Model::EmissionAbsorption, &transfer, usize::MAX);
                println!("{name:12} {view:9} {sort:12} {errors} {:?}", rendered.order);
                assert_eq!(rendered.order.exactness, Exactness::Exact, "{name}, {view}, {sort}");
                assert!(errors.are_small() && errors.pixels > 500, "{name}, {view}, {sort}: {errors}");
            }
            // The control: neither mesh lies behind the other, but for an eye in the cavity.
            for order in [[0, 1], [1, 0]].into_iter().filter(|_| (name, view) != ("in a cavity", "inside")) {
                let image = one_after_the_other(order.map(|i| &meshes[i]), &transfer, &camera);
                let errors = rays.errors(&image, Model::EmissionAbsorption, &transfer, usize::MAX);
                assert!(errors.max > 0.01, "{name}, {view}: {errors}");
            }
        }
    }
}

/// Which of the two linked rings a place is in.
fn ring_of(p: DVec3) -> bool {
    let first = p - DVec3::new(0.35, 0.5, 0.5);
    (first.x.hypot(first.y) - 0.25).hypot(first.z) < 0.07
}

/// A grid of the unit cube in which inner points are moved, two blocks that meet at x = 1/2 or so, the axes of the second
/// turned so that its points run another way.
fn two_blocks(n: usize, jitter: f64, precision: fn(Vec<DVec3>) -> Points) -> [StructuredMesh; 2] {
    let mut random = Random(5);
    let mut place = |p: DVec3| {
        let inner = |x: f64| if x > 1e-9 && x < 1.0 - 1e-9 { jitter / n as f64 } else { 0.0 };
        let mut shift = || 2.0 * f64::from(random.below(1 << 30)) / f64::from(1 << 30) - 1.0;
        p + DVec3::new(inner(p.x) * shift(), inner(p.y) * shift(), inner(p.z) * shift())
    };
    let grid = (0..=n).flat_map(|k| (0..=n).flat_map(move |j| (0..=n).map(move |i| [i, j, k])));
    let all: Vec<DVec3> = grid.map(|ijk| place(DVec3::from_array(ijk.map(|c| c as f64 / n as f64)))).collect();
    let at = |i: usize, j: usize, k: usize| all[i + (n + 1) * (j + (n + 1) * k)];
    let half = n / 2;
    let first = (0..=n).flat_map(|k| (0..=n).flat_map(move |j| (0..=half).map(move |i| [i, j, k])));
    // k fastest, then i, then j backwards: the lowest corner of a face between the blocks is another one.
    let second = (0..=n).rev().flat_map(|j| (half..=n).flat_map(move |i| (0..=n).map(move |k| [i, j, k])));
    let block = |dims: [usize; 3], points: Vec<[usize; 3]>| {
        let points = points.into_iter().map(|[i, j, k]| at(i, j, k)).collect();
        StructuredMesh::new(&[dims], precision(points), Vec::new()).unwrap()
    };
    [block([half + 1, n + 1, n + 1], first.collect()), block([n + 1, n - half + 1, n + 1], second.collect())]
}

fn single(points: Vec<DVec3>) -> Points {
    Points::F32(points.into_iter().map(|p| p.as_vec3().to_array()).collect())
}

fn double(points: Vec<DVec3>) -> Points {
    Points::F64(points.into_iter().map(|p| p.to_array()).collect())
}

/// The largest error of a homogeneous cube's opacity at any pixel, 1 − e^(−κL) for the chord L.
fn largest_error(dataset: &Dataset, camera: &Camera) -> f64 {
    let extinction = 2.0;
    let transfer = TransferFunction::new(vec![point(0.0, [0.9, 0.7, 0.5], extinction)]).unwrap();
    let scene = Scene::new(dataset.clone(), dataset.homogeneous_field(), &transfer);
    let image = Renderer::new(RenderOptions::default()).render(&scene, camera).unwrap().image;
    let pixels = (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (x, y)));
    let error = |(x, y)| {
        let expected = -(-extinction * chord_of_unit_cube(camera, x, y, 0.0)).exp_m1();
        (f64::from(image.pixel(x, y)[3]) - expected).abs()
    };
    pixels.map(error).fold(0.0, f64::max)
}

#[test]
fn blocks_that_touch_have_no_seam() {
    for jitter in [0.0, 0.12] {
        for (precision, points) in [("single", single as fn(Vec<DVec3>) -> Points), ("double", double)] {
            let blocks = || two_blocks(12, jitter, points);
            let [first, second] = blocks();
            let listed = join([second.into(), UnstructuredMesh::empty().into()]);
            assert!(matches!(listed, Mesh::Unstructured(_)));
            let datasets = [
                ("whole blocks", join(blocks().map(Mesh::from)).into_whole_dataset().unwrap()),
                ("split blocks", join(blocks().map(Mesh::from)).into_dataset().unwrap()),
                ("a block and listed cells", join([first.into(), listed]).into_whole_dataset().unwrap()),
            ];
            for (view, camera) in three_views(160, 120) {
                for (kind, dataset) in &datasets {
                    let error = largest_error(dataset, &camera);
                    println!("jitter {jitter}, {precision}, {kind:24}, {view:9} {error:.1e}");
                    assert!(error < 1e-5, "jitter {jitter}, {precision}, {kind}, {view}: {error:.1e}");
                }
                // The control: blocks that are cut one by one do not agree on the diagonals between them.
                let apart = join(blocks().map(|block| unstructured(&block.into_tets().unwrap())));
                let error = largest_error(&apart.into_dataset().unwrap(), &camera);
                assert!((error > 1e-3) == (jitter > 0.0), "jitter {jitter}, {precision}, {view}: {error:.1e}");
            }
        }
    }
}

/// Cells that overlap: each is drawn whole, and where a ray meets two at once, the one that it enters first comes first.
#[test]
fn overlapping_meshes_are_drawn_by_entry_whichever_comes_first() {
    let transfer = smooth().scaled_extinction(2.0).unwrap();
    let still = random_delaunay(3000);
    let turned =
        moved(grid(2500, Scheme::Six, 0.2), |p| DVec3::new(0.31, 0.27, 0.23) + DVec3::new(p.y, p.z, p.x) * 0.61);
    let both = |order: [&TetMesh; 2]| case(join(order.map(unstructured)).into_dataset().unwrap());
    let (forth, back) = (both([&still, &turned]), both([&turned, &still]));
    for (view, camera) in three_views(96, 72) {
        let rays = forth.all_rays(&camera);
        for model in Model::ALL {
            let options = RenderOptions { model, ..RenderOptions::default() };
            let (a, b) = (forth.render(options, &transfer, &camera), back.render(options, &transfer, &camera));
            let difference = a.image.difference(&b.image, [0.0; 4]).unwrap();
            let errors = rays.errors(&a.image, model, &transfer, usize::MAX);
            println!("{view:9} {model:20} {errors} {:?}", a.order);
            // The reference defines it: segments by entry, each whole.
            assert!(errors.are_small() && errors.pixels > 2000, "{view}, {model}: {errors}");
            assert!(difference.max <= 1e-6, "{view}, {model}: {difference:?}");
            if model == Model::EmissionAbsorption {
                assert!(a.order.violations > Some(0), "{view}: {:?}", a.order);
            }
        }
        // A graph of cells presumes that they are disjoint; the fragments show it.
        let options = RenderOptions { sort: SortMethod::Topological, ..RenderOptions::default() };
        let rendered = forth.render(options, &transfer, &camera);
        let errors = rays.errors(&rendered.image, Model::EmissionAbsorption, &transfer, usize::MAX);
        println!("{view:9} topological {errors} {:?}", rendered.order);
        assert!(rendered.order.violations > Some(1000) && errors.max > 0.01, "{view}: {errors}");
    }
}
