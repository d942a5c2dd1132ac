//! Absorption: what is left of light that shines through, in four bands: `e^(−∫κ_k dt)`, `κ_k = κ·(r, g, b, 1)_k`. Bands with
//! functions of their own: [`BandDepths`](super::BandDepths); with columns of their own: [`BandCells`](super::BandCells).
//!
//! Contribution: the optical depth of each band, summed in any order and exponentiated last.

use super::compositing::{CellSpan, Optics, Piecewise, piecewise};
use super::emission::sums;
use super::lanes::{Contribution, Segments};
use super::model::Output;
use super::pieces::{Piece, Pieces};

/// The exact optical depth: κ and the band weights are linear on a piece.
#[derive(Clone, Copy, Debug)]
pub struct Absorption<'a> {
    /// The transfer function.
    pub pieces: &'a Pieces,
    /// What pixels hold.
    pub output: Output,
}

impl Optics for Absorption<'_> {
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

impl Piecewise for Absorption<'_> {
    type Piece = Piece;

    #[inline(always)]
    fn of_piece(piece: &Piece, _: f32, segments: &[Segments], out: &mut [Contribution]) {
        sums(piece, segments, out);
    }
}
