//! The papers' averages, kept to reproduce their pictures: colour and extinction are read at a segment's ends, wherever
//! control points lie between, and averaged.
//!
//! [`Averaged`]: CellFast and Shirley and Tuchman, opacity 1 − e^(−mean κ·ℓ). [`Textured`]: Schussman and Max, the same opacity
//! from a texture.

use super::compositing::{CellSpan, Optics, at};
use super::integral::{SegmentWeights, segment_weights_average};
use super::lanes::{Contribution, LANES, Segments};
use super::pieces::{LinearPiece, Pieces};
use super::texture::{OpacityTexture, TexelFormat};
use super::{emission_absorption::EmissionAbsorption, lanes::max};
use crate::error::Result;

/// Emission and absorption by the average of both ends.
#[derive(Clone, Copy, Debug)]
pub struct Averaged<'a> {
    /// The transfer function.
    pub pieces: &'a Pieces,
}

/// Emission and absorption by the average of both ends, opacity from a texture.
#[derive(Clone, Debug)]
pub struct Textured<'a> {
    pieces: &'a Pieces,
    texture: OpacityTexture,
}

/// Side of the opacity texture; the papers name none.
const TEXELS: usize = 512;

impl<'a> Textured<'a> {
    /// A texture for segments up to `length_max_world`.
    ///
    /// # Errors
    /// [`Error::Option`](crate::Error::Option) where the length is not positive and finite.
    pub fn new(pieces: &'a Pieces, length_max_world: f64) -> Result<Self> {
        let ends = pieces.knots().iter().enumerate();
        let extinctions =
            ends.map(|(k, &knot)| max(pieces.piece(k).extinction_at(knot), pieces.piece(k + 1).extinction_at(knot)));
        let extinction_max = extinctions.fold(pieces.piece(0).extinction, max);
        let texture = OpacityTexture::new(
            TEXELS,
            length_max_world as f32,
            max(extinction_max, f32::MIN_POSITIVE),
            TexelFormat::Float,
        )?;
        Ok(Self { pieces, texture })
    }

    /// The table of opacities.
    pub fn texture(&self) -> &OpacityTexture {
        &self.texture
    }
}

/// Reads both ends of each segment and weighs their colours.
#[inline(always)]
fn of_ends(
    pieces: &Pieces,
    segments: &[Segments],
    weights: impl Fn(f32, f32, f32) -> SegmentWeights,
    out: &mut [Contribution],
) {
    let end = |s: f32| at(pieces.piece(pieces.piece_of(s)), s);
    for (segments, out) in segments.iter().zip(out) {
        for i in 0..LANES {
            let ((k0, c0), (k1, c1)) = (end(segments.enter[i]), end(segments.leave[i]));
            let w = weights(segments.length_world[i], k0, k1);
            for c in 0..3 {
                out[c][i] = w.w0 * c0[c] + w.w1 * c1[c];
            }
            out[3][i] = w.transmittance;
        }
    }
}

macro_rules! composite_like_emission_absorption {
    () => {
        const IS_ORDERED: bool = true;
        const CLEAR: [f32; 4] = EmissionAbsorption::CLEAR;

        #[inline(always)]
        fn over(front: [f32; 4], back: [f32; 4]) -> [f32; 4] {
            EmissionAbsorption::over(front, back)
        }

        fn slipped_in(whole: [f32; 4], behind: [f32; 4], fragment: [f32; 4]) -> Option<[f32; 4]> {
            EmissionAbsorption::slipped_in(whole, behind, fragment)
        }

        #[inline(always)]
        fn transmittance(contribution: [f32; 4]) -> f32 {
            EmissionAbsorption::transmittance(contribution)
        }

        fn pixel(&self, contribution: [f32; 4]) -> [f32; 4] {
            EmissionAbsorption { pieces: self.pieces }.pixel(contribution)
        }
    };
}

impl Optics for Averaged<'_> {
    composite_like_emission_absorption!();

    #[inline(always)]
    fn contributions(&self, _: CellSpan, segments: &[Segments], out: &mut [Contribution]) {
        of_ends(self.pieces, segments, |length, k0, k1| segment_weights_average(k0 * length, k1 * length), out);
    }
}

impl Optics for Textured<'_> {
    composite_like_emission_absorption!();

    #[inline(always)]
    fn contributions(&self, _: CellSpan, segments: &[Segments], out: &mut [Contribution]) {
        of_ends(self.pieces, segments, |length, k0, k1| self.texture.segment_weights(length, k0, k1), out);
    }
}
