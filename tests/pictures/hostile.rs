//! Hard cases: each is right against the reference, or a clear error.

use cellfan::columns::{Array, Association, NumericColumn};
use cellfan::generate::Scheme;
use cellfan::{
    Camera, Dataset, Error, FieldSelection, Model, Points, Projection, RenderOptions, Renderer, Scene,
    TransferFunction, io,
};
use glam::DVec3;

use crate::check::Case;
use crate::meshes::{frame_unit_cube, grid, mesh, moved, point, random_delaunay, smooth, steep, stepped, three_views};

/// A camera on all cells of a case.
fn frame(case: &Case, azimuth: f64, elevation: f64, width: u32, height: u32) -> Camera {
    let corners = case.dataset.bounds.corners().map(|corner| case.dataset.origin + corner.as_dvec3());
    Camera::framing(&corners, azimuth, elevation, width, height)
}

fn parallel(camera: &Camera, height_world: f64) -> Camera {
    Camera { projection: Projection::Orthographic { height_world }, ..camera.clone() }
}

fn is_miss(model: Model, pixel: [f32; 4]) -> bool {
    pixel == if model == Model::Absorption { [1.0; 4] } else { [0.0; 4] }
}

#[test]
fn near_and_far_planes_through_the_mesh() {
    let case = Case::new(grid(3000, Scheme::Six, 0.25), "value");
    let camera = frame_unit_cube(37.0, 22.0, 72, 60);
    let middle = camera.eye.distance(DVec3::splat(0.5));
    let (near, far) = (Some(middle - 0.13), Some(middle + 0.21));
    for (what, near, far) in [("near", near, None), ("far", None, far), ("near and far", near, far)] {
        let camera = Camera { near, far, ..camera.clone() };
        case.assert_right(what, &smooth(), &camera);
        case.assert_right(&format!("{what}, parallel"), &stepped(), &parallel(&camera, 1.7));
        case.assert_right(&format!("{what}, steep"), &steep(), &camera);
    }
    // Parallel rays may start behind the eye.
    let camera = Camera { near: Some(-0.2), far: Some(0.3), ..parallel(&camera, 1.7) };
    let camera = Camera { eye: DVec3::splat(0.5), target: DVec3::new(0.9, 0.7, 0.8), ..camera };
    case.assert_right("a negative near, parallel", &smooth(), &camera);
}

#[test]
fn near_behind_everything_is_blank() {
    let case = Case::new(grid(48, Scheme::Six, 0.25), "value");
    for (near, far) in [(Some(50.0), None), (None, Some(0.1))] {
        let camera = Camera { near, far, ..frame_unit_cube(37.0, 22.0, 40, 30) };
        for model in Model::ALL {
            let rendered = case.render(RenderOptions { model, ..RenderOptions::default() }, &smooth(), &camera);
            assert!(rendered.image.pixels.iter().all(|&pixel| is_miss(model, pixel)), "{model} {near:?} {far:?}");
            assert_eq!(rendered.cells.accounted(), rendered.cells.total);
        }
    }
}

#[test]
fn bad_cameras_are_errors() {
    let case = Case::new(grid(6, Scheme::Six, 0.0), "value");
    let good = frame_unit_cube(37.0, 22.0, 40, 30);
    let bad = [
        Camera { near: Some(2.0), far: Some(1.0), ..good.clone() },
        Camera { near: Some(f64::NAN), ..good.clone() },
        Camera { near: Some(-1.0), ..good.clone() },
        Camera { eye: good.target, ..good.clone() },
        Camera { eye: DVec3::NAN, ..good.clone() },
        Camera { width: 0, ..good.clone() },
        Camera { up: DVec3::ZERO, ..good.clone() },
        Camera { projection: Projection::Perspective { fov_degrees: 180.0 }, ..good.clone() },
        Camera { projection: Projection::Orthographic { height_world: 0.0 }, ..good.clone() },
    ];
    let mut renderer = Renderer::new(RenderOptions::default());
    for camera in bad {
        let result = renderer.render(&case.scene(&smooth()), &camera);
        assert!(matches!(result, Err(Error::Camera { .. })), "{camera:?}");
    }
    for stop_transmittance in [-0.1, 1.0, f32::NAN] {
        let options = RenderOptions { stop_transmittance, ..RenderOptions::default() };
        let result = Renderer::new(options).render(&case.scene(&smooth()), &good);
        assert!(matches!(result, Err(Error::Option { .. })), "{stop_transmittance}");
    }
}

