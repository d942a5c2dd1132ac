//! `radix`: radix sorts of 32-bit keys with 32-bit indices, packed as `key << 32 | index`.
//!
//! In: pairs in any order. Out: the same pairs by key, equal keys by index, whatever the order they came in and however many
//! threads there are: a frame does not depend on the one before. [`sort_local`] moves pairs digit by digit from the least, in a
//! cache; [`sort`] first spreads them over `BUCKETS` by the highest bits that differ, then settles each bucket in the cache of
//! one thread: two moves of each pair through memory, where digit by digit takes three or four. What it waits for is memory.
//!
//! [`frames`] sorts the pairs of frame after frame and gains from the one before.
//!
//! CellFast, section 2, sorts the same pairs by a custom quicksort.

pub mod frames;
mod part;
mod settle;
mod spread;
#[cfg(test)]
mod tests;

use std::sync::atomic::Ordering;

use rayon::prelude::*;

use self::settle::{Settler, order_ties};
use self::spread::{BUCKETS, Counts, SAMPLE, Spread, split_by};
use crate::control::Control;
use crate::stages::scatter::as_atomic;

/// A key and an index in one word: ordering words orders keys, then indices.
pub type Pair = u64;

/// Packs a key and an index.
#[inline]
pub fn pair(key: u32, index: u32) -> Pair {
    u64::from(key) << 32 | u64::from(index)
}

/// The index of a pair.
#[inline]
pub fn index_of(pair: Pair) -> u32 {
    pair as u32
}

/// The key of a pair.
#[inline]
pub fn key_of(pair: Pair) -> u32 {
    (pair >> 32) as u32
}

const DIGITS: usize = 256;
/// Bits of the key, digit by digit, within the packed word.
const SHIFTS: [u32; 4] = [32, 40, 48, 56];
/// Bits of the index.
const INDEX_SHIFTS: [u32; 4] = [0, 8, 16, 24];
/// Pairs that [`sort_local_while`] moves between two looks at the token: some tenths of a millisecond.
const LOOK: usize = 1 << 15;
/// Below this many pairs the library's sort is used: four passes and their counts cost the same for any few. Chosen, not measured.
const SMALL: usize = 384;
/// Pairs a thread takes at least; below two of these [`sort_local`] does it all.
const CHUNK: usize = 1 << 16;

#[inline]
fn digit(pair: Pair, shift: u32) -> usize {
    (pair >> shift) as usize & (DIGITS - 1)
}

/// Sorts `pairs` by key and index on the calling thread. `scratch` is grown as needed.
pub fn sort_local(pairs: &mut Vec<Pair>, scratch: &mut Vec<Pair>) {
    sort_local_while(&Control::default(), pairs, scratch);
}

/// The same until the end is asked for; then pairs stand in any order.
pub(crate) fn sort_local_while(control: &Control, pairs: &mut Vec<Pair>, scratch: &mut Vec<Pair>) {
    if sort_digits(control, pairs, scratch, SHIFTS) {
        order_ties(pairs);
    }
}

/// Sorts pairs of one key by index, until the end is asked for.
pub(crate) fn sort_indices_while(control: &Control, pairs: &mut Vec<Pair>, scratch: &mut Vec<Pair>) {
    sort_digits(control, pairs, scratch, INDEX_SHIFTS);
}

/// Sorts by the digits at `shifts`, the least first, equal ones as they came; whether all of it was done.
fn sort_digits(control: &Control, pairs: &mut Vec<Pair>, scratch: &mut Vec<Pair>, shifts: [u32; 4]) -> bool {
    if pairs.len() < SMALL {
        pairs.sort_unstable();
        return true;
    }
    scratch.resize(pairs.len(), 0);
    let mut counts = [[0_u32; DIGITS]; 4];
    for pairs in pairs.chunks(LOOK) {
        if control.is_cancelled() {
            return false;
        }
        for &pair in pairs {
            for (counts, shift) in counts.iter_mut().zip(shifts) {
                counts[digit(pair, shift)] += 1;
            }
        }
    }
    for (counts, shift) in counts.iter_mut().zip(shifts) {
        if counts.iter().any(|&n| n as usize == pairs.len()) {
            continue;
        }
        let mut start = 0;
        for count in counts.iter_mut() {
            start += std::mem::replace(count, start);
        }
        for pairs in pairs.chunks(LOOK) {
            if control.is_cancelled() {
                return false;
            }
            for &pair in pairs {
                let place = &mut counts[digit(pair, shift)];
                scratch[*place as usize] = pair;
                *place += 1;
            }
        }
        std::mem::swap(pairs, scratch);
    }
    true
}

/// Sorts `pairs` by key and index on all threads of the current pool. `scratch` is grown as needed.
pub fn sort(pairs: &mut Vec<Pair>, scratch: &mut Vec<Pair>) {
    if pairs.len() < 2 * CHUNK {
        sort_local(pairs, scratch);
        return;
    }
    scratch.resize(pairs.len(), 0);
    let len = pairs.len();
    sort_slices(pairs, &mut scratch[..len]);
}

/// The same for slices of one length.
fn sort_slices(pairs: &mut [Pair], scratch: &mut [Pair]) {
    let Some(spread) = Spread::over(pairs.iter().step_by(pairs.len().div_ceil(SAMPLE).max(1))) else { return };
    let chunk_len = pairs.len().div_ceil(rayon::current_num_threads() * 4).max(CHUNK);
    // Count per chunk, scan over (bucket, chunk), write.
    let count = |chunk: &[Pair]| (spread.count(chunk), chunk.is_sorted_by_key(|&pair| index_of(pair)));
    let (mut starts, are_ordered): (Vec<Counts>, Vec<bool>) = pairs.par_chunks(chunk_len).map(count).unzip();
    let is_seam_ordered = |at: usize| index_of(pairs[at - 1]) <= index_of(pairs[at]);
    // Then moves that keep the order of equal keys order them by index.
    let is_in_index_order =
        are_ordered.into_iter().all(|is| is) && (chunk_len..pairs.len()).step_by(chunk_len).all(is_seam_ordered);
    let mut start = 0;
    let lens: Vec<usize> = (0..BUCKETS)
        .map(|bucket| {
            let first = start;
            for counts in &mut starts {
                start += std::mem::replace(&mut counts[bucket], start);
            }
            (start - first) as usize
        })
        .collect();
    debug_assert_eq!(start as usize, pairs.len());
    // The ranges that chunks write to interleave; relaxed atomic stores are plain stores that may.
    let out = as_atomic(scratch);
    pairs.par_chunks(chunk_len).zip(&mut starts).for_each(|(chunk, places)| {
        for &pair in chunk {
            let place = &mut places[spread.bucket(pair)];
            out[*place as usize].store(pair, Ordering::Relaxed);
            *place += 1;
        }
    });
    let buckets = split_by(scratch, lens.iter().copied()).into_iter().zip(split_by(pairs, lens.iter().copied()));
    let buckets: Vec<(&mut [Pair], &mut [Pair])> = buckets.collect();
    buckets.into_par_iter().enumerate().for_each_init(Settler::default, |settler, (bucket, (from, out))| {
        settler.settle(&[from], out, spread.keys_of(bucket));
        if !is_in_index_order {
            order_ties(out);
        }
    });
}
