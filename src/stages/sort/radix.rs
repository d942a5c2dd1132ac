//! `radix`: LSD radix sort of 32-bit keys with 32-bit indices, packed as `key << 32 | index`; parallel.
//!
//! In: pairs in any order. Out: the same pairs by key, equal keys by index, whatever the order they came in: a frame does
//! not depend on the one before. Four passes of 8-bit digits, a pass whose digit is the same everywhere is skipped; 16 bytes
//! moved per pair and pass. The same bytes for any number of threads: a chunk's place under each digit follows from the
//! counts of the chunks before it.
//!
//! CellFast, section 2, sorts the same pairs by a custom quicksort.

use std::sync::atomic::Ordering;

use rayon::prelude::*;

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

const DIGITS: usize = 256;
/// Bits of the key, digit by digit, within the packed word.
const SHIFTS: [u32; 4] = [32, 40, 48, 56];
/// Below this many pairs the library's sort is used: four passes and their counts cost the same for any few. Chosen, not measured.
const SMALL: usize = 384;
/// Pairs a thread takes at least; below two of these one thread does it all.
const CHUNK: usize = 1 << 16;

#[inline]
fn digit(pair: Pair, shift: u32) -> usize {
    (pair >> shift) as usize & (DIGITS - 1)
}

/// Sorts `pairs` by key and index on the calling thread. `scratch` is grown as needed.
pub fn sort_local(pairs: &mut Vec<Pair>, scratch: &mut Vec<Pair>) {
    if pairs.len() < SMALL {
        pairs.sort_unstable();
        return;
    }
    scratch.resize(pairs.len(), 0);
    let mut counts = [[0_u32; DIGITS]; SHIFTS.len()];
    for &pair in pairs.iter() {
        for (counts, shift) in counts.iter_mut().zip(SHIFTS) {
            counts[digit(pair, shift)] += 1;
        }
    }
    for (counts, shift) in counts.iter_mut().zip(SHIFTS) {
        if counts.iter().any(|&n| n as usize == pairs.len()) {
            continue;
        }
        let mut start = 0;
        for count in counts.iter_mut() {
            start += std::mem::replace(count, start);
        }
        for &pair in pairs.iter() {
            let place = &mut counts[digit(pair, shift)];
            scratch[*place as usize] = pair;
            *place += 1;
        }
        std::mem::swap(pairs, scratch);
    }
    order_ties(pairs);
}

/// Sorts `pairs` by key and index on all threads of the current pool. `scratch` is grown as needed.
pub fn sort(pairs: &mut Vec<Pair>, scratch: &mut Vec<Pair>) {
    let threads = rayon::current_num_threads();
    if threads == 1 || pairs.len() < 2 * CHUNK {
        sort_local(pairs, scratch);
        return;
    }
    scratch.resize(pairs.len(), 0);
    let chunk_len = pairs.len().div_ceil(threads * 2).max(CHUNK);
    for shift in SHIFTS {
        // Count per chunk, scan over (digit, chunk), write.
        let mut starts: Vec<[usize; DIGITS]> = pairs
            .par_chunks(chunk_len)
            .map(|chunk| {
                let mut counts = [0; DIGITS];
                for &pair in chunk {
                    counts[digit(pair, shift)] += 1;
                }
                counts
            })
            .collect();
        if (0..DIGITS).any(|d| starts.iter().map(|counts| counts[d]).sum::<usize>() == pairs.len()) {
            continue;
        }
        let mut start = 0;
        for d in 0..DIGITS {
            for counts in &mut starts {
                start += std::mem::replace(&mut counts[d], start);
            }
        }
        debug_assert_eq!(start, pairs.len());
        // The ranges that chunks write to interleave; relaxed atomic stores are plain stores that may.
        let out = as_atomic(scratch);
        pairs.par_chunks(chunk_len).zip(&mut starts).for_each(|(chunk, places)| {
            for &pair in chunk {
                let place = &mut places[digit(pair, shift)];
                out[*place].store(pair, Ordering::Relaxed);
                *place += 1;
            }
        });
        std::mem::swap(pairs, scratch);
    }
    order_ties(pairs);
}

