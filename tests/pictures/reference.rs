//! The slow, obvious twin of everything: all cells against a ray, in f64, each segment integrated by quadrature.
//!
//! In: a mesh, a field, a camera, a pixel. Out: the ray's [`Segment`]s by entry depth, and through a transfer function the
//! pixel of any model. Shares no code with the library's stages and optics: rays are derived from the camera's fields,
//! cells are met through barycentric coordinates, and only `TransferFunction::eval` at points inside a linear piece is used.

use std::sync::LazyLock;

use cellfan::columns::Association;
use cellfan::{Camera, Dataset, Field, Model, Projection, TransferFunction};
use glam::DVec3;

use crate::polyhedron::{Polyhedron, canonical_from_vertex};

/// A ray's way through one cell; s is linear between its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    /// View depths of entry and exit.
    pub(crate) w: [f64; 2],
    /// The scalar at entry and exit.
    pub(crate) s: [f64; 2],
    /// Exit less entry, in world units.
    pub(crate) length_world: f64,
    /// The cell in the dataset.
    pub(crate) cell: usize,
}

/// A cell and the sphere around it.
struct Cell {
    center: DVec3,
    radius_squared: f64,
    corners: [DVec3; 4],
    scalars: [f64; 4],
    index: usize,
}

/// A mesh and its field in f64.
pub(crate) struct Reference {
    cells: Vec<Cell>,
    polyhedra: Vec<Polyhedron>,
    origin: DVec3,
    diagonal_world: f64,
}

/// A ray in a mesh's own coordinates: `origin + w·direction` has view depth w.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

impl Reference {
    /// Cells with a value that is not finite are left out.
    pub(crate) fn new(dataset: &Dataset, field: &Field) -> Self {
        let corner = |v: u32| DVec3::from_array(dataset.positions[v as usize].map(f64::from));
        let stored = |i: usize| field.offset + f64::from(field.values[i]);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut cells = Vec::with_capacity(dataset.tets.len());
        for (index, tet) in dataset.tets.iter().enumerate() {
            let corners = tet.map(corner);
            let center = corners.iter().sum::<DVec3>() * 0.25;
            let radius_squared = corners.iter().map(|c| c.distance_squared(center)).fold(0.0, f64::max) * (1.0 + 1e-9);
            for &c in &corners {
                (low, high) = (low.min(c), high.max(c));
            }
            let scalars = match field.association {
                Association::Point => tet.map(|v| stored(v as usize)),
                Association::Cell => [stored(index); 4],
            };
            if scalars.iter().all(|s| s.is_finite()) {
                cells.push(Cell { center, radius_squared, corners, scalars, index });
            }
        }
        let mut polyhedra = Vec::new();
        let hexahedra = dataset.hexahedra.view();
        let has_tets_alone = dataset.tets.len() == dataset.cells();
        let canonical = if has_tets_alone { Vec::new() } else { canonical_from_vertex(dataset) };
        for hexahedron in (0..hexahedra.len()).filter(|&cell| !hexahedra.shape(cell).is_absent()) {
            let (vertex, index) = (hexahedra.get(hexahedron), dataset.tets.len() + hexahedron);
            for c in vertex.map(corner) {
                (low, high) = (low.min(c), high.max(c));
            }
            let scalars = match field.association {
                Association::Point => vertex.map(|v| stored(v as usize)),
                Association::Cell => [stored(index); 8],
            };
            if scalars.iter().all(|s| s.is_finite()) {
                polyhedra.push(Polyhedron::new(index, vertex, scalars, dataset, &canonical));
            }
        }
        for cell in 0..dataset.polyhedra.len() {
            let index = dataset.first_polyhedron() + cell;
            let scalar = |v: u32| match field.association {
                Association::Point => stored(v as usize),
                Association::Cell => stored(index),
            };
            let corners = dataset.polyhedra.view().corners(cell);
            for c in corners.iter().map(|&v| corner(v)) {
                (low, high) = (low.min(c), high.max(c));
            }
            if corners.iter().all(|&v| scalar(v).is_finite()) {
                polyhedra.push(Polyhedron::of_faces((index, cell), scalar, dataset, &canonical));
            }
        }
        Self { cells, polyhedra, origin: dataset.origin, diagonal_world: (high - low).length() }
    }

