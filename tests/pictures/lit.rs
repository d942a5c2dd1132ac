//! Cells and cubes that reflect light: against a twin in f64 that lights each part of a ray by Phong's formula.

use cellfan::columns::{Array, Association, Lattice, Points, Volume};
use cellfan::generate::Scheme;
use cellfan::io::StructuredMesh;
use cellfan::optics::lighting::{Light, Lighting};
use cellfan::render::{CubeScene, Detail};
use cellfan::{
    Camera, CpuMethod, Dataset, Error, Field, FieldSelection, Image, Model, RenderOptions, Renderer, Scene,
    TransferFunction,
};
use glam::{DMat3, DVec3};

use crate::cubes::{segments as segments_of_cubes, views};
use crate::meshes::{grid, smooth};
use crate::reference::{Reference, Segment, shade};

/// Two lights, one coloured, and coefficients of its own.
fn lighting(has_strength: bool) -> Lighting {
    let light = |direction: [f64; 3], color| Light { direction: direction.into(), color };
    Lighting {
        ambient: 0.3,
        diffuse: 0.5,
        specular: 0.4,
        shininess: 7.0,
        lights: vec![light([1.0, -2.0, 0.5], [1.0, 0.9, 0.8]), light([-1.0, 0.2, 0.3], [0.1, 0.2, 0.6])],
        has_strength,
        has_shadows: false,
    }
}

/// What a surface with this gradient makes of a colour and of opacity.
fn reflected(lighting: &Lighting, gradient: DVec3, toward_eye: DVec3) -> [DVec3; 2] {
    let [mut of_color, mut of_opacity] = [DVec3::ZERO; 2];
    for light in &lighting.lights {
        let (color, l) = (DVec3::from(light.color.map(f64::from)), light.direction.normalize());
        of_color += color * f64::from(lighting.ambient);
        if gradient.length() > 0.0 {
            let n = gradient.normalize();
            of_color += color * f64::from(lighting.diffuse) * n.dot(l).abs();
            let r = 2.0 * n.dot(l) * n - l;
            of_opacity +=
                color * f64::from(lighting.specular) * r.dot(toward_eye).abs().powf(lighting.shininess.into());
        }
    }
    [of_color, of_opacity]
}

/// A ray's light: each part with its cell's gradient and middle, and how strong its surface is.
fn pixel(
    transfer: &TransferFunction,
    segments: &[Segment],
    (lighting, camera): (&Lighting, &Camera),
    of_cell: &dyn Fn(usize) -> (DVec3, DVec3, f64),
) -> [f64; 4] {
    let (mut light, mut transmittance) = (DVec3::ZERO, 1.0);
    for segment in segments {
        let (gradient, middle, strength) = of_cell(segment.cell);
        let [of_color, of_opacity] = reflected(lighting, gradient, (camera.eye - middle).normalize());
        let length_world = segment.length_world * if lighting.has_strength { strength } else { 1.0 };
        let [r, g, b, a] = shade(Model::EmissionAbsorption, transfer, &[Segment { length_world, ..*segment }]);
        light += transmittance * (of_color * DVec3::new(r, g, b) + of_opacity * a);
        transmittance *= 1.0 - a;
    }
    [light.x, light.y, light.z, 1.0 - transmittance]
}

/// Count, mean and largest difference on some pixels that show something.
fn errors(image: &Image, expected: impl Fn([u32; 2]) -> [f64; 4]) -> (usize, f64, f64) {
    let mut errors = Vec::new();
    for i in 0..150 {
        let pixel @ [x, y] = [i * 7919 % image.width, i * 104_729 % image.height];
        let expected = expected(pixel);
        if expected[3] > 0.0 {
            let found = image.pixel(x, y);
            errors.push((0..4).map(|c| (f64::from(found[c]) - expected[c]).abs()).fold(0.0, f64::max));
        }
    }
    (errors.len(), errors.iter().sum::<f64>() / errors.len() as f64, errors.into_iter().fold(0.0, f64::max))
}