#[test]
fn a_long_thin_cell() {
    let points = vec![[-5e4, 0.0, 0.0], [5e4, 0.0, 0.0], [0.0, 1.0, 0.2], [0.0, 0.1, 1.0]];
    let case = Case::new(mesh(points, vec![[0, 1, 2, 3]], vec![0.0, 1.0, 0.4, 0.7]), "value");
    let mut camera = Camera::looking_at(DVec3::new(3.0, -4.0, 2.0), DVec3::new(0.0, 0.3, 0.3), 64, 64);
    case.assert_right("aspect 1e5, across", &smooth(), &camera);
    camera.eye = DVec3::new(-2e4, 0.15, 0.15);
    camera.target = DVec3::new(0.0, 0.35, 0.35);
    camera.projection = Projection::Perspective { fov_degrees: 0.01 };
    case.assert_right("aspect 1e5, along", &smooth().scaled_extinction(1e-4).unwrap(), &camera);
    let camera = parallel(&Camera { eye: DVec3::new(3.0, -4.0, 2.0), ..camera }, 1.5);
    case.assert_right("aspect 1e5, parallel", &smooth(), &camera);
}

#[test]
fn long_thin_cells_fill_a_bar() {
    // A bar of 1000 to 1 in grid cells, seen from near its end: chords are long and cells are slivers.
    let bar = moved(grid(3000, Scheme::Six, 0.25), |p| p * DVec3::new(1000.0, 1.0, 1.0));
    let case = Case::new(bar, "value");
    let mut camera = Camera::looking_at(DVec3::new(-3.0, 0.8, 0.7), DVec3::new(10.0, 0.5, 0.5), 64, 48);
    case.assert_right("bar of 1000:1, along", &smooth().scaled_extinction(0.05).unwrap(), &camera);
    camera.eye = DVec3::new(480.0, -4.0, 2.0);
    camera.target = DVec3::new(500.0, 0.5, 0.5);
    case.assert_right("bar of 1000:1, across", &smooth(), &camera);
}

#[test]
fn cells_with_nan_are_left_out_and_counted() {
    for array in ["value", "cell_value"] {
        let mut mesh = grid(6000, Scheme::Six, 0.25);
        let array_index = mesh.arrays.iter().position(|a| a.name == array).unwrap();
        let is_point = mesh.arrays[array_index].association == Association::Point;
        let values = &mut mesh.arrays[array_index].values;
        // 2 % of cells: a point has up to 24.
        let stride = if is_point { 250 } else { 50 };
        let changed: Vec<f32> = (0..values.len())
            .map(|i| match i % stride {
                17 => f32::NAN,
                18 if !is_point => f32::INFINITY,
                _ => values.get(i) as f32,
            })
            .collect();
        *values = NumericColumn::from(changed);
        let case = Case::new(mesh, array);
        for (view, camera) in three_views(64, 48) {
            case.assert_right(&format!("2 % NaN in {array}, {view}"), &smooth(), &camera);
            let cells = case.render(RenderOptions::default(), &smooth(), &camera).cells;
            let share = cells.invalid as f64 / cells.total as f64;
            println!("{} of {} cells are invalid", cells.invalid, cells.total);
            assert!((0.01..0.05).contains(&share), "{cells:?}");
            assert_eq!(cells.invalid, case.field.invalid);
            assert_eq!(cells.accounted(), cells.total, "{cells:?}");
        }
    }
}

#[test]
fn an_offset_of_a_million_changes_nothing() {
    let mesh = grid(6000, Scheme::Six, 0.25);
    let offset = DVec3::splat(1e6);
    let here = Case::new(mesh.clone(), "value");
    let there = Case::new(moved(mesh, |p| p + offset), "value");
    for (view, camera) in three_views(96, 80) {
        let far_camera = Camera { eye: camera.eye + offset, target: camera.target + offset, ..camera.clone() };
        for model in Model::ALL {
            let options = RenderOptions { model, ..RenderOptions::default() };
            let a = here.render(options, &smooth(), &camera).image;
            let b = there.render(options, &smooth(), &far_camera).image;
            let miss = if model == Model::Absorption { [1.0; 4] } else { [0.0; 4] };
            let difference = a.difference(&b, miss).unwrap();
            println!("offset, {view}, {model}: {difference:?}");
            assert!(!difference.is_blank() && difference.max <= 1e-4, "{view}, {model}: {difference:?}");
        }
        there.assert_right(&format!("offset of 10^6, {view}"), &smooth(), &far_camera);
    }
}

