//! The volume composited with a picture of another program, and with triangles of other files: closed forms, and its own surface.

use std::fmt::Write;

use std::sync::Arc;

use cellfan::generate::Scheme;
use cellfan::geometry::{GeometryOptions, SurfaceFaces, TriangleMesh};
use cellfan::image::DepthImage;
use cellfan::optics::Output;
use cellfan::{
    Camera, CpuMethod, Error, Image, Model, Projection, Region, RenderOptions, Rendered, Renderer, Scene,
    TransferFunction, io,
};
use glam::DVec3;

use crate::check::Case;
use crate::geometry::{COLOR, with};
use crate::meshes::{grid, smooth, three_views};
use crate::opaque::{Eye, Met, sides_of_unit_cube};

pub(crate) const EXTINCTION: f64 = 2.0;

/// The unit cube, homogeneous, white.
pub(crate) fn cube() -> Scene {
    let case = Case::new(grid(384, Scheme::Six, 0.2), "value");
    let field = case.dataset.homogeneous_field();
    Scene::new(case.dataset, field, &TransferFunction::constant([1.0; 3], EXTINCTION).unwrap())
}

/// A picture of depths that slope from column to column, with holes: beyond them there is a faint glow, or nothing.
pub(crate) fn slope(camera: &Camera) -> DepthImage {
    let (width, height) = (camera.width, camera.height);
    let middle = (DVec3::splat(0.5) - camera.eye).dot((camera.target - camera.eye).normalize());
    let pixels = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let is_hole = |x: u32, y: u32| (x + y).is_multiple_of(7);
    let color = |(x, y)| match (is_hole(x, y), x % 2) {
        (false, _) => [COLOR[0], COLOR[1], COLOR[2], 1.0],
        (true, 0) => [0.1, 0.05, 0.0, 0.25],
        (true, _) => [0.0; 4],
    };
    let depth = |(x, y)| {
        let share = f64::from(x) / f64::from(width) - 0.5;
        if is_hole(x, y) { f32::INFINITY } else { (middle.max(0.3) + share) as f32 }
    };
    DepthImage::new(Image { width, height, pixels: pixels().map(color).collect() }, pixels().map(depth).collect())
        .unwrap()
}

pub(crate) fn composited(scene: &Scene, external: &DepthImage) -> Scene {
    let mut scene = scene.clone();
    scene.set_external(Some(Arc::new(external.clone())));
    scene
}

/// Depths at which the ray of a pixel enters and leaves the unit cube, and world length per depth.
fn chord(camera: &Camera, x: u32, y: u32) -> Option<(f64, f64, f64)> {
    let ray = camera.frame().unwrap().ray(x.into(), y.into());
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let sides = [0.0, 1.0].map(|side| (side - ray.origin[axis]) / ray.direction[axis]);
        enter = enter.max(sides[0].min(sides[1]));
        leave = leave.min(sides[0].max(sides[1]));
    }
    (enter < leave).then(|| (enter, leave, ray.direction.length()))
}

#[test]
fn a_homogeneous_cube_is_cut_at_the_depth_of_each_pixel() {
    let scene = cube();
    for (view, camera) in three_views(90, 70) {
        let external = slope(&camera);
        let scene = composited(&scene, &external);
        for (cpu_method, model) in [
            (CpuMethod::Footprints, Model::EmissionAbsorption),
            (CpuMethod::Fans, Model::EmissionAbsorption),
            (CpuMethod::Footprints, Model::Emission),
            (CpuMethod::Footprints, Model::Absorption),
        ] {
            let options = RenderOptions { cpu_method, model, ..RenderOptions::default() };
            let image = Renderer::new(options).render(&scene, &camera).unwrap().image;
            let (mut cut, mut largest) = (0, 0.0_f64);
            for (x, y) in (0..70).flat_map(|y| (0..90).map(move |x| (x, y))) {
                let i = (y * 90 + x) as usize;
                let (wall, back) = (f64::from(external.depth_world[i]), external.image.pixels[i].map(f64::from));
                let length = chord(&camera, x, y)
                    .map_or(0.0, |(enter, leave, scale)| (leave.min(wall) - enter).max(0.0) * scale);
                // A grazed edge may be missed by rounding.
                cut += usize::from(wall.is_finite() && length > 0.0);
                let left = (-EXTINCTION * length).exp();
                let expected = match model {
                    Model::Emission => [0, 1, 2].map(|k| EXTINCTION * length + back[k]).map(|c| [c, back[3]]),
                    Model::Absorption => [0, 1, 2].map(|_| [left * (1.0 - back[3]), left * (1.0 - back[3])]),
                    _ => [0, 1, 2].map(|k| [1.0 - left + left * back[k], 1.0 - left * (1.0 - back[3])]),
                };
                let found = image.pixel(x, y).map(f64::from);
                for (k, [color, alpha]) in expected.into_iter().enumerate() {
                    let error = (found[k] - color).abs().max((found[3] - alpha).abs());
                    largest = largest.max(error);
                    assert!(
                        error < 2e-4,
                        "{view}, {model}, {cpu_method:?}, ({x}, {y}): {found:?} for {color}, {alpha}"
                    );
                }
            }
            println!("{view:9} {model:20} {cpu_method:?}: {cut} rays cut, largest error {largest:.1e}");
            assert!(cut > 1000 || view != "outside");
        }
    }
}

