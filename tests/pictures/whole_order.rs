//! Topological order of hexahedra, wedges, pyramids and tetrahedra together: every pixel against the reference, beside `exact`.

use cellfan::cells::{HEXAHEDRON, PYRAMID, WEDGE, split};
use cellfan::io::{StructuredMesh, UnstructuredMesh};
use cellfan::profile::Exactness;
use cellfan::{
    Camera, FieldSelection, Model, Projection, RenderOptions, Rendered, Renderer, Scene, SortMethod, TransferFunction,
    io,
};
use glam::DVec3;

use crate::check::Case;
use crate::common::data_folder;
use crate::hexahedra::{case, hex_grid, jittered, mesh, twisted_shell};
use crate::meshes::{Random, point, smooth, three_views};
use crate::topological::{combs, waves};

type Cells = Vec<(u8, Vec<u32>)>;

/// The cells whose middle is one that `is_kept`.
fn part((points, cells): (Vec<DVec3>, Cells), is_kept: impl Fn(DVec3) -> bool) -> UnstructuredMesh {
    let middle = |corners: &[u32]| corners.iter().map(|&v| points[v as usize]).sum::<DVec3>() / corners.len() as f64;
    let kept: Cells = cells.into_iter().filter(|(_, corners)| is_kept(middle(corners))).collect();
    mesh(&points, &kept)
}

