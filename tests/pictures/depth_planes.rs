//! Depth planes against closed forms, against a slow twin in f64 that takes the same samples, and against the ray integral.

use std::sync::Arc;

use cellfan::backends::cpu::InstructionSet;
use cellfan::columns::{Array, Association, FieldSelection, Lattice, NumericColumn, Volume, VolumeField};
use cellfan::depth_planes::{
    Classification, Filter, Light, Lighting, Medium, Options, Planes, Samples, ValueBlocks, draw,
};
use cellfan::geometry::{GeometryOptions, TriangleMesh};
use cellfan::image::DepthImage;
use cellfan::optics::presets::{self, OpacityProfile};
use cellfan::render::{VolumeScene, depth_planes};
use cellfan::{Camera, ControlPoint, Image, Model, Projection, Region, TransferFunction, io};
use glam::{DMat3, DVec3};

use crate::common::data_folder;

/// A volume with its only array, and what it looks like.
struct Case {
    volume: Volume,
    field: VolumeField,
    transfer: TransferFunction,
}

fn array(association: Association, values: NumericColumn) -> Array {
    Array { name: "v".into(), association, components: 1, values }
}

impl Case {
    fn new(dims: [usize; 3], lattice: Lattice, array: Array, transfer: TransferFunction) -> Self {
        let volume = Volume::new(dims, lattice, vec![array]).unwrap();
        let field = volume.field(&FieldSelection::parse("v", &[])).unwrap();
        Self { volume, field, transfer }
    }

    /// Smooth values on a small grid of any lattice.
    fn smooth(lattice: Lattice) -> Self {
        let dims = [21, 18, 24];
        let mut values = Vec::new();
        for k in 0..dims[2] {
            for j in 0..dims[1] {
                for i in 0..dims[0] {
                    let [x, y, z] = [i, j, k].map(|n| n as f32);
                    values.push(0.5 + 0.3 * (0.5 * x).sin() * (0.4 * y).cos() + 0.2 * (0.3 * z + 0.1 * x).sin());
                }
            }
        }
        Self::new(dims, lattice, array(Association::Point, values.into()), ramps())
    }

    fn draw_until(&self, camera: &Camera, options: &Options, end: &(dyn Fn(u32, u32) -> f64 + Sync)) -> Image {
        let blocks = ValueBlocks::new(&self.field);
        let medium = Medium { volume: &self.volume, field: &self.field, blocks: &blocks, transfer: &self.transfer };
        draw(medium, camera, options, end).unwrap()
    }

    fn draw(&self, camera: &Camera, options: &Options) -> Image {
        self.draw_until(camera, options, &|_, _| f64::INFINITY)
    }

    fn cameras(&self, width: u32, height: u32) -> [Camera; 2] {
        let perspective = Camera::framing(&self.volume.corners_world(), 35.0, 20.0, width, height);
        let across = perspective.eye.distance(perspective.target) * 0.5;
        let projection = Projection::Orthographic { height_world: across };
        [perspective.clone(), Camera { projection, ..perspective }]
    }
}

fn point(value: f64, color: [f64; 3], extinction: f64) -> ControlPoint {
    ControlPoint { value, color, extinction }
}

fn ramps() -> TransferFunction {
    let points = vec![
        point(0.1, [0.1, 0.2, 0.9], 0.0),
        point(0.45, [0.2, 0.9, 0.3], 0.25),
        point(0.6, [0.9, 0.8, 0.1], 0.0),
        point(0.95, [1.0, 0.3, 0.2], 0.9),
    ];
    TransferFunction::new(points).unwrap()
}

fn sheared() -> Lattice {
    let steps = DMat3::from_cols([0.9, 0.1, 0.0].into(), [0.3, 1.1, -0.1].into(), [-0.2, 0.25, 0.8].into());
    Lattice::sheared([3.0, -2.0, 1.0].into(), steps)
}

