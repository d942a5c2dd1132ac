//! `power`: the power distance of the eye to a cell's circumsphere, CellFast's "tangential distance".
//!
//! With the corner a as origin, q the other corners and E = e − a, the circumcentre k solves 2 k·q = |q|² for the three q, and
//! |e − a − k|² − |k|² = |E|² − 2 k·E. Along parallel rays d it is (a + k)·d. In f64: a flat cell has a far centre.
//!
//! Exact for a Delaunay mesh of a convex domain without ties (Karasick et al. 1997, Cignoni et al. 1995): of two neighbours,
//! the one on the eye's side of the shared face has the smaller power.

use glam::{DVec3, Vec3};

use super::Toward;
use crate::stages::View;

/// Orders by power distance.
#[derive(Clone, Copy, Debug)]
pub struct Power {
    toward: Toward,
}

impl Power {
    /// For one view.
    pub fn new(view: &View) -> Self {
        Self { toward: Toward::new(view) }
    }

    /// The square root of the power distance with its sign (perspective), or the depth of the circumcentre.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "part of kernels that are compiled for wider vectors")]
    pub fn depth(&self, corners: [Vec3; 4]) -> f64 {
        let [a, b, c, d] = [corners[0].as_dvec3(), corners[1].as_dvec3(), corners[2].as_dvec3(), corners[3].as_dvec3()];
        let (q, r, s) = (b - a, c - a, d - a);
        let (rs, sq, qr) = (r.cross(s), s.cross(q), q.cross(r));
        // Cramer: 2 k = (|q|² r×s + |r|² s×q + |s|² q×r) / (q·r×s).
        let two_k = (rs * q.length_squared() + sq * r.length_squared() + qr * s.length_squared()) / q.dot(rs);
        match self.toward {
            Toward::Eye(eye) => {
                let e: DVec3 = eye - a;
                let power = e.length_squared() - two_k.dot(e);
                // The root spreads keys evenly over depth; it keeps the order.
                power.abs().sqrt().copysign(power)
            }
            Toward::Along(direction) => (a + two_k * 0.5).dot(direction),
        }
    }

    /// The same for a sphere: of a cell with any number of corners, one that fits them.
    pub fn depth_of_sphere(&self, center: DVec3, radius_squared: f64) -> f64 {
        match self.toward {
            Toward::Eye(eye) => {
                let power = eye.distance_squared(center) - radius_squared;
                power.abs().sqrt().copysign(power)
            }
            Toward::Along(direction) => center.dot(direction),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_of_a_regular_corner_is_known() {
        // Circumcentre (½, ½, ½), r² = ¾; from (2, ½, ½): 2.25 − 0.75.
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let eye = Power { toward: Toward::Eye(DVec3::new(2.0, 0.5, 0.5)) };
        assert!((eye.depth(corners) - 1.5_f64.sqrt()).abs() < 1e-12);
        let inside = Power { toward: Toward::Eye(DVec3::splat(0.5)) };
        assert!((inside.depth(corners) + 0.75_f64.sqrt()).abs() < 1e-12);
        let along = Power { toward: Toward::Along(DVec3::X) };
        assert!((along.depth(corners) - 0.5).abs() < 1e-12);
    }
}
