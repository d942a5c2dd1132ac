//! What an optical model is to a compositor: segments become contributions, contributions combine along a ray.
//!
//! `over` is associative and [`Optics::CLEAR`] is its identity, so a ray may be composited from the front, from the back, or
//! in parts. An order-free model's `over` commutes.

use super::intervals::Intervals;
use super::lanes::{Contribution, LANES, Lanes, Mask, Segments, is_any, mask, max, min, select, two_sum};
use super::pieces::{LinearPiece, Piece, Pieces};

/// One optical model, for one transfer function.
pub trait Optics: Sync {
    /// Whether the order of a ray's segments matters.
    const IS_ORDERED: bool;

    /// Whether contributions only add up: a compositor then keeps what f32 would lose of the sum.
    const IS_SUM: bool = false;

    /// Whether a contribution is the larger of two first numbers, and no more than the larger value at a segment's ends: a compositor
    /// may then leave out what cannot be larger.
    const IS_MAXIMUM: bool = false;

    /// How many of a contribution's four numbers count: the first ones; what a compositor makes of the others is of no use.
    const CHANNELS: usize = 4;

    /// The contribution of nothing.
    const CLEAR: [f32; 4];

    /// What each segment of a cell contributes, `segments[i]` to `out[i]`. A segment of length 0 contributes [`Self::CLEAR`].
    fn contributions(&self, span: CellSpan, segments: &[Segments], out: &mut [Contribution]);

    /// The contribution of two parts of a ray.
    fn over(front: [f32; 4], back: [f32; 4]) -> [f32; 4];

    /// What `front over behind` becomes with a `fragment` between the two; none where it cannot be told what `behind` dimmed.
    fn slipped_in(whole: [f32; 4], behind: [f32; 4], fragment: [f32; 4]) -> Option<[f32; 4]>;

    /// How much of what lies behind a contribution still shows; 1 for an order-free model.
    fn transmittance(contribution: [f32; 4]) -> f32;

    /// The pixel of a ray's whole contribution.
    fn pixel(&self, contribution: [f32; 4]) -> [f32; 4];
}

/// The stored values of a cell, and the pieces of a transfer function that they touch, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellSpan {
    /// Piece of the smallest value.
    pub first: usize,
    /// Piece of the largest value.
    pub last: usize,
    /// Which cell of the dataset it is, where the compositor keeps that: tiles do, fans do not.
    pub cell: Option<usize>,
    s_min: f32,
    s_max: f32,
    pub(super) length_world_max: f32,
}

impl CellSpan {
    /// For values from `s_min` to `s_max`, of whatever cell, with segments of any length.
    #[inline]
    pub fn new(intervals: &Intervals, s_min: f32, s_max: f32) -> Self {
        let (first, last) = (intervals.piece_of(s_min), intervals.piece_of(s_max));
        Self { first, last, cell: None, s_min, s_max, length_world_max: f32::INFINITY }
    }

    /// The same where no segment is longer than `length_world_max`.
    #[inline]
    #[must_use]
    pub fn within(self, length_world_max: f32) -> Self {
        Self { length_world_max, ..self }
    }

    /// The same of a cell of the dataset.
    #[inline]
    #[must_use]
    pub fn of_cell(self, cell: usize) -> Self {
        Self { cell: Some(cell), ..self }
    }
}

/// [`Optics::slipped_in`] for light that is dimmed: the light and the transmittance of the whole, of what lies behind, of the fragment.
///
/// The front's transmittance is that of the whole over that of what lies behind, and each light behind it is dimmed by it.
#[inline]
pub(super) fn light_slipped_in(whole: [f32; 2], behind: [f32; 2], fragment: [f32; 2]) -> Option<[f32; 2]> {
    /// Below it a transmittance has lost digits.
    const DARK: f32 = 1e-30;
    let front = whole[1] / behind[1];
    let light = whole[0] + front * (fragment[0] - (1.0 - fragment[1]) * behind[0]);
    (behind[1] > DARK && whole[1] > DARK).then_some([light, whole[1] * fragment[1]])
}

/// A model whose integral is known where extinction and colour are linear; without extinction nothing shows.
pub(super) trait Piecewise: Optics {
    /// What is linear.
    type Piece: LinearPiece;

    /// What each segment, within one piece, contributes; no segment's mean optical depth is above `depth_max`.
    fn of_piece(piece: &Self::Piece, depth_max: f32, segments: &[Segments], out: &mut [Contribution]);
}

