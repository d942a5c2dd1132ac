//! In: a transfer function and the offset of a stored field. Out: its linear pieces in f32, and the piece of a value in O(1).
//!
//! A field is stored as `value = offset + s` with s in f32. Piece k covers `knots[k - 1] <= s < knots[k]`; the first and the last
//! have no outer end and are constant. Each piece starts at an f32 knot, so that `s - start` is exact near it and no digit of s
//! is lost to a large offset.

use std::ops::Deref;

use super::intervals::Intervals;
use super::transfer::{ControlPoint, TransferFunction};

/// What is linear between two knots.
pub trait LinearPiece: Copy {
    /// Whether extinction is 0 on the whole piece.
    fn is_transparent(&self) -> bool;

    /// Extinction at s, per world unit length; the largest where there are several.
    fn extinction_at(&self, s: f32) -> f32;
}

/// Extinction and colour, linear in s: `extinction + (s - start) · extinction_slope`, and so for each colour channel.
///
/// At either end it gives the control point within a few ulp of the larger of both ends, so a value that falls to 0 may end
/// some ulp below 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Where the piece begins (the first: where it ends).
    pub start: f32,
    /// At `start`, per world unit length.
    pub extinction: f32,
    /// Per unit of s.
    pub extinction_slope: f32,
    /// At `start`, linear RGB.
    pub color: [f32; 3],
    /// Per unit of s.
    pub color_slope: [f32; 3],
}

impl Piece {
    /// Linear RGB at s.
    #[inline(always)]
    pub fn color_at(&self, s: f32) -> [f32; 3] {
        std::array::from_fn(|k| self.color[k] + (s - self.start) * self.color_slope[k])
    }

    /// From one control point at `start` to another at `end`.
    fn between(start: f32, end: f32, from: &ControlPoint, to: &ControlPoint) -> Self {
        let slope = |from, to| slope([start, end], [from, to]);
        Self {
            start,
            extinction: from.extinction as f32,
            extinction_slope: slope(from.extinction, to.extinction),
            color: from.color.map(|channel| channel as f32),
            color_slope: std::array::from_fn(|k| slope(from.color[k], to.color[k])),
        }
    }

    fn constant(start: f32, point: &ControlPoint) -> Self {
        Self::between(start, f32::INFINITY, point, point)
    }

    /// Whether both pieces are constant and the same.
    fn continues(&self, next: &Self) -> bool {
        let flat = |piece: &Self| piece.extinction_slope == 0.0 && piece.color_slope.iter().all(|&slope| slope == 0.0);
        flat(self) && flat(next) && *self == Self { start: self.start, ..*next }
    }
}

/// The slope from one control point to the next, in s and in f32.
pub(super) fn slope([start, end]: [f32; 2], [from, to]: [f64; 2]) -> f32 {
    // Between the narrowed values, over the narrowed width: the far end then comes out right. Knots that are almost one would
    // give an infinite slope, and NaN at the start.
    let rise = f64::from(to as f32) - f64::from(from as f32);
    let slope = (rise / (f64::from(end) - f64::from(start))) as f32;
    slope.clamp(f32::MIN, f32::MAX)
}

impl LinearPiece for Piece {
    fn is_transparent(&self) -> bool {
        self.extinction == 0.0 && self.extinction_slope == 0.0
    }

    #[inline(always)]
    fn extinction_at(&self, s: f32) -> f32 {
        self.extinction + (s - self.start) * self.extinction_slope
    }
}

/// Linear pieces over s, one on each of its [`Intervals`], which it dereferences to.
///
/// ```
/// # use cellfan::optics::{LinearPiece, transfer::{ControlPoint, TransferFunction}};
/// let point = |value, extinction| ControlPoint { value, color: [1.0; 3], extinction };
/// let ramp = TransferFunction::new(vec![point(100.0, 0.0), point(102.0, 8.0)])?;
/// let pieces = ramp.pieces(100.0); // stored as value - 100
/// assert_eq!(pieces.knots(), [0.0, 2.0]);
/// assert_eq!(pieces.piece_of(0.5), 1);
/// assert_eq!(pieces.piece(1).extinction_at(0.5), 2.0);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Pieces<P = Piece> {
    all: Vec<P>,
    intervals: Intervals,
}

impl TransferFunction {
    /// The function over s = value - offset, in f32; steps become two pieces, points that are one f32 become a step.
    pub fn pieces(&self, offset: f64) -> Pieces {
        let narrow = |point: &ControlPoint| ((point.value - offset) as f32).clamp(f32::MIN, f32::MAX);
        let points = self.points();
        let mut pieces: Vec<Piece> = vec![Piece::constant(narrow(&points[0]), &points[0])];
        let mut knots: Vec<f32> = Vec::new();
        let mut push = |knot: f32, piece: Piece| {
            if !pieces[pieces.len() - 1].continues(&piece) {
                knots.push(knot);
                pieces.push(piece);
            }
        };
        for pair in points.windows(2) {
            let (start, end) = (narrow(&pair[0]), narrow(&pair[1]));
            if start < end {
                push(start, Piece::between(start, end, &pair[0], &pair[1]));
            }
        }
        let last = &points[points.len() - 1];
        push(narrow(last), Piece::constant(narrow(last), last));
        Pieces::new(pieces, knots)
    }
}

impl<P> Pieces<P> {
    pub(super) fn new(all: Vec<P>, knots: Vec<f32>) -> Self {
        debug_assert!(all.len() == knots.len() + 1);
        Self { all, intervals: Intervals::new(knots) }
    }

    /// All pieces, by ascending s.
    pub fn as_slice(&self) -> &[P] {
        &self.all
    }

    /// Piece k.
    ///
    /// # Panics
    ///
    /// If k is not below [`Intervals::len`].
    pub fn piece(&self, k: usize) -> &P {
        &self.all[k]
    }
}

impl<P> Deref for Pieces<P> {
    type Target = Intervals;

    fn deref(&self) -> &Intervals {
        &self.intervals
    }
}

#[cfg(test)]
pub(super) mod tests;
