//! `March`: sixteen rays from plane to plane, nearest first.
//!
//! In: [`Rays`], planes, what samples look like. Out: pixels. The paper merges planes into the picture from back to front; a ray that does the
//! same from front to back has the same light, and can end where nothing behind shows any more. Each plane stands for the slab around it: where a
//! ray enters, leaves or ends within a slab, the sample is taken in the middle of what is left of it, and weighs as much as that is long.
//! Optical depth is summed up and transmittance taken from the sum, so that thin samples lose no digit.

use super::blocks::Occupancy;
use super::classify::{Classifier, least, most};
use super::dispatch::Kernel;
use super::lighting::Lit;
use super::rays::Rays;
use super::sample::{Corners, Places, Sampler};
use super::{Classification, Options};
use crate::optics::exp::{exp_neg, one_minus_exp_neg};
use crate::optics::lanes::{LANES, Lanes, is_any, mask, max, min};
use crate::optics::{Model, Output};

/// What all rays of a picture read.
pub(super) struct March<'a> {
    pub(super) sampler: &'a dyn Sampler,
    pub(super) classifier: &'a Classifier,
    /// Nothing where all that a ray meets counts.
    pub(super) occupancy: Option<&'a Occupancy>,
    pub(super) lit: Option<&'a Lit>,
    pub(super) options: &'a Options,
    /// Between the slabs, from the near limit.
    pub(super) edges: Vec<f32>,
    /// Where the planes are; nothing where they are in the middle of their slabs.
    pub(super) depths: Option<Vec<f32>>,
    /// Planes for which blocks are asked at once.
    pub(super) stretch: usize,
    /// The grid's last point.
    pub(super) upper: [f32; 3],
}

/// The rays of a block of pixels.
pub(super) struct Block<'a> {
    pub(super) march: &'a March<'a>,
    pub(super) rays: Rays,
    pub(super) pixels: &'a mut [[f32; 4]; LANES],
}

impl Kernel for Block<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { march, mut rays, pixels } = self;
        march.follow(&mut rays, pixels);
    }
}

/// What rays have met so far.
struct Met {
    /// Light, or the optical depths of absorption.
    sum: [Lanes; 4],
    /// Optical depth.
    depth: Lanes,
    transmittance: Lanes,
    /// The largest scalar.
    largest: Lanes,
    /// The transfer function's piece that all were in last.
    piece: u32,
}