#[test]
fn pictures_are_chained_by_depth() {
    let scene = cube();
    for (view, camera) in three_views(90, 70) {
        let external = slope(&camera);
        let options = RenderOptions { depth: true, ..RenderOptions::default() };
        let render = |scene: &Scene| -> Rendered { Renderer::new(options).render(scene, &camera).unwrap() };
        let first = render(&composited(&scene, &external)).depth_image().unwrap();
        for (found, expected) in first.depth_world.iter().zip(&external.depth_world) {
            // What lies behind the eye is as near as can be.
            let is_behind = *expected <= 0.0 && (0.0..1e-30).contains(found);
            let is_same = found == expected || (found - expected).abs() < 1e-6 * expected.abs();
            assert!(is_same || is_behind, "{view}: {found} for {expected}");
        }
        // Nothing is drawn twice of a volume that shows nothing.
        let mut clear = scene.clone();
        clear.set_transfer(&TransferFunction::constant([1.0; 3], 0.0).unwrap());
        let again = render(&composited(&clear, &first)).depth_image().unwrap();
        let pairs = again.image.pixels.iter().zip(&first.image.pixels);
        let off = pairs.flat_map(|(a, b)| a.iter().zip(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-6, "{view}: {off}");
        // Without anything opaque all is far away.
        let nothing = render(&scene);
        assert!(nothing.depth_world.unwrap().iter().all(|depth| *depth == f32::INFINITY));
        assert!(Renderer::new(RenderOptions::default()).render(&scene, &camera).unwrap().depth_world.is_none());
    }
}

#[test]
fn a_region_takes_its_part_of_the_picture() {
    let (scene, [(_, camera), ..]) = (cube(), three_views(150, 110));
    let external = slope(&camera);
    let options =
        RenderOptions { depth: true, ..with(GeometryOptions { edges: Some([1.0; 3]), ..Default::default() }) };
    let whole = Renderer::new(options).render(&composited(&scene, &external), &camera).unwrap();
    let region = Region { x0: 37, y0: 21, x1: 118, y1: 67 };
    let places = || (21..67).flat_map(|y| (37..118).map(move |x| (y * 150 + x) as usize));
    let crop = |all: &[[f32; 4]]| places().map(|i| all[i]).collect::<Vec<_>>();
    let part = DepthImage {
        image: Image { width: 81, height: 46, pixels: crop(&external.image.pixels) },
        depth_world: places().map(|i| external.depth_world[i]).collect(),
    };
    let camera = Camera { region: Some(region), ..camera };
    for external in [external, part] {
        let drawn = Renderer::new(options).render(&composited(&scene, &external), &camera).unwrap();
        assert!(drawn.image.pixels == crop(&whole.image.pixels));
        let depths = whole.depth_world.as_ref().unwrap();
        assert!(drawn.depth_world.unwrap().into_iter().eq(places().map(|i| depths[i])));
    }
    let small = slope(&Camera { width: 81, height: 45, ..camera.clone() });
    let refused = Renderer::new(options).render(&composited(&scene, &small), &camera).unwrap_err().to_string();
    assert!(refused.contains("(Vol's error 102)") && refused.contains("81x46 as the region"), "{refused}");
}

/// The unit cube's sides as a file of another program.
pub(crate) fn cube_mesh() -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for triangle in sides_of_unit_cube().triangles {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(triangle.map(|corner| corner.to_array()));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    mesh
}

fn stl(mesh: &TriangleMesh) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for triangle in &mesh.triangles {
        bytes.extend([0; 12]);
        let corners = triangle.iter().flat_map(|&corner| mesh.positions[corner as usize]);
        corners.for_each(|x| bytes.extend((x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ply(mesh: &TriangleMesh) -> Vec<u8> {
    let (vertices, faces) = (mesh.positions.len(), mesh.triangles.len());
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    );
    for [x, y, z] in &mesh.positions {
        let _ = writeln!(text, "{x} {y} {z}");
    }
    for [a, b, c] in &mesh.triangles {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    text.into_bytes()
}

#[test]
fn the_cube_of_a_file_is_the_surface_of_the_cube() {
    let case = Case::new(grid(6, Scheme::Six, 0.0), "value");
    let surface =
        with(GeometryOptions { surface: Some(COLOR), surface_faces: SurfaceFaces::All, ..Default::default() });
    let mesh = cube_mesh();
    for (name, bytes) in [("a.stl", stl(&mesh)), ("a.ply", ply(&mesh))] {
        let read = io::read_triangles(&bytes, name.as_ref()).unwrap();
        for (view, camera) in three_views(120, 90) {
            let mut scene = case.scene(&smooth());
            let expected = Renderer::new(surface).render(&scene, &camera).unwrap();
            scene.add_triangles(&read, Some(COLOR)).unwrap();
            let found = Renderer::new(RenderOptions::default()).render(&scene, &camera).unwrap();
            assert_eq!(found.geometry.triangles, 12);
            let off = |pair: &(&[f32; 4], &[f32; 4])| (0..4).any(|k| (pair.0[k] - pair.1[k]).abs() > 1e-5);
            let differ = found.image.pixels.iter().zip(&expected.image.pixels).filter(off).count();
            // Centres on a border may go to either side.
            assert!(differ <= 4, "{name}, {view}: {differ} pixels differ");
        }
    }
}

#[test]
fn normals_and_colours_run_across_a_triangle() {
    // A square across the cube, half way, its colour its place, its normals turned aside at one end.
    let mut scene = cube();
    scene.set_transfer(&TransferFunction::constant([1.0; 3], 0.0).unwrap());
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mesh = TriangleMesh {
        positions: corners.map(|[y, z]| [0.5, y, z]).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: corners.map(|[y, _]| if y > 0.0 { [0.6, 0.8, 0.0] } else { [-1.0, 0.0, 0.0] }).to_vec(),
        colors: corners.map(|[y, z]| [y as f32, z as f32, 0.5]).to_vec(),
    };
    scene.add_triangles(&mesh, None).unwrap();
    for projection in [Projection::Orthographic { height_world: 1.5 }, Projection::Perspective { fov_degrees: 30.0 }] {
        let mut camera = Camera::looking_at(DVec3::new(3.0, 0.7, 0.4), DVec3::new(0.5, 0.5, 0.5), 60, 60);
        camera.projection = projection;
        let options = RenderOptions { depth: true, ..RenderOptions::default() };
        let rendered = Renderer::new(options).render(&scene, &camera).unwrap();
        let eye = Eye::new(&camera, 1.0);
        let quad = crate::opaque::Primitives {
            triangles: mesh
                .triangles
                .iter()
                .map(|t| t.map(|i| DVec3::from_array(mesh.positions[i as usize])))
                .collect(),
            ..Default::default()
        };
        let mut seen = 0;
        for (x, y) in (0..60).flat_map(|y| (0..60).map(move |x| (x, y))) {
            let Met::At(depth, _) = quad.meet(&eye, [x, y], [1.0; 2], false) else { continue };
            seen += 1;
            let ray = camera.frame().unwrap().ray(x.into(), y.into());
            let hit = ray.origin + ray.direction * depth;
            let normal = DVec3::new(-1.0, 0.0, 0.0).lerp(DVec3::new(0.6, 0.8, 0.0), hit.y).normalize();
            let light = cellfan::geometry::headlight(normal.dot(ray.direction.normalize()) as f32);
            let expected = [hit.y as f32, hit.z as f32, 0.5].map(|channel| channel * light);
            let found = rendered.image.pixel(x, y);
            for k in 0..3 {
                assert!((found[k] - expected[k]).abs() < 1e-4, "({x}, {y}): {found:?} for {expected:?}");
            }
            let found = rendered.depth_world.as_ref().unwrap()[(y * 60 + x) as usize];
            assert!((f64::from(found) - depth).abs() < 1e-5 * depth);
        }
        assert!(seen > 1000);
    }
}

#[test]
fn what_cannot_be_drawn_beside_a_mesh_is_refused() {
    let mut scene = cube();
    let far = TriangleMesh { positions: vec![[1e13, 0.0, 0.0]; 3], triangles: vec![[0, 1, 2]], ..Default::default() };
    assert!(matches!(scene.add_triangles(&far, None), Err(Error::Option { option: "--mesh", .. })));
    let few = TriangleMesh { positions: vec![[0.0; 3]; 2], triangles: vec![[0, 1, 2]], ..Default::default() };
    assert!(matches!(scene.add_triangles(&few, None), Err(Error::IndexOutOfRange { .. })));
    assert_eq!(scene.added_triangles(), 0);
}

#[test]
fn depths_of_an_absorption_picture_end_at_the_wall() {
    let (scene, [(_, camera), ..]) = (cube(), three_views(90, 70));
    let external = slope(&camera);
    let options = RenderOptions { model: Model::Absorption, output: Output::Depth, ..RenderOptions::default() };
    let image = Renderer::new(options).render(&composited(&scene, &external), &camera).unwrap().image;
    for (x, y) in (0..70).flat_map(|y| (0..90).map(move |x| (x, y))) {
        let wall = f64::from(external.depth_world[(y * 90 + x) as usize]);
        let length =
            chord(&camera, x, y).map_or(0.0, |(enter, leave, scale)| (leave.min(wall) - enter).max(0.0) * scale);
        assert!((f64::from(image.pixel(x, y)[3]) - EXTINCTION * length).abs() < 2e-4);
    }
}
