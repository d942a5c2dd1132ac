//! The intervals against rank statistics, against all resamples, and against series whose truth is known.

use super::*;

/// A normal number by twelve uniform ones.
fn normal(random: &mut SplitMix) -> f64 {
    (0..12).map(|_| random.next() as f64 / u64::MAX as f64).sum::<f64>() - 6.0
}

/// An autoregression of unit variance and median 0: each value is `rho` times the one before and something new.
fn series(random: &mut SplitMix, n: usize, rho: f64) -> Vec<f64> {
    let mut last = normal(random);
    (0..n)
        .map(|_| {
            last = rho * last + (1.0 - rho * rho).sqrt() * normal(random);
            last
        })
        .collect()
}

/// How often, of 200 series, the interval with 95 % does not hold the true median 0.
fn misses(rho: f64, n: usize, interval: impl Fn(&[f64]) -> Option<[f64; 2]>) -> usize {
    let mut random = SplitMix(7);
    let is_missed = |_: &usize| {
        let [low, high] = interval(&series(&mut random, n, rho)).unwrap();
        low > 0.0 || high < 0.0
    };
    (0..200).filter(is_missed).count()
}

#[test]
fn medians_by_selection_are_those_of_sorting() {
    let mut random = SplitMix(1);
    for n in 1..40 {
        let values: Vec<f64> = (0..n).map(|_| random.below(9) as f64).collect();
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let expected = f64::midpoint(sorted[(n - 1) / 2], sorted[n / 2]);
        assert!((median_in_place(&mut values.clone()) - expected).abs() < 1e-12, "{values:?}");
    }
}

/// The slow twin: every one of the n^b ways to put b blocks together, instead of 10,000 at random.
#[test]
fn random_resamples_are_spread_as_all_of_them() {
    let values = [3.0, 1.0, 4.0, 1.5, 5.0, 9.0, 2.0, 6.0];
    let (n, block) = (values.len(), 2);
    let mut all = Vec::new();
    for code in 0..n.pow((n / block) as u32) {
        let starts = (0..n / block).map(|digit| code / n.pow(digit as u32) % n);
        let mut resample: Vec<f64> =
            starts.flat_map(|start| (0..block).map(move |i| values[(start + i) % n])).collect();
        all.push(median_in_place(&mut resample));
    }
    all.sort_by(f64::total_cmp);
    let random = {
        let mut random = medians(&values, block, &mut SplitMix(SEED));
        random.sort_by(f64::total_cmp);
        random
    };
    // The largest distance of the distributions (Kolmogorov): 1.63/√10,000 is exceeded once in a hundred seeds.
    let share_below = |sorted: &[f64], x: f64| sorted.partition_point(|&y| y <= x) as f64 / sorted.len() as f64;
    let distance =
        |other: &[f64]| all.iter().map(|&x| (share_below(&all, x) - share_below(other, x)).abs()).fold(0.0, f64::max);
    assert!(distance(&random) < 0.0163, "{}", distance(&random));
    // Another block length gives another distribution: the comparison can fail.
    let mut by_one = medians(&values, 1, &mut SplitMix(SEED));
    by_one.sort_by(f64::total_cmp);
    assert!(distance(&by_one) > 0.0163, "{}", distance(&by_one));
}

/// Order statistics: of n independent values, x_(k) and x_(n+1−k) enclose the median with 1 − 2 P(Binomial(n, ½) < k).
#[test]
fn independent_values_have_about_the_interval_of_ranks() {
    let mut random = SplitMix(3);
    for n in [50, 200, 1000] {
        let values = series(&mut random, n, 0.0);
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let (mut k, mut tail, mut term) = (0, 0.0, 0.5_f64.powi(n as i32));
        while tail + term < 0.025 {
            tail += term;
            term *= (n - k) as f64 / (k + 1) as f64;
            k += 1;
        }
        let by_rank = [sorted[k - 1], sorted[n - k]];
        let [low, high] = interval(&values, 1, 0.95).unwrap();
        let width = by_rank[1] - by_rank[0];
        assert!(
            (low - by_rank[0]).abs() < 0.25 * width && (high - by_rank[1]).abs() < 0.25 * width,
            "{n}: {low} {high} {by_rank:?}"
        );
    }
}

#[test]
fn correlated_values_are_missed_about_as_rarely_as_said_and_by_single_values_often() {
    // 10 of 200 are 5 %; short series of strongly correlated values are somewhat worse, as for every block bootstrap.
    let of_blocks = [0.0, 0.5, 0.8].map(|rho| misses(rho, 200, |values| median_interval(values, 0.95)));
    assert!(of_blocks[0] <= 18 && of_blocks[1] <= 24 && of_blocks[2] <= 32, "{of_blocks:?}");
    // Without blocks a correlation of 0.8 is taken for information: the negative control.
    let of_single = misses(0.8, 200, |values| interval(values, 1, 0.95));
    assert!(of_single > 70, "{of_single}");
}

#[test]
fn blocks_grow_with_correlation() {
    let mut random = SplitMix(5);
    let lengths = [0.0, 0.5, 0.9].map(|rho| block_length(&series(&mut random, 1000, rho)));
    assert!((9..=14).contains(&lengths[0]) && lengths[0] < lengths[1] && lengths[1] < lengths[2], "{lengths:?}");
    assert_eq!((block_length(&[1.0; 27]), block_length(&[1.0])), (3, 1));
}

#[test]
fn ratios_of_unpaired_values() {
    let mut random = SplitMix(9);
    let times = |random: &mut SplitMix, scale: f64| -> Vec<f64> {
        series(random, 200, 0.3).iter().map(|x| scale * (1.0 + 0.03 * x)).collect()
    };
    let (a, b) = (times(&mut random, 10.0), times(&mut random, 11.0));
    let [low, high] = ratio_interval(&a, &b, 0.99).unwrap();
    assert!(1.05 < low && low < 1.1 && 1.1 < high && high < 1.15, "{low} {high}");
    let [low, high] = ratio_interval(&a, &times(&mut random, 10.0), 0.99).unwrap();
    assert!(low < 1.0 && 1.0 < high, "{low} {high}");
    assert_eq!(ratio_interval(&a, &b[..FEWEST - 1], 0.99), None);
    assert_eq!(
        (median_interval(&a[..FEWEST - 1], 0.99), median_interval(&[], 0.99), ratio_interval(&[], &a, 0.99)),
        (None, None, None)
    );
}

#[test]
fn the_same_values_have_the_same_interval() {
    let values = series(&mut SplitMix(4), 100, 0.5);
    assert_eq!(median_interval(&values, 0.95), median_interval(&values, 0.95));
    assert_eq!(median_interval(&[2.0; 20], 0.95), Some([2.0, 2.0]));
}