impl March<'_> {
    #[inline(always)]
    fn follow(&self, rays: &mut Rays, pixels: &mut [[f32; 4]; LANES]) {
        let mut met = Met {
            sum: [[0.0; LANES]; 4],
            depth: [0.0; LANES],
            transmittance: [1.0; LANES],
            largest: [f32::NEG_INFINITY; LANES],
            piece: 0,
        };
        let mut between = [f32::INFINITY, f32::NEG_INFINITY];
        for l in 0..LANES {
            if rays.enter[l] < rays.exit[l] {
                between = [between[0].min(rays.enter[l]), between[1].max(rays.exit[l])];
            }
        }
        let mut plane = self.edges.partition_point(|&edge| edge <= between[0]).saturating_sub(1);
        let end = self.edges.partition_point(|&edge| edge < between[1]).min(self.edges.len() - 1);
        while plane < end {
            let next = (plane + self.stretch).min(end);
            if self.may_show(rays, [self.edges[plane], self.edges[next]]) {
                for plane in plane..next {
                    self.sample(plane, rays, &mut met);
                }
                if !(0..LANES).any(|l| rays.exit[l] > self.edges[next]) {
                    break;
                }
            }
            plane = next;
        }
        for l in 0..LANES {
            pixels[l] = self.pixel(&met, l);
        }
    }

    /// Whether anything between two depths may.
    #[inline(always)]
    fn may_show(&self, rays: &Rays, between: [f32; 2]) -> bool {
        let Some(occupancy) = self.occupancy else { return true };
        let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let (mut lows, mut highs) = ([0.0; LANES], [0.0; LANES]);
            for l in 0..LANES {
                let (from, to) = (max(between[0], rays.enter[l]), min(between[1], rays.exit[l]));
                let a = rays.origin[axis][l] + from * rays.step[axis][l];
                let b = rays.origin[axis][l] + to * rays.step[axis][l];
                let is_in = from < to;
                lows[l] = if is_in { min(a, b) } else { f32::INFINITY };
                highs[l] = if is_in { max(a, b) } else { f32::NEG_INFINITY };
            }
            (low[axis], high[axis]) = (least(&lows), most(&highs));
        }
        // Rounding may put a place a little outside, where a sample is brought back in.
        let clamped = |place: f32, axis: usize| min(max(place, 0.0), self.upper[axis]);
        let box_of = |corner: [f32; 3], pad: f32| [0, 1, 2].map(|axis| clamped(corner[axis] + pad, axis));
        low[0] <= high[0] && occupancy.any(box_of(low, -1e-3), box_of(high, 1e-3))
    }

    /// Takes the samples of one plane.
    #[inline(always)]
    fn sample(&self, plane: usize, rays: &mut Rays, met: &mut Met) {
        let [front, back] = [self.edges[plane], self.edges[plane + 1]];
        let (mut depth, mut length): (Lanes, Lanes) = ([0.0; LANES], [0.0; LANES]);
        match &self.depths {
            None => {
                for l in 0..LANES {
                    let (from, to) = (max(front, rays.enter[l]), min(back, rays.exit[l]));
                    depth[l] = 0.5 * (from + to);
                    length[l] = max(to - from, 0.0) * rays.length[l];
                }
            }
            // The paper's: a plane's point counts whole where it is in the grid.
            Some(depths) => {
                let at = depths[plane];
                for l in 0..LANES {
                    let is_in = rays.enter[l] <= at && at <= rays.exit[l];
                    depth[l] = at;
                    length[l] = if is_in { (back - front) * rays.length[l] } else { 0.0 };
                }
            }
        }
        let mut at: Places = [[0.0; LANES]; 3];
        let mut is_met = [0; LANES];
        // All axes in one loop: three short ones are unrolled before they can become vector code.
        let [x, y, z] = &mut at;
        let ([ox, oy, oz], [dx, dy, dz], [ux, uy, uz]) = (&rays.origin, &rays.step, self.upper);
        for l in 0..LANES {
            is_met[l] = mask(length[l] > 0.0);
            x[l] = min(max(ox[l] + depth[l] * dx[l], 0.0), ux);
            y[l] = min(max(oy[l] + depth[l] * dy[l], 0.0), uy);
            z[l] = min(max(oz[l] + depth[l] * dz[l], 0.0), uz);
        }
        if !is_any(&is_met) {
            return;
        }
        if self.options.classification == Classification::Pre && self.options.model != Model::Mip {
            self.classified_before(&at, &length, rays, met);
        } else {
            self.classified_after(&at, &length, rays, met);
        }
    }

    #[inline(always)]
    fn classified_after(&self, at: &Places, length: &Lanes, rays: &mut Rays, met: &mut Met) {
        let mut s = [0.0; LANES];
        self.sampler.sample(at, &mut s);
        if self.options.model == Model::Mip {
            for l in 0..LANES {
                if length[l] > 0.0 && s[l].is_finite() {
                    met.largest[l] = max(s[l], met.largest[l]);
                }
            }
            return;
        }
        let looks = self.classifier.looks(&s, length, &mut met.piece);
        let colors = |colors: &mut [Lanes; 3]| self.classifier.colors(&looks, &s, colors);
        self.composite(at, length, &looks.extinction, colors, rays, met);
    }

    #[inline(always)]
    fn classified_before(&self, at: &Places, length: &Lanes, rays: &mut Rays, met: &mut Met) {
        let mut corners = Corners::NONE;
        self.sampler.corners(at, &mut corners);
        let mut extinction = [0.0; LANES];
        let mut found = [[0.0; LANES]; 3];
        for l in 0..LANES {
            if length[l] > 0.0 {
                [extinction[l], found[0][l], found[1][l], found[2][l]] = self.classifier.interpolated(&corners, l);
            }
        }
        self.composite(at, length, &extinction, |colors| *colors = found, rays, met);
    }

    /// Adds samples behind those before.
    #[inline(always)]
    fn composite(
        &self,
        at: &Places,
        length: &Lanes,
        extinction: &Lanes,
        colors_of: impl FnOnce(&mut [Lanes; 3]),
        rays: &mut Rays,
        met: &mut Met,
    ) {
        let mut depth = [0.0; LANES];
        let mut is_shown = [0; LANES];
        for l in 0..LANES {
            depth[l] = if length[l] > 0.0 { extinction[l] * length[l] } else { 0.0 };
            is_shown[l] = mask(depth[l] > 0.0);
        }
        if !is_any(&is_shown) {
            return;
        }
        let surfaces = self.lit.map(|lit| lit.surfaces(self.sampler, at));
        if let Some(surfaces) = &surfaces {
            for l in 0..LANES {
                depth[l] *= surfaces.strength[l];
            }
        }
        let mut weight = depth;
        if self.options.model == Model::EmissionAbsorption {
            for l in 0..LANES {
                met.depth[l] += depth[l];
                let left = exp_neg(met.depth[l]);
                weight[l] = met.transmittance[l] - left;
                met.transmittance[l] = left;
                // What is behind cannot be seen.
                let is_done = left < self.options.stop_transmittance;
                rays.exit[l] = if is_done { f32::NEG_INFINITY } else { rays.exit[l] };
            }
        }
        let mut colors = [[0.0; LANES]; 3];
        colors_of(&mut colors);
        if let (Some(lit), Some(surfaces)) = (self.lit, &surfaces) {
            for l in 0..LANES {
                if weight[l] > 0.0 {
                    let color = [0, 1, 2].map(|c| colors[c][l]);
                    let color = lit.reflected(color, surfaces, at, &rays.toward_eye, l);
                    (0..3).for_each(|c| colors[c][l] = color[c]);
                }
            }
        }
        for c in 0..3 {
            for l in 0..LANES {
                // A lane without a weight may have no colour either.
                met.sum[c][l] += if weight[l] > 0.0 { weight[l] * colors[c][l] } else { 0.0 };
            }
        }
        for l in 0..LANES {
            met.sum[3][l] += weight[l];
        }
    }

    /// The pixel of a ray.
    fn pixel(&self, met: &Met, lane: usize) -> [f32; 4] {
        let sum = met.sum.map(|channel| channel[lane]);
        let [r, g, b, _] = sum;
        match self.options.model {
            Model::EmissionAbsorption => [r, g, b, one_minus_exp_neg(met.depth[lane])],
            Model::Emission => [r, g, b, 0.0],
            Model::Absorption => match self.options.output {
                Output::Intensity => sum.map(exp_neg),
                Output::Depth => sum,
            },
            Model::Mip if met.largest[lane] == f32::NEG_INFINITY => [0.0; 4],
            Model::Mip => {
                let [r, g, b] = self.classifier.color_of(met.largest[lane]);
                [r, g, b, 1.0]
            }
        }
    }
}
