//! Emission and absorption: the gas glows with c·κ and hides what is behind it.
//!
//! Contribution: premultiplied RGB and transmittance. `over` is Porter and Duff's.

use super::attenuation::THIN_LIMIT;
use super::compositing::{CellSpan, Optics, Piecewise, extinction, light_slipped_in, piecewise};
use super::integral::{
    SegmentWeights, VERY_THIN_LIMIT, segment_weights, segment_weights_thin, segment_weights_very_thin,
};
use super::lanes::{Contribution, LANES, Segments};
use super::pieces::{Piece, Pieces};

/// The exact integral of every piece.
#[derive(Clone, Copy, Debug)]
pub struct EmissionAbsorption<'a> {
    /// The transfer function.
    pub pieces: &'a Pieces,
}

/// Colour and transmittance of each segment by one form of the integral.
#[inline(always)]
fn weigh(piece: &Piece, segments: &[Segments], weights: impl Fn(f32, f32) -> SegmentWeights, out: &mut [Contribution]) {
    let piece = &{ *piece };
    for (&segments, out) in segments.iter().zip(out) {
        let mut added = [[0.0; LANES]; 4];
        for i in 0..LANES {
            let (t0, t1) = (segments.enter[i] - piece.start, segments.leave[i] - piece.start);
            let (k0, k1) = (extinction(piece, t0), extinction(piece, t1));
            let w = weights(k0 * segments.length_world[i], k1 * segments.length_world[i]);
            // w0 c0 + w1 c1 with c = color + t·slope.
            let (opacity, slope) = (w.w0 + w.w1, w.w0 * t0 + w.w1 * t1);
            for c in 0..3 {
                added[c][i] = opacity * piece.color[c] + slope * piece.color_slope[c];
            }
            added[3][i] = w.transmittance;
        }
        *out = added;
    }
}

impl Optics for EmissionAbsorption<'_> {
    const IS_ORDERED: bool = true;
    const CLEAR: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

    #[inline(always)]
    fn contributions(&self, span: CellSpan, segments: &[Segments], out: &mut [Contribution]) {
        piecewise::<Self>(self.pieces, span, segments, out);
    }

    #[inline(always)]
    fn over(front: [f32; 4], back: [f32; 4]) -> [f32; 4] {
        let t = front[3];
        [front[0] + t * back[0], front[1] + t * back[1], front[2] + t * back[2], t * back[3]]
    }

    fn slipped_in(whole: [f32; 4], behind: [f32; 4], fragment: [f32; 4]) -> Option<[f32; 4]> {
        let of = |c: usize| light_slipped_in([whole[c], whole[3]], [behind[c], behind[3]], [fragment[c], fragment[3]]);
        let ([r, t], [g, _], [b, _]) = (of(0)?, of(1)?, of(2)?);
        Some([r, g, b, t])
    }

    #[inline(always)]
    fn transmittance(contribution: [f32; 4]) -> f32 {
        contribution[3]
    }

    fn pixel(&self, [r, g, b, t]: [f32; 4]) -> [f32; 4] {
        [r, g, b, 1.0 - t]
    }
}

impl Piecewise for EmissionAbsorption<'_> {
    type Piece = Piece;

    #[inline(always)]
    fn of_piece(piece: &Piece, depth_max: f32, segments: &[Segments], out: &mut [Contribution]) {
        if depth_max <= VERY_THIN_LIMIT {
            weigh(piece, segments, segment_weights_very_thin, out);
        } else if depth_max <= THIN_LIMIT {
            weigh(piece, segments, segment_weights_thin, out);
        } else {
            weigh(piece, segments, segment_weights, out);
        }
    }
}