    /// The segments of the ray through the centre of pixel (x, y), between the near and the far plane, nearest first.
    pub(crate) fn segments(&self, camera: &Camera, x: u32, y: u32) -> Vec<Segment> {
        let mut ray = ray_of(camera, f64::from(x) + 0.5, f64::from(y) + 0.5);
        ray.origin -= self.origin;
        let near = camera.near.unwrap_or(1e-6 * self.diagonal_world);
        let far = camera.far.unwrap_or(f64::INFINITY);
        let mut segments: Vec<Segment> = self.cells.iter().filter_map(|cell| cell.meet(ray, near, far)).collect();
        segments.extend(self.polyhedra.iter().flat_map(|cell| cell.meet(ray, near, far)));
        segments.sort_by(|a, b| a.w[0].total_cmp(&b.w[0]));
        segments
    }
}

/// The world ray through picture position (x, y), pixel centres at halves.
pub(crate) fn ray_of(camera: &Camera, x: f64, y: f64) -> Ray {
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let down = forward.cross(right);
    let (width, height) = (f64::from(camera.width), f64::from(camera.height));
    let aside = |view_height: f64| (right * (x - 0.5 * width) + down * (y - 0.5 * height)) * (view_height / height);
    match camera.projection {
        Projection::Perspective { fov_degrees } => {
            let view_height = 2.0 * (0.5 * fov_degrees).to_radians().tan();
            Ray { origin: camera.eye, direction: forward + aside(view_height) }
        }
        Projection::Orthographic { height_world } => {
            Ray { origin: camera.eye + aside(height_world), direction: forward }
        }
    }
}

impl Cell {
    fn meet(&self, ray: Ray, near: f64, far: f64) -> Option<Segment> {
        // The bounding sphere: distance of the centre from the ray.
        let to_center = self.center - ray.origin;
        let foot = to_center.dot(ray.direction) / ray.direction.length_squared();
        if (to_center - ray.direction * foot).length_squared() > self.radius_squared {
            return None;
        }
        // Barycentric coordinate i is (p − b)·n / (a − b)·n, n normal to the face b, c, d opposite corner a.
        let mut at_foot = [0.0; 4];
        let mut per_depth = [0.0; 4];
        let (mut enter, mut leave) = (near, far);
        let middle = ray.origin + ray.direction * foot;
        for i in 0..4 {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.corners[(i + k) % 4]);
            let normal = (c - b).cross(d - b);
            let height = (a - b).dot(normal);
            at_foot[i] = (middle - b).dot(normal) / height;
            per_depth[i] = ray.direction.dot(normal) / height;
            if per_depth[i] > 0.0 {
                enter = enter.max(foot - at_foot[i] / per_depth[i]);
            } else if per_depth[i] < 0.0 {
                leave = leave.min(foot - at_foot[i] / per_depth[i]);
            } else if at_foot[i] < 0.0 || (at_foot[i] == 0.0 && !owns_face(normal * height)) {
                return None;
            }
        }
        if enter >= leave {
            return None;
        }
        let value =
            |w: f64| -> f64 { (0..4).map(|i| self.scalars[i] * (at_foot[i] + per_depth[i] * (w - foot))).sum::<f64>() };
        let w = [enter, leave];
        let length_world = (leave - enter) * ray.direction.length();
        Some(Segment { w, s: w.map(value), length_world, cell: self.index })
    }
}

/// A ray in a face's plane belongs to one of its two cells: the one whose inward normal is lexicographically positive.
fn owns_face(inward: DVec3) -> bool {
    inward.to_array().into_iter().find(|&c| c != 0.0).is_some_and(|c| c > 0.0)
}

