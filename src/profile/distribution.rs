//! [`Distribution`]: how frame times spread: median, percentiles, extremes.

use serde::Serialize;

/// Median, percentiles and extremes of some values, in their unit.
///
/// ```
/// # use cellfan::profile::Distribution;
/// let ms = Distribution::of((1..=100).map(f64::from)).unwrap();
/// assert_eq!((ms.least, ms.median, ms.most, ms.count), (1.0, 50.5, 100.0, 100));
/// assert!((ms.p95 - 95.05).abs() < 1e-12 && (ms.p99 - 99.01).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distribution {
    /// How many values there are.
    pub count: usize,
    /// The smallest.
    pub least: f64,
    /// The middle one.
    pub median: f64,
    /// 95 of 100 are not above it.
    pub p95: f64,
    /// 99 of 100 are not above it.
    pub p99: f64,
    /// The largest.
    pub most: f64,
    /// Sum over count.
    pub mean: f64,
}

impl Distribution {
    /// Of `values`; none of none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        Some(Self {
            count: sorted.len(),
            least: *sorted.first()?,
            median: quantile(&sorted, 0.5)?,
            p95: quantile(&sorted, 0.95)?,
            p99: quantile(&sorted, 0.99)?,
            most: *sorted.last()?,
            mean: sorted.iter().sum::<f64>() / sorted.len() as f64,
        })
    }
}

/// The value below which the share `q` of `sorted` lies, linear between neighbours; none of none.
///
/// Hyndman and Fan (1996), definition 7, as numpy and R have it: the value at place q (n − 1).
///
/// # Panics
/// If `q` is not between 0 and 1.
pub fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    assert!((0.0..=1.0).contains(&q), "{q} is no share");
    let last = sorted.len().checked_sub(1)?;
    let place = q * last as f64;
    let below = place.floor() as usize;
    let (low, high) = (sorted[below], sorted[(below + 1).min(last)]);
    // Of two infinite ones the difference is not a number.
    let rise = if high > low { high - low } else { 0.0 };
    Some(low + rise * (place - place.floor()))
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "values are chosen, or come out without rounding")]

    use super::*;

    /// Straight from the definition: the piecewise linear function through (k / (n − 1), xₖ), found by search.
    fn slow_quantile(values: &[f64], q: f64) -> f64 {
        let n = values.len();
        let rank = |x: f64| values.iter().filter(|&&y| y < x).count();
        let nth = |k: usize| {
            values.iter().copied().find(|&x| {
                let ties = values.iter().filter(|&&y| y == x).count();
                (rank(x)..rank(x) + ties).contains(&k)
            })
        };
        if n == 1 {
            return values[0];
        }
        (0..n - 1)
            .find_map(|k| {
                let (from, to) = (k as f64 / (n - 1) as f64, (k + 1) as f64 / (n - 1) as f64);
                let (low, high) = (nth(k)?, nth(k + 1)?);
                (q <= to + 1e-15).then(|| low + (high - low) * ((q - from) / (to - from)).clamp(0.0, 1.0))
            })
            .unwrap()
    }

    #[test]
    fn quantiles_are_those_of_the_definition() {
        let mut state = 1_u64;
        for n in [1, 2, 3, 10, 99, 200] {
            let values: Vec<f64> = (0..n)
                .map(|_| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    (state >> 58) as f64 // few levels: ties
                })
                .collect();
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            for q in [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0] {
                let (fast, slow) = (quantile(&sorted, q).unwrap(), slow_quantile(&values, q));
                assert!((fast - slow).abs() < 1e-9, "n {n}, q {q}: {fast} {slow}");
            }
        }
    }

    #[test]
    fn known_values_and_none() {
        // numpy.percentile([1, 2, 4, 8], [50, 95]).
        let of = Distribution::of([8.0, 1.0, 4.0, 2.0]).unwrap();
        assert_eq!((of.median, of.mean), (3.0, 3.75));
        assert!((of.p95 - 7.4).abs() < 1e-12);
        assert_eq!(Distribution::of([]), None);
        assert_eq!(quantile(&[f64::INFINITY; 2], 0.3), Some(f64::INFINITY));
        assert_eq!(Distribution::of([5.0]).unwrap().p99, 5.0);
    }
}
