//! `orbital`: the density |ψ|² of an electron of the hydrogen atom, from the closed form of its wave function.
//!
//! In units of the Bohr radius, with ρ = 2r/n:
//!
//! ψ = √((2/n)³ (n−l−1)! / (2n (n+l)!)) e^(−ρ/2) ρ^l L(ρ) · √((2l+1)/4π · (l−m)!/(l+m)!) P(cos θ) e^(imφ)
//!
//! L is the associated Laguerre polynomial of degree n−l−1 and order 2l+1, P the associated Legendre function of degree
//! l and order m; both come from their three-term recurrences. |ψ|² depends neither on φ nor on the sign of m.

use std::f64::consts::PI;

use glam::DVec3;

use super::field::{Field, sample};
use super::grid::grid;
use super::settings::Settings;
use crate::columns::TetMesh;
use crate::error::{Error, Result};

/// Quantum numbers of an orbital: 1 ≤ n ≤ 20, l < n, |m| ≤ l.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Orbital {
    /// The shell, from 1.
    pub n: u32,
    /// The angular momentum, from 0.
    pub l: u32,
    /// Its component along z; the density is the same for −m.
    pub m: i32,
}

impl Default for Orbital {
    /// 4d with m = 0: lobes, a torus and a nodal sphere.
    fn default() -> Self {
        Self { n: 4, l: 2, m: 0 }
    }
}

impl Orbital {
    /// The largest n: (n + l)! and the powers of ρ stay far from the limits of f64.
    pub const MAX_N: u32 = 20;

    fn check(self) -> Result<()> {
        let Self { n, l, m } = self;
        if n == 0 || n > Self::MAX_N || l >= n || m.unsigned_abs() > l {
            let problem = format!("there is no n = {n}, l = {l}, m = {m}: 1 ≤ n ≤ {}, l < n, |m| ≤ l", Self::MAX_N);
            return Err(Error::Option { option: "--orbital", problem });
        }
        Ok(())
    }

    /// Half the edge of the cube that is drawn, in Bohr radii: more than 99.9 % of the electron is inside (tested).
    pub fn half_edge(self) -> f64 {
        let n = f64::from(self.n);
        n * (2.0 * n + 7.0)
    }

    /// |ψ|² at `p`, in Bohr radii from the nucleus, per cubic Bohr radius; 0 where there is no such orbital.
    ///
    /// ```
    /// # use cellfan::generate::Orbital;
    /// let ground = Orbital { n: 1, l: 0, m: 0 };
    /// let density = ground.density(glam::DVec3::new(0.0, 0.6, 0.8));
    /// assert!((density - (-2.0_f64).exp() / std::f64::consts::PI).abs() < 1e-15); // e^(-2r)/pi at r = 1
    /// ```
    pub fn density(self, p: DVec3) -> f64 {
        if self.check().is_err() {
            return 0.0;
        }
        let (n, l, m) = (self.n, self.l, self.m.unsigned_abs());
        let r = p.length();
        let rho = 2.0 * r / f64::from(n);
        let cos_theta = if r > 0.0 { p.z / r } else { 1.0 };
        let shell = f64::from(n);
        let radial_squared = 8.0 / (shell * shell * shell) * factorial(n - l - 1) / (2.0 * shell * factorial(n + l));
        let angular_squared = f64::from(2 * l + 1) / (4.0 * PI) * factorial(l - m) / factorial(l + m);
        let radial = libm::pow(rho, f64::from(l)) * laguerre(n - l - 1, f64::from(2 * l + 1), rho);
        let angular = legendre(l, m, cos_theta);
        radial_squared * libm::exp(-rho) * (radial * radial) * (angular_squared * (angular * angular))
    }
}

fn factorial(k: u32) -> f64 {
    (2..=k).map(f64::from).product()
}

/// The associated Laguerre polynomial of degree `k` and order `order`: (i+1) L' = (2i+1+order−x) L − (i+order) L
/// before.
fn laguerre(k: u32, order: f64, x: f64) -> f64 {
    let (mut before, mut now) = (0.0, 1.0);
    for i in 0..k {
        let i = f64::from(i);
        (before, now) = (now, ((2.0 * i + 1.0 + order - x) * now - (i + order) * before) / (i + 1.0));
    }
    now
}

/// The associated Legendre function without (−1)^m: from degree m, (2m−1)!! (1−x²)^(m/2), up to degree l.
fn legendre(l: u32, m: u32, x: f64) -> f64 {
    let sine = (1.0 - x * x).max(0.0).sqrt();
    let mut now: f64 = (1..=m).map(|i| f64::from(2 * i - 1) * sine).product();
    let mut before = 0.0;
    for degree in m + 1..=l {
        let next = (f64::from(2 * degree - 1) * x * now - f64::from(degree + m - 1) * before) / f64::from(degree - m);
        (before, now) = (now, next);
    }
    now
}

/// |ψ|² of `settings.orbital` on a grid of the unit cube in tetrahedra, per cubic Bohr radius.
///
/// The cube stands for [`Orbital::half_edge`] Bohr radii on each side of the nucleus at (½, ½, ½); z is the axis.
///
/// # Errors
/// As [`super::generate`]; [`Error::Option`] where there is no such orbital.
pub fn orbital(settings: &Settings) -> Result<TetMesh> {
    let field = field(settings)?;
    let grid = grid(settings)?;
    Ok(sample(grid.points, grid.tets, field))
}

/// The density over the unit cube.
pub(super) fn field(settings: &Settings) -> Result<Field> {
    settings.orbital.check()?;
    let (orbital, edge) = (settings.orbital, 2.0 * settings.orbital.half_edge());
    Ok(Box::new(move |p| orbital.density((p - DVec3::splat(0.5)) * edge)))
}

#[cfg(test)]
mod tests;
