//! Cubes between points: against a twin in f64 that finds the value at every corner by looking at all boxes, across borders between boxes of
//! different size too.

use std::cell::OnceCell;
use std::collections::HashMap;

use cellfan::columns::{Association, Cube, GridEye, VolumeField};
use cellfan::hierarchy::{Hierarchy, Interpolation, Selection, Shows, WithinError};
use cellfan::optics::CullTable;
use cellfan::render::{CubeScene, Detail};
use cellfan::{Camera, CpuMethod, Error, FieldSelection, Image, Model, RenderOptions, Renderer, TransferFunction};
use glam::DVec3;

use crate::cubes::{draw, views, volume};
use crate::meshes::{smooth, stepped};
use crate::parity::miss;
use crate::reference::{Segment, ray_of, shade};

/// Parts of a ray's way through a box, each linear.
const PARTS: usize = 48;

/// A trilinear scene, and its boxes at a tolerance (a share of the range).
struct Twin {
    scene: CubeScene,
    cubes: Vec<Cube>,
    boxes: [u32; 3],
    /// Whether corners on larger boxes follow these.
    follows: bool,
    /// The values at all corners, where they do not and where they do: long to find.
    corners: [OnceCell<Vec<[f64; 8]>>; 2],
}

impl Twin {
    fn new(dims: [usize; 3], transfer: &TransferFunction, error: f64) -> Self {
        let volume = volume(dims, Association::Point);
        let field = volume.field(&FieldSelection::parse("v", &volume.arrays)).unwrap();
        let hierarchy = Hierarchy::with(&field, Interpolation::Trilinear).unwrap();
        let (pieces, mut selection) = (transfer.pieces(hierarchy.offset()), Selection::default());
        let table = CullTable::new(&pieces, Model::Mip);
        let shows = Shows { intervals: &pieces, table: &table };
        let rule = WithinError(((field.range.1 - field.range.0) * error * (1.0 + 1e-6)) as f32);
        selection.select((&hierarchy, &field), &rule, shows, GridEye::Along(DVec3::ONE), false);
        let boxes = hierarchy.dims();
        let scene = CubeScene::with_hierarchy(&volume, field, hierarchy, transfer).unwrap();
        Self { scene, cubes: selection.cubes, boxes, follows: true, corners: Default::default() }
    }

    fn field(&self) -> &VolumeField {
        self.scene.field()
    }

    fn levels(&self) -> HashMap<u16, usize> {
        let mut levels = HashMap::new();
        self.cubes.iter().for_each(|cube| *levels.entry(cube.level).or_default() += 1);
        levels
    }

    /// The value at a corner: of the largest of all boxes that hold the point.
    fn value(&self, point: [u32; 3]) -> f64 {
        let holds = |cube: &&Cube| {
            let [first, end] = cube.samples(self.boxes);
            (0..3).all(|axis| first[axis] <= point[axis] && point[axis] <= end[axis])
        };
        let largest = self.cubes.iter().filter(holds).max_by_key(|cube| cube.level).unwrap();
        let [first, end] = largest.samples(self.boxes);
        let is_corner = (0..3).all(|axis| point[axis] == first[axis] || point[axis] == end[axis]);
        if is_corner || !self.follows {
            return self.field().values.get(self.field().index(point.map(|along| along as usize)));
        }
        between(&self.corners(largest), [first, end], DVec3::from(point.map(f64::from)))
    }

    fn corners(&self, cube: &Cube) -> [f64; 8] {
        let ends = cube.samples(self.boxes);
        std::array::from_fn(|corner| self.value([0, 1, 2].map(|axis| ends[corner >> axis & 1][axis])))
    }