#[test]
fn one_cell_and_two_cells() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 1.0, 0.1], [0.3, 0.2, 1.0], [1.1, 0.9, 0.8]];
    let values = vec![0.1, 0.9, 0.4, 0.7, 0.2];
    for tets in [vec![[0, 1, 2, 3]], vec![[0, 1, 2, 3], [3, 2, 1, 4]]] {
        let count = tets.len();
        let case = Case::new(mesh(points.clone(), tets, values.clone()), "value");
        for azimuth in [0.0, 77.0, 180.0, 251.0] {
            let camera = frame(&case, azimuth, 20.0, 40, 33);
            case.assert_right(&format!("{count} cells from {azimuth}"), &smooth(), &camera);
            case.assert_right(&format!("{count} cells from {azimuth}, stepped"), &stepped(), &parallel(&camera, 1.6));
        }
    }
}

#[test]
fn extinctions_over_six_decades() {
    let transfer = TransferFunction::new(vec![
        point(0.0, [0.2, 0.4, 1.0], 0.01),
        point(0.4, [0.2, 1.0, 0.4], 0.1),
        point(0.55, [1.0, 0.6, 0.1], 10.0),
        point(0.6, [1.0, 0.2, 0.2], 1e4),
        point(1.0, [1.0, 1.0, 1.0], 1e4),
    ])
    .unwrap();
    let case = Case::new(grid(6000, Scheme::Six, 0.25), "value");
    for (view, camera) in three_views(64, 48) {
        let rays = case.all_rays(&camera);
        for model in [Model::EmissionAbsorption, Model::Absorption, Model::Mip] {
            let image = case.render(RenderOptions { model, ..RenderOptions::default() }, &transfer, &camera).image;
            let errors = rays.errors(&image, model, &transfer, usize::MAX);
            println!("1:10^6, {view:10} {model:20} {errors}");
            assert!(errors.are_small(), "{view}, {model}: {errors}");
        }
        // Emission is unbounded here: its error is relative.
        let image =
            case.render(RenderOptions { model: Model::Emission, ..RenderOptions::default() }, &transfer, &camera).image;
        for (&(x, y), segments) in rays.pixels.iter().zip(&rays.segments) {
            let expected = crate::reference::shade(Model::Emission, &transfer, segments);
            for k in 0..3 {
                let error = (f64::from(image.pixel(x, y)[k]) - expected[k]).abs();
                assert!(
                    error <= 2e-3 * expected[k].max(1.0),
                    "{view} ({x}, {y}): {:?} {expected:?}",
                    image.pixel(x, y)
                );
            }
        }
    }
}

#[test]
fn a_faint_extinction_beside_a_strong_one_shows() {
    // Below 1/256 of the largest, which an 8-bit table would round to nothing; the strong value does not occur.
    let transfer = TransferFunction::new(vec![
        point(0.0, [1.0, 0.5, 0.2], 0.2),
        point(1.5, [1.0, 0.5, 0.2], 0.2),
        point(1.6, [1.0; 3], 1000.0),
    ])
    .unwrap();
    let case = Case::new(grid(6000, Scheme::Six, 0.25), "value");
    let camera = frame_unit_cube(37.0, 22.0, 60, 60);
    case.assert_right("faint", &transfer, &camera);
    let [.., alpha] = case.render(RenderOptions::default(), &transfer, &camera).image.pixel(30, 30);
    assert!(alpha > 0.1, "{alpha}");
}

