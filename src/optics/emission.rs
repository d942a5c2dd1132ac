//! Emission: the gas glows and hides nothing. RGB = ∫ c κ dt, A = 0; the order does not matter.

use super::compositing::{CellSpan, Optics, Piecewise, at, piecewise};
use super::integral::product_mean;
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
#[inline(always)]
pub(super) fn sums(piece: &Piece, segments: &[Segments], out: &mut [Contribution]) {
    let piece = &{ *piece };
    for (segments, out) in segments.iter().zip(out) {
        for i in 0..LANES {
            let (k0, c0) = at(piece, segments.enter[i]);
            let (k1, c1) = at(piece, segments.leave[i]);
            for c in 0..3 {
                out[c][i] = segments.length_world[i] * product_mean(k0, k1, c0[c], c1[c]);
            }
            out[3][i] = segments.length_world[i] * 0.5 * (k0 + k1);
        }
    }
}
