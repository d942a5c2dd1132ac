//! Projected convex polyhedra as published (Roettger and Ertl 2003, section 3), kept to reproduce their pictures: a segment glows by the mean
//! of the emission at its ends, times its length in eight bits of its cell's depth.
//!
//! The paper renders the back faces of a cell with `α = (d − d_min)/Δd`, takes the front faces' away, and weighs the colours of all faces
//! with what is left, κ(S)Δd/2 each. Here each segment comes from the one pass that has its ends; α is rounded to 1/255 as a whole, where the
//! paper rounds two depths, which is off by one step at most. Δd is the longest that a segment of the cell can be. Sums of light are
//! in 32 bits, not eight.

use super::compositing::{CellSpan, Optics, at};
use super::lanes::{Contribution, LANES, Segments};
use super::pieces::Pieces;
use super::{Emission, lanes::min};

/// Emission by the ends of segments, whose lengths have eight bits.
#[derive(Clone, Copy, Debug)]
pub struct NormalisedLengths<'a> {
    /// The transfer function.
    pub pieces: &'a Pieces,
}

/// Steps of a length: those of the alpha channel.
const STEPS: f32 = 255.0;

impl Optics for NormalisedLengths<'_> {
    const IS_ORDERED: bool = false;
    const IS_SUM: bool = true;
    const CLEAR: [f32; 4] = Emission::CLEAR;

    #[inline(always)]
    fn contributions(&self, span: CellSpan, segments: &[Segments], out: &mut [Contribution]) {
        let longest = min(span.length_world_max, f32::MAX / STEPS);
        let end = |s: f32| at(self.pieces.piece(self.pieces.piece_of(s)), s);
        for (segments, out) in segments.iter().zip(out) {
            for i in 0..LANES {
                let ((k0, c0), (k1, c1)) = (end(segments.enter[i]), end(segments.leave[i]));
                let alpha = (segments.length_world[i] / longest * STEPS + 0.5) as i32 as f32 / STEPS;
                for c in 0..3 {
                    out[c][i] = alpha * longest * 0.5 * (k0 * c0[c] + k1 * c1[c]);
                }
                out[3][i] = alpha * longest * 0.5 * (k0 + k1);
            }
        }
    }

    #[inline(always)]
    fn over(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        Emission::over(a, b)
    }

    fn slipped_in(whole: [f32; 4], behind: [f32; 4], fragment: [f32; 4]) -> Option<[f32; 4]> {
        Emission::slipped_in(whole, behind, fragment)
    }

    #[inline(always)]
    fn transmittance(_: [f32; 4]) -> f32 {
        1.0
    }

    fn pixel(&self, contribution: [f32; 4]) -> [f32; 4] {
        Emission { pieces: self.pieces }.pixel(contribution)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::{ControlPoint, TransferFunction};

    #[test]
    fn lengths_have_255_steps_and_light_is_the_mean_of_the_ends() {
        let point = |value, extinction| ControlPoint { value, color: [1.0, 0.5, 0.0], extinction };
        let transfer = TransferFunction::new(vec![point(0.0, 1.0), point(1.0, 3.0)]).unwrap();
        let pieces = transfer.pieces(0.0);
        let mut segments = Segments::NONE;
        for i in 0..LANES {
            (segments.enter[i], segments.leave[i]) = (0.0, 1.0);
            segments.length_world[i] = 2.0 * i as f32 / 510.0;
        }
        let span = CellSpan::new(&pieces, 0.0, 1.0).within(2.0);
        let mut out = [[[0.0; LANES]; 4]];
        NormalisedLengths { pieces: &pieces }.contributions(span, &[segments], &mut out);
        for i in 0..LANES {
            // Half steps go up.
            let length = 2.0 * i.div_ceil(2) as f32 / 255.0;
            let [r, g, b, _] = out[0];
            assert!((r[i] - length * 2.0).abs() < 1e-6 && (g[i] - length).abs() < 1e-6 && b[i] == 0.0, "{i}: {}", r[i]);
        }
    }
}
