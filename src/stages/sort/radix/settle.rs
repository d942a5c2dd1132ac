//! `Settler`: sorts one bucket, in cache.
//!
//! In: runs of pairs, one after the other, whose keys differ in their low bits. Out: the same pairs by key, equal keys as they
//! came. Digits from the least, twelve bits at most: after the high bits are gone, one or two do. O(n) moves, each in cache.

use rayon::prelude::*;

use super::{Pair, SMALL, key_of, sort_slices};

/// The largest digit: its counts fit into the first cache beside what is moved.
const DIGIT_BITS: u32 = 12;
/// A bucket of more pairs than this, 2 MiB, is spread again, where that narrows its keys: it has left the cache of a thread. Chosen, not measured.
const LARGE: usize = 1 << 18;

/// Memory for settling; one for each thread.
#[derive(Default)]
pub(super) struct Settler {
    counts: Vec<u32>,
    scratch: Vec<Pair>,
}

impl Settler {
    /// Sorts the pairs of `runs` into `out`, which is as long as all of them; keys are `low` and above and differ from it in the
    /// `bits` lowest bits of the difference.
    pub(super) fn settle<R: AsRef<[Pair]>>(&mut self, runs: &[R], out: &mut [Pair], (low, bits): (u32, u32)) {
        let n = out.len();
        debug_assert_eq!(n, runs.iter().map(|run| run.as_ref().len()).sum::<usize>());
        if bits == 0 || !(SMALL..=LARGE).contains(&n) {
            let mut at = 0;
            for run in runs.iter().map(AsRef::as_ref) {
                out[at..at + run.len()].copy_from_slice(run);
                at += run.len();
            }
            match (bits, n) {
                (0, _) => {}
                (_, ..SMALL) => out.sort_by_key(|&pair| key_of(pair)),
                (u32::BITS, _) => out.par_sort_unstable(),
                _ => sort_slices(out, &mut vec![0; n]),
            }
            return;
        }
        // No more counts than pairs, but for few pairs, and digits of one size.
        let passes = bits.div_ceil(n.ilog2().min(DIGIT_BITS));
        let digit_bits = bits.div_ceil(passes);
        let digits = 1 << digit_bits;
        let digit = |pair: Pair, pass: u32| (key_of(pair) - low) >> (pass * digit_bits);
        self.counts.clear();
        self.counts.resize(digits * passes as usize, 0);
        for run in runs.iter().map(AsRef::as_ref) {
            for (pass, counts) in (0..).zip(self.counts.chunks_exact_mut(digits)) {
                for &pair in run {
                    counts[digit(pair, pass) as usize & (digits - 1)] += 1;
                }
            }
        }
        self.scratch.resize(self.scratch.len().max(n), 0);
        let (mut from, mut to) = (out, &mut self.scratch[..n]);
        if passes % 2 == 1 {
            std::mem::swap(&mut from, &mut to);
        }
        for (pass, places) in (0..).zip(self.counts.chunks_exact_mut(digits)) {
            let mut start = 0;
            for place in places.iter_mut() {
                start += std::mem::replace(place, start);
            }
            let mut put = |pair: Pair| {
                let place = &mut places[digit(pair, pass) as usize & (digits - 1)];
                to[*place as usize] = pair;
                *place += 1;
            };
            if pass == 0 {
                for run in runs.iter().map(AsRef::as_ref) {
                    for &pair in run {
                        put(pair);
                    }
                }
            } else {
                for &pair in &*from {
                    put(pair);
                }
            }
            std::mem::swap(&mut from, &mut to);
        }
    }
}

/// Orders runs of equal keys by index.
pub(super) fn order_ties(pairs: &mut [Pair]) {
    for run in pairs.chunk_by_mut(|a, b| key_of(*a) == key_of(*b)) {
        if run.len() > 1 {
            run.sort_unstable();
        }
    }
}