    /// The parts of a ray, nearest first.
    fn segments(&self, corners: &[[f64; 8]], camera: &Camera, [x, y]: [u32; 2]) -> Vec<Segment> {
        let ray = ray_of(camera, f64::from(x) + 0.5, f64::from(y) + 0.5);
        let to_grid = self.scene.grid().lattice.grid_from_world();
        let (origin, direction) = (to_grid.transform_point3(ray.origin), to_grid.transform_vector3(ray.direction));
        let mut segments = Vec::new();
        for (cell, (cube, corners)) in self.cubes.iter().zip(corners).enumerate() {
            let ends = cube.samples(self.boxes);
            let [a, b] = ends.map(|end| (DVec3::from(end.map(f64::from)) - origin) / direction);
            let (enter, leave) = (a.min(b).max_element().max(1e-6), a.max(b).min_element());
            if enter >= leave {
                continue;
            }
            let depth = |part: usize| enter + (leave - enter) * part as f64 / PARTS as f64;
            let value = |part: usize| between(corners, ends, origin + direction * depth(part));
            segments.extend((0..PARTS).map(|part| {
                let w = [part, part + 1].map(depth);
                let length_world = (w[1] - w[0]) * ray.direction.length();
                Segment { w, s: [part, part + 1].map(value), length_world, cell }
            }));
        }
        segments.sort_by(|a, b| a.w[0].total_cmp(&b.w[0]));
        segments
    }

    /// Count, mean and largest difference of a picture from the twin, on some pixels that show something.
    fn errors(&self, image: &Image, model: Model, transfer: &TransferFunction, camera: &Camera) -> (usize, f64, f64) {
        let corners = self.corners[usize::from(self.follows)]
            .get_or_init(|| self.cubes.iter().map(|cube| self.corners(cube)).collect());
        let [width, height] = [image.width, image.height];
        let mut errors = Vec::new();
        for i in 0..120 {
            let pixel @ [x, y] = [i * 7919 % width, i * 104_729 % height];
            let expected = shade(model, transfer, &self.segments(corners, camera, pixel));
            if expected != [f64::from(miss(model)); 4] {
                let found = image.pixel(x, y);
                errors.push((0..4).map(|c| (f64::from(found[c]) - expected[c]).abs()).fold(0.0, f64::max));
            }
        }
        (errors.len(), errors.iter().sum::<f64>() / errors.len() as f64, errors.into_iter().fold(0.0, f64::max))
    }
}

/// The value at `at`, given along the axes in the numbers of `corners`, by the values of a box's corners.
fn between(corners: &[f64; 8], [first, end]: [[u32; 3]; 2], at: DVec3) -> f64 {
    let [low, high] = [first, end].map(|end| DVec3::from(end.map(f64::from)));
    let share = (at - low) / (high - low);
    let weight = |corner: usize| {
        (0..3).map(|axis| if corner >> axis & 1 == 1 { share[axis] } else { 1.0 - share[axis] }).product::<f64>()
    };
    (0..8).map(|corner| weight(corner) * corners[corner]).sum()
}

