//! Absorption in bands with functions of their own, four a pass: ∫ κ dt of each.
//!
//! Contribution: the optical depth of each band of the pass. κ is linear along a segment, so its mean is that of its ends.

use super::band_pieces::BandPiece;
use super::compositing::{CellSpan, Optics, Piecewise, piecewise};
use super::lanes::{Contribution, LANES, Segments, max};
use super::model::Output;
use super::pieces::Pieces;

/// The exact optical depth of four bands.
#[derive(Clone, Copy, Debug)]
pub struct BandDepths<'a> {
    /// The bands of the pass.
    pub pieces: &'a Pieces<BandPiece>,
    /// What pixels hold.
    pub output: Output,
}

impl Optics for BandDepths<'_> {
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

    fn pixel(&self, depths: [f32; 4]) -> [f32; 4] {
        self.output.of_depths(depths)
    }
}

impl Piecewise for BandDepths<'_> {
    type Piece = BandPiece;

    #[inline(always)]
    fn of_piece(piece: &BandPiece, _: f32, segments: &[Segments], out: &mut [Contribution]) {
        let piece = &{ *piece };
        for (segments, out) in segments.iter().zip(out) {
            for c in 0..4 {
                for i in 0..LANES {
                    let ends = piece.extinction_of(c, segments.enter[i]) + piece.extinction_of(c, segments.leave[i]);
                    // A function that falls to 0 may end some ulp below it.
                    out[c][i] = segments.length_world[i] * max(0.5 * ends, 0.0);
                }
            }
        }
    }
}
