//! A camp fire: rising Perlin noise under the outline of a flame.

use glam::DVec3;

use super::PhenomenonSettings;
use super::block::Block;
use crate::columns::CellMesh;
use crate::error::Result;
use crate::generate::noise::{Noise, smoothstep};

/// How fast the noise rises, in heights a second.
const RISE_PER_S: f64 = 0.6;

/// The flame in the unit cube.
pub(super) fn camp_fire(settings: &PhenomenonSettings) -> Result<CellMesh> {
    let noise = Noise::new(settings.seed, 0.35, 4);
    let rise = DVec3::new(0.0, 0.0, RISE_PER_S * settings.time_s);
    let block = Block::new(settings, [1.0; 3], false)?;
    Ok(block.mesh(|at| (at, emission(&noise, at, rise))))
}

/// Hottest above the middle of the ground; noise, twice as high as wide, takes away more of it the higher it is.
fn emission(noise: &Noise, at: DVec3, rise: DVec3) -> f64 {
    let from_axis = DVec3::new(at.x - 0.5, at.y - 0.5, 0.0).length();
    let width = 0.36 * (1.0 - at.z).max(0.0).sqrt() * (0.6 + 0.4 * smoothstep(0.0, 0.2, at.z));
    let outline = 1.0 - smoothstep(0.3 * width, width.max(1e-9), from_axis);
    let turbulence = noise.space(DVec3::new(at.x, at.y, at.z * 0.5) - rise * 0.5);
    (outline * (1.0 - 0.5 * at.z) + (0.3 + 1.2 * at.z) * turbulence * outline).clamp(0.0, 1.0)
}
