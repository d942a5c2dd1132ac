//! All sorts against the library's, at their thresholds; frames after frames against sorts of their own.

use proptest::prelude::*;

use super::frames::FrameSort;
use super::*;

type Sorter = fn(&mut Vec<Pair>, &mut Vec<Pair>);

fn twin(mut pairs: Vec<Pair>) -> Vec<Pair> {
    pairs.sort_unstable();
    pairs
}

fn random() -> impl FnMut() -> u32 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as u32
    }
}

fn shuffled(n: usize, mask: u32) -> Vec<Pair> {
    let mut random = random();
    (0..n as u32).map(|i| pair(random() & mask, i)).collect()
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

#[test]
fn sorts_around_every_threshold_like_the_library() {
    for n in [0, 1, 2, SMALL - 1, SMALL, SMALL + 1, 2 * CHUNK - 1, 2 * CHUNK, 2 * CHUNK + 1, 5 * CHUNK + 7] {
        for mask in [u32::MAX, 0xff, 0xff00_0000, 1, 0] {
            let pairs = shuffled(n, mask);
            let expected = twin(pairs.clone());
            let sorters: [Sorter; 2] = [sort_local, sort];
            for sorter in sorters {
                let (mut sorted, mut scratch) = (pairs.clone(), Vec::new());
                sorter(&mut sorted, &mut scratch);
                assert!(sorted == expected, "n {n}, mask {mask:x}");
            }
        }
    }
}

#[test]
fn equal_keys_are_ordered_by_index_whatever_order_they_came_in() {
    for keys in [1, 5, 100_000] {
        let mut pairs: Vec<Pair> = (0..3 * CHUNK as u32).map(|i| pair(i % keys, 7 * i % 1000)).collect();
        let expected = twin(pairs.clone());
        sort(&mut pairs, &mut Vec::new());
        assert!(pairs == expected, "{keys} keys");
    }
}

#[test]
fn one_key_far_from_all_others_leaves_them_one_bucket_that_is_spread_again() {
    for bits in [1, 12, 20] {
        let mut pairs = shuffled(5 * CHUNK, (1 << bits) - 1);
        pairs[CHUNK] = pair(u32::MAX, index_of(pairs[CHUNK]));
        let expected = twin(pairs.clone());
        sort(&mut pairs, &mut Vec::new());
        assert!(pairs == expected, "{bits} bits");
    }
}

#[test]
fn keys_beyond_the_sampled_range_are_sorted_too() {
    // One in ten, at both ends, where the sample does not look; then so many that an end is large.
    for share in [10, 2] {
        let n = 12 * CHUNK;
        let step = n.div_ceil(SAMPLE);
        let mut random = random();
        let key = |i: usize, random: u32| match (!i.is_multiple_of(step) && i.is_multiple_of(share), i % 4 < 2) {
            (true, true) => random % 1000,
            (true, false) => u32::MAX - random % 1000,
            (false, _) => (1 << 30) + random % (1 << 20),
        };
        let pairs: Vec<Pair> = (0..n).map(|i| pair(key(i, random()), i as u32)).collect();
        let expected = twin(pairs.clone());
        let mut sorted = pairs.clone();
        sort(&mut sorted, &mut Vec::new());
        assert!(sorted == expected, "1 in {share}");
        let mut frames = FrameSort::default();
        for moved in [None, Some(0.01)] {
            assert!(frame(&mut frames, &pairs, 7, moved) == expected, "1 in {share}, moved {moved:?}");
        }
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let pairs = shuffled(3 * CHUNK, 0xffff);
    let expected = twin(pairs.clone());
    for threads in [1, 2, 3, 7] {
        let (mut sorted, mut scratch) = (pairs.clone(), Vec::new());
        pool(threads).install(|| sort(&mut sorted, &mut scratch));
        assert!(sorted == expected, "{threads} threads");
    }
}

#[test]
fn settles_runs_around_every_threshold_like_a_stable_sort() {
    for n in [0, 1, SMALL - 1, SMALL, 5000] {
        for bits in [0, 1, 8, 9, 12, 13, 24, 25, 32] {
            let low = if bits == 32 { 0 } else { 77 };
            let mut random = random();
            let mask = u32::MAX.checked_shr(32 - bits).unwrap_or(0);
            let pairs: Vec<Pair> = (0..n as u32).map(|i| pair((random() & mask).saturating_add(low), i)).collect();
            let runs: Vec<&[Pair]> = pairs.chunks(n / 3 + 1).collect();
            let mut out = vec![0; n];
            Settler::default().settle(&runs, &mut out, (low, bits));
            assert!(out == twin(pairs.clone()), "n {n}, {bits} bits");
        }
    }
}

/// The pairs of a frame in parts, as threads fill them.
fn frame(sort: &mut FrameSort, pairs: &[Pair], parts: usize, moved: Option<f64>) -> Vec<Pair> {
    let of_part = pairs.len().div_ceil(parts).max(1);
    let mut rest = pairs.chunks(of_part);
    for part in sort.begin(parts, moved) {
        for some in rest.next().unwrap_or_default().chunks(1000) {
            part.extend(some.iter().copied());
        }
    }
    let mut sorted = Vec::new();
    sort.finish(&mut sorted);
    sorted
}

/// Keys like depths: two humps, moved by `step`.
fn depths(n: usize, step: f32) -> Vec<Pair> {
    let mut random = random();
    let mut share = move || random() as f32 / (1_u64 << 31) as f32;
    let key = |depth: f32| crate::stages::sort::key_of_depth(depth);
    (0..n as u32)
        .map(|i| {
            let (hump, place) = (share().round(), share() + share());
            pair(key(3.0 + hump + place + step * (share() - 0.5)), i)
        })
        .collect()
}

#[test]
fn frames_after_frames_sort_like_the_library() {
    let n = 3 * CHUNK;
    let few = depths(5000, 0.0);
    let mut one_key: Vec<Pair> = (0..n as u32).map(|i| pair(9, i)).collect();
    one_key[7] = pair(1 << 30, 7);
    let random_keys = shuffled(n, u32::MAX);
    let (first, second) = (depths(n, 0.0), depths(n, 0.1));
    let far: Vec<Pair> = first.iter().map(|&p| pair(key_of(p) / 2, index_of(p))).collect();
    for threads in [1, 3] {
        let mut sort = FrameSort::default();
        // Foreseen well, badly, wrongly, for other numbers of parts and of pairs.
        for (number, (pairs, parts, moved)) in [
            (&first, 5, Some(0.0)),
            (&second, 5, Some(0.02)),
            (&first, 5, Some(0.02)),
            (&far, 5, Some(0.0)),
            (&far, 5, Some(0.0)),
            (&random_keys, 5, Some(0.01)),
            (&random_keys, 4, Some(0.01)),
            (&random_keys, 4, Some(0.06)),
            (&one_key, 4, Some(0.0)),
            (&one_key, 4, Some(0.03)),
            (&few, 4, Some(0.0)),
            (&few, 4, Some(0.0)),
            (&Vec::new(), 4, None),
            (&first, 4, Some(f64::NAN)),
            (&first, 4, Some(0.0)),
            (&Vec::new(), 4, Some(0.0)),
            (&second, 4, Some(0.02)),
        ]
        .into_iter()
        .enumerate()
        {
            let sorted = pool(threads).install(|| frame(&mut sort, pairs, parts, moved));
            assert!(sorted == twin(pairs.clone()), "frame {number}, {threads} threads");
        }
    }
}

#[test]
fn a_small_step_is_foreseen_and_a_new_view_is_not() {
    let n = 3 * CHUNK;
    let mut sort = FrameSort::default();
    let homeless = |sort: &mut FrameSort, pairs: &[Pair], moved| -> usize {
        frame(sort, &depths(n, 0.0), 4, None);
        sort.begin(4, moved).iter_mut().zip(pairs.chunks(n.div_ceil(4))).for_each(|(part, some)| {
            part.extend(some.iter().copied());
        });
        sort.homeless()
    };
    assert!(homeless(&mut sort, &depths(n, 0.03), Some(0.01)) < n / 1000);
    assert_eq!(homeless(&mut sort, &depths(n, 0.03), None), n);
    assert_eq!(homeless(&mut sort, &depths(n, 0.03), Some(0.5)), n);
}

#[test]
fn unsorted_pairs_come_as_they_are() {
    let pairs = depths(3 * CHUNK, 0.0);
    let mut sort = FrameSort::default();
    frame(&mut sort, &pairs, 3, None);
    let mut out = Vec::new();
    for (part, some) in sort.begin(3, None).iter_mut().zip(pairs.chunks(CHUNK)) {
        part.extend(some.iter().copied());
    }
    sort.finish_unsorted(&mut out);
    assert!(out == pairs);
}

proptest! {
    #[test]
    fn any_keys_sort_like_the_library(keys in prop::collection::vec(any::<u32>(), 0..2000)) {
        let pairs: Vec<Pair> = keys.iter().enumerate().map(|(i, &key)| pair(key, i as u32)).collect();
        let (mut sorted, mut scratch) = (pairs.clone(), Vec::new());
        sort_local(&mut sorted, &mut scratch);
        prop_assert_eq!(&sorted, &twin(pairs.clone()));
        let mut out = vec![0; pairs.len()];
        Settler::default().settle(&[&pairs[..]], &mut out, (0, u32::BITS));
        prop_assert_eq!(sorted, out);
    }

    #[test]
    fn any_two_frames_sort_like_the_library(
        seeds in prop::array::uniform2(0_u32..),
        masks in prop::array::uniform2(0_u32..),
        parts in 1_usize..9,
        moved in 0.0..0.07_f64,
    ) {
        let mut sort = FrameSort::default();
        for (seed, mask) in seeds.into_iter().zip(masks) {
            let pairs: Vec<Pair> =
                shuffled(2 * CHUNK + 3, u32::MAX).iter().map(|&p| pair((key_of(p) ^ seed) & mask, index_of(p))).collect();
            prop_assert!(frame(&mut sort, &pairs, parts, Some(moved)) == twin(pairs));
        }
    }
}