/// The pixel of a ray, in f64.
pub(crate) fn shade(model: Model, transfer: &TransferFunction, segments: &[Segment]) -> [f64; 4] {
    match model {
        Model::EmissionAbsorption => emission_absorption(transfer, segments),
        Model::Absorption => absorption(transfer, segments),
        Model::Emission => emission(transfer, segments),
        Model::Mip => mip(transfer, segments),
    }
}

/// Part of a segment within which colour and extinction are linear: s at its ends and its length.
#[derive(Clone, Copy)]
struct Part {
    s: [f64; 2],
    length_world: f64,
}

impl Part {
    fn s_at(&self, t: f64) -> f64 {
        self.s[0] + (self.s[1] - self.s[0]) * t
    }

    /// Optical depth from the start to t: extinction is linear, so its value in the middle is its mean.
    fn depth(&self, transfer: &TransferFunction, t: f64) -> f64 {
        self.length_world * t * transfer.eval(self.s_at(0.5 * t)).extinction
    }
}

/// Cuts a segment where s passes a control point.
fn parts(transfer: &TransferFunction, segment: &Segment) -> Vec<Part> {
    let Segment { s: [s0, s1], length_world, .. } = *segment;
    let (low, high) = (s0.min(s1), s0.max(s1));
    let mut cuts: Vec<f64> = transfer.points().iter().map(|p| p.value).filter(|&v| low < v && v < high).collect();
    cuts.dedup();
    if s1 < s0 {
        cuts.reverse();
    }
    let mut parts = Vec::with_capacity(cuts.len() + 1);
    let mut start = s0;
    for end in cuts.into_iter().chain([s1]) {
        let share = if s0 == s1 { 1.0 } else { (end - start) / (s1 - s0) };
        parts.push(Part { s: [start, end], length_world: length_world * share });
        start = end;
    }
    parts
}

/// Nodes in 0..1 and weights of Gauss-Legendre quadrature, exact for polynomials of degree 19.
static GAUSS: LazyLock<[(f64, f64); NODES]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let n = NODES as f64;
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut p, mut before) = (x, 1.0);
            for k in 2..=NODES {
                let k = k as f64;
                (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    })
});
const NODES: usize = 10;

/// ∫ f(t) dt from `from` to `to`.
fn integrate(from: f64, to: f64, f: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for &(node, weight) in GAUSS.iter() {
        let value = f(from + (to - from) * node);
        for k in 0..3 {
            sum[k] += (to - from) * weight * value[k];
        }
    }
    sum
}

fn emission_absorption(transfer: &TransferFunction, segments: &[Segment]) -> [f64; 4] {
    let mut color = [0.0; 3];
    let mut depth = 0.0;
    for part in segments.iter().flat_map(|segment| parts(transfer, segment)) {
        let of_part = part.depth(transfer, 1.0);
        // Steps of at most two optical depths: the quadrature is exact to rounding.
        let steps = of_part.ceil().clamp(1.0, 1e7) as usize;
        for step in 0..steps {
            let (from, to) = (step as f64 / steps as f64, (step + 1) as f64 / steps as f64);
            let reached = depth + part.depth(transfer, from);
            if reached > 45.0 {
                break; // e^-45 is 3e-20
            }
            let light = integrate(from, to, |t| {
                let point = transfer.eval(part.s_at(t));
                let left = (-depth - part.depth(transfer, t)).exp();
                point.color.map(|c| c * point.extinction * part.length_world * left)
            });
            color = std::array::from_fn(|k| color[k] + light[k]);
        }
        depth += of_part;
    }
    [color[0], color[1], color[2], -(-depth).exp_m1()]
}

fn absorption(transfer: &TransferFunction, segments: &[Segment]) -> [f64; 4] {
    let mut depths = [0.0; 4];
    for part in segments.iter().flat_map(|segment| parts(transfer, segment)) {
        let bands = light_of(transfer, &part);
        depths = std::array::from_fn(|k| depths[k] + bands.get(k).copied().unwrap_or(part.depth(transfer, 1.0)));
    }
    depths.map(|depth: f64| (-depth).exp())
}

