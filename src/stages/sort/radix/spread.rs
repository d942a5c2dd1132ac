//! `Spread`: which bucket a key falls into.
//!
//! In: some of the keys. Out: a bucket for each key, ascending with the key. The buckets are of one width and reach a little beyond all
//! but the outermost of the sample: a few cells have keys far from all others (the spheres of slivers), and would leave the others one
//! bucket. What lies beyond goes to the first and to the last.

use super::{Pair, key_of};

/// Buckets that one pass spreads pairs over: their ends, a line of cache each, fit into the first cache (32 KiB or more). With 1,024
/// and 2,048 the pass takes 1.8 and 3.5 times as long on random keys (ten million, Zen 5).
pub(super) const BUCKETS: usize = 512;

/// How many pairs fall into each bucket.
pub(super) type Counts = [u32; BUCKETS];

/// Keys that are looked at to find the range of most.
pub(super) const SAMPLE: usize = 1 << 12;
/// One in so many of them may lie beyond either end, and the range is widened by one part in so many at either end.
const BEYOND: (usize, u32) = (256, 32);

/// The buckets of a range of keys: all of one width, a power of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Spread {
    low: u32,
    shift: u32,
}

impl Spread {
    /// Over most of the keys of a sample; `None` where there is none.
    pub(super) fn over<'a>(sample: impl Iterator<Item = &'a Pair>) -> Option<Self> {
        let mut keys: Vec<u32> = sample.map(|&pair| key_of(pair)).collect();
        keys.sort_unstable();
        let beyond = keys.len() / BEYOND.0;
        let (first, last) = (*keys.get(beyond)?, *keys.get(keys.len() - 1 - beyond)?);
        // At least one key wider, so that no key of the range shares a bucket with what lies beyond.
        let margin = ((last - first) / BEYOND.1).max(1);
        let (low, high) = (first.saturating_sub(margin), last.saturating_add(margin));
        let bits = u32::BITS - (high - low).leading_zeros();
        Some(Self { low, shift: bits.saturating_sub(BUCKETS.ilog2()) })
    }

    /// The bucket of a pair; the first and the last take what lies beyond.
    #[inline]
    pub(super) fn bucket(self, pair: Pair) -> usize {
        ((key_of(pair).saturating_sub(self.low) >> self.shift) as usize).min(BUCKETS - 1)
    }

    /// The lowest key of a bucket, and how many low bits its keys differ in: at both ends, any. Buckets above all keys are empty.
    pub(super) fn keys_of(self, bucket: usize) -> (u32, u32) {
        let is_end = (bucket == 0 && self.low > 0) || bucket == BUCKETS - 1;
        if is_end { (0, u32::BITS) } else { (self.low.wrapping_add((bucket as u32) << self.shift), self.shift) }
    }

    /// How many of the pairs fall into each bucket.
    pub(super) fn count(self, pairs: &[Pair]) -> Counts {
        let mut counts = [0; BUCKETS];
        for &pair in pairs {
            counts[self.bucket(pair)] += 1;
        }
        counts
    }
}

/// Splits a slice into slices of these lengths.
pub(super) fn split_by(mut pairs: &mut [Pair], lens: impl Iterator<Item = usize>) -> Vec<&mut [Pair]> {
    let split = |len| {
        let (first, rest) = std::mem::take(&mut pairs).split_at_mut(len);
        pairs = rest;
        first
    };
    lens.map(split).collect()
}