/// The world ray of a pixel, from the camera's own fields: origin and change per unit of view depth.
fn ray(camera: &Camera, x: f64, y: f64, is_vol: bool) -> (DVec3, DVec3) {
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let down = forward.cross(right);
    let (width, height) = (f64::from(camera.width), f64::from(camera.height));
    // The paper: from −1 to 1 in steps of 2/(size − 1), times half the picture.
    let place = |pixel: f64, size: f64| {
        if is_vol { (-1.0 + pixel * 2.0 / (size - 1.0)) * 0.5 * size } else { pixel + 0.5 - 0.5 * size }
    };
    let aside = |view_height: f64| (right * place(x, width) + down * place(y, height)) * (view_height / height);
    match camera.projection {
        Projection::Perspective { fov_degrees } => {
            (camera.eye, forward + aside(2.0 * (0.5 * fov_degrees.to_radians()).tan()))
        }
        Projection::Orthographic { height_world } => (camera.eye + aside(height_world), forward),
    }
}

/// View depths at which a ray enters and leaves the grid's box.
fn span(volume: &Volume, (origin, direction): (DVec3, DVec3)) -> Option<[f64; 2]> {
    let inverse = volume.lattice.world_from_grid().inverse();
    let (o, d) = (inverse.transform_point3(origin), inverse.transform_vector3(direction));
    let mut span = [f64::NEG_INFINITY, f64::INFINITY];
    for axis in 0..3 {
        let last = (volume.dims[axis] - 1) as f64;
        let [a, b] = [-o[axis] / d[axis], (last - o[axis]) / d[axis]];
        span = [span[0].max(a.min(b)), span[1].min(a.max(b))];
    }
    (span[0] < span[1]).then_some(span)
}

/// The eight points around a place of the grid with their weights.
fn around(dims: [usize; 3], place: DVec3) -> [(usize, f64); 8] {
    let cell: [usize; 3] = std::array::from_fn(|a| (place[a].max(0.0) as usize).min(dims[a] - 2));
    std::array::from_fn(|corner| {
        let (mut index, mut weight, mut stride) = (0, 1.0, 1);
        for a in 0..3 {
            let (bit, t) = (corner >> a & 1, place[a] - cell[a] as f64);
            weight *= if bit == 1 { t } else { 1.0 - t };
            index += (cell[a] + bit) * stride;
            stride *= dims[a];
        }
        (index, weight)
    })
}

impl Case {
    fn value(&self, place: DVec3) -> f64 {
        around(self.field.dims, place).iter().map(|&(i, weight)| weight * self.field.values.get(i)).sum()
    }

    /// The unnormalised gradient in the world: central differences at the points, one-sided at the border, interpolated.
    fn gradient(&self, place: DVec3) -> DVec3 {
        let dims = self.field.dims;
        let at = |index: usize| -> DVec3 {
            let ijk = [index % dims[0], index / dims[0] % dims[1], index / dims[0] / dims[1]];
            let mut gradient = DVec3::ZERO;
            for a in 0..3 {
                let stride = [1, dims[0], dims[0] * dims[1]][a];
                let (down, up) = (ijk[a].min(1), (dims[a] - 1 - ijk[a]).min(1));
                let rise = self.field.values.get(index + up * stride) - self.field.values.get(index - down * stride);
                gradient[a] = rise / (up + down) as f64;
            }
            gradient
        };
        let by_step: DVec3 = around(dims, place).iter().map(|&(i, weight)| at(i) * weight).sum();
        self.volume.lattice.grid_from_world().matrix3.transpose() * by_step
    }

