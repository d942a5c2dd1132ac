//! Closed forms: the homogeneous cube however it is cut, one tetrahedron, a slab.

use cellfan::columns::{CellCounts, Points};
use cellfan::generate::Scheme;
use cellfan::{
    Camera, CpuMethod, Dataset, Image, Model, Projection, RenderOptions, Renderer, Scene, TetMesh, TransferFunction,
};
use glam::DVec3;

use crate::check::Case;
use crate::meshes::{chord_of_unit_cube, frame_unit_cube, grid, mesh, point};

const EXTINCTION: f64 = 2.5;

/// Rays this close to the cube's surface (world units) may meet it or not.
const HAIR: f64 = 2e-6;

/// The opacity of the cube of constant extinction is 1 − e^(−κL); says which pixels are farther from it than 1e-5.
fn compare(image: &Image, camera: &Camera, what: &str) -> Result<(), String> {
    let opacity = |chord: f64| -(-EXTINCTION * chord).exp_m1();
    let (mut largest, mut covered, mut hairs) = (0.0_f64, 0, 0);
    let mut wrong = Vec::new();
    for (x, y) in (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (x, y))) {
        let found = image.pixel(x, y);
        let [least, chord, most] = [-HAIR, 0.0, HAIR].map(|grown| chord_of_unit_cube(camera, x, y, grown));
        if most == 0.0 {
            if found != [0.0; 4] {
                wrong.push(format!("({x}, {y}) misses the cube and is {found:?}"));
            }
            continue;
        }
        covered += 1;
        // Along a face or an edge of the cube, any chord between is right.
        let is_hair = most - least > 1e-4;
        hairs += u32::from(is_hair);
        let (low, high) = if is_hair { (opacity(least), opacity(most)) } else { (opacity(chord), opacity(chord)) };
        // White light everywhere: the premultiplied colour is the opacity.
        let error = found.map(f64::from).map(|c| if c.is_nan() { 1.0 } else { (low - c).max(c - high).max(0.0) });
        let error = error.into_iter().fold(0.0, f64::max);
        if error > 1e-5 {
            wrong.push(format!("({x}, {y}) is {found:?} for {}", opacity(chord)));
        }
        largest = largest.max(error);
    }
    println!("{what:44} {covered:6} covered, {hairs:4} along a surface, largest error {largest:.1e}");
    assert!(covered > 500 && hairs * 10 <= covered, "{what}: {covered} covered, {hairs} along a surface");
    if wrong.is_empty() {
        return Ok(());
    }
    Err(format!("{what}: {} wrong pixels, the first: {}", wrong.len(), wrong[0]))
}

fn views() -> Vec<(String, Camera)> {
    let mut views = Vec::new();
    for (azimuth, elevation) in [(37.0, 22.0), (200.0, -41.0), (0.0, 0.0), (45.0, 0.0), (90.0, 90.0)] {
        let camera = frame_unit_cube(azimuth, elevation, 131, 97);
        views.push((format!("perspective {azimuth}, {elevation}"), camera.clone()));
        let parallel = Camera { projection: Projection::Orthographic { height_world: 1.83 }, ..camera };
        views.push((format!("parallel {azimuth}, {elevation}"), parallel));
    }
    // Along the axes, where whole layers of faces are exactly edge-on.
    let center = DVec3::splat(0.5);
    for axis in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
        let mut camera = Camera::looking_at(center + axis * 3.0, center, 97, 131);
        camera.projection = Projection::Orthographic { height_world: 1.3 };
        views.push((format!("parallel along {axis}"), camera));
    }
    // Along the diagonal that six tetrahedra share, and past it.
    for aside in [DVec3::ZERO, DVec3::new(0.13, -0.08, 0.02)] {
        let camera = Camera::looking_at(DVec3::splat(-1.5) + aside, center + aside, 93, 93);
        views.push((format!("perspective along the diagonal + {aside}"), camera.clone()));
        let parallel = Camera { projection: Projection::Orthographic { height_world: 1.7 }, ..camera };
        views.push((format!("parallel along the diagonal + {aside}"), parallel));
    }
    let eyes = [
        ("inside", DVec3::new(0.41, 0.52, 0.37)),
        ("on the middle vertex", center),
        ("on the lattice", DVec3::new(0.25, 0.5, 0.75)),
        ("on a corner", DVec3::ZERO),
        ("on an outer face", DVec3::new(0.0, 0.4, 0.6)),
        ("on an edge", DVec3::new(0.0, 0.0, 0.5)),
    ];
    for (name, eye) in eyes {
        let mut camera = Camera::looking_at(eye, DVec3::new(0.9, 0.8, 0.75), 120, 90);
        camera.projection = Projection::Perspective { fov_degrees: 80.0 };
        views.push((format!("eye {name}"), camera.clone()));
        let parallel = Camera { projection: Projection::Orthographic { height_world: 1.2 }, ..camera };
        views.push((format!("parallel, eye {name}"), parallel));
    }
    views
}

