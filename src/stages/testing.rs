//! What the stages' tests share: random cells, views of them, and rays through them in f64, the slow twin.

pub(super) mod polyhedra;
pub(super) mod whole;

use glam::{DVec3, Vec3};

use super::{SceneVertex, View};
use crate::camera::{Camera, Projection};
use crate::columns::{CellCounts, Dataset, Points, TetMesh};

/// Random numbers, the same for the same seed (Knuth's MMIX generator, its upper bits).
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1)
    }

    /// Uniform in [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / f64::from(1 << 24)
    }

    /// Uniform in the cube from −1 to 1.
    pub(super) fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

/// Separate cells of about `size` in the cube from −1 to 1; they overlap.
pub(super) fn random_cells(count: u32, size: f64, random: &mut Random) -> Dataset {
    let mut points = Vec::new();
    for _ in 0..count {
        let center = random.point();
        points.extend((0..4).map(|_| (center + random.point() * size).to_array()));
    }
    Dataset::from_tets(TetMesh {
        points: Points::F64(points),
        tets: (0..count).map(|i| [0, 1, 2, 3].map(|k| 4 * i + k)).collect(),
        file_from_tet: (0..count).collect(),
        arrays: Vec::new(),
        counts: CellCounts::default(),
    })
    .unwrap()
}

/// Views of the cube from −1 to 1: from outside and from inside it, and along parallel rays.
pub(super) fn views(dataset: &Dataset, width: u32, height: u32) -> [View; 3] {
    let outside = Camera::looking_at(DVec3::new(3.0, -2.5, 1.5), DVec3::new(0.1, 0.0, 0.2), width, height);
    let inside = Camera {
        projection: Projection::Perspective { fov_degrees: 75.0 },
        ..Camera::looking_at(DVec3::new(0.3, -0.2, 0.1), DVec3::new(-0.6, 0.5, 0.0), width, height)
    };
    let parallel = Camera { projection: Projection::Orthographic { height_world: 3.0 }, ..outside.clone() };
    [outside, inside, parallel].map(|camera| View::new(&camera, dataset).unwrap())
}

/// Origin and direction (per unit of view depth) of the ray of picture position (x, y).
pub(super) fn ray(view: &View, x: f64, y: f64) -> (DVec3, DVec3) {
    let aside = view.corner + view.step_x * x + view.step_y * y;
    if view.is_perspective { (view.eye, view.forward + aside) } else { (view.eye + aside, view.forward) }
}

pub(super) fn corners(dataset: &Dataset, vertices: &[SceneVertex], cell: usize) -> [DVec3; 4] {
    dataset.tets.get(cell).map(|v| Vec3::from_array(vertices[v as usize].position).as_dvec3())
}

/// View depths between which a ray lies in a cell and in the view's range; empty (first ≥ second) where it misses.
pub(super) fn depths_in_cell(view: &View, (origin, direction): (DVec3, DVec3), p: [DVec3; 4]) -> (f64, f64) {
    let (mut first, mut last) = (f64::from(view.near), f64::from(view.far));
    for k in 0..4 {
        let [a, b, c] = [(k + 1) % 4, (k + 2) % 4, (k + 3) % 4].map(|i| p[i]);
        let n = (b - a).cross(c - a);
        // Outward: away from the vertex opposite.
        let n = if n.dot(p[k] - a) > 0.0 { -n } else { n };
        let (height, along) = (n.dot(origin - a), n.dot(direction));
        if along < 0.0 {
            first = first.max(-height / along);
        } else if along > 0.0 {
            last = last.min(-height / along);
        } else if height > 0.0 {
            return (0.0, 0.0);
        }
    }
    (first, last)
}
