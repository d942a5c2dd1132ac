//! The order of cells: power distance on Delaunay meshes, and cells that no order can put right.

use cellfan::columns::{Array, Association, CellCounts};
use cellfan::generate::Scheme;
use cellfan::profile::Exactness;
use cellfan::{
    Camera, CpuMethod, Dataset, FieldSelection, Model, Points, Projection, RenderOptions, Renderer, Scene, SortMethod,
    TetMesh, TransferFunction,
};
use glam::DVec3;

use crate::check::Case;
use crate::meshes::{grid, mesh, point, random_delaunay, smooth, three_views};

fn misordered(case: &Case, camera: &Camera, sort: SortMethod) -> u64 {
    let options = RenderOptions { sort, check_order: true, ..RenderOptions::default() };
    case.render(options, &smooth(), camera).order.misordered_pairs.unwrap()
}

#[test]
fn power_puts_a_delaunay_mesh_in_order() {
    let case = Case::new(random_delaunay(30_000), "value");
    let mut failures = Vec::new();
    for (view, camera) in three_views(64, 64) {
        let [power, centroid, none] =
            [SortMethod::Power, SortMethod::Centroid, SortMethod::None].map(|sort| misordered(&case, &camera, sort));
        println!("{view}: {power} pairs misordered by power, {centroid} by centroid, {none} without a sort");
        // The check can fail.
        assert!(centroid > 0 && none > centroid, "{view}: centroid {centroid}, none {none}");
        if power > 0 {
            failures.push(format!("{view}: {power}"));
        }
    }
    assert!(failures.is_empty(), "misordered by power: {}", failures.join(", "));
}

#[test]
fn an_order_that_is_not_checked_is_not_called_exact() {
    let case = Case::new(grid(6000, Scheme::Six, 0.25), "value");
    for (view, camera) in three_views(96, 96) {
        for sort in [SortMethod::Centroid, SortMethod::None] {
            let options = RenderOptions { sort, ..RenderOptions::default() };
            let order = case.render(options, &smooth(), &camera).order;
            assert_eq!(order.exactness, Exactness::Unverified, "{view}, {sort}");
            assert!(order.violations.unwrap() > 0, "{view}, {sort}");
        }
        let order = case.render(RenderOptions::default(), &smooth(), &camera).order;
        println!("{view}: {order:?}");
        assert_eq!((order.kind, order.exactness), ("exact", Exactness::Exact));
    }
}

