//! Emission: the gas glows and hides nothing. RGB = ∫ c κ dt, A = 0; the order does not matter.

use super::compositing::{CellSpan, Optics, Piecewise, extinction, piecewise};
use super::lanes::{Contribution, LANES, Segments};
use super::pieces::{Piece, Pieces};

/// The exact integral: κ and c are linear on a piece, their product is integrated in closed form.
#[derive(Clone, Copy, Debug)]
pub struct Emission<'a> {
    /// The transfer function.
    pub pieces: &'a Pieces,
}

impl Optics for Emission<'_> {
    const IS_ORDERED: bool = false;
    const IS_SUM: bool = true;
    const CHANNELS: usize = 3;
    const CLEAR: [f32; 4] = [0.0; 4];

    #[inline(always)]
    fn contributions(&self, span: CellSpan, segments: &[Segments], out: &mut [Contribution]) {
        piecewise::<Self>(self.pieces, span, segments, out);
    }

    #[inline(always)]
    fn over(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
    }

    fn slipped_in(whole: [f32; 4], _: [f32; 4], fragment: [f32; 4]) -> Option<[f32; 4]> {
        Some(Self::over(whole, fragment))
    }

    #[inline(always)]
    fn transmittance(_: [f32; 4]) -> f32 {
        1.0
    }

    fn pixel(&self, [r, g, b, _]: [f32; 4]) -> [f32; 4] {
        [r, g, b, 0.0]
    }
}

impl Piecewise for Emission<'_> {
    type Piece = Piece;

    #[inline(always)]
    fn of_piece(piece: &Piece, _: f32, segments: &[Segments], out: &mut [Contribution]) {
        sums(piece, segments, out);
    }
}

/// RGB: ∫ c κ dt, A: ∫ κ dt, of segments within one piece.
///
/// With length ℓ, means κ̄ and c̄ and differences Δκ and Δc of both ends, ∫ c κ dt = ℓ (κ̄ c̄ + Δκ Δc/12).
#[inline(always)]
pub(super) fn sums(piece: &Piece, segments: &[Segments], out: &mut [Contribution]) {
    let piece = &{ *piece };
    for (segments, out) in segments.iter().zip(out) {
        for i in 0..LANES {
            let (t0, t1) = (segments.enter[i] - piece.start, segments.leave[i] - piece.start);
            let (k0, k1) = (extinction(piece, t0), extinction(piece, t1));
            let length_world = segments.length_world[i];
            let (depth, rise) = (length_world * (0.5 * (k0 + k1)), length_world * ((k1 - k0) * (1.0 / 12.0)));
            let (mean, difference) = (0.5 * t0 + 0.5 * t1, t1 - t0);
            for c in 0..3 {
                let slope = piece.color_slope[c];
                out[c][i] = depth * (piece.color[c] + mean * slope) + rise * (difference * slope);
            }
            out[3][i] = depth;
        }
    }
}
