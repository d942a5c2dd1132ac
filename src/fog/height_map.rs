//! `HeightMap`: heights on a square grid of 2ⁿ + 1 points a side, from noise or from a 16-bit picture.

use std::path::Path;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::generate::noise::{Noise, smoothstep};
use crate::memory;

/// Heights over the unit square, row by row from y = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    /// Points a side: 2ⁿ + 1.
    side: usize,
    heights: Vec<f32>,
}

/// What shapes maps of noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapSettings {
    /// Points a side; rounded up to 2ⁿ + 1.
    pub points: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// When, in seconds: fog drifts.
    pub time_s: f64,
}

impl Default for MapSettings {
    fn default() -> Self {
        Self { points: 513, seed: 1, time_s: 0.0 }
    }
}

impl HeightMap {
    /// The longest side.
    pub const MOST: usize = (1 << 13) + 1;

    /// Samples `height` at all points of a grid of at least `points` a side.
    ///
    /// # Errors
    /// [`Error::Option`] where there are fewer than 3 or more than [`HeightMap::MOST`] points; [`Error::OutOfMemory`].
    pub fn sample(points: usize, height: impl Fn(DVec2) -> f64 + Sync) -> Result<Self> {
        let most = Self::MOST;
        if !(3..=most).contains(&points) {
            let problem = format!("{points} points a side; a map has 3 to {most}");
            return Err(Error::Option { option: "--points", problem });
        }
        let side = (points - 1).next_power_of_two() + 1;
        memory::check(|| format!("a map of {side}x{side} heights"), Some(64 * (side * side) as u64))?;
        let at = |i: usize| DVec2::new((i % side) as f64, (i / side) as f64) / (side - 1) as f64;
        Ok(Self { side, heights: (0..side * side).into_par_iter().map(|i| height(at(i)) as f32).collect() })
    }

    /// Reads a picture of 8 or 16 bits: black is 0, white is 1; interpolated where its sides are not 2ⁿ + 1. Its first row is at y = 1.
    ///
    /// # Errors
    /// [`Error::Io`] where the file cannot be read, [`Error::Malformed`] where it is no picture.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
        let malformed = |problem: String| Error::Malformed { path: path.to_owned(), place: String::new(), problem };
        let picture = image::load_from_memory(&bytes).map_err(|error| malformed(error.to_string()))?.into_luma16();
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        if width < 2 || height < 2 {
            return Err(malformed(format!("{width}x{height} pixels; a map needs 2x2 or more")));
        }
        let pixel = |x: usize, y: usize| f64::from(picture.get_pixel(x as u32, (height - 1 - y) as u32).0[0]);
        Self::sample(width.max(height).clamp(3, Self::MOST), |at| {
            let [fx, fy] = [at.x * (width - 1) as f64, at.y * (height - 1) as f64];
            let [x, y] = [(fx as usize).min(width - 2), (fy as usize).min(height - 2)];
            let [tx, ty] = [fx - x as f64, fy - y as f64];
            let row = |y| pixel(x, y) * (1.0 - tx) + pixel(x + 1, y) * tx;
            (row(y) * (1.0 - ty) + row(y + 1) * ty) / f64::from(u16::MAX)
        })
    }

    /// Points a side.
    pub fn side(&self) -> usize {
        self.side
    }

    /// All heights, row by row.
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// The height over any place of the unit square, between points bilinear; places outside count as its border.
    pub fn height(&self, at: DVec2) -> f64 {
        let cells = self.side - 1;
        let scaled = at.clamp(DVec2::ZERO, DVec2::ONE) * cells as f64;
        let [x, y] = [(scaled.x as usize).min(cells - 1), (scaled.y as usize).min(cells - 1)];
        let [tx, ty] = [scaled.x - x as f64, scaled.y - y as f64];
        let of = |x: usize, y: usize| f64::from(self.heights[x + self.side * y]);
        let row = |y| of(x, y) * (1.0 - tx) + of(x + 1, y) * tx;
        row(y) * (1.0 - ty) + row(y + 1) * ty
    }

    /// The same map with as many points as one of `side` points.
    pub(super) fn resampled(&self, side: usize) -> Result<Self> {
        if self.side == side { Ok(self.clone()) } else { Self::sample(side, |at| self.height(at)) }
    }
}

/// Mountains and valleys, 0 to 1.
///
/// # Errors
/// Those of [`HeightMap::sample`].
pub fn ground_map(settings: &MapSettings) -> Result<HeightMap> {
    let broad = Noise::new(settings.seed, 0.55, 3);
    let ridges = Noise::new(settings.seed.wrapping_add(11), 0.3, 7);
    HeightMap::sample(settings.points, |at| {
        let valley = smoothstep(-0.45, 0.55, broad.plane(at));
        let ridge = 1.0 - (2.0 * ridges.plane(at)).abs().min(1.0);
        (0.12 * ridge + valley * (0.35 + 0.53 * ridge)).clamp(0.0, 1.0)
    })
}

/// Banks of fog, thickest where `ground` is low, 0 to 1; they drift.
///
/// # Errors
/// Those of [`HeightMap::sample`].
pub fn fog_map(ground: &HeightMap, settings: &MapSettings) -> Result<HeightMap> {
    let banks = Noise::new(settings.seed.wrapping_add(23), 0.16, 4);
    let drift = DVec3::new(0.010, 0.004, 0.015) * settings.time_s;
    HeightMap::sample(ground.side(), |at| {
        let low = 1.0 - smoothstep(0.12, 0.5, ground.height(at));
        let bank = 0.5 + 0.9 * banks.space(DVec3::new(at.x, at.y, 0.0) + drift);
        (low * bank).clamp(0.0, 1.0)
    })
}
