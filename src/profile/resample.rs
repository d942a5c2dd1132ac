//! How far a median may be from what it estimates: confidence intervals by resampling.
//!
//! In: values in the order in which they were measured. Out: an interval that holds their median's true value with a given
//! confidence. Neighbouring frames are alike (a machine is busy for a while; views follow each other), so that n frames tell less
//! than n independent ones: a resample is put together from blocks of neighbours, around the end (the circular block bootstrap of
//! Politis and Romano, 1992). Blocks are longer the longer the values stay on one side of their median.

/// Resamples; the ends of a 99.5 % interval then stand on 25 of them on either side.
const RESAMPLES: usize = 10_000;

/// Fewer values tell nothing: the smallest and the largest of 8 independent ones enclose the median with 99.2 %.
pub(super) const FEWEST: usize = 8;

/// Where each interval's random numbers begin: the same figures give the same interval.
const SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// The interval of the median of `values` with `confidence`, 0 to 1; none of fewer than [`FEWEST`] values.
pub(super) fn median_interval(values: &[f64], confidence: f64) -> Option<[f64; 2]> {
    if values.len() < FEWEST {
        return None;
    }
    interval(values, block_length(values), confidence)
}

/// The same for the ratio of medians `b / a` of values that are not paired.
pub(super) fn ratio_interval(a: &[f64], b: &[f64], confidence: f64) -> Option<[f64; 2]> {
    if a.len().min(b.len()) < FEWEST {
        return None;
    }
    let mut random = SplitMix(SEED);
    let (of_a, of_b) = (medians(a, block_length(a), &mut random), medians(b, block_length(b), &mut random));
    ends(of_a.iter().zip(&of_b).map(|(a, b)| b / a).collect(), confidence)
}

/// With blocks of a known length.
fn interval(values: &[f64], block: usize, confidence: f64) -> Option<[f64; 2]> {
    ends(medians(values, block, &mut SplitMix(SEED)), confidence)
}

/// Medians of resamples.
fn medians(values: &[f64], block: usize, random: &mut SplitMix) -> Vec<f64> {
    let n = values.len();
    let mut resample = vec![0.0; n];
    let median_of_resample = |_| {
        for part in resample.chunks_mut(block) {
            let start = random.below(n);
            for (i, value) in part.iter_mut().enumerate() {
                *value = values[(start + i) % n];
            }
        }
        median_in_place(&mut resample)
    };
    (0..RESAMPLES).map(median_of_resample).collect()
}

/// The middle `confidence` of the medians.
fn ends(mut medians: Vec<f64>, confidence: f64) -> Option<[f64; 2]> {
    medians.sort_by(f64::total_cmp);
    let tail = 0.5 * (1.0 - confidence);
    Some([super::quantile(&medians, tail)?, super::quantile(&medians, 1.0 - tail)?])
}

/// The median, by selection; at least one value.
fn median_in_place(values: &mut [f64]) -> f64 {
    let half = values.len() / 2;
    let is_odd = values.len() % 2 == 1;
    let (below, &mut upper, _) = values.select_nth_unstable_by(half, f64::total_cmp);
    if is_odd { upper } else { f64::midpoint(below.iter().copied().fold(f64::NEG_INFINITY, f64::max), upper) }
}

/// How many neighbours a block holds: ∛n for independent values (the rate at which the error of a block bootstrap is least),
/// longer by τ^⅔ for values that are correlated over τ of them (as Künsch, 1989, finds for an autoregression), a quarter of them at most.
fn block_length(values: &[f64]) -> usize {
    let n = values.len();
    let length = (n as f64).cbrt() * correlation_length(values).powf(2.0 / 3.0);
    (length.ceil() as usize).clamp(1, (n / 4).max(1))
}

/// τ = 1 + 2 Σ ρₖ, where ρₖ is how often values k apart lie on the same side of the median, from −1 to 1: what the spread of a
/// median depends on. Summed until ρₖ is no more than chance would have it, 2/√n.
fn correlation_length(values: &[f64]) -> f64 {
    let n = values.len();
    let median = median_in_place(&mut values.to_vec());
    let sides: Vec<f64> = values
        .iter()
        .map(|&v| {
            if v > median {
                1.0
            } else if v < median {
                -1.0
            } else {
                0.0
            }
        })
        .collect();
    let power: f64 = sides.iter().map(|side| side * side).sum();
    if power == 0.0 {
        return 1.0;
    }
    let correlation = |k: usize| sides.iter().zip(&sides[k..]).map(|(a, b)| a * b).sum::<f64>() / power;
    let chance = 2.0 / (n as f64).sqrt();
    1.0 + 2.0 * (1..n / 2).map(correlation).take_while(|&rho| rho > chance).sum::<f64>()
}

/// Random numbers; Steele, Lea, Flood (2014).
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `n`.
    fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.next()) * n as u128) >> 64) as usize
    }
}

#[cfg(test)]
mod tests;