#[test]
fn a_peak_narrower_than_a_cell() {
    // s = x over cells of a quarter: the peak at 0.4 is a hundredth wide, all of it inside cells.
    let mut mesh = grid(384, Scheme::Six, 0.0);
    let values: Vec<f64> = (0..mesh.points.len()).map(|i| mesh.points.get(i).x).collect();
    mesh.arrays[0].values = values.into();
    let case = Case::new(mesh, "value");
    let transfer = TransferFunction::new(vec![
        point(0.0, [0.0, 0.0, 1.0], 0.0),
        point(0.395, [0.0, 0.0, 1.0], 0.0),
        point(0.4, [1.0, 0.5, 0.0], 200.0),
        point(0.405, [0.0, 0.0, 1.0], 0.0),
    ])
    .unwrap();
    for (view, camera) in three_views(64, 48).into_iter().filter(|(view, _)| *view != "inside") {
        case.assert_right(&format!("narrow peak, {view}"), &transfer, &camera);
    }
    // Along x the depth is 200 · 0.01 / 2 = 1.
    let mut camera = Camera::looking_at(DVec3::new(-2.0, 0.52, 0.48), DVec3::new(0.5, 0.52, 0.48), 9, 9);
    camera.projection = Projection::Orthographic { height_world: 0.1 };
    let [.., alpha] = case.render(RenderOptions::default(), &transfer, &camera).image.pixel(4, 4);
    assert!((f64::from(alpha) - (1.0 - (-1.0_f64).exp())).abs() < 1e-4, "{alpha}");
}

#[test]
fn tiny_and_huge_worlds() {
    for scale in [1e-9, 1e-3, 1e15] {
        let case = Case::new(moved(grid(3000, Scheme::Six, 0.25), |p| p * scale), "value");
        let transfer = smooth().scaled_extinction(1.0 / scale).unwrap();
        for (view, camera) in three_views(64, 48) {
            let mut camera = Camera { eye: camera.eye * scale, target: camera.target * scale, ..camera };
            if let Projection::Orthographic { height_world } = &mut camera.projection {
                *height_world *= scale;
            }
            case.assert_right(&format!("{scale:e} units, {view}"), &transfer, &camera);
        }
    }
}

#[test]
fn all_cells_transparent() {
    let case = Case::new(grid(3000, Scheme::Six, 0.25), "value");
    let nothing = TransferFunction::new(vec![point(0.0, [1.0; 3], 0.0), point(1.0, [0.5; 3], 0.0)]).unwrap();
    for (view, camera) in three_views(50, 40) {
        for model in [Model::EmissionAbsorption, Model::Absorption, Model::Emission] {
            let rendered = case.render(RenderOptions { model, ..RenderOptions::default() }, &nothing, &camera);
            assert!(rendered.image.pixels.iter().all(|&pixel| is_miss(model, pixel)), "{view}, {model}");
            assert_eq!(rendered.cells.drawn, 0, "{view}, {model}");
            assert_eq!(rendered.cells.accounted(), rendered.cells.total);
        }
        // The largest value is still shown.
        let mip = case.render(RenderOptions { model: Model::Mip, ..RenderOptions::default() }, &nothing, &camera);
        assert!(mip.image.covered([0.0; 4]) > 500, "{view}");
    }
}

#[test]
fn odd_picture_sizes() {
    let case = Case::new(grid(3000, Scheme::Six, 0.25), "value");
    for (width, height) in [(1, 1), (1, 40), (31, 33), (32, 32), (33, 31), (65, 3), (130, 1)] {
        // Pixels of one size, however many.
        let projection = Projection::Perspective { fov_degrees: 30.0 * f64::from(height) / 64.0 };
        let camera = Camera { width, height, projection, ..frame_unit_cube(37.0, 22.0, 64, 64) };
        let what = format!("{width}x{height}");
        case.assert_right(&what, &smooth(), &camera);
        let image = case.render(RenderOptions::default(), &smooth(), &camera).image;
        assert_eq!((image.width, image.height, image.pixels.len() as u32), (width, height, width * height));
    }
}