/// The unit cube, every point moved by up to `jitter` cells.
fn shaken(n: u32, jitter: f64) -> (Vec<DVec3>, Cells) {
    let mut random = Random(17);
    let mut moved = move || ((random.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) * jitter / f64::from(n);
    hex_grid([n; 3], move |p| p + DVec3::new(moved(), moved(), moved()))
}

/// Hexahedra, wedges, pyramids around middles of their own, and tetrahedra.
fn mixed(n: u32, jitter: f64) -> UnstructuredMesh {
    let (mut points, hexahedra) = shaken(n, jitter);
    let mut cells = Vec::new();
    for (i, (code, corners)) in hexahedra.into_iter().enumerate() {
        let [a, b, c, d, e, f, g, h] = corners[..] else { panic!("eight corners") };
        match i % 4 {
            0 => cells.push((code, corners)),
            1 => cells.extend([[a, b, c, e, f, g], [a, c, d, e, g, h]].map(|wedge| (WEDGE.code, wedge.to_vec()))),
            2 => {
                let middle = points.len() as u32;
                points.push(corners.iter().map(|&v| points[v as usize]).sum::<DVec3>() / 8.0);
                for (i, face) in HEXAHEDRON.faces.iter().enumerate() {
                    let base = [3, 2, 1, 0].map(|k: usize| corners[usize::from(face[k])]);
                    let pyramid = [&base[..], &[middle]].concat();
                    if i % 2 == 0 {
                        split(&PYRAMID, &pyramid, |v| v, |tet| cells.push((10, tet.to_vec())));
                    } else {
                        cells.push((PYRAMID.code, pyramid));
                    }
                }
            }
            _ => split(&HEXAHEDRON, &corners, |v| v, |tet| cells.push((10, tet.to_vec()))),
        }
    }
    mesh(&points, &cells)
}

fn render(case: &Case, sort: SortMethod, transfer: &TransferFunction, camera: &Camera) -> Rendered {
    let options = RenderOptions { sort, check_order: true, ..RenderOptions::default() };
    case.render(options, transfer, camera)
}

#[test]
fn whole_cells_in_topological_order_are_right_at_every_pixel() {
    let center = DVec3::splat(0.5);
    let meshes = [
        ("boxes", part(shaken(9, 0.0), |_| true), true),
        ("jittered", jittered(10, 0.1), false),
        ("cavity", part(shaken(10, 0.1), |p| p.distance(center) > 0.3), false),
        ("two parts", part(shaken(10, 0.1), |p| (p.x + 0.3 * p.y - 0.65).abs() > 0.12), false),
        ("combs", part(shaken(14, 0.0), combs), true),
        ("shell", twisted_shell([15, 4, 5], 0.6), false),
        ("mixed", mixed(6, 0.1), false),
    ];
    let transfer = smooth().scaled_extinction(3.0).unwrap();
    let mut right = 0;
    for (name, mesh, has_order) in meshes {
        let case = case(mesh, "value");
        for (view, camera) in three_views(96, 72) {
            let rays = case.all_rays(&camera);
            let errors =
                |rendered: &Rendered| rays.errors(&rendered.image, Model::EmissionAbsorption, &transfer, usize::MAX);
            let [exact, topological, none] = [SortMethod::Exact, SortMethod::Topological, SortMethod::None]
                .map(|sort| render(&case, sort, &transfer, &camera));
            let (order, of_exact, found) = (&topological.order, errors(&exact), errors(&topological));
            println!("{name:10} {view:9} exact {of_exact}; topological {found} {order:?}");
            assert!(of_exact.mean <= 2e-4 && of_exact.max <= 5e-3, "{name}, {view}: {of_exact}");
            assert_eq!(order.kind, "topological");
            assert!(order.layers.unwrap() > 5 && errors(&none).max > 0.02, "{name}, {view}: no order passes");
            if order.cycles == Some(0) {
                right += 1;
                assert_eq!((order.exactness, order.misordered_pairs), (Exactness::Exact, Some(0)), "{name}, {view}");
                assert!(found.mean <= 2e-4 && found.max <= 5e-3, "{name}, {view}: {found}");
            } else {
                assert_eq!(order.exactness, Exactness::CyclesBroken(order.cycles.unwrap()), "{name}, {view}");
                assert!(!has_order, "{name}, {view}: {order:?}");
            }
        }
    }
    assert!(right > 12, "{right} of 21");
}

/// Three bars around the z axis, each above the next where they cross.
#[test]
fn three_hexahedra_in_a_cycle_are_told() {
    let (mut points, mut cells) = (Vec::new(), Vec::new());
    for bar in 0..3 {
        let turn = f64::from(bar) * std::f64::consts::TAU / 3.0;
        let out = DVec3::new(turn.cos(), turn.sin(), 0.0);
        let along = DVec3::new(-turn.sin(), turn.cos(), 0.35);
        let corner = |[x, y, z]: [f64; 3]| out + out * (0.3 * x) + along * (2.6 * y) + DVec3::Z * (0.15 * z);
        let around = |z: f64| [[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]].map(corner);
        let first = points.len() as u32;
        points.extend([around(-1.0), around(1.0)].concat());
        cells.push((HEXAHEDRON.code, (first..first + 8).collect()));
    }
    let case = case(mesh(&points, &cells), "cell_value");
    let transfer =
        TransferFunction::new(vec![point(0.0, [1.0, 0.1, 0.1], 8.0), point(1.0, [0.1, 0.1, 1.0], 8.0)]).unwrap();
    let mut camera = Camera::looking_at(DVec3::new(0.3, 0.2, 12.0), DVec3::ZERO, 150, 150);
    for projection in [Projection::Perspective { fov_degrees: 30.0 }, Projection::Orthographic { height_world: 6.5 }] {
        camera.projection = projection;
        let rays = case.all_rays(&camera);
        let [exact, topological] =
            [SortMethod::Exact, SortMethod::Topological].map(|sort| render(&case, sort, &transfer, &camera));
        let errors = [&exact, &topological]
            .map(|rendered| rays.errors(&rendered.image, Model::EmissionAbsorption, &transfer, usize::MAX));
        println!("{projection:?}: exact {}; topological {} {:?}", errors[0], errors[1], topological.order);
        assert!(errors[0].pixels > 3000 && errors[0].are_small(), "{}", errors[0]);
        assert!(errors[1].max > 0.1, "no order is right");
        assert_eq!((topological.order.exactness, topological.order.cycles), (Exactness::CyclesBroken(1), Some(1)));
    }
}

/// Cells without volume between others are left out: what they part is related by the rays that pass.
#[test]
fn flat_cells_between_others_leave_the_order_right() {
    // The middle layer has no height. Listed, the cells below and above it adjoin; in a block they do not. Layers are shifted as a
    // whole, which keeps faces planar.
    let layers =
        [[0.03, -0.04, 0.0], [-0.05, 0.02, 0.27], [0.0, 0.0, 0.5], [0.0, 0.0, 0.5], [0.04, 0.05, 0.7], [0.0, 0.0, 1.0]];
    let (points, cells) =
        hex_grid([7, 7, 5], |p| DVec3::new(p.x, p.y, 0.0) + DVec3::from_array(layers[(p.z * 5.0).round() as usize]));
    let hexahedra = mesh(&points, &cells);
    let blocks = StructuredMesh::new(&[[8, 8, 6]], hexahedra.points.clone(), hexahedra.arrays.clone()).unwrap();

    // Tetrahedra: below the middle quadrilaterals are cut along one diagonal, above along the other, flat ones between them.
    let side = 8 * 8;
    let mut tets: Cells = Vec::new();
    for (_, corners) in &cells {
        let layer = corners[0] / side;
        // The upper half stands on the points of the lower one's top.
        let corners: Vec<u32> = corners.iter().map(|&v| if v / side == 3 { v - side } else { v }).collect();
        match layer {
            0 | 1 => split(&HEXAHEDRON, &corners, |v| v, |tet| tets.push((10, tet.to_vec()))),
            2 => tets.push((10, corners[..4].to_vec())),
            // From the corner of lowest y, then of highest x.
            _ => split(&HEXAHEDRON, &corners, |v| v ^ 7, |tet| tets.push((10, tet.to_vec()))),
        }
    }
    let tets = mesh(&points, &tets);

    let transfer = smooth().scaled_extinction(3.0).unwrap();
    for (name, dataset) in [
        ("hexahedra", hexahedra.into_whole_dataset()),
        ("blocks", blocks.into_whole_dataset()),
        ("tetrahedra", tets.into_whole_dataset()),
    ] {
        let dataset = dataset.unwrap();
        let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays)).unwrap();
        let case = Case::of(dataset, field);
        assert_eq!(case.dataset.counts.degenerate, 49, "{name}");
        for (view, camera) in three_views(96, 72) {
            let rays = case.all_rays(&camera);
            let draw = |sort| {
                let rendered = render(&case, sort, &transfer, &camera);
                let errors = rays.errors(&rendered.image, Model::EmissionAbsorption, &transfer, usize::MAX);
                println!("{name:10} {view:9} {sort:12} {errors} {:?}", rendered.order);
                (errors, rendered.order)
            };
            let (errors, order) = draw(SortMethod::Topological);
            assert_eq!((order.exactness, order.misordered_pairs), (Exactness::Exact, Some(0)), "{name}, {view}");
            assert!(errors.mean <= 2e-4 && errors.max <= 5e-3, "{name}, {view}: {errors}");
            assert!(draw(SortMethod::None).0.max > 0.02, "{name}, {view}: no order passes");
        }
    }
}