    /// The pixel, plane by plane, by the paper's order: from back to front.
    fn twin(&self, camera: &Camera, options: &Options, x: u32, y: u32, end: f64) -> [f64; 4] {
        let planes = Planes::new(&self.volume, camera, options).unwrap();
        let ray = ray(camera, x.into(), y.into(), options.is_vol_compatible);
        let Some([enter, exit]) = span(&self.volume, ray) else { return [0.0; 4] };
        let exit = exit.min(end);
        let mut pixel = [0.0; 4];
        for plane in (0..planes.depths.len()).rev() {
            let [front, back] = [planes.edges[plane], planes.edges[plane + 1]];
            let (from, to) = (front.max(enter), back.min(exit));
            let (depth, thickness) = if options.is_vol_compatible {
                let depth = planes.depths[plane];
                (depth, if (enter..=exit).contains(&depth) { back - front } else { 0.0 })
            } else {
                (0.5 * (from + to), to - from)
            };
            if thickness <= 0.0 {
                continue;
            }
            let place = self.volume.lattice.grid(ray.0 + ray.1 * depth);
            let (mut extinction, mut color) = match options.classification {
                Classification::Post => {
                    let looks = self.transfer.eval(self.value(place));
                    (looks.extinction, DVec3::from(looks.color))
                }
                Classification::Pre => around(self.field.dims, place).iter().fold(
                    (0.0, DVec3::ZERO),
                    |(extinction, color), &(i, weight)| {
                        let looks = self.transfer.eval(self.field.values.get(i));
                        (extinction + weight * looks.extinction, color + weight * DVec3::from(looks.color))
                    },
                ),
            };
            if let Some(lighting) = &options.lighting {
                let gradient = self.gradient(place);
                if lighting.has_strength {
                    let spacing = self.volume.lattice.volume_of_cell().cbrt();
                    extinction *= gradient.length() * spacing / (self.field.range.1 - self.field.range.0);
                }
                let (n, v) = (gradient.normalize(), -ray.1.normalize());
                color = lighting.lights.iter().fold(DVec3::ZERO, |sum, light| {
                    let l = light.direction.normalize();
                    let highlight = (2.0 * n.dot(l) * n - l).dot(v).abs().powf(lighting.shininess.into());
                    let lit = color * (f64::from(lighting.ambient) + f64::from(lighting.diffuse) * n.dot(l).abs());
                    sum + DVec3::from(light.color.map(f64::from)) * (lit + f64::from(lighting.specular) * highlight)
                });
            }
            let opacity = 1.0 - (-extinction * thickness * ray.1.length()).exp();
            for (c, channel) in color.to_array().into_iter().chain([1.0]).enumerate() {
                pixel[c] = pixel[c] * (1.0 - opacity) + channel * opacity;
            }
        }
        pixel
    }
}

/// The largest difference of a picture from the twin on every so manieth pixel, and how many of these show something.
fn difference(case: &Case, camera: &Camera, options: &Options, image: &Image, end: f64) -> (f64, usize) {
    let (mut worst, mut covered) = (0.0_f64, 0);
    for y in (0..camera.height).step_by(3) {
        for x in (0..camera.width).step_by(5) {
            let twin = case.twin(camera, options, x, y, end);
            covered += usize::from(twin[3] > 0.01);
            for (a, b) in twin.into_iter().zip(image.pixel(x, y)) {
                worst = worst.max((a - f64::from(b)).abs());
            }
        }
    }
    (worst, covered)
}

fn lighting() -> Lighting {
    let light = |direction: [f64; 3], color| Light { direction: direction.into(), color };
    let lights = vec![light([1.0, 2.0, 3.0], [0.9, 0.8, 0.7]), light([-4.0, 1.0, 0.5], [0.0, 0.1, 0.3])];
    Lighting { lights, ..Lighting::default() }
}

/// Every option that the twin knows, on upright and sheared grids, in perspective and not.
#[test]
fn every_way_of_sampling_agrees_with_the_twin() {
    let plain = Options { stop_transmittance: 0.0, ..Options::default() };
    let lit = |has_strength| Some(Lighting { has_strength, ..lighting() });
    let all = [
        ("plain", plain.clone(), f64::INFINITY),
        ("twice the rate", Options { sample_rate: 2.0, ..plain.clone() }, f64::INFINITY),
        (
            "seven planes",
            Options { samples: [Samples::Pixels, Samples::Pixels, Samples::Count(7)], ..plain.clone() },
            f64::INFINITY,
        ),
        ("pre", Options { classification: Classification::Pre, ..plain.clone() }, f64::INFINITY),
        ("vol", Options { is_vol_compatible: true, ..plain.clone() }, f64::INFINITY),
        (
            "vol, pre",
            Options { is_vol_compatible: true, classification: Classification::Pre, ..plain.clone() },
            f64::INFINITY,
        ),
        ("lit", Options { lighting: lit(false), ..plain.clone() }, f64::INFINITY),
        ("strength", Options { lighting: lit(true), ..plain.clone() }, f64::INFINITY),
        ("a wall", plain.clone(), 1.0),
        ("stop", Options { stop_transmittance: 1e-5, ..plain.clone() }, f64::INFINITY),
    ];
    for (lattice_name, lattice) in
        [("upright", Lattice::new([5.0; 3].into(), [1.0, 0.7, 1.2].into())), ("sheared", sheared())]
    {
        let case = Case::smooth(lattice);
        for (camera_name, camera) in ["perspective", "orthographic"].into_iter().zip(case.cameras(61, 45)) {
            let middle = camera.eye.distance(camera.target);
            for (name, options, end) in &all {
                let end = end * middle;
                let image = case.draw_until(&camera, options, &|_, _| end);
                let (worst, covered) = difference(&case, &camera, options, &image, end);
                println!("{lattice_name:8} {camera_name:13} {name:15} {worst:.1e} of {covered} pixels");
                assert!(
                    worst < 1e-5 && covered > 40,
                    "{lattice_name}, {camera_name}, {name}: {worst} of {covered} pixels"
                );
            }
            // The comparison fails where it must.
            for wrong in [1, 3, 4, 6, 7, 8] {
                let (image, end) = (case.draw(&camera, &all[0].1), all[wrong].2 * middle);
                let (worst, _) = difference(&case, &camera, &all[wrong].1, &image, end);
                assert!(worst > 1e-3, "{camera_name}: {} passes for plain, {worst}", all[wrong].0);
            }
        }
    }
}