/// Cuts segments where they pass from piece to piece and composites the parts.
#[inline(always)]
pub(super) fn piecewise<O: Piecewise>(
    pieces: &Pieces<O::Piece>,
    span: CellSpan,
    segments: &[Segments],
    out: &mut [Contribution],
) {
    // Extinction is linear on a piece: largest where the cell's values, or the piece, end.
    let depth_max = |k: usize| {
        let piece = pieces.piece(k);
        let (low, high) = (max(span.s_min, pieces.start_of(k)), min(span.s_max, pieces.end_of(k)));
        span.length_world_max * max(piece.extinction_at(low), piece.extinction_at(high))
    };
    if span.first == span.last {
        O::of_piece(pieces.piece(span.first), depth_max(span.first), segments, out);
        return;
    }
    if O::IS_SUM && span.last - span.first < FEW {
        add_few::<O>(pieces, span, depth_max, segments, out);
        return;
    }
    for (&segments, out) in segments.iter().zip(out) {
        let mut sum = O::CLEAR.map(|clear| [clear; LANES]);
        let mut lost = [[0.0; LANES]; 4];
        let ramp = Ramp::new(&segments);
        for k in span.first..=span.last {
            if pieces.piece(k).is_transparent() {
                continue;
            }
            let (part, is_met) = ramp.cut(pieces.start_of(k), pieces.end_of(k));
            if !is_any(&is_met) {
                continue;
            }
            let mut added = [[[0.0; LANES]; 4]];
            O::of_piece(pieces.piece(k), depth_max(k), &[part], &mut added);
            let [added] = added;
            if O::IS_SUM {
                for c in 0..4 {
                    for i in 0..LANES {
                        let (rounded, error) = two_sum(sum[c][i], added[c][i]);
                        sum[c][i] = rounded;
                        lost[c][i] += error;
                    }
                }
                continue;
            }
            for i in 0..LANES {
                let so_far = [sum[0][i], sum[1][i], sum[2][i], sum[3][i]];
                let added = [added[0][i], added[1][i], added[2][i], added[3][i]];
                // Pieces are visited by rising value: along a falling ray each one lies in front of those before it.
                let (behind, ahead) = (O::over(so_far, added), O::over(added, so_far));
                for c in 0..4 {
                    sum[c][i] = select(ramp.is_rising[i], behind[c], ahead[c]);
                }
            }
        }
        for c in 0..4 {
            for i in 0..LANES {
                out[c][i] = if O::IS_SUM { sum[c][i] + lost[c][i] } else { sum[c][i] };
            }
        }
    }
}

/// So many pieces are added up as they are: that rounds three times, 2·10^-7 of the sum at most.
const FEW: usize = 4;

/// Cuts segments at few pieces and adds the parts.
#[inline(always)]
fn add_few<O: Piecewise>(
    pieces: &Pieces<O::Piece>,
    span: CellSpan,
    depth_max: impl Fn(usize) -> f32,
    segments: &[Segments],
    out: &mut [Contribution],
) {
    for (segments, out) in segments.iter().zip(out) {
        *out = [[0.0; LANES]; 4];
        let ramp = Ramp::new(segments);
        for k in (span.first..=span.last).filter(|&k| !pieces.piece(k).is_transparent()) {
            let (part, _) = ramp.cut(pieces.start_of(k), pieces.end_of(k));
            let mut added = [[[0.0; LANES]; 4]];
            O::of_piece(pieces.piece(k), depth_max(k), &[part], &mut added);
            let [added] = added;
            for c in 0..O::CHANNELS {
                for i in 0..LANES {
                    out[c][i] += added[c][i];
                }
            }
        }
    }
}

/// Segments, ready to be cut at values: their length is spread evenly between their end values.
struct Ramp<'a> {
    segments: &'a Segments,
    is_rising: Mask,
    is_flat: Mask,
    /// World length per unit of value; 0 where the value does not change.
    length_per_value: Lanes,
}

impl<'a> Ramp<'a> {
    #[inline(always)]
    fn new(segments: &'a Segments) -> Self {
        let mut ramp = Self { segments, is_rising: [0; LANES], is_flat: [0; LANES], length_per_value: [0.0; LANES] };
        for i in 0..LANES {
            let (enter, leave, length) = (segments.enter[i], segments.leave[i], segments.length_world[i]);
            let height = (leave - enter).abs();
            // A height so small that the quotient overflows is as good as none.
            let slope = length / height;
            let is_steep = mask(slope < f32::MAX);
            ramp.is_rising[i] = mask(leave >= enter);
            ramp.is_flat[i] = !is_steep;
            ramp.length_per_value[i] = select(is_steep, slope, 0.0);
        }
        ramp
    }

    /// The parts whose values lie in `[start, end)`, and the lanes that have one; a segment of one value belongs to the piece
    /// that holds it.
    #[inline(always)]
    fn cut(&self, start: f32, end: f32) -> (Segments, Mask) {
        let mut part = *self.segments;
        let mut is_met = [0; LANES];
        for i in 0..LANES {
            let (enter, leave) = (self.segments.enter[i], self.segments.leave[i]);
            let (a, b) = (min(max(enter, start), end), min(max(leave, start), end));
            let holds = self.is_flat[i] & mask(enter >= start) & mask(enter < end);
            let length = (b - a).abs() * self.length_per_value[i] + select(holds, self.segments.length_world[i], 0.0);
            part.enter[i] = a;
            part.leave[i] = b;
            part.length_world[i] = length;
            is_met[i] = mask(length > 0.0);
        }
        (part, is_met)
    }
}

/// Extinction and colour of a piece at value `s`.
#[inline(always)]
pub(super) fn at(piece: &Piece, s: f32) -> (f32, [f32; 3]) {
    let t = s - piece.start;
    let (c, d) = (&piece.color, &piece.color_slope);
    (extinction(piece, t), [c[0] + t * d[0], c[1] + t * d[1], c[2] + t * d[2]])
}

/// Extinction of a piece at value t above its start.
#[inline(always)]
pub(super) fn extinction(piece: &Piece, t: f32) -> f32 {
    max(piece.extinction + t * piece.extinction_slope, 0.0)
}