#[test]
fn the_eye_in_a_cell_and_on_its_parts() {
    let case = Case::new(grid(48, Scheme::Six, 0.25), "value");
    let corner = |i: usize| DVec3::from_array(case.dataset.positions[i].map(f64::from)) + case.dataset.origin;
    let tet = case.dataset.tets.get(case.dataset.tets.len() / 2).map(|v| corner(v as usize));
    let eyes = [
        ("in a cell", (tet[0] + tet[1] + tet[2] + tet[3]) * 0.25),
        ("near a face", (tet[0] + tet[1] + tet[2]) / 3.0 * 0.999 + tet[3] * 0.001),
        ("on an edge", (tet[0] + tet[1]) * 0.5),
    ];
    for (name, eye) in eyes {
        for target in [DVec3::new(0.9, 0.2, 0.7), DVec3::new(0.1, 0.1, 0.2)] {
            let mut camera = Camera::looking_at(eye, target, 64, 48);
            camera.projection = Projection::Perspective { fov_degrees: 85.0 };
            case.assert_right(name, &smooth(), &camera);
            case.assert_right(&format!("{name}, steep"), &steep(), &camera);
        }
    }
    // One cell alone around the eye: every pixel shows it.
    let points = vec![[-1.0, -1.0, -1.0], [3.0, -1.0, -1.0], [-1.0, 3.0, -1.0], [-1.0, -1.0, 3.0]];
    let one = Case::new(mesh(points, vec![[0, 1, 2, 3]], vec![0.0, 1.0, 0.3, 0.6]), "value");
    let camera = Camera::looking_at(DVec3::new(-0.5, -0.4, -0.6), DVec3::new(1.0, 1.0, 0.5), 40, 40);
    one.assert_right("in the only cell", &smooth(), &camera);
    let image = one.render(RenderOptions::default(), &smooth(), &camera).image;
    assert_eq!(image.covered([0.0; 4]), 1600);
}

#[test]
fn looking_away_is_blank() {
    let case = Case::new(random_delaunay(1000), "value");
    let toward = frame_unit_cube(37.0, 22.0, 50, 40);
    let away = Camera { target: toward.eye * 2.0 - toward.target, ..toward };
    for camera in [away.clone(), parallel(&away, 2.0)] {
        for model in Model::ALL {
            let rendered = case.render(RenderOptions { model, ..RenderOptions::default() }, &smooth(), &camera);
            assert!(rendered.image.pixels.iter().all(|&pixel| is_miss(model, pixel)), "{model}");
            assert_eq!((rendered.cells.drawn, rendered.cells.culled_outside), (0, rendered.cells.total));
        }
    }
}

#[test]
fn cell_data() {
    for mesh in [random_delaunay(3000), grid(3000, Scheme::Five, 0.25)] {
        let case = Case::new(mesh, "cell_value");
        for (view, camera) in three_views(64, 48) {
            for (name, transfer) in [("smooth", smooth()), ("steep", steep()), ("stepped", stepped())] {
                case.assert_right(&format!("cell data, {name}, {view}"), &transfer, &camera);
            }
        }
    }
}

#[test]
fn a_field_that_varies_little_around_a_large_value() {
    // 10^7 + 0..1: f32 has steps of 1 there.
    let mut mesh = grid(3000, Scheme::Six, 0.25);
    let values: Vec<f64> = (0..mesh.points.len()).map(|i| 1e7 + mesh.arrays[0].values.get(i)).collect();
    mesh.arrays[0].values = values.into();
    let case = Case::new(mesh, "value");
    let transfer = smooth().stretched((1e7, 1e7 + 1.0)).unwrap();
    for (view, camera) in three_views(64, 48) {
        case.assert_right(&format!("values near 10^7, {view}"), &transfer, &camera);
    }
}

#[test]
fn a_mesh_with_a_hole() {
    // Not convex: the power order is not exact, and rays leave and enter again.
    let mut mesh = grid(3000, Scheme::Six, 0.25);
    let is_kept: Vec<bool> = mesh
        .tets
        .iter()
        .map(|tet| {
            let center = tet.iter().map(|&v| mesh.points.get(v as usize)).sum::<DVec3>() * 0.25;
            !(0.25..0.75).contains(&center.x) || !(0.3..0.7).contains(&center.z)
        })
        .collect();
    let mut kept = is_kept.iter();
    mesh.tets.to_mut().retain(|_| *kept.next().unwrap());
    let mut kept = is_kept.iter();
    mesh.file_from_tet.to_mut().retain(|_| *kept.next().unwrap());
    let case = Case::new(mesh, "value");
    for (view, camera) in three_views(72, 56) {
        case.assert_right(&format!("with a hole, {view}"), &smooth(), &camera);
        case.assert_right(&format!("with a hole, {view}, steep"), &steep(), &camera);
    }
}

/// A hexahedron, a tetrahedron on its top and a quadrangle, as a file has them.
const MIXED: &str = "# vtk DataFile Version 3.0
a hexahedron, a tetrahedron on its upper face, and a quadrangle
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 9 double
0 0 0  1 0 0  1 1 0  0 1 0
0 0 1  1 0 1  1 1 1  0 1 1
0.2 0.2 2
CELLS 3 19
4 0 1 2 3
8 0 1 2 3 4 5 6 7
4 4 5 7 8
CELL_TYPES 3
9
12
10
POINT_DATA 9
SCALARS height double 1
LOOKUP_TABLE default
0 0.1 0.3 0.2 0.5 0.6 0.9 0.7 1.0
CELL_DATA 3
SCALARS part double 1
LOOKUP_TABLE default
5 0.25 0.75
";

