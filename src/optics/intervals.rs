//! In: knots. Out: the intervals between them, and which one holds a value, in O(1).

/// Intervals of s between ascending knots: interval k covers `knots[k - 1] <= s < knots[k]`, the first and the last have no outer
/// end.
#[derive(Clone, Debug)]
pub struct Intervals {
    knots: Vec<f32>,
    /// `bucket(s) = (s - knots[0]) · bucket_per_s`, truncated and clamped, grows with s in floating point too.
    bucket_per_s: f32,
    /// Per bucket, how many knots lie in buckets before it; one more entry at the end.
    knots_before_bucket: Vec<u32>,
}

/// So many knots are compared faster than looked up.
const FEW: usize = 4;

impl Intervals {
    pub(super) fn new(knots: Vec<f32>) -> Self {
        debug_assert!(knots.is_sorted_by(|a, b| a < b));
        // Four buckets a knot: a search of one or two steps where knots are spread evenly.
        let buckets = 4 * knots.len().max(1);
        let width = knots.last().zip(knots.first()).map_or(0.0, |(last, first)| last - first);
        let bucket_per_s = if width > 0.0 { buckets as f32 / width } else { 0.0 };
        let mut intervals = Self { knots, bucket_per_s, knots_before_bucket: vec![0; buckets + 1] };
        for i in 0..intervals.knots.len() {
            let bucket = intervals.bucket(intervals.knots[i]);
            intervals.knots_before_bucket[bucket + 1] += 1;
        }
        for bucket in 0..buckets {
            intervals.knots_before_bucket[bucket + 1] += intervals.knots_before_bucket[bucket];
        }
        intervals
    }

    /// The values of s between intervals, strictly ascending.
    pub fn knots(&self) -> &[f32] {
        &self.knots
    }

    /// How many intervals there are, at least one.
    #[expect(clippy::len_without_is_empty, reason = "there is always one")]
    pub fn len(&self) -> usize {
        self.knots.len() + 1
    }

    /// The smallest s of interval k: the knot below it, or minus infinity.
    #[inline]
    pub fn start_of(&self, k: usize) -> f32 {
        if k == 0 { f32::NEG_INFINITY } else { self.knots[k - 1] }
    }

    /// The end of interval k, not in it: the knot above it, or infinity.
    #[inline]
    pub fn end_of(&self, k: usize) -> f32 {
        self.knots.get(k).copied().unwrap_or(f32::INFINITY)
    }

    /// The interval that holds s: the number of knots <= s; 0 for NaN. O(1) where knots are spread evenly, O(log n) at worst.
    #[inline]
    pub fn piece_of(&self, s: f32) -> usize {
        if self.knots.len() <= FEW {
            return self.knots.iter().map(|&knot| usize::from(knot <= s)).sum();
        }
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