#[test]
fn cubes_between_points_are_the_reference_of_trilinear_fields() {
    let mut failures = Vec::new();
    for (transfer, name) in [(smooth(), "smooth"), (stepped(), "stepped")] {
        let twin = Twin::new([15, 12, 13], &transfer, 0.0);
        for (view, camera) in views(&twin.scene, [96, 72]) {
            for model in Model::ALL {
                let options = RenderOptions { model, stop_transmittance: 0.0, ..RenderOptions::default() };
                let (mut image, cubes) = draw(options, &twin.scene, Detail::Error(0.0), &camera);
                let (count, mean, largest) = twin.errors(&image, model, &transfer, &camera);
                let line = format!(
                    "{name} {view:8} {model:20}: {cubes} cubes, {count} pixels, mean {mean:.1e}, largest {largest:.1e}"
                );
                println!("{line}");
                if !(count > 20 && mean <= 1e-4 && largest <= 2e-3) {
                    failures.push(line);
                }
                image.pixels.iter_mut().for_each(|pixel| pixel[1] += 1.0 / 255.0);
                assert!(twin.errors(&image, model, &transfer, &camera).1 > 1e-4, "one level passes");
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn across_borders_of_boxes_of_different_size_the_field_is_one() {
    let transfer = smooth();
    let mut twin = Twin::new([33, 28, 30], &transfer, 0.12);
    let levels = twin.levels();
    println!("{} boxes: {levels:?}", twin.cubes.len());
    assert!((0..3).all(|level| levels.get(&level).is_some_and(|&count| count > 20)), "{levels:?}");
    let model = Model::EmissionAbsorption;
    let mut others = 0.0_f64;
    for (view, camera) in views(&twin.scene, [96, 72]) {
        let options = RenderOptions { model, stop_transmittance: 0.0, ..RenderOptions::default() };
        let (image, cubes) = draw(options, &twin.scene, Detail::Error(0.12), &camera);
        twin.follows = true;
        let (count, mean, largest) = twin.errors(&image, model, &transfer, &camera);
        println!("{view}: {cubes} cubes, {count} pixels, mean {mean:.1e}, largest {largest:.1e}");
        assert!(count > 20 && mean <= 1e-4 && largest <= 2e-3, "{view}: mean {mean:.1e}, largest {largest:.1e}");
        // Negative control: corners that do not follow the larger box beside them are another picture.
        twin.follows = false;
        others = others.max(twin.errors(&image, model, &transfer, &camera).2);
    }
    assert!(others > 4e-3, "{others}");
}

#[test]
fn a_linear_field_needs_few_cubes_and_is_the_same_picture_at_every_size() {
    use cellfan::columns::{Array, Lattice, Volume};
    let dims = [33, 20, 17];
    let place = |i: usize| [i % dims[0], i / dims[0] % dims[1], i / (dims[0] * dims[1])].map(|along| along as f32);
    let values: Vec<f32> = (0..dims.iter().product()).map(place).map(|[x, y, z]| x + 2.0 * y + 4.0 * z).collect();
    let array = Array { name: "v".into(), association: Association::Point, components: 1, values: values.into() };
    let volume = Volume::new(dims, Lattice::new(DVec3::ZERO, DVec3::splat(0.03)), vec![array]).unwrap();
    let field = volume.field(&FieldSelection::parse("v", &[])).unwrap();
    let point = |value, extinction| cellfan::ControlPoint { value, color: [1.0, 0.5, 0.2], extinction };
    let transfer = TransferFunction::new(vec![point(0.0, 0.0), point(60.0, 9.0), point(130.0, 0.5)]).unwrap();
    let hierarchy = Hierarchy::with(&field, Interpolation::Trilinear).unwrap();
    let scene = CubeScene::with_hierarchy(&volume, field, hierarchy, &transfer).unwrap();
    let camera = Camera::framing(&volume.corners_world(), 30.0, 20.0, 80, 60);
    // What is linear is trilinear in a box of any size; halves and quarters of whole numbers are exact.
    let (one, cubes) = draw(RenderOptions::default(), &scene, Detail::Error(0.0), &camera);
    assert_eq!(cubes, 1);
    // Constant cubes of the same samples: an entirely different picture, whose steps show.
    let field = volume.field(&FieldSelection::parse("v", &[])).unwrap();
    let constant = CubeScene::new(&volume, field, &transfer).unwrap();
    let (other, cubes) = draw(RenderOptions::default(), &constant, Detail::Error(0.0), &camera);
    assert!(cubes > 1000 && one.pixels != other.pixels);
}

#[test]
fn what_cubes_between_points_cannot_be_is_refused() {
    let scene = Twin::new([6, 5, 4], &smooth(), 0.0).scene;
    let [(_, camera), ..] = views(&scene, [20, 20]);
    let refused = |options: RenderOptions, detail| Renderer::new(options).render_cubes(&scene, detail, &camera).err();
    let fans = RenderOptions { cpu_method: CpuMethod::Fans, ..RenderOptions::default() };
    assert!(matches!(refused(fans, Detail::Error(0.0)), Some(Error::Option { option: "--filter", .. })));
    let by_picture = refused(RenderOptions::default(), Detail::PictureError(0.1));
    assert!(matches!(by_picture, Some(Error::Option { option: "--error-image", .. })));
    let cells = volume([4, 4, 4], Association::Cell);
    let field = cells.field(&FieldSelection::parse("v", &cells.arrays)).unwrap();
    let refused = Hierarchy::with(&field, Interpolation::Trilinear).err();
    assert!(matches!(refused, Some(Error::Option { option: "--filter", .. })));
}
