//! `tets`: a jittered grid with the signal of Marschner and Lobb.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::field::sample;
use super::grid::grid;
use super::settings::Settings;
use crate::columns::TetMesh;
use crate::error::Result;

/// A jittered grid of the unit cube in tetrahedra, with the [`marschner_lobb`] signal, 0 to 1.
///
/// ```
/// # use cellfan::generate::{Scheme, Settings, tets};
/// let mesh = tets(&Settings { cells: 40, scheme: Scheme::Five, ..Settings::default() })?;
/// assert_eq!((mesh.tets.len(), mesh.points.len()), (5 * 8, 27));
/// # Ok::<(), cellfan::Error>(())
/// ```
///
/// # Errors
/// As [`super::generate`].
pub fn tets(settings: &Settings) -> Result<TetMesh> {
    let grid = grid(settings)?;
    Ok(sample(grid.points, grid.tets, marschner_lobb))
}

/// The test signal of Marschner and Lobb (An Evaluation of Reconstruction Filters for Volume Rendering, 1994) at a
/// point of the unit cube, which stands for their [−1, 1]³: rings of frequency 6 under a sine, 0 to 1.
///
/// ```
/// # use cellfan::generate::marschner_lobb;
/// // On the axis the ring term is cos(12 pi cos 0 / 2) = 1; the sine is 0 in the middle.
/// let middle = marschner_lobb(glam::DVec3::splat(0.5));
/// assert!((middle - (1.0 + 0.25 * 2.0) / 2.5).abs() < 1e-12);
/// ```
pub fn marschner_lobb(p: DVec3) -> f64 {
    const ALPHA: f64 = 0.25;
    const FREQUENCY: f64 = 6.0;
    let p = p * 2.0 - 1.0;
    let r = (p.x * p.x + p.y * p.y).sqrt();
    let ring = libm::cos(2.0 * PI * FREQUENCY * libm::cos(FRAC_PI_2 * r));
    (1.0 - libm::sin(FRAC_PI_2 * p.z) + ALPHA * (1.0 + ring)) / (2.0 * (1.0 + ALPHA))
}
