use std::f64::consts::PI;

use glam::DVec3;

use super::{Orbital, laguerre, legendre, orbital};
use crate::error::Error;
use crate::generate::Settings;

/// ∫ |ψ|² in the ball that fits the cube, by midpoints in r and cos θ.
fn electron_in_ball(orbital: Orbital) -> f64 {
    let (radii, angles) = (2000, 200);
    let dr = orbital.half_edge() / f64::from(radii);
    let dc = 2.0 / f64::from(angles);
    let ring = |i: i32, j: i32| {
        let (r, cos) = ((f64::from(i) + 0.5) * dr, -1.0 + (f64::from(j) + 0.5) * dc);
        let p = DVec3::new(r * (1.0 - cos * cos).sqrt(), 0.0, r * cos);
        orbital.density(p) * 2.0 * PI * r * r * dr * dc
    };
    (0..radii).flat_map(|i| (0..angles).map(move |j| (i, j))).map(|(i, j)| ring(i, j)).sum()
}

#[test]
fn every_orbital_up_to_shell_5_holds_one_electron() {
    for n in 1..=5 {
        for l in 0..n {
            for m in 0..=l as i32 {
                let total = electron_in_ball(Orbital { n, l, m });
                assert!((total - 1.0).abs() < 1e-3, "n {n} l {l} m {m}: {total}");
            }
        }
    }
    for orbital in [Orbital { n: 20, l: 0, m: 0 }, Orbital { n: 12, l: 5, m: -3 }] {
        let total = electron_in_ball(orbital);
        assert!((total - 1.0).abs() < 1e-3, "{orbital:?}: {total}");
    }
}

#[test]
fn density_is_that_of_the_closed_forms() {
    for p in [DVec3::new(0.3, -1.2, 0.7), DVec3::new(0.0, 0.0, 2.5), DVec3::new(4.0, 1.0, -3.0), DVec3::ZERO] {
        let (r, cos) = (p.length(), if p == DVec3::ZERO { 1.0 } else { p.z / p.length() });
        let sin_squared = 1.0 - cos * cos;
        // Griffiths, Introduction to Quantum Mechanics, tables 4.3 and 4.7.
        let r20 = 0.5_f64.sqrt() * (1.0 - r / 2.0) * (-r / 2.0).exp();
        let r21 = r / 24.0_f64.sqrt() * (-r / 2.0).exp();
        let r32 = 4.0 / (81.0 * 30.0_f64.sqrt()) * r * r * (-r / 3.0).exp();
        let known = [
            (Orbital { n: 2, l: 0, m: 0 }, r20 * r20 / (4.0 * PI)),
            (Orbital { n: 2, l: 1, m: 0 }, r21 * r21 * 3.0 / (4.0 * PI) * cos * cos),
            (Orbital { n: 2, l: 1, m: 1 }, r21 * r21 * 3.0 / (8.0 * PI) * sin_squared),
            (Orbital { n: 3, l: 2, m: 0 }, r32 * r32 * 5.0 / (16.0 * PI) * (3.0 * cos * cos - 1.0).powi(2)),
            (Orbital { n: 3, l: 2, m: -1 }, r32 * r32 * 15.0 / (8.0 * PI) * sin_squared * cos * cos),
            (Orbital { n: 3, l: 2, m: 2 }, r32 * r32 * 15.0 / (32.0 * PI) * sin_squared * sin_squared),
        ];
        for (orbital, expected) in known {
            let found = orbital.density(p);
            assert!((found - expected).abs() <= 1e-12 * expected + 1e-18, "{orbital:?} at {p}: {found} {expected}");
        }
    }
}

#[test]
fn recurrences_agree_with_the_polynomials_written_out() {
    for x in [0.0_f64, 0.3, -0.8, 1.0] {
        assert!((laguerre(2, 1.0, x) - (x * x / 2.0 - 3.0 * x + 3.0)).abs() < 1e-14);
        assert!((legendre(3, 0, x) - (5.0 * x.powi(3) - 3.0 * x) / 2.0).abs() < 1e-14);
        assert!((legendre(3, 2, x) - 15.0 * x * (1.0 - x * x)).abs() < 1e-13);
    }
}

#[test]
fn orbital_that_does_not_exist_is_refused() {
    for (n, l, m) in [(0, 0, 0), (21, 0, 0), (2, 2, 0), (3, 1, 2), (3, 1, -2), (1, 0, i32::MIN), (u32::MAX, 3, 0)] {
        let orbital_settings = Settings { orbital: Orbital { n, l, m }, ..Settings::default() };
        assert!(matches!(orbital(&orbital_settings), Err(Error::Option { option: "--orbital", .. })));
        assert!(orbital_settings.orbital.density(DVec3::ONE).abs() <= 0.0);
    }
}