/// 1 − exp(−κL) for every chord, in every type, for points and for cells, for few planes and many.
#[test]
fn a_homogeneous_box_is_exact() {
    let extinction = 0.13;
    let transfer = TransferFunction::constant([0.2, 0.5, 1.0], extinction).unwrap();
    let arrays = [
        array(Association::Point, vec![3_u8; 5 * 6 * 7].into()),
        array(Association::Point, vec![-3_i16; 5 * 6 * 7].into()),
        array(Association::Point, vec![1e9_f64; 5 * 6 * 7].into()),
        array(Association::Cell, vec![0.5_f32; 4 * 5 * 6].into()),
    ];
    for array in arrays {
        let case = Case::new([5, 6, 7], sheared(), array, transfer.clone());
        for camera in case.cameras(40, 32) {
            for count in [Samples::Nyquist, Samples::Count(1), Samples::Count(333)] {
                let options = Options { samples: [Samples::Pixels, Samples::Pixels, count], ..Options::default() };
                let image = case.draw(&camera, &options);
                let mut covered = 0;
                for (x, y) in (0..32).flat_map(|y| (0..40).map(move |x| (x, y))) {
                    let ray = ray(&camera, x.into(), y.into(), false);
                    let length = span(&case.volume, ray).map_or(0.0, |[from, to]| (to - from) * ray.1.length());
                    let opacity = 1.0 - (-extinction * length).exp();
                    let [r, g, b, a] = image.pixel(x, y).map(f64::from);
                    let expected = [0.2 * opacity, 0.5 * opacity, opacity, opacity];
                    let off = [r, g, b, a].iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    assert!(off < 1e-5, "({x}, {y}): {:?} for {expected:?}", [r, g, b, a]);
                    covered += u32::from(opacity > 0.1);
                }
                assert!(covered > 200);
            }
        }
    }
}

/// A shear along the picture's columns moves each column of pixels by a whole number of them.
#[test]
fn a_sheared_grid_looks_like_the_upright_one_through_the_inverse() {
    let upright = Case::smooth(Lattice::default());
    // y' = y + x, seen along z: a step of the grid is four pixels.
    let shear = DMat3::from_cols([1.0, 1.0, 0.0].into(), DVec3::Y, DVec3::Z);
    let sheared = Case::smooth(Lattice::sheared(DVec3::ZERO, shear));
    let size = 192;
    let mut camera = Camera::looking_at([10.0, 10.0, 60.0].into(), [10.0, 10.0, 0.0].into(), size, size);
    camera.projection = Projection::Orthographic { height_world: 48.0 };
    let b = sheared.draw(&camera, &Options::default());
    // Row for row: pixel centres at x = (n + 1/2)/4 shift by n + 1/2 rows, so compare with the picture half a pixel lower.
    let mut lower = camera.clone();
    lower.eye.y -= 0.125;
    lower.target.y -= 0.125;
    let a = upright.draw(&lower, &Options::default());
    let mut worst = 0.0_f32;
    for x in 0..size {
        let rows = i64::from(x) - 96 + 40;
        for y in 0..i64::from(size) {
            // Up in the picture by `rows` and a half.
            let from = y + rows;
            if (0..i64::from(size)).contains(&from) {
                let (expected, found) = (a.pixel(x, from as u32), b.pixel(x, y as u32));
                worst = expected.iter().zip(found).map(|(a, b)| (a - b).abs()).fold(worst, f32::max);
            }
        }
    }
    assert!(b.covered([0.0; 4]) > 5000 && worst < 2e-5, "{worst}");
}

