//! `Flight`: a path low over a terrain, in and out of its fog.

use std::f64::consts::TAU;

use glam::DVec3;

use super::Terrain;
use crate::camera::Camera;

/// A closed path around the middle of a terrain, at a height above the ground that it follows smoothly.
#[derive(Clone, Debug)]
pub struct Flight {
    places: Vec<DVec3>,
}

/// Places that the path is smoothed over.
const SAMPLES: usize = 512;

/// How far ahead the camera looks, as a share of the path.
const AHEAD: f64 = 0.09;

impl Flight {
    /// The path at `clearance_world` above the ground, as the mean along a part of the path, and never below half of it.
    pub fn new(terrain: &Terrain, clearance_world: f64) -> Self {
        let side = terrain.side_world();
        let place = |i: usize| {
            let angle = TAU * i as f64 / SAMPLES as f64;
            let radius = side * (0.30 + 0.06 * libm::sin(2.0 * angle));
            let [x, y] = [0.5 * side + radius * libm::cos(angle), 0.5 * side + radius * libm::sin(angle)];
            DVec3::new(x, y, terrain.heights_at(x, y)[0])
        };
        let ground: Vec<DVec3> = (0..SAMPLES).map(place).collect();
        let mean = |heights: &[f64], i: usize, width: usize| {
            let near = (0..=2 * width).map(|k| heights[(i + SAMPLES + k - width) % SAMPLES]);
            near.sum::<f64>() / (2 * width + 1) as f64
        };
        let smoothed = |heights: Vec<f64>, width| (0..SAMPLES).map(|i| mean(&heights, i, width)).collect::<Vec<_>>();
        let of_ground: Vec<f64> = ground.iter().map(|p| p.z).collect();
        let broad = smoothed(of_ground.clone(), 20);
        let above: Vec<f64> =
            (0..SAMPLES).map(|i| (broad[i] + clearance_world).max(of_ground[i] + 0.5 * clearance_world)).collect();
        let heights = smoothed(above, 6);
        let heights = (0..SAMPLES).map(|i| heights[i].max(of_ground[i] + 0.25 * clearance_world));
        Self { places: ground.iter().zip(heights).map(|(p, z)| p.with_z(z)).collect() }
    }

    /// Where the path is after a share of it, 0 to 1; it is closed.
    pub fn place(&self, share: f64) -> DVec3 {
        let scaled = share.rem_euclid(1.0) * SAMPLES as f64;
        let (i, t) = (scaled as usize % SAMPLES, scaled.fract());
        self.places[i].lerp(self.places[(i + 1) % SAMPLES], t)
    }

    /// The view ahead.
    pub fn camera(&self, share: f64, size_px: [u32; 2]) -> Camera {
        let (eye, ahead) = (self.place(share), self.place(share + AHEAD));
        // A little down, into the valleys.
        let target = ahead - DVec3::Z * 0.15 * eye.distance(ahead);
        let mut camera = Camera::looking_at(eye, target, size_px[0], size_px[1]);
        camera.projection = crate::camera::Projection::Perspective { fov_degrees: 55.0 };
        camera
    }
}
