//! A search light: a narrow cone in which light falls off with the square of the distance from the lamp.

use glam::DVec3;

use super::PhenomenonSettings;
use super::block::{Block, disc_from_square};
use crate::columns::CellMesh;
use crate::error::Result;

/// Radius at the lamp, and at the far end, where the beam is 1 long.
const RADII: [f64; 2] = [0.03, 0.16];

/// How far behind the lamp's glass its light comes from: emission is 1 at the glass.
const SOURCE: f64 = 0.25;

/// Degrees that the beam turns in a second, about +z.
const SWEEP_PER_S: f64 = 20.0;

/// Degrees above the horizon.
const ELEVATION: f64 = 15.0;

/// Beam along the direction of the time, from the origin.
pub(super) fn search_light(settings: &PhenomenonSettings) -> Result<CellMesh> {
    let azimuth = (SWEEP_PER_S * settings.time_s).to_radians();
    let (sin_a, cos_a) = (libm::sin(azimuth), libm::cos(azimuth));
    let (sin_e, cos_e) = (libm::sin(ELEVATION.to_radians()), libm::cos(ELEVATION.to_radians()));
    let along = DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e);
    let side = DVec3::new(-sin_a, cos_a, 0.0);
    let up = along.cross(side);
    let block = Block::new(settings, [1.0, 1.0, 4.0], false)?;
    Ok(block.mesh(|at| {
        let [x, y] = disc_from_square(2.0 * at.x - 1.0, 2.0 * at.y - 1.0);
        let radius = RADII[0] + (RADII[1] - RADII[0]) * at.z;
        let point = along * at.z + (side * x + up * y) * radius;
        (point, emission(at.z, x * x + y * y))
    }))
}

/// Emission at a distance along the beam, and the square of the distance from its axis as a share of its radius.
fn emission(distance: f64, radius_squared: f64) -> f64 {
    let attenuation = (SOURCE / (SOURCE + distance)).powi(2);
    attenuation * (1.0 - radius_squared).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_falls_off_with_the_square_of_the_distance_from_its_source() {
        let at = |distance| emission(distance, 0.0);
        assert!((at(SOURCE) / at(0.0) - 0.25).abs() < 1e-12, "twice as far");
        assert!((at(2.0 * SOURCE) / at(0.0) - 1.0 / 9.0).abs() < 1e-12, "three times as far");
        assert!(emission(0.3, 1.0).abs() < 1e-12, "no light at the edge");
    }
}