#[test]
fn a_file_of_mixed_cells() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mixed.vtk");
    std::fs::write(&path, MIXED).unwrap();
    let dataset = io::open(&path).unwrap();
    assert_eq!((dataset.counts.in_file, dataset.counts.lower_dimensional), (3, 1));
    for array in ["height", "part"] {
        let field = dataset.field(&FieldSelection::parse(array, &dataset.arrays)).unwrap();
        let case = Case::of(dataset.clone(), field);
        for azimuth in [20.0, 130.0, 275.0] {
            let camera = frame(&case, azimuth, 15.0, 48, 64);
            case.assert_right(&format!("mixed cells, {array}, {azimuth}"), &smooth(), &camera);
            case.assert_right(&format!("mixed cells, {array}, {azimuth}, steep"), &steep(), &parallel(&camera, 2.6));
            let cells = case.render(RenderOptions::default(), &smooth(), &camera).cells;
            assert_eq!((cells.skipped, cells.accounted()), (1, cells.total), "{cells:?}");
        }
    }
    // The hexahedron is the unit cube: its depth straight down is 1 below the tetrahedron, which adds its own.
    let scene =
        Scene::new(dataset.clone(), dataset.homogeneous_field(), &TransferFunction::constant([1.0; 3], 1.5).unwrap());
    let mut camera = Camera::looking_at(DVec3::new(0.5, 0.5, -3.0), DVec3::splat(0.5), 50, 50);
    camera.projection = Projection::Orthographic { height_world: 1.2 };
    let image = Renderer::new(RenderOptions::default()).render(&scene, &camera).unwrap().image;
    let ray = camera.frame().unwrap();
    let mut beside = 0;
    for (x, y) in (0..50).flat_map(|y| (0..50).map(move |x| (x, y))) {
        let p = ray.ray(f64::from(x), f64::from(y)).origin;
        if (0.0..1.0).contains(&p.x) && (0.0..1.0).contains(&p.y) && p.x + p.y > 1.0 {
            let alpha = f64::from(image.pixel(x, y)[3]);
            assert!((alpha + (-1.5_f64).exp_m1()).abs() < 1e-5, "({x}, {y}): {alpha}");
            beside += 1;
        }
    }
    assert!(beside > 500);
}

#[test]
fn positions_without_digits_and_flat_cells_are_errors() {
    let flat = mesh(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
        vec![[0, 1, 2, 3]],
        vec![0.0, 1.0, 2.0, 3.0],
    );
    assert!(matches!(Dataset::from_tets(flat), Err(Error::NoCells { .. })));
    for bad in [f64::NAN, f64::INFINITY] {
        let mut mesh = grid(6, Scheme::Six, 0.0);
        mesh = moved(mesh, |p| if p == DVec3::ONE { DVec3::new(1.0, bad, 1.0) } else { p });
        assert!(matches!(Dataset::from_tets(mesh), Err(Error::NonFinitePosition { .. })), "{bad}");
    }
    // Finite in f64 and infinite in f32.
    let huge = moved(grid(6, Scheme::Six, 0.0), |p| p * 1e300);
    match Dataset::from_tets(huge) {
        Err(_) => {}
        Ok(dataset) => {
            let finite = dataset.positions.iter().flatten().all(|c| c.is_finite());
            assert!(finite, "positions of 1e300 became infinite without an error");
        }
    }
}

#[test]
fn an_array_of_nothing_but_nan_is_an_error() {
    let mut mesh = grid(6, Scheme::Six, 0.0);
    let count = mesh.points.len();
    mesh.arrays.push(Array {
        name: "empty".to_owned(),
        association: Association::Point,
        components: 1,
        values: NumericColumn::from(vec![f32::NAN; count]),
    });
    assert!(matches!(&mesh.points, Points::F32(_)));
    let dataset = Dataset::from_tets(mesh).unwrap();
    let field = dataset.field(&FieldSelection::parse("empty", &dataset.arrays));
    assert!(matches!(field, Err(Error::UnusableArray { .. })));
}