/// The ray integral by Simpson's rule in steps that end where the scalar's rule changes.
fn integral(case: &Case, camera: &Camera, x: u32, y: u32) -> [f64; 4] {
    let ray = ray(camera, x.into(), y.into(), false);
    let Some([enter, exit]) = span(&case.volume, ray) else { return [0.0; 4] };
    let steps = 40_000;
    let h = (exit - enter) / f64::from(steps);
    let (mut light, mut depth) = ([0.0; 3], 0.0_f64);
    for step in 0..steps {
        let place = case.volume.lattice.grid(ray.0 + ray.1 * (enter + (f64::from(step) + 0.5) * h));
        let looks = case.transfer.eval(case.value(place));
        let of_step = looks.extinction * h * ray.1.length();
        let weight = (-depth).exp() * (1.0 - (-of_step).exp());
        (0..3).for_each(|c| light[c] += weight * looks.color[c]);
        depth += of_step;
    }
    [light[0], light[1], light[2], 1.0 - (-depth).exp()]
}

/// With the scalar interpolated first, the picture goes to the ray integral as planes double, by the square of their distance.
#[test]
fn pictures_converge_to_the_ray_integral() {
    let case = Case::smooth(sheared());
    let camera = &case.cameras(64, 64)[0];
    let pixels: Vec<(u32, u32)> = (0..64).map(|n| (17 + n * 7 % 31, 17 + n * 11 % 29)).collect();
    let expected: Vec<_> = pixels.iter().map(|&(x, y)| integral(&case, camera, x, y)).collect();
    let error = |options: &Options| -> f64 {
        let image = case.draw(camera, options);
        let of = |(&(x, y), expected): (&(u32, u32), &[f64; 4])| -> f64 {
            image.pixel(x, y).iter().zip(expected).map(|(&a, b)| (f64::from(a) - b).powi(2)).sum()
        };
        let sum: f64 = pixels.iter().zip(&expected).map(of).sum();
        (sum / (4 * pixels.len()) as f64).sqrt()
    };
    let post: Vec<f64> =
        (0..6).map(|n| error(&Options { sample_rate: f64::from(1 << n), ..Options::default() })).collect();
    let orders: Vec<f64> = post.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    let errors: Vec<String> = post.iter().map(|error| format!("{error:.2e}")).collect();
    println!("root mean square error {}, orders {orders:.2?}", errors.join(" "));
    let order = (post[0] / post[4]).log2() / 4.0;
    assert!(order > 1.7 && post[4] < 3e-5, "order {order}");
    // What is classified first is another picture.
    let pre = error(&Options { sample_rate: 16.0, classification: Classification::Pre, ..Options::default() });
    println!("classified first: {pre:.2e}");
    assert!(pre > 50.0 * post[4]);
}

/// Same bytes for any number of threads, any instruction set, and any part of the picture.
#[test]
fn pictures_do_not_depend_on_how_they_are_drawn() {
    let case = Case::smooth(sheared());
    let [camera, _] = case.cameras(83, 70);
    for options in [
        Options::default(),
        Options { classification: Classification::Pre, is_vol_compatible: true, ..Options::default() },
        Options { lighting: Some(Lighting { has_shadows: true, ..lighting() }), ..Options::default() },
        Options { render_scale: 0.6, ..Options::default() },
        Options { filter: Filter::CatmullRom, model: Model::Emission, ..Options::default() },
    ] {
        let whole = case.draw(&camera, &options);
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| case.draw(&camera, &options)) == whole, "{threads} threads");
        }
        for set in InstructionSet::available() {
            let drawn = case.draw(&camera, &Options { instruction_set: Some(set), ..options.clone() });
            assert!(drawn == whole, "{set:?}");
        }
        let region = Region { x0: 13, y0: 21, x1: 59, y1: 50 };
        let part = case.draw(&Camera { region: Some(region), ..camera.clone() }, &options);
        for (x, y) in (0..29).flat_map(|y| (0..46).map(move |x| (x, y))) {
            assert_eq!(part.pixel(x, y), whole.pixel(x + 13, y + 21), "({x}, {y})");
        }
    }
}