/// Three bars around the z axis, each above the next where they cross.
pub(crate) fn three_bars() -> Case {
    let (mut points, mut tets, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for bar in 0..3 {
        let turn = f64::from(bar) * std::f64::consts::TAU / 3.0;
        let out = DVec3::new(turn.cos(), turn.sin(), 0.0);
        let along = DVec3::new(-turn.sin(), turn.cos(), 0.35);
        let first = points.len() as u32;
        let (tail, head) = (out - along * 2.6, out + along * 2.6);
        let wide = out * 0.45;
        let thick = DVec3::Z * 0.2;
        points.extend([tail - wide, tail + wide, head - thick, head + thick].map(|p| p.to_array()));
        tets.push([first, first + 1, first + 2, first + 3]);
        values.extend([f64::from(bar); 4]);
    }
    Case::new(mesh(points, tets, values), "value")
}

/// Two wide, opaque cells behind a small one, `z` their height over x.
fn two_behind_a_small_one(z: impl Fn(f64) -> f64, small_at: DVec3) -> Case {
    let wide = |below: f64| {
        [[5.0, 5.0, 0.0], [-5.0, -5.0, 0.0], [5.0, -5.0, 0.3], [-5.0, 5.0, 0.3]]
            .map(|[x, y, up]| [x, y, z(x) + up - below])
    };
    let small = [[-0.7, -0.5, 0.0], [0.7, -0.5, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 0.8]];
    let small = small.map(|p| (DVec3::from_array(p) + small_at).to_array());
    let points = [wide(0.0), wide(0.5), small].concat();
    let tets = (0..3).map(|i| [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3]).collect();
    let values = (0..12).map(|i| f64::from(i / 4)).collect();
    Case::new(mesh(points, tets, values), "value")
}

/// A pixel may be opaque before its nearest cell has come: `auto` and `exact` must notice, and no order is called exact
/// of which the picture is wrong.
fn check_opaque(case: &Case, small_at: DVec3, deceived: SortMethod) {
    let colors = [[1.0, 0.1, 0.1], [0.1, 1.0, 0.1], [0.1, 0.1, 1.0]];
    let above = DVec3::new(small_at.x, small_at.y, 14.0);
    let mut camera = Camera::looking_at(above + DVec3::new(0.2, 0.1, 0.0), small_at, 192, 192);
    let mut failures = Vec::new();
    // In the last, the small cell covers whole tiles.
    let projections = [
        Projection::Perspective { fov_degrees: 30.0 },
        Projection::Orthographic { height_world: 7.0 },
        Projection::Perspective { fov_degrees: 4.5 },
    ];
    for projection in projections {
        camera.projection = projection;
        let rays = case.all_rays(&camera);
        for extinction in [1.0, 300.0] {
            let points = [0.0, 1.0, 2.0].into_iter().zip(colors).map(|(s, color)| point(s, color, extinction));
            let transfer = TransferFunction::new(points.collect()).unwrap();
            for sort in SortMethod::ALL {
                let options = RenderOptions { sort, ..RenderOptions::default() };
                let rendered = case.render(options, &transfer, &camera);
                let errors = rays.errors(&rendered.image, Model::EmissionAbsorption, &transfer, usize::MAX);
                let line = format!("{sort} {projection:?}, extinction {extinction}: {errors} {:?}", rendered.order);
                println!("{line}");
                if sort == deceived && projection == (Projection::Perspective { fov_degrees: 30.0 }) {
                    assert!(errors.max > 0.1, "this order is right here: {line}");
                }
                if rendered.order.exactness == Exactness::Exact && !errors.are_small() {
                    failures.push(line);
                }
            }
        }
    }
    assert!(failures.is_empty(), "called exact:\n{}", failures.join("\n"));
}

#[test]
fn opaque_cells_nearer_by_power_distance() {
    // Wide cells have wide circumspheres, which reach nearer than the small one's.
    let small_at = DVec3::new(0.0, 0.0, 1.0);
    check_opaque(&two_behind_a_small_one(|_| 0.0, small_at), small_at, SortMethod::Power);
}

#[test]
fn opaque_cells_nearer_by_centroid() {
    // Tilted cells have their centroids before the small one, and lie behind it where it is.
    let small_at = DVec3::new(-2.0, 0.0, -1.1);
    check_opaque(&two_behind_a_small_one(|x| 0.8 * x, small_at), small_at, SortMethod::Centroid);
}

#[test]
fn cells_that_overlap_in_a_cycle() {
    let case = three_bars();
    let extinction = 8.0;
    let transfer = TransferFunction::new(vec![
        point(0.0, [1.0, 0.1, 0.1], extinction),
        point(1.0, [0.1, 1.0, 0.1], extinction),
        point(2.0, [0.1, 0.1, 1.0], extinction),
    ])
    .unwrap();
    let mut camera = Camera::looking_at(DVec3::new(0.3, 0.2, 12.0), DVec3::ZERO, 150, 150);
    for projection in [Projection::Perspective { fov_degrees: 30.0 }, Projection::Orthographic { height_world: 6.5 }] {
        camera.projection = projection;
        let rays = case.all_rays(&camera);
        // It is a cycle: each bar is in front of the next somewhere.
        for bar in 0..3 {
            let scalar = |segment: &crate::reference::Segment| segment.s[0].round() as u32;
            let crossed = rays.segments.iter().filter(|segments| segments.len() == 2);
            let order: Vec<_> = crossed.map(|two| [scalar(&two[0]), scalar(&two[1])]).collect();
            let over = order.iter().filter(|two| two[0] == bar && (two[1] == (bar + 1) % 3)).count();
            assert!(over > 20, "bar {bar} is over the next at {over} pixels");
        }
        let errors = |sort| {
            let options = RenderOptions { sort, ..RenderOptions::default() };
            let rendered = case.render(options, &transfer, &camera);
            println!("{sort} {:?}", rendered.order);
            rays.errors(&rendered.image, Model::EmissionAbsorption, &transfer, usize::MAX)
        };
        for sort in [SortMethod::Power, SortMethod::Centroid, SortMethod::None] {
            let errors = errors(sort);
            assert!(errors.max > 0.1, "no order of whole cells is right, yet {sort} gives {errors}");
        }
        for sort in [SortMethod::Auto, SortMethod::Exact] {
            let errors = errors(sort);
            println!("{sort}: {errors}");
            assert!(errors.pixels > 3000 && errors.are_small(), "{sort}: {errors}");
        }
        // A graph of cells has no order either, and says so.
        for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays, CpuMethod::Fans] {
            let options = RenderOptions { sort: SortMethod::Topological, cpu_method, ..RenderOptions::default() };
            let order = case.render(options, &transfer, &camera).order;
            assert_eq!((order.exactness, order.cycles), (Exactness::CyclesBroken(1), Some(1)));
        }
    }
}