/// Hexahedra of a bent block, whole, and a grid of tetrahedra.
fn datasets() -> [(&'static str, Dataset); 2] {
    let dims = [9, 7, 8];
    let place = |i: usize| [i % dims[0], i / dims[0] % dims[1], i / (dims[0] * dims[1])].map(|along| along as f64);
    let points: Vec<[f64; 3]> = (0..dims.iter().product())
        .map(place)
        .map(|[x, y, z]| [0.1 * x + 0.02 * (0.7 * y).sin(), 0.13 * y + 0.015 * (0.9 * z).cos(), 0.11 * z])
        .collect();
    let values: Vec<f64> = points.iter().map(|[x, y, z]| 0.5 + 0.5 * (4.0 * x + 3.0 * y * z).sin()).collect();
    let array = Array { name: "value".into(), association: Association::Point, components: 1, values: values.into() };
    let block = StructuredMesh::new(&[dims], Points::F64(points), vec![array]).unwrap();
    let whole = block.into_whole_dataset().unwrap();
    assert!(!whole.hexahedra.structured_blocks().is_empty());
    [("hexahedra", whole), ("tetrahedra", Dataset::from_tets(grid(400, Scheme::Six, 0.2)).unwrap())]
}

/// Gradient, middle and strength of each cell, from the changes between the middles of opposite faces, or along three edges.
fn gradients(dataset: &Dataset, field: &Field) -> Vec<(DVec3, DVec3, f64)> {
    let at = |v: u32| {
        let p = DVec3::from(dataset.positions[v as usize].map(f64::from)) + dataset.origin;
        (p, f64::from(field.values[v as usize]) + field.offset)
    };
    let solved = |edges: [DVec3; 3], changes: [f64; 3]| {
        let [a, b, c] = edges;
        let volume = a.dot(b.cross(c));
        (changes[0] * b.cross(c) + changes[1] * c.cross(a) + changes[2] * a.cross(b)) / volume
    };
    let of_tets = dataset.tets.iter().map(|tet| {
        let [a, b, c, d] = tet.map(at);
        let gradient = solved([b.0 - a.0, c.0 - a.0, d.0 - a.0], [b.1 - a.1, c.1 - a.1, d.1 - a.1]);
        let volume = (b.0 - a.0).dot((c.0 - a.0).cross(d.0 - a.0)).abs() / 6.0;
        (gradient, (a.0 + b.0 + c.0 + d.0) / 4.0, volume)
    });
    let hexahedra = dataset.hexahedra.view();
    let of_hexahedra = (0..hexahedra.len()).map(|cell| {
        let corners = hexahedra.get(cell).map(at);
        let face = |corners_of: [usize; 4]| {
            let sum =
                corners_of.iter().fold((DVec3::ZERO, 0.0), |sum, &i| (sum.0 + corners[i].0, sum.1 + corners[i].1));
            (sum.0 / 4.0, sum.1 / 4.0)
        };
        let pairs = [[[0, 3, 4, 7], [1, 2, 5, 6]], [[0, 1, 4, 5], [3, 2, 7, 6]], [[0, 1, 2, 3], [4, 5, 6, 7]]];
        let across = pairs.map(|[low, high]| {
            let (low, high) = (face(low), face(high));
            (high.0 - low.0, high.1 - low.1)
        });
        let gradient = solved(across.map(|(edge, _)| edge), across.map(|(_, change)| change));
        let middle = corners.iter().map(|(p, _)| *p).sum::<DVec3>() / 8.0;
        let p = corners.map(|(p, _)| (p - corners[0].0).as_vec3());
        (gradient, middle, hexahedra.shape(cell).volume(p))
    });
    let cells: Vec<_> = of_tets.chain(of_hexahedra).collect();
    let side = (cells.iter().map(|(.., volume)| volume).sum::<f64>() / cells.len() as f64).cbrt();
    let (low, high) = field.range;
    cells.into_iter().map(|(gradient, middle, _)| (gradient, middle, gradient.length() * side / (high - low))).collect()
}

#[test]
fn lit_cells_are_the_twin_that_lights_each_part_of_a_ray() {
    let transfer = smooth();
    for (name, dataset) in datasets() {
        let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays)).unwrap();
        let (reference, cells) = (Reference::new(&dataset, &field), gradients(&dataset, &field));
        let camera = Camera::framing(&dataset.corners_world(), 40.0, 25.0, 96, 72);
        let scene = Scene::new(dataset, field, &transfer);
        for has_strength in [false, true] {
            let lighting = lighting(has_strength);
            let options = RenderOptions { stop_transmittance: 0.0, ..RenderOptions::default() };
            let draw = |lighting: Option<Lighting>| {
                let mut renderer = Renderer::new(options);
                renderer.set_lighting(lighting);
                renderer.render(&scene, &camera).unwrap().image
            };
            let image = draw(Some(lighting.clone()));
            let expected = |[x, y]: [u32; 2]| {
                pixel(&transfer, &reference.segments(&camera, x, y), (&lighting, &camera), &|cell| cells[cell])
            };
            let (count, mean, largest) = errors(&image, expected);
            println!("{name}, strength {has_strength}: {count} pixels, mean {mean:.1e}, largest {largest:.1e}");
            assert!(count > 40 && mean <= 1e-4 && largest <= 2e-3, "{name}: mean {mean:.1e}, largest {largest:.1e}");
            // Negative controls: without light, and with another lamp.
            assert!(errors(&draw(None), expected).1 > 1e-2);
            let other = Lighting { lights: lighting.lights[..1].to_vec(), ..lighting.clone() };
            assert!(errors(&draw(Some(other)), expected).1 > 1e-3);
        }
    }
}

