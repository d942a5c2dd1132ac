//! The slow twin of opaque geometry: every primitive against every pixel, in f64.
//!
//! In: primitives in world coordinates, a camera, a pixel. Out: how far away the nearest one is that covers its centre; or that it cannot be
//! told, where a centre lies on a border within rounding.

use cellfan::{Camera, Dataset, Projection};
use glam::{DVec2, DVec3};

/// Centres this close to a border, in pixels, may be covered or not; a rasteriser of a GPU places corners to 1/256.
const HAIR_PX: f64 = 0.02;

/// A pixel of the geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Met {
    Nothing,
    /// At this view depth; the cosine of the angle between ray and normal, 1 of lines and points.
    At(f64, f64),
    Unclear,
}

/// Primitives in world coordinates.
#[derive(Default)]
pub(crate) struct Primitives {
    pub(crate) triangles: Vec<[DVec3; 3]>,
    pub(crate) lines: Vec<[DVec3; 2]>,
    pub(crate) points: Vec<DVec3>,
}

/// A camera by its axes.
pub(crate) struct Eye<'a> {
    camera: &'a Camera,
    axes: [DVec3; 3],
    /// Pixels per unit of x / depth, or of x.
    px: f64,
    near: f64,
}

impl<'a> Eye<'a> {
    pub(crate) fn new(camera: &'a Camera, diagonal_world: f64) -> Self {
        let forward = (camera.target - camera.eye).normalize();
        let right = forward.cross(camera.up).normalize();
        let down = forward.cross(right);
        let height = f64::from(camera.height);
        let px = match camera.projection {
            Projection::Perspective { fov_degrees } => height / (2.0 * (0.5 * fov_degrees).to_radians().tan()),
            Projection::Orthographic { height_world } => height / height_world,
        };
        Self { camera, axes: [right, down, forward], px, near: camera.near.unwrap_or(1e-6 * diagonal_world) }
    }

    fn is_perspective(&self) -> bool {
        matches!(self.camera.projection, Projection::Perspective { .. })
    }

    /// To the right, down, and away.
    fn turned(&self, p: DVec3) -> DVec3 {
        DVec3::from_array(self.axes.map(|axis| axis.dot(p - self.camera.eye)))
    }

    /// Place in the picture, pixel centres at halves.
    fn place(&self, p: DVec3) -> DVec2 {
        let scale = if self.is_perspective() { self.px / p.z } else { self.px };
        p.truncate() * scale + 0.5 * DVec2::new(self.camera.width.into(), self.camera.height.into())
    }

    /// Where a point of the world is in the picture.
    pub(crate) fn place_of(&self, p: DVec3) -> DVec2 {
        self.place(self.turned(p))
    }

    /// The ray of a place: where it begins, and its direction per unit of depth.
    fn ray(&self, at: DVec2) -> [DVec3; 2] {
        let aside = (at - 0.5 * DVec2::new(self.camera.width.into(), self.camera.height.into())) / self.px;
        if self.is_perspective() { [DVec3::ZERO, aside.extend(1.0)] } else { [aside.extend(0.0), DVec3::Z] }
    }

    /// A line's part behind the near plane.
    fn behind_near(&self, [a, b]: [DVec3; 2]) -> Option<[DVec3; 2]> {
        let (first, last) = if a.z < b.z { (a, b) } else { (b, a) };
        if last.z < self.near {
            return None;
        }
        let first = if first.z < self.near {
            first + (last - first) * ((self.near - first.z) / (last.z - first.z))
        } else {
            first
        };
        Some([first, last])
    }
}

impl Primitives {
    /// What a pixel shows of them.
    pub(crate) fn meet(&self, eye: &Eye, [x, y]: [u32; 2], [line_px, point_px]: [f64; 2], has_back_only: bool) -> Met {
        let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let far = eye.camera.far.unwrap_or(f64::INFINITY);
        let (mut nearest, mut cos, mut is_unclear) = (f64::INFINITY, 1.0, false);
        let mut meet = |depth: f64, border_px: f64, of: f64| {
            if depth < eye.near || depth > far || border_px < -HAIR_PX {
                return;
            }
            if border_px < HAIR_PX {
                is_unclear = true;
            } else if depth < nearest {
                (nearest, cos) = (depth, of);
            }
        };
        for line in &self.lines {
            let Some(ends) = eye.behind_near(line.map(|end| eye.turned(end))) else { continue };
            let [a, b] = ends.map(|end| eye.place(end));
            let along = b - a;
            let t = if along == DVec2::ZERO { 0.0 } else { (at - a).dot(along) / along.length_squared() };
            let t = t.clamp(0.0, 1.0);
            let mix = |f: fn(f64) -> f64| f(f(ends[0].z) + (f(ends[1].z) - f(ends[0].z)) * t);
            let depth = if eye.is_perspective() { mix(|z| 1.0 / z) } else { mix(|z| z) };
            meet(depth, 0.5 * line_px - at.distance(a + along * t), 1.0);
        }
        for &point in &self.points {
            let p = eye.turned(point);
            if p.z > 0.0 || !eye.is_perspective() {
                let off = (at - eye.place(p)).abs().max_element();
                meet(p.z, 0.5 * point_px - off, 1.0);
            }
        }
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|corner| eye.turned(corner));
            let [origin, direction] = eye.ray(at);
            let normal = (b - a).cross(c - a).normalize();
            // Axes run right, down and away: a right-handed system.
            let toward = normal.dot(direction);
            if has_back_only && toward <= 0.0 {
                continue;
            }
            let depth = normal.dot(a - origin) / toward;
            let hit = origin + direction * depth;
            // Distance to each edge, in pixels, at the depth of the hit.
            let scale = if eye.is_perspective() { eye.px / depth } else { eye.px };
            let inside = [[a, b], [b, c], [c, a]].map(|[p, q]| normal.dot((q - p).normalize().cross(hit - p)) * scale);
            // Seen at an angle a distance is shorter in the picture.
            let border = inside.into_iter().fold(f64::INFINITY, f64::min) * (toward.abs() / direction.length());
            meet(depth, border, (toward / direction.length()).abs());
        }
        match is_unclear {
            true => Met::Unclear,
            false if nearest.is_finite() => Met::At(nearest, cos),
            false => Met::Nothing,
        }
    }
}

/// All edges of the tetrahedra, and all vertices.
pub(crate) fn edges_and_points(dataset: &Dataset) -> Primitives {
    let at = |v: u32| dataset.origin + DVec3::from_array(dataset.positions[v as usize].map(f64::from));
    let mut primitives = Primitives::default();
    let mut edges = std::collections::BTreeSet::new();
    for tet in dataset.tets.iter() {
        for i in 0..4 {
            edges.extend((0..i).map(|k| [tet[k], tet[i]]));
        }
    }
    primitives.lines = edges.iter().map(|edge| edge.map(at)).collect();
    let used: std::collections::BTreeSet<u32> = edges.into_iter().flatten().collect();
    primitives.points = used.into_iter().map(at).collect();
    primitives
}

/// The unit cube's sides, each two triangles, counterclockwise seen from outside.
pub(crate) fn sides_of_unit_cube() -> Primitives {
    let mut primitives = Primitives::default();
    for axis in 0..3 {
        for side in [0.0, 1.0] {
            let corner = |u: f64, v: f64| {
                let mut p = [0.0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, u, v);
                DVec3::from_array(p)
            };
            let around = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
            let [a, b, c, d] = if side > 0.5 { around } else { [around[3], around[2], around[1], around[0]] };
            primitives.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    primitives
}
