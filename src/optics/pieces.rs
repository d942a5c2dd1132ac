//! In: a transfer function and the offset of a stored field. Out: its linear pieces in f32, and the piece of a value in O(1).
//!
//! A field is stored as `value = offset + s` with s in f32. Piece k covers `knots[k - 1] <= s < knots[k]`; the first and the last
//! have no outer end and are constant. Each piece starts at an f32 knot, so that `s - start` is exact near it and no digit of s
//! is lost to a large offset.

use super::transfer::{ControlPoint, TransferFunction};

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
    /// Extinction at s, per world unit length.
    #[inline(always)]
    pub fn extinction_at(&self, s: f32) -> f32 {
        self.extinction + (s - self.start) * self.extinction_slope
    }

    /// Linear RGB at s.
    #[inline(always)]
    pub fn color_at(&self, s: f32) -> [f32; 3] {
        std::array::from_fn(|k| self.color[k] + (s - self.start) * self.color_slope[k])
    }

    /// Whether extinction is 0 on the whole piece.
    pub fn is_transparent(&self) -> bool {
        self.extinction == 0.0 && self.extinction_slope == 0.0
    }

    /// From one control point at `start` to another at `end`.
    fn between(start: f32, end: f32, from: &ControlPoint, to: &ControlPoint) -> Self {
        let slope = |from: f64, to: f64| {
            // Between the narrowed values, over the narrowed width: the far end then comes out right. Knots that are almost
            // one would give an infinite slope, and NaN at the start.
            let rise = f64::from(to as f32) - f64::from(from as f32);
            let slope = (rise / (f64::from(end) - f64::from(start))) as f32;
            slope.clamp(f32::MIN, f32::MAX)
        };
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

/// A transfer function as n linear pieces over s, separated by n - 1 knots.
///
/// ```
/// # use cellfan::optics::transfer::{ControlPoint, TransferFunction};
/// let point = |value, extinction| ControlPoint { value, color: [1.0; 3], extinction };
/// let ramp = TransferFunction::new(vec![point(100.0, 0.0), point(102.0, 8.0)])?;
/// let pieces = ramp.pieces(100.0); // stored as value - 100
/// assert_eq!(pieces.knots(), [0.0, 2.0]);
/// assert_eq!(pieces.piece_of(0.5), 1);
/// assert_eq!(pieces.piece(1).extinction_at(0.5), 2.0);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Pieces {
    all: Vec<Piece>,
    knots: Vec<f32>,
    /// `bucket(s) = (s - knots[0]) · bucket_per_s`, truncated and clamped, grows with s in floating point too.
    bucket_per_s: f32,
    /// Per bucket, how many knots lie in buckets before it; one more entry at the end.
    knots_before_bucket: Vec<u32>,
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

impl Pieces {
    fn new(all: Vec<Piece>, knots: Vec<f32>) -> Self {
        debug_assert!(all.len() == knots.len() + 1 && knots.is_sorted_by(|a, b| a < b));
        // Four buckets a knot: a search of one or two steps where knots are spread evenly.
        let buckets = 4 * knots.len().max(1);
        let width = knots.last().zip(knots.first()).map_or(0.0, |(last, first)| last - first);
        let bucket_per_s = if width > 0.0 { buckets as f32 / width } else { 0.0 };
        let mut pieces = Self { all, knots, bucket_per_s, knots_before_bucket: vec![0; buckets + 1] };
        for i in 0..pieces.knots.len() {
            let bucket = pieces.bucket(pieces.knots[i]);
            pieces.knots_before_bucket[bucket + 1] += 1;
        }
        for bucket in 0..buckets {
            pieces.knots_before_bucket[bucket + 1] += pieces.knots_before_bucket[bucket];
        }
        pieces
    }

    /// The values of s between pieces, strictly ascending.
    pub fn knots(&self) -> &[f32] {
        &self.knots
    }

    /// How many pieces there are, at least one.
    #[expect(clippy::len_without_is_empty, reason = "there is always a piece")]
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// All pieces, by ascending s.
    pub fn as_slice(&self) -> &[Piece] {
        &self.all
    }

    /// Piece k.
    ///
    /// # Panics
    ///
    /// If k is not below [`Pieces::len`].
    pub fn piece(&self, k: usize) -> &Piece {
        &self.all[k]
    }

    /// The smallest s of piece k: the knot below it, or minus infinity.
    #[inline]
    pub fn start_of(&self, k: usize) -> f32 {
        if k == 0 { f32::NEG_INFINITY } else { self.knots[k - 1] }
    }

    /// The end of piece k, not in it: the knot above it, or infinity.
    #[inline]
    pub fn end_of(&self, k: usize) -> f32 {
        self.knots.get(k).copied().unwrap_or(f32::INFINITY)
    }

    /// The piece that holds s: the number of knots <= s; 0 for NaN. O(1) where knots are spread evenly, O(log n) at worst.
    #[inline]
    pub fn piece_of(&self, s: f32) -> usize {
        let bucket = self.bucket(s);
        // Earlier buckets hold only knots below s, later ones only knots above.
        let first = self.knots_before_bucket[bucket] as usize;
        let end = self.knots_before_bucket[bucket + 1] as usize;
        first + self.knots[first..end].partition_point(|&knot| knot <= s)
    }

    #[inline]
    fn bucket(&self, s: f32) -> usize {
        let first = self.knots.first().copied().unwrap_or(0.0);
        // The cast truncates, takes negative and NaN to 0 and what is too large to the maximum.
        (((s - first) * self.bucket_per_s) as usize).min(self.knots_before_bucket.len() - 2)
    }
}

#[cfg(test)]
pub(super) mod tests;