fn emission(transfer: &TransferFunction, segments: &[Segment]) -> [f64; 4] {
    let mut light = [0.0; 4];
    for part in segments.iter().flat_map(|segment| parts(transfer, segment)) {
        for (sum, band) in light.iter_mut().zip(light_of(transfer, &part)) {
            *sum += band;
        }
    }
    light
}

/// The optical depth of segments, ∫ κ dt.
pub(crate) fn depth(transfer: &TransferFunction, segments: &[Segment]) -> f64 {
    segments.iter().flat_map(|segment| parts(transfer, segment)).map(|part| part.depth(transfer, 1.0)).sum()
}

/// ∫ c κ over a part.
fn light_of(transfer: &TransferFunction, part: &Part) -> [f64; 3] {
    integrate(0.0, 1.0, |t| {
        let point = transfer.eval(part.s_at(t));
        point.color.map(|c| c * point.extinction * part.length_world)
    })
}

fn mip(transfer: &TransferFunction, segments: &[Segment]) -> [f64; 4] {
    let largest = segments.iter().flat_map(|segment| segment.s).reduce(f64::max);
    largest.map_or([0.0; 4], |s| {
        let [r, g, b] = transfer.eval(s).color;
        [r, g, b, 1.0]
    })
}

mod tests {
    use cellfan::generate::{Scheme, Settings, tets};
    use cellfan::{ControlPoint, FieldSelection};

    use super::*;
    use crate::meshes::{chord_of_unit_cube, frame_unit_cube, grid, point};

    #[test]
    fn quadrature_is_exact_for_polynomials() {
        for degree in 0..2 * NODES {
            let [found, ..] = integrate(0.0, 1.0, |t| [t.powi(degree as i32), 0.0, 0.0]);
            assert!((found - 1.0 / (degree as f64 + 1.0)).abs() < 1e-15, "degree {degree}: {found}");
        }
    }