/// Orders runs of equal keys by index.
fn order_ties(pairs: &mut [Pair]) {
    for run in pairs.chunk_by_mut(|a, b| a >> 32 == b >> 32) {
        if run.len() > 1 {
            run.sort_unstable();
        }
    }
}

/// Sorts `pairs` that are likely nearly in order already, as they are when they stand in the last frame's order.
///
/// A sorted input costs one pass over it; one with few descents goes to the library's merge sort, which takes runs as
/// they are; anything else goes to [`sort`].
pub fn sort_coherent(pairs: &mut Vec<Pair>, scratch: &mut Vec<Pair>) {
    let descents = pairs.par_windows(2).filter(|two| two[0] > two[1]).count();
    // A merge of runs costs a pass per doubling: worth it while runs are long. The limit is chosen, not measured.
    if descents == 0 {
    } else if descents < pairs.len() / 4096 {
        pairs.par_sort();
    } else {
        sort(pairs, scratch);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn twin(mut pairs: Vec<Pair>) -> Vec<Pair> {
        pairs.sort_unstable();
        pairs
    }

    fn shuffled(n: usize, mask: u32) -> Vec<Pair> {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        (0..n as u32)
            .map(|i| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                pair((state >> 33) as u32 & mask, i)
            })
            .collect()
    }

    #[test]
    fn sorts_around_every_threshold_like_the_library() {
        for n in [0, 1, 2, SMALL - 1, SMALL, SMALL + 1, 2 * CHUNK - 1, 2 * CHUNK, 2 * CHUNK + 1, 5 * CHUNK + 7] {
            for mask in [u32::MAX, 0xff, 0xff00_0000, 0] {
                let pairs = shuffled(n, mask);
                let expected = twin(pairs.clone());
                for sorter in [sort_local, sort, sort_coherent] {
                    let (mut sorted, mut scratch) = (pairs.clone(), Vec::new());
                    sorter(&mut sorted, &mut scratch);
                    assert!(sorted == expected, "n {n}, mask {mask:x}");
                }
            }
        }
    }

    #[test]
    fn equal_keys_are_ordered_by_index_whatever_order_they_came_in() {
        let mut pairs: Vec<Pair> = (0..3 * CHUNK as u32).map(|i| pair(i % 5, 7 * i % 1000)).collect();
        let expected = twin(pairs.clone());
        sort(&mut pairs, &mut Vec::new());
        assert!(pairs == expected);
    }

    #[test]
    fn the_same_bytes_for_any_number_of_threads() {
        let pairs = shuffled(3 * CHUNK, 0xffff);
        let expected = twin(pairs.clone());
        for threads in [1, 2, 3, 7] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (mut sorted, mut scratch) = (pairs.clone(), Vec::new());
            pool.install(|| sort(&mut sorted, &mut scratch));
            assert!(sorted == expected, "{threads} threads");
        }
    }

    #[test]
    fn nearly_sorted_pairs_come_out_sorted() {
        let mut pairs: Vec<Pair> = (0..100_000).map(|i| pair(i, i)).collect();
        pairs.swap(500, 90_000);
        let expected = twin(pairs.clone());
        sort_coherent(&mut pairs, &mut Vec::new());
        assert_eq!(pairs, expected);
    }

    proptest! {
        #[test]
        fn any_keys_sort_like_the_library(keys in prop::collection::vec(any::<u32>(), 0..2000)) {
            let pairs: Vec<Pair> = keys.iter().enumerate().map(|(i, &key)| pair(key, i as u32)).collect();
            let (mut sorted, mut scratch) = (pairs.clone(), Vec::new());
            sort_local(&mut sorted, &mut scratch);
            prop_assert_eq!(sorted, twin(pairs));
        }
    }
}