#[test]
fn any_number_of_threads_draws_the_same_bytes() {
    let case = case(mixed(6, 0.3), "value");
    for (view, camera) in three_views(96, 72) {
        let draw = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render(&case, SortMethod::Topological, &smooth(), &camera))
        };
        let expected = draw(1);
        for threads in [2, 5] {
            let found = draw(threads);
            assert!(found.image.pixels == expected.image.pixels && found.order == expected.order, "{view}, {threads}");
        }
    }
}

/// File, and whether its cells lie apart. Those of the hybrid mesh do not: faces of four corners meet two triangles that are cut along
/// the other diagonal. No cycle tells, the faces do.
const MESHES: &[(&str, bool)] = &[
    ("classic/bluntfin.vts", true),
    ("classic/combxyz.bin", true),
    ("classic/postxyz.bin", true),
    ("curvilinear/SampleStructGrid.vtk", true),
    ("curvilinear/multi-bin.xyz", true),
    ("regular/RectGrid2.vtk", true),
    ("unstructured/box_hybrid_mesh.vtu", false),
    ("unstructured/disk_out_ref.vtu", true),
    ("unstructured/fire_ug.vtu", true),
];

#[test]
fn real_meshes_of_whole_cells_are_those_of_the_exact_order() {
    let Some(folder) = data_folder("whole_order::real_meshes") else { return };
    let (mut right, mut views) = (0, 0);
    for &(file, lie_apart) in MESHES {
        let dataset = io::open_mesh(&folder.join(file)).unwrap().into_whole_dataset().unwrap();
        let (corners, diagonal) = (dataset.corners_world(), dataset.diagonal_world());
        let field = waves(&dataset);
        let transfer = smooth().scaled_extinction(4.0 / diagonal).unwrap();
        let scene = Scene::new(dataset, field, &transfer);
        for (azimuth, elevation) in [(37.0, 22.0), (160.0, -35.0), (-80.0, 75.0)] {
            let camera = Camera::framing(&corners, azimuth, elevation, 320, 256);
            let [exact, topological, none] =
                [SortMethod::Exact, SortMethod::Topological, SortMethod::None].map(|sort| {
                    let options = RenderOptions { sort, check_order: true, ..RenderOptions::default() };
                    Renderer::new(options).render(&scene, &camera).unwrap()
                });
            let (off, order) = (|image| exact.image.difference(image, [0.0; 4]).unwrap(), topological.order);
            let difference = off(&topological.image);
            println!("{file:36} {azimuth:5} {:.1e} {order:?}", difference.max);
            views += 1;
            assert!(off(&none.image).max > 1e-3, "{file}: no order passes");
            assert_eq!(matches!(order.exactness, Exactness::CellsOverlap(_)), !lie_apart, "{file}: {order:?}");
            if order.cycles == Some(0) && lie_apart {
                right += 1;
                assert!(difference.max < 1e-4, "{file}: {difference:?}");
                assert_eq!((order.exactness, order.misordered_pairs), (Exactness::Exact, Some(0)), "{file}");
            }
        }
    }
    assert!(2 * right > views, "{right} of {views} have an order");
}