/// The cube in `cells` tetrahedra from every view.
fn check_cube(cells: u64, scheme: Scheme, jitter: f64, cpu_method: CpuMethod) {
    let dataset = Dataset::from_tets(grid(cells, scheme, jitter)).unwrap();
    let count = dataset.tets.len();
    let transfer = TransferFunction::constant([1.0; 3], EXTINCTION).unwrap();
    let field = dataset.homogeneous_field();
    let scene = Scene::new(dataset, field, &transfer);
    // A ray is never ended: 1e-5 is the precision asked for.
    let options = RenderOptions { stop_transmittance: 0.0, cpu_method, ..RenderOptions::default() };
    let mut renderer = Renderer::new(options);
    let mut failures = Vec::new();
    for (view, camera) in views() {
        let image = renderer.render(&scene, &camera).unwrap().image;
        failures.extend(compare(&image, &camera, &format!("{count} tetrahedra, {cpu_method:?}, {view}")).err());
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn homogeneous_cube_in_5_and_6() {
    for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays] {
        check_cube(5, Scheme::Five, 0.0, cpu_method);
        check_cube(6, Scheme::Six, 0.0, cpu_method);
    }
}

#[test]
fn homogeneous_cube_in_48_jittered() {
    for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays] {
        check_cube(48, Scheme::Six, 0.25, cpu_method);
    }
}

#[test]
fn homogeneous_cube_in_6000_regular() {
    for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays] {
        check_cube(6000, Scheme::Six, 0.0, cpu_method);
    }
}

#[test]
fn homogeneous_cube_in_5000_regular() {
    for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays] {
        check_cube(5000, Scheme::Five, 0.0, cpu_method);
    }
}

#[test]
fn homogeneous_cube_in_100_000_jittered() {
    for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays] {
        check_cube(100_000, Scheme::Six, 0.25, cpu_method);
    }
}

#[test]
fn the_comparison_with_the_cube_can_fail() {
    let camera = frame_unit_cube(37.0, 22.0, 120, 90);
    let dataset = Dataset::from_tets(grid(48, Scheme::Six, 0.25)).unwrap();
    let field = dataset.homogeneous_field();
    let transfer = TransferFunction::constant([1.0; 3], EXTINCTION).unwrap();
    let options = RenderOptions { stop_transmittance: 0.0, ..RenderOptions::default() };
    let scene = Scene::new(dataset, field, &transfer);
    let mut image = Renderer::new(options).render(&scene, &camera).unwrap().image;
    assert_eq!(compare(&image, &camera, "unchanged"), Ok(()));
    image.pixels[45 * 120 + 60][3] += 2e-5;
    let error = compare(&image, &camera, "one pixel changed").unwrap_err();
    assert!(error.contains("1 wrong pixels, the first: (60, 45)"), "{error}");
    image.pixels[45 * 120 + 60][3] -= 2e-5;
    // One pixel beside the cube, however faint, is found.
    image.pixels[0] = [1e-9; 4];
    let error = compare(&image, &camera, "a pixel beside it").unwrap_err();
    assert!(error.contains("(0, 0) misses"), "{error}");
}

