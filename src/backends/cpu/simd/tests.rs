#![expect(unsafe_code, reason = "instruction sets are made where the processor was found to have them")]
#![expect(clippy::float_cmp, reason = "numbers are moved, not computed")]

use super::*;
use crate::optics::LANES;

type Run = fn(u16, &Lanes) -> (u16, [Lanes; 4]);

fn all() -> Vec<(&'static str, Run)> {
    fn run(by: impl Simd, lanes: u16, from: &Lanes) -> (u16, [Lanes; 4]) {
        let mask = std::array::from_fn(|lane| u32::from(lanes >> lane & 1 == 1).wrapping_neg());
        let mut packed = [0.0; LANES];
        by.store(by.pack(lanes, by.load(from)), &mut packed);
        let moved = [by.compress(lanes, from), packed, by.expand(lanes, from, 7.0), by.put(lanes, 7.0, from)];
        (by.bits(&mask), moved)
    }
    let mut all: Vec<(&'static str, Run)> = vec![("by lane", |lanes, from| run(ByLane, lanes, from))];
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        // SAFETY: detected in the line above.
        all.push(("AVX2", |lanes, from| run(unsafe { ByAvx2::new() }, lanes, from)));
    }
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx512f") {
        // SAFETY: detected in the line above.
        all.push(("AVX-512", |lanes, from| run(unsafe { ByAvx512::new() }, lanes, from)));
    }
    all
}

#[test]
fn every_pattern_of_lanes_is_moved_like_by_a_filter() {
    let from: Lanes = std::array::from_fn(|i| i as f32 + 0.5);
    for (name, run) in all() {
        for lanes in 0..=u16::MAX {
            let (bits, [compressed, packed, expanded, put]) = run(lanes, &from);
            assert_eq!(bits, lanes, "{name}");
            let chosen = (0..LANES).filter(|i| lanes >> i & 1 == 1);
            let mut expected = [7.0; LANES];
            let mut expected_put = from;
            for (place, lane) in chosen.enumerate() {
                assert_eq!([compressed[place], packed[place]], [from[lane]; 2], "{name}, lanes {lanes:#b}");
                expected[lane] = from[place];
                expected_put[lane] = 7.0;
            }
            assert_eq!(expanded, expected, "{name}, lanes {lanes:#b}");
            assert_eq!(put, expected_put, "{name}, lanes {lanes:#b}");
        }
    }
}

#[test]
fn arithmetic_is_that_of_every_lane() {
    fn run(by: impl Simd, a: &Lanes, b: &Lanes) -> ([Lanes; 8], u16) {
        let (u, v) = (by.load(a), by.load(b));
        let of = [
            by.add(u, v),
            by.mul(u, v),
            by.min(u, v),
            by.max(u, v),
            by.abs(u),
            by.select(by.splat_mask(u32::MAX), u, v),
            by.select(by.splat_mask(0), u, v),
            by.splat(b[3]),
        ];
        let stored = of.map(|vector| {
            let mut lanes = [0.0; LANES];
            by.store(vector, &mut lanes);
            lanes
        });
        (stored, by.bits_where_less(u, v))
    }
    let numbers = [0.0, -0.0, 1.5, -2.25, 1e-40, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 3e38, -7.0];
    let at = |turn: usize, i: usize| numbers[(i * (turn + 3) + turn) % numbers.len()];
    let bits = |(stored, less): ([Lanes; 8], u16)| (stored.map(|lanes| lanes.map(f32::to_bits)), less);
    for turn in 0..50 {
        let (a, b) = (std::array::from_fn(|i| at(turn, i)), std::array::from_fn(|i| at(turn / 7, i + turn)));
        let expected = bits(run(ByLane, &a, &b));
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            // SAFETY: detected in the line above.
            assert_eq!(bits(run(unsafe { ByAvx2::new() }, &a, &b)), expected, "AVX2, {a:?}, {b:?}");
        }
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: detected in the line above.
            assert_eq!(bits(run(unsafe { ByAvx512::new() }, &a, &b)), expected, "AVX-512, {a:?}, {b:?}");
        }
    }
}

#[test]
fn rows_of_tables_are_those_asked_for() {
    fn run(by: impl Simd, at: &[u32; LANES]) -> ([Lanes; 4], [[u32; LANES]; 2]) {
        let rows: Vec<[f32; 4]> = (0..100).map(|i| [0.0, 0.25, 0.5, 0.75].map(|part| i as f32 + part)).collect();
        let pairs: Vec<[u32; 2]> = (0..100).map(|i| [i, 1000 + i]).collect();
        (by.rows(&rows, at), by.pairs(&pairs, at))
    }
    type Rows = fn(&[u32; LANES]) -> ([Lanes; 4], [[u32; LANES]; 2]);
    let mut all: Vec<(&str, Rows)> = vec![("by lane", |at| run(ByLane, at))];
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx512f") {
        // SAFETY: detected in the line above.
        all.push(("AVX-512", |at| run(unsafe { ByAvx512::new() }, at)));
    }
    for (name, run) in all {
        let at: [u32; LANES] = std::array::from_fn(|lane| (37 * lane as u32 + 5) % 100);
        let (rows, pairs) = run(&at);
        for lane in 0..LANES {
            let row = [0.0, 0.25, 0.5, 0.75].map(|part| at[lane] as f32 + part);
            assert_eq!(rows.map(|column| column[lane]), row, "{name}, lane {lane}");
            assert_eq!(pairs.map(|column| column[lane]), [at[lane], 1000 + at[lane]], "{name}, lane {lane}");
        }
        for lane in [0, 7, 15] {
            let mut beyond = at;
            beyond[lane] = 100;
            assert!(std::panic::catch_unwind(|| run(&beyond)).is_err(), "{name}, lane {lane}");
        }
    }
}
