//! Emission and absorption: the gas glows with c·κ and hides what is behind it.
//!
//! Contribution: premultiplied RGB and transmittance. `over` is Porter and Duff's.

use super::attenuation::THIN_LIMIT;
use super::compositing::{Optics, PieceSpan, Piecewise, at, piecewise};
use super::integral::{
    SegmentWeights, VERY_THIN_LIMIT, segment_weights, segment_weights_thin, segment_weights_very_thin,
};
use super::lanes::{Contribution, LANES, Lanes, Segments, is_any, mask};
use super::pieces::{Piece, Pieces};

/// The exact integral of every piece.
#[derive(Clone, Copy, Debug)]
pub struct EmissionAbsorption<'a> {
    /// The transfer function.
    pub pieces: &'a Pieces,
}

/// Colour and transmittance of each segment from its optical depths at entry and exit, by one form of the integral.
#[inline(always)]
fn weigh(
    piece: &Piece,
    segments: &Segments,
    (depth_enter, depth_leave): (&Lanes, &Lanes),
    weights: impl Fn(f32, f32) -> SegmentWeights,
    out: &mut Contribution,
) {
    for i in 0..LANES {
        let (_, c0) = at(piece, segments.enter[i]);
        let (_, c1) = at(piece, segments.leave[i]);
        let w = weights(depth_enter[i], depth_leave[i]);
        for c in 0..3 {
            out[c][i] = w.w0 * c0[c] + w.w1 * c1[c];
        }
        out[3][i] = w.transmittance;
    }
}

impl Optics for EmissionAbsorption<'_> {
    const IS_ORDERED: bool = true;
    const CLEAR: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

    #[inline(always)]
    fn contribution(&self, span: PieceSpan, segments: &Segments, out: &mut Contribution) {
        piecewise::<Self>(self.pieces, span, segments, out);
    }

    #[inline(always)]
    fn over(front: [f32; 4], back: [f32; 4]) -> [f32; 4] {
        let t = front[3];
        [front[0] + t * back[0], front[1] + t * back[1], front[2] + t * back[2], t * back[3]]
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
    #[inline(always)]
    fn of_piece(piece: &Piece, segments: &Segments, out: &mut Contribution) {
        let mut depth_enter = [0.0; LANES];
        let mut depth_leave = [0.0; LANES];
        let (mut is_thick, mut is_visible) = ([0; LANES], [0; LANES]);
        for i in 0..LANES {
            depth_enter[i] = at(piece, segments.enter[i]).0 * segments.length_world[i];
            depth_leave[i] = at(piece, segments.leave[i]).0 * segments.length_world[i];
            is_thick[i] = mask(depth_enter[i] + depth_leave[i] > 2.0 * THIN_LIMIT);
            is_visible[i] = mask(depth_enter[i] + depth_leave[i] > 2.0 * VERY_THIN_LIMIT);
        }
        let depths = (&depth_enter, &depth_leave);
        if !is_any(&is_visible) {
            weigh(piece, segments, depths, segment_weights_very_thin, out);
        } else if !is_any(&is_thick) {
            weigh(piece, segments, depths, segment_weights_thin, out);
        } else {
            weigh(piece, segments, depths, segment_weights, out);
        }
    }
}
