//! Random numbers as a pure function of seed, stream and index: any of them alone, in parallel, on every platform.
//!
//! The mixing function is the finaliser of `SplitMix64` (Steele, Lea, Flood 2014), which passes `BigCrush` on a
//! counter.

/// Uniform in [0, 1), in steps of 2^-53; `stream` keeps uses of one seed apart.
pub(super) fn uniform(seed: u64, stream: u64, index: u64) -> f64 {
    (bits(seed, stream, index) >> 11) as f64 / (1_u64 << 53) as f64
}

/// 64 random bits.
pub(super) fn bits(seed: u64, stream: u64, index: u64) -> u64 {
    mix(index.wrapping_add(mix(stream.wrapping_add(mix(seed)))))
}

fn mix(counter: u64) -> u64 {
    // 2^64 over the golden ratio: a counter of any stride visits all of the numbers evenly.
    let z = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

#[cfg(test)]
mod tests {
    use super::{mix, uniform};

    #[test]
    fn first_number_is_that_of_splitmix64() {
        // SplitMix64 with seed 0: its published first outputs.
        assert_eq!(mix(0), 0xe220_a839_7b1d_cdaf);
        assert_eq!(mix(0x9e37_79b9_7f4a_7c15), 0x6e78_9e6a_a1b9_65f4);
    }

    #[test]
    fn mean_and_variance_are_those_of_a_uniform_number() {
        let n = 100_000;
        let (sum, square) = (0..n).map(|i| uniform(3, 1, i)).fold((0.0, 0.0), |(s, q), u| (s + u, q + u * u));
        let mean = sum / n as f64;
        assert!((mean - 0.5).abs() < 0.004, "{mean}"); // 4 standard deviations
        assert!((square / n as f64 - mean * mean - 1.0 / 12.0).abs() < 0.001);
        assert!(
            (uniform(3, 1, 0) - uniform(3, 2, 0)).abs() > 1e-9 && (uniform(4, 1, 0) - uniform(3, 1, 0)).abs() > 1e-9
        );
    }
}
