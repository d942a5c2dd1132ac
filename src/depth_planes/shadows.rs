//! `LightVolume`: how much of a light arrives at each place of a volume.
//!
//! Made before the picture, as it is made: planes across the light, nearest to it first, and what arrives at a point of a plane is what
//! arrived at the plane before, dimmed by what lies between. The planes are those of a lattice along the grid's axis that runs most towards
//! the light, so that a plane's points see the plane before between four of its points.

use glam::DVec3;
use rayon::prelude::*;

use super::classify::Classifier;
use super::sample::{Grid, Places, Sampler};
use crate::optics::exp::exp_neg;
use crate::optics::lanes::{LANES, Lanes};

/// Points of the lattice along an axis at most.
const MOST: usize = 128;

/// Transmittances on a lattice over the grid.
pub(super) struct LightVolume {
    dims: [usize; 3],
    /// Points of the lattice per step of the grid.
    scale: [f32; 3],
    transmittances: Vec<f32>,
}

impl LightVolume {
    /// The light that comes from `toward`, a world direction of length 1 in grid steps.
    pub(super) fn new(sampler: &dyn Sampler, grid: &Grid, classifier: &Classifier, toward: DVec3) -> Self {
        let dims = grid.upper.map(|upper| (upper as usize + 1).clamp(2, MOST));
        let scale: [f32; 3] = std::array::from_fn(|axis| (dims[axis] - 1) as f32 / grid.upper[axis]);
        let step: [f32; 3] = std::array::from_fn(|axis| toward[axis] as f32 * scale[axis]);
        let axis = (0..3).max_by(|&a, &b| step[a].abs().total_cmp(&step[b].abs())).unwrap_or(0);
        let sweep = Sweep {
            sampler,
            classifier,
            dims,
            scale,
            upper: grid.upper,
            axis,
            across: [(axis + 1) % 3, (axis + 2) % 3],
            step: step.map(|along| along / step[axis].abs()),
            length_world: 1.0 / step[axis].abs(),
        };
        let mut transmittances = vec![1.0; dims.iter().product()];
        let [u, v] = sweep.across;
        let strides = [1, dims[0], dims[0] * dims[1]];
        let mut before = vec![1.0; dims[u] * dims[v]];
        for number in 1..dims[axis] {
            let place = if step[axis] > 0.0 { dims[axis] - 1 - number } else { number };
            let mut plane = vec![0.0; before.len()];
            plane.par_chunks_mut(dims[u]).enumerate().for_each(|(row, out)| sweep.row(place, row, &before, out));
            for (i, &transmittance) in plane.iter().enumerate() {
                transmittances[place * strides[axis] + i % dims[u] * strides[u] + i / dims[u] * strides[v]] =
                    transmittance;
            }
            before = plane;
        }
        Self { dims, scale, transmittances }
    }

    /// The share of the light that arrives at a place of the grid.
    pub(super) fn at(&self, place: [f32; 3]) -> f32 {
        let mut first = [0; 3];
        let mut share = [0.0; 3];
        for axis in 0..3 {
            let place = place[axis] * self.scale[axis];
            first[axis] = (place as usize).min(self.dims[axis] - 2);
            share[axis] = place - first[axis] as f32;
        }
        let [i, j, k] = first;
        let at = |i: usize, j: usize, k: usize| self.transmittances[i + self.dims[0] * (j + self.dims[1] * k)];
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let row = |j, k| mix(at(i, j, k), at(i + 1, j, k), share[0]);
        mix(mix(row(j, k), row(j + 1, k), share[1]), mix(row(j, k + 1), row(j + 1, k + 1), share[1]), share[2])
    }
}

/// From plane to plane.
struct Sweep<'a> {
    sampler: &'a dyn Sampler,
    classifier: &'a Classifier,
    dims: [usize; 3],
    scale: [f32; 3],
    upper: [f32; 3],
    /// The axis that planes follow each other along, and those in them.
    axis: usize,
    across: [usize; 2],
    /// From a point to the plane before, in points, and how long that is.
    step: [f32; 3],
    length_world: f32,
}

impl Sweep<'_> {
    /// A row of the plane at `place` along the axis; `before` is the plane nearer to the light.
    fn row(&self, place: usize, row: usize, before: &[f32], out: &mut [f32]) {
        let [u, v] = self.across;
        for (batch, out) in out.chunks_mut(LANES).enumerate() {
            let mut middle: Places = [[0.0; LANES]; 3];
            let mut length: Lanes = [0.0; LANES];
            let mut arrived: Lanes = [1.0; LANES];
            for l in 0..out.len() {
                let mut point = [0.0; 3];
                (point[self.axis], point[u], point[v]) = (place as f32, (batch * LANES + l) as f32, row as f32);
                // As far as the light's way is in the grid.
                let inside = [u, v].into_iter().fold(1.0_f32, |share, axis| {
                    let last = (self.dims[axis] - 1) as f32;
                    let room = if self.step[axis] > 0.0 { last - point[axis] } else { point[axis] };
                    if self.step[axis].abs() > room { share.min(room / self.step[axis].abs()) } else { share }
                });
                for axis in 0..3 {
                    let at = (point[axis] + 0.5 * inside * self.step[axis]) / self.scale[axis];
                    middle[axis][l] = at.clamp(0.0, self.upper[axis]);
                }
                length[l] = inside * self.length_world;
                if inside >= 1.0 {
                    arrived[l] = self.on_plane(before, point[u] + self.step[u], point[v] + self.step[v]);
                }
            }
            let mut s = [0.0; LANES];
            self.sampler.sample(&middle, &mut s);
            let looks = self.classifier.looks(&s, &length, &mut 0);
            for l in 0..out.len() {
                out[l] = arrived[l] * exp_neg(looks.extinction[l] * length[l]);
            }
        }
    }

    fn on_plane(&self, plane: &[f32], u: f32, v: f32) -> f32 {
        let width = self.dims[self.across[0]];
        let cell = |at: f32, axis: usize| (at as usize).min(self.dims[axis] - 2);
        let (i, j) = (cell(u, self.across[0]), cell(v, self.across[1]));
        let (x, y) = (u - i as f32, v - j as f32);
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let row = |j: usize| mix(plane[i + j * width], plane[i + 1 + j * width], x);
        mix(row(j), row(j + 1), y)
    }
}
