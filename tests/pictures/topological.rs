//! Topological order on meshes that are not convex: every pixel against the reference, beside `exact`.

use cellfan::columns::Association;
use cellfan::generate::Scheme;
use cellfan::profile::Exactness;
use cellfan::{
    Camera, CpuMethod, Dataset, Field, Image, Model, RenderOptions, Renderer, Scene, SortMethod, TetMesh, io,
};
use glam::DVec3;

use crate::check::Case;
use crate::common::data_folder;
use crate::meshes::{grid, random_delaunay, smooth, three_views};

/// The cells of a mesh of the unit cube whose centroid is one that `is_kept`.
pub(crate) fn part(mesh: TetMesh, is_kept: impl Fn(DVec3) -> bool) -> TetMesh {
    let centroid = |tet: &[u32; 4]| tet.map(|v| mesh.points.get(v as usize)).into_iter().sum::<DVec3>() * 0.25;
    let kept = || (0..mesh.tets.len()).filter(|&i| is_kept(centroid(&mesh.tets[i])));
    let (tets, file_from_tet): (Vec<_>, Vec<_>) = kept().map(|i| (mesh.tets[i], mesh.file_from_tet[i])).unzip();
    TetMesh { tets: tets.into(), file_from_tet: file_from_tet.into(), ..mesh }
}

/// Two linked rings.
pub(crate) fn rings(p: DVec3) -> bool {
    let distance = |p: DVec3| p.x.hypot(p.y) - 0.25;
    let first = p - DVec3::new(0.35, 0.5, 0.5);
    let second = p - DVec3::new(0.65, 0.5, 0.5);
    distance(first).hypot(first.z) < 0.07 || distance(DVec3::new(second.x, second.z, 0.0)).hypot(second.y) < 0.07
}

/// Two combs, the teeth of each between those of the other.
pub(crate) fn combs(p: DVec3) -> bool {
    let tooth = (p.x * 7.0).floor() as i32 % 2 == 0;
    let is_in_gap = (p.x * 7.0).fract() < 0.25;
    p.z < 0.2 || p.z > 0.8 || (!is_in_gap && if tooth { p.z < 0.7 } else { p.z > 0.3 })
}

#[test]
fn meshes_that_are_not_convex_are_right_at_every_pixel() {
    // Parts of a Delaunay mesh have an order from everywhere.
    let center = DVec3::splat(0.5);
    let meshes = [
        ("cavity", part(random_delaunay(4000), |p| p.distance(center) > 0.3)),
        ("two parts", part(random_delaunay(4000), |p| (p.x + 0.3 * p.y - 0.65).abs() > 0.12)),
        ("rings", part(random_delaunay(30_000), rings)),
        ("combs", part(random_delaunay(8000), combs)),
        ("jittered grid", part(grid(4000, Scheme::Six, 0.2), |p| p.distance(center) > 0.3)),
    ];
    let transfer = smooth().scaled_extinction(3.0).unwrap();
    for (name, mesh) in meshes {
        let case = Case::new(mesh, "value");
        for (view, camera) in three_views(96, 72) {
            let rays = case.all_rays(&camera);
            for (sort, cpu_method) in [
                (SortMethod::Exact, CpuMethod::Footprints),
                (SortMethod::Topological, CpuMethod::Footprints),
                (SortMethod::Topological, CpuMethod::Fans),
                (SortMethod::Auto, CpuMethod::Fans),
            ] {
                let options = RenderOptions { sort, cpu_method, check_order: true, ..RenderOptions::default() };
                let rendered = case.render(options, &transfer, &camera);
                let errors = rays.errors(&rendered.image, Model::EmissionAbsorption, &transfer, usize::MAX);
                let order = rendered.order;
                println!("{name:14} {view:9} {sort:12} {cpu_method:?} {errors} {order:?}");
                assert_eq!(order.exactness, Exactness::Exact, "{name}, {view}, {sort}");
                assert!(errors.mean <= 1e-4, "{name}, {view}, {sort}: {errors}");
                // Fans place an outline to some thousandths of a pixel.
                assert!(errors.max <= 2e-3 || cpu_method == CpuMethod::Fans, "{name}, {view}, {sort}: {errors}");
                if sort != SortMethod::Exact {
                    assert_eq!((order.kind, order.cycles), ("topological", Some(0)), "{name}, {view}");
                    assert_eq!(order.misordered_pairs, Some(0), "{name}, {view}");
                    assert!(order.layers.unwrap() > 10, "{name}, {view}");
                }
            }
            // The control: the errors above would show an order that is not right.
            let options = RenderOptions { sort: SortMethod::None, ..RenderOptions::default() };
            let errors = rays.errors(
                &case.render(options, &transfer, &camera).image,
                Model::EmissionAbsorption,
                &transfer,
                usize::MAX,
            );
            assert!(!errors.are_small(), "{name}, {view}: no order passes");
        }
    }
}

