//! Polar light: prisms that hang from a ceiling, a height field of how deep particles penetrate.

use glam::{DVec2, DVec3};

use super::PhenomenonSettings;
use super::block::Block;
use crate::columns::CellMesh;
use crate::error::Result;
use crate::generate::noise::{Noise, smoothstep};

/// The ceiling, above a square of side 1.
const CEILING: f64 = 0.6;

/// The deepest penetration below it.
const DEEPEST: f64 = 0.5;

/// Penetration below this share of the deepest does not show.
const LEAST: f64 = 0.04;

/// How fast curtains fold.
const FOLD_PER_S: f64 = 0.03;

/// The curtains of the time.
pub(super) fn aurora(settings: &PhenomenonSettings) -> Result<CellMesh> {
    let penetration = Penetration::new(settings);
    let block = Block::new(settings, [4.0, 4.0, 1.0], false)?;
    Ok(block.mesh(|at| {
        let down = 1.0 - at.z;
        let share = penetration.share(DVec2::new(at.x, at.y));
        // Columns without light keep a little thickness: they are left out, and no cell of others collapses.
        let depth = DEEPEST * share.max(LEAST);
        let point = DVec3::new(at.x, at.y, CEILING - depth * down);
        // Faint at the top, brightest shortly above the lower border.
        let glow = down * down * (1.0 - smoothstep(0.8, 1.0, down));
        let shows = if share > LEAST { share } else { 0.0 };
        (point, (2.0 * shows * glow).clamp(0.0, 1.0))
    }))
}

/// How deep particles come, as a share of the deepest: curtains along lines where noise is 0.
struct Penetration {
    folds: Noise,
    rays: Noise,
    shift: f64,
}

impl Penetration {
    fn new(settings: &PhenomenonSettings) -> Self {
        Self {
            folds: Noise::new(settings.seed, 0.7, 2),
            rays: Noise::new(settings.seed.wrapping_add(1), 0.08, 2),
            shift: FOLD_PER_S * settings.time_s,
        }
    }

    fn share(&self, at: DVec2) -> f64 {
        const WIDTH: f64 = 0.1;
        let fold = self.folds.space(DVec3::new(at.x, at.y, self.shift));
        let curtain = 1.0 - smoothstep(0.0, WIDTH, fold.abs());
        let ray = self.rays.space(DVec3::new(at.x, at.y, 4.0 * self.shift));
        // Nothing at the sides of the square.
        let [x, y] = [at.x, at.y].map(|c| smoothstep(0.0, 0.12, c) * smoothstep(0.0, 0.12, 1.0 - c));
        (curtain * (0.75 + 0.5 * ray) * x * y).clamp(0.0, 1.0)
    }
}