/// A corner tetrahedron of legs a, seen along z: the ray at (x, y) has the length a − x − y.
#[test]
fn one_tetrahedron() {
    let legs = 0.75;
    let points = vec![[0.0, 0.0, 0.0], [legs, 0.0, 0.0], [0.0, legs, 0.0], [0.0, 0.0, legs]];
    // s = z / legs; κ = 4 s: the depth of a ray from z = 0 to its length L is 2 L² / legs.
    let case = Case::new(mesh(points, vec![[0, 1, 2, 3]], vec![0.0, 0.0, 0.0, 1.0]), "value");
    let transfer =
        TransferFunction::new(vec![point(0.0, [0.5, 0.25, 1.0], 0.0), point(1.0, [0.5, 0.25, 1.0], 4.0)]).unwrap();
    let center = DVec3::new(0.3, 0.3, 0.0);
    let mut camera = Camera::looking_at(center - DVec3::Z, center, 64, 64);
    camera.projection = Projection::Orthographic { height_world: 1.0 };
    for model in Model::ALL {
        let image = case.render(RenderOptions { model, ..RenderOptions::default() }, &transfer, &camera).image;
        let mut covered = 0;
        for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
            let at = camera.frame().unwrap().ray(f64::from(x), f64::from(y)).origin;
            let found = image.pixel(x, y);
            let length = legs - at.x - at.y;
            if at.x < 0.0 || at.y < 0.0 || length < 0.0 {
                let miss = if model == Model::Absorption { [1.0; 4] } else { [0.0; 4] };
                assert_eq!(found, miss, "{model} ({x}, {y})");
                continue;
            }
            covered += 1;
            let depth = 2.0 * length * length / legs;
            let alpha = -(-depth).exp_m1();
            let expected = match model {
                Model::EmissionAbsorption => [0.5 * alpha, 0.25 * alpha, alpha, alpha],
                Model::Absorption => [0.5, 0.25, 1.0, 1.0].map(|band: f64| (-depth * band).exp()),
                Model::Emission => [0.5 * depth, 0.25 * depth, depth, 0.0],
                Model::Mip => [0.5, 0.25, 1.0, 1.0],
            };
            for k in 0..4 {
                let error = (f64::from(found[k]) - expected[k]).abs();
                assert!(error < 2e-6, "{model} ({x}, {y}): {found:?} for {expected:?}");
            }
        }
        assert!(covered > 900, "{model}: {covered} covered pixels");
    }
}

/// A slab of two linear media, colour and extinction changing across it, seen straight on and at an angle.
#[test]
fn slab() {
    // Six tetrahedra of the unit cube, s = z; κ = 3 below, colour from 0.2 to 1.
    let mut cube = grid(6, Scheme::Six, 0.0);
    let Points::F32(points) = &cube.points else { unreachable!("grids are made in f32") };
    let values: Vec<f32> = points.iter().map(|p| p[2]).collect();
    cube.arrays[0].values = values.into();
    let cube = TetMesh { counts: CellCounts { in_file: 6, ..CellCounts::default() }, ..cube };
    let case = Case::new(cube, "value");
    let transfer = TransferFunction::new(vec![point(0.0, [0.2; 3], 3.0), point(1.0, [1.0; 3], 3.0)]).unwrap();
    for tilt in [0.0, 0.31] {
        let direction = DVec3::new(tilt, 0.0, -1.0).normalize();
        let center = DVec3::splat(0.5);
        let mut camera = Camera::looking_at(center - direction * 4.0, center, 33, 33);
        camera.up = DVec3::Y;
        camera.projection = Projection::Orthographic { height_world: 0.5 };
        let image = case.render(RenderOptions::default(), &transfer, &camera).image;
        // From z = 1 to 0 over the length 1/cos: colour c0 − c1 T + (c1 − c0)(1 − T)/τ from c0 = 1 to c1 = 0.2.
        let depth = 3.0 / -direction.z;
        let t = (-depth).exp();
        let color = 1.0 - 0.2 * t - 0.8 * (1.0 - t) / depth;
        for pixel in &image.pixels {
            assert!((f64::from(pixel[1]) - color).abs() < 2e-6, "{pixel:?} for {color}");
            assert!((f64::from(pixel[3]) - (1.0 - t)).abs() < 2e-6, "{pixel:?} for {}", 1.0 - t);
        }
    }
}