/// Values from 0 to 1 that vary everywhere; the arrays of some files do not.
pub(crate) fn waves(dataset: &Dataset) -> Field {
    let scale = 40.0 / dataset.diagonal_world();
    let wave = |p: &[f32; 3]| 0.5 + 0.5 * (scale * f64::from(p[0] + 2.0 * p[1] + 3.0 * p[2])).sin() as f32;
    let mut field = dataset.homogeneous_field();
    (field.association, field.range) = (Association::Point, (0.0, 1.0));
    field.values = dataset.positions.iter().map(wave).collect::<Vec<f32>>().into();
    field.block_ranges.fill((0.0, 1.0));
    field
}

/// File, and whether its cells lie apart from everywhere: those of the crushed can push through each other.
const MESHES: &[(&str, bool)] = &[
    ("unstructured/multi_material_cylinder_plate.vtk", true),
    ("unstructured/wheelset.vtk", true),
    ("classic/spx.vtk", true),
    ("unstructured/can.vtu", false),
];

#[test]
fn real_meshes_are_those_of_the_exact_order() {
    let Some(folder) = data_folder("topological::real_meshes") else { return };
    for &(file, has_order) in MESHES {
        let dataset = io::open(&folder.join(file)).unwrap();
        let (corners, diagonal) = (dataset.corners_world(), dataset.diagonal_world());
        let field = waves(&dataset);
        let transfer = smooth().scaled_extinction(4.0 / diagonal).unwrap();
        let scene = Scene::new(dataset, field, &transfer);
        let mut cycles = 0;
        for (azimuth, elevation) in [(37.0, 22.0), (160.0, -35.0), (-80.0, 75.0)] {
            let camera = Camera::framing(&corners, azimuth, elevation, 320, 256);
            let draw = |sort| {
                let options = RenderOptions { sort, check_order: true, ..RenderOptions::default() };
                Renderer::new(options).render(&scene, &camera).unwrap()
            };
            let [exact, topological, none] = [SortMethod::Exact, SortMethod::Topological, SortMethod::None].map(draw);
            let order = topological.order;
            let off = |image: &Image| {
                let channels = image.pixels.iter().flatten().zip(exact.image.pixels.iter().flatten());
                channels.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
            };
            println!("{file:48} {azimuth:5} {:.1e} {order:?}", off(&topological.image));
            cycles += order.cycles.unwrap();
            match order.cycles {
                Some(0) => {
                    assert!(off(&topological.image) < 1e-4, "{file}: {}", off(&topological.image));
                    assert_eq!((order.exactness, order.misordered_pairs), (Exactness::Exact, Some(0)), "{file}");
                }
                broken => assert_eq!(order.exactness, Exactness::CyclesBroken(broken.unwrap()), "{file}"),
            }
            assert!(off(&none.image) > 1e-3, "{file}: no order passes");
        }
        assert_eq!(cycles == 0, has_order, "{file}: {cycles}");
    }
}