#[test]
fn lit_cubes_are_the_twin_that_lights_each_part_of_a_ray() {
    let transfer = smooth();
    let dims = [11, 9, 10];
    let place = |i: usize| [i % dims[0], i / dims[0] % dims[1], i / (dims[0] * dims[1])];
    let value = |[i, j, k]: [usize; 3]| 0.5 + 0.5 * (0.5 * i as f64 + 0.31 * (j * k) as f64 / 5.0).sin();
    let values: Vec<f64> = (0..dims.iter().product()).map(|i| value(place(i))).collect();
    let array = Array { name: "v".into(), association: Association::Point, components: 1, values: values.into() };
    let steps = DMat3::from_cols(DVec3::X, DVec3::new(0.15, 0.9, 0.0), DVec3::new(-0.1, 0.1, 1.1)) * 0.1;
    let volume = Volume::new(dims, Lattice::sheared(DVec3::new(0.2, -0.1, 0.3), steps), vec![array]).unwrap();
    let field = volume.field(&FieldSelection::parse("v", &[])).unwrap();
    let (low, high) = field.range;
    let scene = CubeScene::new(&volume, field, &transfer).unwrap();
    let of_cube = |cell: usize| {
        let at = place(cell);
        let along = DVec3::from([0, 1, 2].map(|axis| {
            let moved = |place: usize| [0, 1, 2].map(|a| if a == axis { place } else { at[a] });
            let (before, after) = (at[axis].saturating_sub(1), (at[axis] + 1).min(dims[axis] - 1));
            (value(moved(after)) - value(moved(before))) / (after - before) as f64
        }));
        let gradient = steps.inverse().transpose() * along;
        let strength = gradient.length() * steps.determinant().cbrt() / (high - low);
        (gradient, volume.lattice.world(DVec3::from(at.map(|along| along as f64))), strength)
    };
    let [(_, camera), ..] = views(&scene, [96, 72]);
    for has_strength in [false, true] {
        let lighting = lighting(has_strength);
        let mut renderer = Renderer::new(RenderOptions { stop_transmittance: 0.0, ..RenderOptions::default() });
        renderer.set_lighting(Some(lighting.clone()));
        let image = renderer.render_cubes(&scene, Detail::Error(0.0), &camera).unwrap().0.image;
        let expected = |pixel_at: [u32; 2]| {
            pixel(&transfer, &segments_of_cubes(&scene, &camera, pixel_at), (&lighting, &camera), &of_cube)
        };
        let (count, mean, largest) = errors(&image, expected);
        println!("strength {has_strength}: {count} pixels, mean {mean:.1e}, largest {largest:.1e}");
        assert!(count > 40 && mean <= 1e-4 && largest <= 2e-3, "mean {mean:.1e}, largest {largest:.1e}");
        renderer.set_lighting(None);
        let dark = renderer.render_cubes(&scene, Detail::Error(0.0), &camera).unwrap().0.image;
        assert!(errors(&dark, expected).1 > 1e-2);
    }
}

#[test]
fn light_that_cannot_be_drawn_is_refused() {
    let [(_, dataset), _] = datasets();
    let camera = Camera::framing(&dataset.corners_world(), 40.0, 25.0, 20, 16);
    let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays)).unwrap();
    let of_cells = dataset.homogeneous_field();
    let points = Scene::new(dataset.clone(), field, &smooth());
    let cells = Scene::new(dataset, of_cells, &smooth());
    let default = RenderOptions::default();
    let refused = |scene: &Scene, options: RenderOptions, lighting: Lighting| {
        let mut renderer = Renderer::new(options);
        renderer.set_lighting(Some(lighting));
        match renderer.render(scene, &camera) {
            Err(Error::Option { option, .. }) => option,
            other => panic!("{:?}", other.map(|rendered| rendered.frame_ms)),
        }
    };
    let plain = lighting(false);
    assert_eq!(refused(&cells, default, plain.clone()), "--shade");
    assert_eq!(refused(&points, RenderOptions { model: Model::Mip, ..default }, plain.clone()), "--shade");
    assert_eq!(refused(&points, RenderOptions { model: Model::Emission, ..default }, plain.clone()), "--shade");
    assert_eq!(
        refused(&points, RenderOptions { cpu_method: CpuMethod::Fans, ..default }, plain.clone()),
        "--cpu-method"
    );
    assert_eq!(refused(&points, default, Lighting { has_shadows: true, ..plain.clone() }), "--shade");
    assert_eq!(refused(&points, default, Lighting { ambient: -1.0, ..plain }), "--ambient");
}
