//! In: how often each value occurs, the mesh's diagonal. Out: a transfer function that shows something, for a first look.
//!
//! What is common is background and nearly transparent, what is rare is a feature and more opaque: a bin's weight grows with the
//! logarithm of how much rarer it is than the commonest. All extinctions are then scaled so that a ray across the diagonal,
//! meeting values as often as the mesh holds them, has an optical depth of 3 (opacity 0.95).

use super::presets::{ColorMap, sampled};
use super::transfer::{TransferFunction, check_unit_distance};
use crate::error::Result;

/// Optical depth aimed at, over the diagonal.
const DEPTH: f64 = 3.0;

/// Bins that weights are made from: few, so that a noisy histogram does not give a noisy function and a cell does not span
/// many pieces.
const BINS: usize = 8;

/// Weight of the commonest bin, where the rarest has 1.
const BACKGROUND: f64 = 0.02;

/// No extinction is greater than this over the diagonal: where nearly all is background, the rest does not become a solid.
const DEPTH_LIMIT: f64 = 100.0;

impl TransferFunction {
    /// A function for a field whose values fall into the equal bins of `range` as often as `histogram` says; `diagonal` in world units.
    ///
    /// ```
    /// # use cellfan::optics::{presets::ColorMap, transfer::TransferFunction};
    /// let mut histogram = [10_u64; 64];
    /// histogram[0] = 100_000; // background
    /// let transfer = TransferFunction::from_histogram(&histogram, (0.0, 1.0), ColorMap::Viridis, 2.0)?;
    /// assert!(transfer.eval(0.0).extinction < 0.05 * transfer.eval(0.9).extinction);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the range is not finite and ascending or the diagonal not positive. An empty histogram counts as an even one.
    pub fn from_histogram(histogram: &[u64], range: (f64, f64), map: ColorMap, diagonal: f64) -> Result<Self> {
        check_unit_distance(diagonal)?;
        let share = shares(histogram);
        let weight = weights(&share);
        let mean: f64 = share.iter().zip(&weight).map(|(share, weight)| share * weight).sum();
        let most = weight.iter().copied().fold(0.0, f64::max);
        let scale = (DEPTH / mean).min(DEPTH_LIMIT / most) / diagonal;
        sampled(map, range, BINS + 1, |t| {
            // Bin k's weight holds at its middle; straight lines between, level at the ends.
            let place = (t * BINS as f64 - 0.5).clamp(0.0, (BINS - 1) as f64);
            let k = (place as usize).min(BINS - 2);
            let u = place - k as f64;
            scale * (weight[k] * (1.0 - u) + weight[k + 1] * u)
        })
    }
}

/// The histogram in few bins, adding up to 1.
fn shares(histogram: &[u64]) -> [f64; BINS] {
    let total: f64 = histogram.iter().map(|&count| count as f64).sum();
    let mut share = [0.0; BINS];
    if total <= 0.0 {
        return [1.0 / BINS as f64; BINS];
    }
    let fine = BINS as f64 / histogram.len() as f64;
    for (i, &count) in histogram.iter().enumerate() {
        // A bin may overlap two or, if there are fewer than ours, several of ours.
        let (low, high) = (i as f64 * fine, (i + 1) as f64 * fine);
        for (k, share) in share.iter_mut().enumerate() {
            let overlap = (high.min((k + 1) as f64) - low.max(k as f64)).max(0.0);
            *share += count as f64 / total * overlap / fine;
        }
    }
    share
}

/// From [`BACKGROUND`] for the commonest bin to 1 for one that is 1000 times rarer, or empty.
fn weights(share: &[f64; BINS]) -> [f64; BINS] {
    let commonest = share.iter().copied().fold(0.0, f64::max);
    let rarity = share.map(|share| ((commonest / share.max(commonest * 1e-3)).ln() / 1000_f64.ln()).clamp(0.0, 1.0));
    std::array::from_fn(|k| {
        let neighbours = rarity[k.saturating_sub(1)] + rarity[(k + 1).min(BINS - 1)];
        // Peaks of rarity are smoothed, common bins stay transparent.
        BACKGROUND + (1.0 - BACKGROUND) * rarity[k].min(0.5 * rarity[k] + 0.25 * neighbours)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Optical depth of a diagonal that meets values as often as the histogram says.
    fn depth(transfer: &TransferFunction, histogram: &[u64], diagonal: f64) -> f64 {
        let total: u64 = histogram.iter().sum();
        let bins = histogram.len() as f64;
        let at = |i: usize| transfer.eval((i as f64 + 0.5) / bins).extinction;
        histogram.iter().enumerate().map(|(i, &n)| at(i) * n as f64 / total as f64).sum::<f64>() * diagonal
    }

    fn check(histogram: &[u64], expected: std::ops::RangeInclusive<f64>) {
        let transfer = TransferFunction::from_histogram(histogram, (0.0, 1.0), ColorMap::Viridis, 7.0).unwrap();
        let depth = depth(&transfer, histogram, 7.0);
        assert!(expected.contains(&depth), "{depth}");
        assert!(transfer.points().len() < 70, "{}", transfer.points().len());
        assert!(transfer.points().iter().all(|point| point.extinction * 7.0 <= 100.0 + 1e-9));
    }

    #[test]
    fn the_depth_is_about_three() {
        check(&[5; 256], 2.9..=3.1);
        check(&(0..256).map(|i| 1 + i * i).collect::<Vec<u64>>(), 2.0..=4.0);
        check(&(0..64).map(|i| (1e6 * (-0.2 * f64::from(i)).exp()) as u64 + 1).collect::<Vec<u64>>(), 1.5..=4.5);
        check(&[1, 2, 3], 1.5..=4.5);
    }

    #[test]
    fn one_bin_only_is_visible() {
        let mut histogram = [0; 100];
        histogram[40] = 1_000_000;
        let transfer = TransferFunction::from_histogram(&histogram, (0.0, 1.0), ColorMap::Inferno, 1.0).unwrap();
        assert!(depth(&transfer, &histogram, 1.0) > 0.5);
        let one = TransferFunction::from_histogram(&[9], (3.0, 3.0), ColorMap::Inferno, 1.0).unwrap();
        assert!((one.eval(3.0).extinction - 3.0).abs() < 1e-9);
    }

    #[test]
    fn empty_histograms_and_bad_diagonals() {
        assert!(TransferFunction::from_histogram(&[], (0.0, 1.0), ColorMap::Viridis, 1.0).is_ok());
        assert!(TransferFunction::from_histogram(&[0; 8], (0.0, 1.0), ColorMap::Viridis, 1.0).is_ok());
        assert!(TransferFunction::from_histogram(&[1; 8], (0.0, 1.0), ColorMap::Viridis, 0.0).is_err());
        assert!(TransferFunction::from_histogram(&[1; 8], (0.0, f64::INFINITY), ColorMap::Viridis, 1.0).is_err());
    }
}
