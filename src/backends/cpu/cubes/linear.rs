//! Cubes between eight points: the trilinear value along a ray, as a chain of segments on which it is nearly linear.
//!
//! Along a ray through a cube, by a parameter t from entry to exit, the value is a cubic whose second derivative is at most twice the sum of
//! the mixed second differences M of the corners (each axis changes by 1 at most). On one of n equal parts it is linear up to M / (4 n²).
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::tile::{BlockRays, Crossing};
use crate::optics::lanes::{max, min};
use crate::optics::{LANES, Lanes, Segments};

/// The value may be off by this share of the range of values.
pub(super) const TOLERANCE: f32 = 1.0 / 2048.0;
/// Parts of a ray's way at most; noise of the whole range is off by a hundredth of it then.
const PARTS_MAX: f32 = 16.0;

/// A cube with values at its corners: corner i has x = bit 0, y = bit 1, z = bit 2 of i.
pub(super) struct LinearCube {
    corners: [f32; 8],
    low: [f32; 3],
    /// One over its sides.
    per_side: [f32; 3],
    /// Segments of a ray.
    pub(super) parts: usize,
    /// The least and the greatest value.
    pub(super) range: [f32; 2],
}

impl LinearCube {
    /// A cube between two grid points, with values that may be off by `tolerance` within.
    pub(super) fn new(corners: [f32; 8], [low, high]: [[f32; 3]; 2], tolerance: f32) -> Self {
        let c = &corners;
        let mixed = |[a, b, d, e]: [usize; 4]| (c[a] - c[b] - c[d] + c[e]).abs();
        // Of two opposite faces across z, y and x.
        let across = [[[0, 1, 2, 3], [4, 5, 6, 7]], [[0, 1, 4, 5], [2, 3, 6, 7]], [[0, 2, 4, 6], [1, 3, 5, 7]]];
        let bent: f32 = across.iter().map(|&[near, far]| mixed(near).max(mixed(far))).sum();
        let parts = (bent / (4.0 * tolerance.max(f32::MIN_POSITIVE))).sqrt().ceil().clamp(1.0, PARTS_MAX);
        let fold = |f: fn(f32, f32) -> f32| c[1..].iter().fold(c[0], |a, &b| f(a, b));
        let per_side = [0, 1, 2].map(|axis| 1.0 / (high[axis] - low[axis]));
        Self { corners, low, per_side, parts: parts as usize, range: [fold(f32::min), fold(f32::max)] }
    }

    /// Where rays enter and leave the cube, from 0 to 1 along each axis.
    #[inline(always)]
    pub(super) fn ends(&self, rays: &BlockRays, crossing: &Crossing) -> [[Lanes; 3]; 2] {
        [&crossing.enter, &crossing.leave].map(|depth| {
            let mut place = [[0.0; LANES]; 3];
            for (axis, place) in place.iter_mut().enumerate() {
                let (low, per_side) = (self.low[axis], self.per_side[axis]);
                for i in 0..LANES {
                    let at = rays.origin[axis][i] - low + depth[i] * rays.step[axis][i];
                    place[i] = min(max(at * per_side, 0.0), 1.0);
                }
            }
            place
        })
    }

    /// The values along rays, a share of their way from entry.
    #[inline(always)]
    pub(super) fn values(&self, [enter, leave]: &[[Lanes; 3]; 2], share: f32) -> Lanes {
        let c = &self.corners;
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let mut values = [0.0; LANES];
        for i in 0..LANES {
            let at = |axis: usize| mix(enter[axis][i], leave[axis][i], share);
            let (x, y, z) = (at(0), at(1), at(2));
            let bottom = mix(mix(c[0], c[1], x), mix(c[2], c[3], x), y);
            let top = mix(mix(c[4], c[5], x), mix(c[6], c[7], x), y);
            // Rounding must not leave the range of the cube.
            values[i] = min(max(mix(bottom, top, z), self.range[0]), self.range[1]);
        }
        values
    }

    /// Part `part` of the rays' ways, which begins at `enter`.
    #[inline(always)]
    pub(super) fn segments(
        &self,
        ends: &[[Lanes; 3]; 2],
        crossing: &Crossing,
        (part, enter): (usize, Lanes),
    ) -> Segments {
        let per_part = 1.0 / self.parts as f32;
        let leave = self.values(ends, (part + 1) as f32 * per_part);
        let mut length_world = crossing.length_world;
        for length in &mut length_world {
            *length *= per_part;
        }
        Segments { enter, leave, length_world }
    }
}