/// The paper's pixels reach the picture's border, and its planes the limits.
#[test]
fn vol_compatible_pixels_and_planes_lie_where_the_paper_has_them() {
    // The scalar is x, its largest value the colour.
    let values: Vec<f32> = (0..3 * 3 * 3).map(|n| (n % 3) as f32).collect();
    let transfer = TransferFunction::new(vec![point(0.0, [0.0; 3], 1.0), point(2.0, [2.0; 3], 1.0)]).unwrap();
    let case = Case::new([3; 3], Lattice::default(), array(Association::Point, values.into()), transfer);
    let mut camera = Camera::looking_at([1.0, -8.0, 1.0].into(), [1.0; 3].into(), 5, 9);
    camera.projection = Projection::Orthographic { height_world: 1.8 };
    let mip = Options { model: Model::Mip, ..Options::default() };
    for (is_vol_compatible, left, step) in [(false, 0.6, 0.2), (true, 0.5, 0.25)] {
        let image = case.draw(&camera, &Options { is_vol_compatible, ..mip.clone() });
        for x in 0..5 {
            let expected = left + step * x as f32;
            assert!((image.pixel(x, 4)[0] - expected).abs() < 1e-5, "{x}: {:?} for {expected}", image.pixel(x, 4));
        }
    }
    let camera = Camera::looking_at([1.0, -8.0, 1.0].into(), [1.0; 3].into(), 8, 8);
    let samples = [Samples::Pixels, Samples::Pixels, Samples::Count(5)];
    let planes = Planes::new(&case.volume, &camera, &Options { is_vol_compatible: true, samples, ..mip }).unwrap();
    // −df/(z (f − d) − f) with d = 8, f = 10, z in quarters.
    let expected = [8.0, 80.0 / 9.5, 80.0 / 9.0, 80.0 / 8.5, 10.0];
    assert!(planes.depths.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{:?}", planes.depths);
}

/// Planes one by one, composited, are the picture.
#[test]
fn cross_sections_make_up_the_picture() {
    let case = Case::smooth(sheared());
    let [camera, _] = case.cameras(48, 40);
    let options = Options { stop_transmittance: 0.0, ..Options::default() };
    let count = Planes::new(&case.volume, &camera, &options).unwrap().depths.len() as u32;
    let mut sum = Image::filled(48, 40, [0.0; 4]);
    for plane in (0..count).rev() {
        let section = case.draw(&camera, &Options { only_plane: Some(plane), ..options.clone() });
        for (behind, front) in sum.pixels.iter_mut().zip(&section.pixels) {
            *behind = std::array::from_fn(|c| front[c] + behind[c] * (1.0 - front[3]));
        }
    }
    let whole = case.draw(&camera, &options);
    let off = whole.pixels.iter().flatten().zip(sum.pixels.iter().flatten()).map(|(a, b)| (a - b).abs());
    let off = off.fold(0.0, f32::max);
    assert!(count > 20 && off < 1e-5, "{count} planes, {off}");
}

/// Values that are no numbers, and volumes that nothing can be seen of, leave holes and no panic.
#[test]
fn what_is_not_finite_is_not_drawn() {
    let mut values = vec![1.0_f32; 6 * 6 * 6];
    values[3 + 6 * (3 + 6 * 3)] = f32::NAN;
    values[1] = f32::INFINITY;
    let transfer = TransferFunction::constant([1.0; 3], 1.0).unwrap();
    let case = Case::new([6; 3], Lattice::default(), array(Association::Point, values.into()), transfer);
    let mut camera = Camera::looking_at([20.0, 2.9, 2.9].into(), [2.5, 2.9, 2.9].into(), 9, 9);
    camera.projection = Projection::Orthographic { height_world: 0.1 };
    for classification in [Classification::Pre, Classification::Post] {
        let samples = [Samples::Pixels, Samples::Pixels, Samples::Count(500)];
        let image = case.draw(&camera, &Options { classification, samples, ..Options::default() });
        // Two of five cells have the point that is not a number.
        assert!((image.pixel(4, 4)[3] - (1.0 - (-3.0_f32).exp())).abs() < 1e-4, "{:?}", image.pixel(4, 4));
        assert!(image.pixels.iter().flatten().all(|channel| channel.is_finite()));
    }
    let away = Camera::looking_at([20.0, 0.0, 0.0].into(), [40.0, 0.0, 0.0].into(), 9, 9);
    assert_eq!(case.draw(&away, &Options::default()).covered([0.0; 4]), 0);
    let inside = Camera::looking_at([2.2, 2.3, 2.4].into(), [40.0, 1.0, 0.0].into(), 9, 9);
    assert_eq!(case.draw(&inside, &Options::default()).covered([0.0; 4]), 81);
}

/// A wall of triangles and another program's picture end rays where they are.
#[test]
fn opaque_things_stand_in_the_volume() {
    let transfer = TransferFunction::constant([1.0; 3], 0.5).unwrap();
    let case = Case::new([5; 3], Lattice::default(), array(Association::Point, vec![1_u8; 125].into()), transfer);
    let mut scene = VolumeScene::new(case.volume, case.field, &case.transfer);
    let mut camera = Camera::looking_at([14.0, 2.0, 2.0].into(), [2.0; 3].into(), 9, 9);
    camera.projection = Projection::Orthographic { height_world: 2.0 };
    let draw =
        |scene: &VolumeScene| depth_planes(scene, &camera, &Options::default(), &GeometryOptions::NONE, true).unwrap();
    let whole = draw(&scene);
    assert!((whole.image.pixel(4, 4)[0] - (1.0 - (-2.0_f32).exp())).abs() < 1e-5);
    assert!(whole.depth_world.unwrap().iter().all(|&depth| depth == f32::INFINITY));
    // A red wall at x = 1.3, 2.7 of 4 units behind the front.
    let positions = vec![[1.3, -90.0, -90.0], [1.3, 90.0, -90.0], [1.3, 0.0, 90.0]];
    let wall = TriangleMesh { positions, triangles: vec![[0, 1, 2]], ..TriangleMesh::default() };
    scene.add_triangles(&wall, Some([1.0, 0.0, 0.0])).unwrap();
    let walled = draw(&scene);
    let left = (-0.5 * 2.7_f32).exp();
    let [r, g, _, a] = walled.image.pixel(4, 4);
    assert!((r - 1.0).abs() < 1e-4 && (g - (1.0 - left)).abs() < 1e-4 && a == 1.0, "{r} {g} {a} for {left}");
    assert!((walled.depth_world.unwrap()[40] - 12.7).abs() < 1e-4);
    // A picture nearer than the wall.
    let picture = DepthImage::new(Image::filled(9, 9, [0.0, 0.0, 0.5, 1.0]), vec![11.0; 81]).unwrap();
    scene.set_external(Some(Arc::new(picture)));
    let [r, _, b, _] = draw(&scene).image.pixel(4, 4);
    let left = (-0.5_f32).exp();
    assert!((r - (1.0 - left)).abs() < 1e-4 && (b - (1.0 - 0.5 * left)).abs() < 1e-4, "{r} {b}");
}

/// Every volume of the shared data shows something, plain and lit.
#[test]
fn real_volumes_are_drawn() {
    let Some(folder) = data_folder("real_volumes_are_drawn") else { return };
    let files = [
        "classic/engine.nhdr",
        "classic/Bucky.nhdr",
        "regular/heart.vti",
        "regular/Teddybear.nhdr",
        "regular/LIDC2.nhdr",
        "regular/hydrogen.vti",
        "regular/head.120.vtk",
        "regular/ironProt.vtk",
        "regular/carotid.vtk",
        "formats/volume_complex.vti",
        "formats/volume_complex.vtk",
    ];
    for file in files {
        let mesh = io::open_mesh(&folder.join(file)).unwrap();
        let io::Mesh::Volume(volume) = mesh else { panic!("{file} is no volume") };
        let name = volume.arrays[0].name.clone();
        let field = volume.field(&FieldSelection::parse(&name, &volume.arrays)).unwrap();
        let camera = Camera::framing(&volume.corners_world(), 35.0, 20.0, 64, 64);
        let unit = camera.eye.distance(camera.target) / 200.0;
        let transfer = presets::preset("viridis", field.range, OpacityProfile::default(), unit).unwrap();
        let scene = VolumeScene::new(volume, field, &transfer);
        for lighting in [None, Some(Lighting::default())] {
            let options = Options { lighting, ..Options::default() };
            let image = depth_planes(&scene, &camera, &options, &GeometryOptions::NONE, false).unwrap().image;
            let covered = image.pixels.iter().filter(|pixel| pixel[3] > 0.02).count();
            assert!(covered > 200, "{file}: {covered} pixels");
        }
    }
}
