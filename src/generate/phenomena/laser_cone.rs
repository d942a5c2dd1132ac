//! A laser cone: a beam that circles faster than the eye can follow, seen where smoke drifts through it.

use std::f64::consts::TAU;

use glam::DVec3;

use super::PhenomenonSettings;
use super::block::Block;
use crate::columns::CellMesh;
use crate::error::Result;
use crate::generate::noise::Noise;

/// Radius at the far end, where the cone is 1 long.
const RADIUS: f64 = 0.45;

/// Radius at the mirror.
const MIRROR: f64 = 0.01;

/// Thickness of the beam.
const THICKNESS: f64 = 0.02;

/// How far smoke drifts in a second.
const DRIFT_PER_S: DVec3 = DVec3::new(0.05, 0.02, 0.08);

/// The cone along +x, from the origin.
pub(super) fn laser_cone(settings: &PhenomenonSettings) -> Result<CellMesh> {
    let smoke = Noise::new(settings.seed, 0.3, 4);
    let drift = DRIFT_PER_S * settings.time_s;
    let block = Block::new(settings, [24.0, 2.0, 12.0], true)?;
    Ok(block.mesh(|at| {
        let (sin, cos) = (libm::sin(-TAU * at.x), libm::cos(TAU * at.x));
        let across = 2.0 * at.y - 1.0;
        let radius = MIRROR + RADIUS * at.z + THICKNESS * at.y;
        let point = DVec3::new(at.z, radius * cos, radius * sin);
        // The beam is brightest in the middle of its thickness; its light spreads over a growing circle.
        let beam = (1.0 - across * across) / (1.0 + 4.0 * at.z);
        (point, beam * (0.35 + 0.65 * (0.5 + smoke.space(point - drift))).clamp(0.0, 1.0))
    }))
}