/// One long slanted cell in front of ten opaque layers that all have nearer keys: it comes when its blocks are opaque already.
#[test]
fn a_near_cell_that_comes_after_its_pixels_are_opaque() {
    let mut points = vec![[-0.2, -2.0, -2.0], [-0.2, -2.0, 2.0], [4.9, 100.0, 0.0], [-0.3, -2.0, 0.0]];
    for k in 0..10 {
        let x = 0.1 * f64::from(k);
        points.extend([[x, -0.8, -0.8], [x, -0.8, 0.8], [x, 1.2, 0.0], [x + 0.05, -0.1, 0.0]]);
    }
    let dataset = Dataset::from_tets(TetMesh {
        points: Points::F64(points),
        tets: (0..11).map(|i| [0, 1, 2, 3].map(|k| 4 * i + k)).collect(),
        file_from_tet: (0..11).collect(),
        arrays: vec![Array {
            name: "layer".to_owned(),
            association: Association::Cell,
            components: 1,
            values: (0..11).map(|cell| f64::from(u8::from(cell > 0))).collect::<Vec<f64>>().into(),
        }],
        counts: CellCounts { in_file: 11, ..CellCounts::default() },
    })
    .unwrap();
    let field = dataset.field(&FieldSelection::parse("layer", &dataset.arrays)).unwrap();
    let transfer =
        TransferFunction::new(vec![point(0.0, [1.0, 0.0, 0.0], 1e4), point(1.0, [0.0, 0.0, 1.0], 1e4)]).unwrap();
    let mut camera = Camera::looking_at(DVec3::new(-5.0, 0.0, 0.0), DVec3::ZERO, 32, 32);
    camera.projection = Projection::Orthographic { height_world: 0.4 };
    let scene = Scene::new(dataset, field, &transfer);
    let draw = |sort| {
        let options = RenderOptions { sort, ..RenderOptions::default() };
        Renderer::new(options).render(&scene, &camera).unwrap()
    };
    let exact = draw(SortMethod::Auto);
    assert_eq!(exact.image.pixel(16, 16), [1.0, 0.0, 0.0, 1.0]);
    assert_eq!((exact.order.exactness, exact.order.tiles_redone), (Exactness::Exact, 1));
    // The keys alone get it wrong, and nobody calls that exact.
    let by_key = draw(SortMethod::Power);
    assert_eq!(by_key.image.pixel(16, 16), [0.0, 0.0, 1.0, 1.0]);
    assert_eq!(by_key.order.exactness, Exactness::Unverified);
}
