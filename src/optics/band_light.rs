//! Emission and absorption with an extinction of its own in each band, two bands a pass: `∫ c_k κ_k e^(−∫κ_k) dt`.
//!
//! Contribution: light of both bands, transmittance of both; `over` is Porter and Duff's, channel by channel. A ray goes on as
//! long as any band shines through.

use super::attenuation::THIN_LIMIT;
use super::band_pieces::{BandPiece, GLOWING_BANDS_PER_PASS};
use super::compositing::{CellSpan, Optics, Piecewise, light_slipped_in, piecewise};
use super::integral::{
    SegmentWeights, VERY_THIN_LIMIT, segment_weights, segment_weights_thin, segment_weights_very_thin,
};
use super::lanes::{Contribution, LANES, Segments, max};
use super::pieces::Pieces;

/// The exact integral of two bands. Pixels hold the light of both, then the opacity of both.
#[derive(Clone, Copy, Debug)]
pub struct BandLight<'a> {
    /// The bands of the pass.
    pub pieces: &'a Pieces<BandPiece>,
}

impl Optics for BandLight<'_> {
    const IS_ORDERED: bool = true;
    const CLEAR: [f32; 4] = [0.0, 0.0, 1.0, 1.0];

    #[inline(always)]
    fn contributions(&self, span: CellSpan, segments: &[Segments], out: &mut [Contribution]) {
        piecewise::<Self>(self.pieces, span, segments, out);
    }

    #[inline(always)]
    fn over([a, b, t, u]: [f32; 4], [a_back, b_back, t_back, u_back]: [f32; 4]) -> [f32; 4] {
        [a + t * a_back, b + u * b_back, t * t_back, u * u_back]
    }

    fn slipped_in(whole: [f32; 4], behind: [f32; 4], fragment: [f32; 4]) -> Option<[f32; 4]> {
        let of = |c: usize| {
            light_slipped_in([whole[c], whole[c + 2]], [behind[c], behind[c + 2]], [fragment[c], fragment[c + 2]])
        };
        let ([a, t], [b, u]) = (of(0)?, of(1)?);
        Some([a, b, t, u])
    }

    #[inline(always)]
    fn transmittance([_, _, t, u]: [f32; 4]) -> f32 {
        max(t, u)
    }

    fn pixel(&self, [a, b, t, u]: [f32; 4]) -> [f32; 4] {
        [a, b, 1.0 - t, 1.0 - u]
    }
}

impl Piecewise for BandLight<'_> {
    type Piece = BandPiece;

    #[inline(always)]
    fn of_piece(piece: &BandPiece, depth_max: f32, segments: &[Segments], out: &mut [Contribution]) {
        if depth_max <= VERY_THIN_LIMIT {
            weigh(piece, segments, segment_weights_very_thin, out);
        } else if depth_max <= THIN_LIMIT {
            weigh(piece, segments, segment_weights_thin, out);
        } else {
            weigh(piece, segments, segment_weights, out);
        }
    }
}

/// Light and transmittance of each segment by one form of the integral.
#[inline(always)]
fn weigh(
    piece: &BandPiece,
    segments: &[Segments],
    weights: impl Fn(f32, f32) -> SegmentWeights,
    out: &mut [Contribution],
) {
    let piece = &{ *piece };
    for (segments, out) in segments.iter().zip(out) {
        for c in 0..GLOWING_BANDS_PER_PASS {
            for i in 0..LANES {
                let (enter, leave, length) = (segments.enter[i], segments.leave[i], segments.length_world[i]);
                let x = max(piece.extinction_of(c, enter), 0.0) * length;
                let y = max(piece.extinction_of(c, leave), 0.0) * length;
                let w = weights(x, y);
                out[c][i] = w.w0 * piece.color_of(c, enter) + w.w1 * piece.color_of(c, leave);
                out[GLOWING_BANDS_PER_PASS + c][i] = w.transmittance;
            }
        }
    }
}
