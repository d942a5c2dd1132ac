//! Maximum intensity projection: the colour of the largest value on the ray, wherever a cell is met.
//!
//! Contribution: the largest stored value; the transfer function is read once per pixel, last.

use super::compositing::{CellSpan, Optics, at};
use super::lanes::{Contribution, LANES, Segments, mask, max, select};
use super::pieces::Pieces;

/// The largest value on the ray.
#[derive(Clone, Copy, Debug)]
pub struct Mip<'a> {
    /// The transfer function; only its colours are used.
    pub pieces: &'a Pieces,
}

impl Optics for Mip<'_> {
    const IS_ORDERED: bool = false;
    const IS_MAXIMUM: bool = true;
    const CHANNELS: usize = 1;
    const CLEAR: [f32; 4] = [f32::NEG_INFINITY, 0.0, 0.0, 0.0];

    #[inline(always)]
    fn contributions(&self, _: CellSpan, segments: &[Segments], out: &mut [Contribution]) {
        for (segments, out) in segments.iter().zip(out) {
            *out = [[0.0; LANES]; 4];
            for i in 0..LANES {
                // The field is linear on a segment: its largest value is at an end.
                let largest = max(segments.enter[i], segments.leave[i]);
                out[0][i] = select(mask(segments.length_world[i] > 0.0), largest, f32::NEG_INFINITY);
            }
        }
    }

    #[inline(always)]
    fn over(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        [max(a[0], b[0]), 0.0, 0.0, 0.0]
    }

    fn slipped_in(whole: [f32; 4], _: [f32; 4], fragment: [f32; 4]) -> Option<[f32; 4]> {
        Some(Self::over(whole, fragment))
    }

    #[inline(always)]
    fn transmittance(_: [f32; 4]) -> f32 {
        1.0
    }

    fn pixel(&self, [largest, ..]: [f32; 4]) -> [f32; 4] {
        if largest == f32::NEG_INFINITY {
            return [0.0; 4];
        }
        let (_, [r, g, b]) = at(self.pieces.piece(self.pieces.piece_of(largest)), largest);
        [r, g, b, 1.0]
    }
}