    #[test]
    fn segment_lengths_add_up_to_the_chord_and_touch_end_to_end() {
        let dataset = Dataset::from_tets(tets(&Settings { cells: 3000, ..Settings::default() }).unwrap()).unwrap();
        let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays)).unwrap();
        let reference = Reference::new(&dataset, &field);
        for projection in
            [Projection::Perspective { fov_degrees: 40.0 }, Projection::Orthographic { height_world: 1.6 }]
        {
            for inside in [false, true] {
                let mut camera = frame_unit_cube(31.0, 17.0, 40, 30);
                camera.projection = projection;
                if inside {
                    camera.eye = DVec3::new(0.4, 0.45, 0.55);
                }
                let mut met = 0;
                for (x, y) in (0..30).flat_map(|y| (0..40).map(move |x| (x, y))) {
                    let segments = reference.segments(&camera, x, y);
                    let sum: f64 = segments.iter().map(|segment| segment.length_world).sum();
                    let chord = chord_of_unit_cube(&camera, x, y, 0.0);
                    // The near plane, 1e-6 of the diagonal away, is not in the chord.
                    let allowed = if inside { 1e-5 } else { 1e-9 };
                    assert!((sum - chord).abs() < allowed, "({x}, {y}): {sum} of {chord}");
                    for two in segments.windows(2) {
                        assert!((two[0].w[1] - two[1].w[0]).abs() < 1e-9);
                        assert!((two[0].s[1] - two[1].s[0]).abs() < 1e-6, "the field is continuous: {two:?}");
                    }
                    met += u32::from(chord > 0.0);
                }
                assert!(met > 150, "{met} rays met the cube");
            }
        }
    }

    /// A ray along edges that many cells share has each of its points in one of them.
    #[test]
    fn a_ray_along_edges_and_in_faces_is_counted_once() {
        let dataset = Dataset::from_tets(grid(6000, Scheme::Six, 0.0)).unwrap();
        let reference = Reference::new(&dataset, &dataset.homogeneous_field());
        for axis in [DVec3::X, DVec3::NEG_Y, DVec3::Z] {
            let center = DVec3::splat(0.5);
            let mut camera = Camera::looking_at(center + axis * 3.0, center, 17, 17);
            camera.projection = Projection::Orthographic { height_world: 17.0 / 32.0 };
            for (x, y) in (0..17).flat_map(|y| (0..17).map(move |x| (x, y))) {
                let segments = reference.segments(&camera, x, y);
                let sum: f64 = segments.iter().map(|segment| segment.length_world).sum();
                assert!((sum - 1.0).abs() < 1e-9, "along {axis}, ({x}, {y}): {sum}");
            }
        }
    }

    fn segment(s: [f64; 2], w: [f64; 2]) -> Segment {
        Segment { w, s, length_world: w[1] - w[0], cell: 0 }
    }

    #[test]
    fn constant_extinction_has_a_closed_form() {
        // κ = 2, colour from 0.2 to 0.8 over length 1.5: c0 − c1 T + (c1 − c0)(1 − T)/τ.
        let transfer = TransferFunction::new(vec![point(0.0, [0.2; 3], 2.0), point(1.0, [0.8; 3], 2.0)]).unwrap();
        let two = [segment([0.0, 0.4], [1.0, 1.6]), segment([0.4, 1.0], [1.6, 2.5])];
        let t = (-3.0_f64).exp();
        let expected = 0.2 - 0.8 * t + 0.6 * (1.0 - t) / 3.0;
        let found = shade(Model::EmissionAbsorption, &transfer, &two);
        assert!((found[1] - expected).abs() < 1e-14 && (found[3] - (1.0 - t)).abs() < 1e-14, "{found:?} {expected}");
        let found = shade(Model::Emission, &transfer, &two);
        assert!((found[0] - 0.5 * 2.0 * 1.5).abs() < 1e-14 && found[3] == 0.0);
        let found = shade(Model::Absorption, &transfer, &two);
        assert!((found[2] - (-1.5_f64).exp()).abs() < 1e-14 && (found[3] - t).abs() < 1e-14);
        assert_eq!(shade(Model::Mip, &transfer, &two), [0.8, 0.8, 0.8, 1.0]);
    }

    #[test]
    fn a_step_and_a_ramp_have_closed_forms() {
        // From s = 1 down to 0 over length 2; κ = 4 above 0.5, a ramp 0..1 below: depths 4 and 0.5.
        let points = vec![point(0.0, [1.0; 3], 0.0), point(0.5, [1.0; 3], 1.0), point(0.5, [0.5; 3], 4.0)];
        let transfer = TransferFunction::new(points).unwrap();
        let found = shade(Model::EmissionAbsorption, &transfer, &[segment([1.0, 0.0], [0.0, 2.0])]);
        let (front, back) = ((-4.0_f64).exp(), (-0.5_f64).exp());
        let expected = 0.5 * (1.0 - front) + front * (1.0 - back);
        assert!((found[0] - expected).abs() < 1e-13 && (found[3] - (1.0 - front * back)).abs() < 1e-13, "{found:?}");
    }

    #[test]
    fn great_depths_are_integrated_and_nothing_is_a_miss() {
        let transfer = TransferFunction::new(vec![
            ControlPoint { value: 0.0, color: [1.0, 0.0, 0.5], extinction: 0.0 },
            ControlPoint { value: 1.0, color: [1.0, 1.0, 0.5], extinction: 1e6 },
        ])
        .unwrap();
        let [r, g, b, a] = shade(Model::EmissionAbsorption, &transfer, &[segment([0.0, 1.0], [0.0, 1.0])]);
        // With τ = 10^6 t²/2, green is the mean depth of the light: ∫ e^(−τ) dt = √(π/2)/1000.
        assert!((r - 1.0).abs() < 1e-12 && (b - 0.5).abs() < 1e-12 && (a - 1.0).abs() < 1e-12);
        assert!((g - (std::f64::consts::FRAC_PI_2).sqrt() * 1e-3).abs() < 1e-12, "{g}");
        for model in Model::ALL {
            let miss = if model == Model::Absorption { [1.0; 4] } else { [0.0; 4] };
            assert_eq!(shade(model, &transfer, &[]), miss);
        }
    }
}
