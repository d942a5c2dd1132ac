//! In: optical depths x = ℓ κ0 and y = ℓ κ1 of a segment (κ0 at the eye's side). Out: the weights of its two end colours
//! and its transmittance.
//!
//! Extinction κ and colour c run linearly over the segment's length ℓ. With T = e^(-(x + y)/2) and J the mean transmittance
//! ([`attenuation`](super::attenuation)), light ∫ c κ e^-τ ℓ dt = c0 - c1 T + (c1 - c0) J = c0 (1 - J) + c1 (J - T). The weights
//! W0 = 1 - J and W1 = J - T are computed without cancelling where the segment is thin: with h = e^(-m/2), E = 1 - h and
//! J = h (1 + Q), they are W0 = E - h Q and W1 = h (E + Q), and W0 + W1 = 1 - h² = 1 - T.
//!
//! All functions are branch-free and inline, for loops over vector lanes. Measured on one Zen 5 core, per segment in a loop over
//! 16 lanes: thin 0.40 ns (AVX-512), 0.77 (AVX2), 1.6 (SSE2); any depth 1.4, 2.9, 6.5; the same bits on all three.

use super::attenuation::{THIN_LIMIT, thick, thin_excess};
use super::exp::{exp_neg, one_minus_exp_neg, one_minus_exp_neg_small};

/// The largest (x + y)/2 that [`segment_weights_very_thin`] holds for.
pub const VERY_THIN_LIMIT: f32 = 1.0 / 16.0;

/// What a segment adds: light `w0 · c0 + w1 · c1`, seen through nothing nearer; opacity `w0 + w1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentWeights {
    /// Weight of the colour at the entry, the end at the eye's side.
    pub w0: f32,
    /// Weight of the colour at the exit.
    pub w1: f32,
    /// T: what of the light behind passes. `w0 + w1` is 1 - T, with a relative error of 4e-7 even where T rounds to 1.
    pub transmittance: f32,
}

/// The exact integral where (x + y)/2 <= [`THIN_LIMIT`] (2): relative error of both weights and of the opacity below 1e-6.
///
/// Measured (test `thin_weights_keep_their_digits`): weights 5.7e-7, opacity 2.0e-7, T 4.7e-7, all relative. No division, no root.
///
/// ```
/// # use cellfan::optics::integral::segment_weights_thin;
/// let thin = segment_weights_thin(1e-6, 1e-6); // a constant segment splits evenly
/// assert!(((thin.w0 + thin.w1) / 9.999_995e-7 - 1.0).abs() < 4e-7);
/// assert!((thin.w0 / thin.w1 - 1.0).abs() < 1e-6);
/// ```
#[inline(always)]
pub fn segment_weights_thin(x: f32, y: f32) -> SegmentWeights {
    let m = 0.5 * (x + y);
    let loss = one_minus_exp_neg_small(0.5 * m);
    let h = 1.0 - loss;
    let excess = thin_excess(m, 0.5 * (y - x));
    SegmentWeights { w0: loss - h * excess, w1: h * (loss + excess), transmittance: h * h }
}

/// The exact integral where (x + y)/2 <= [`VERY_THIN_LIMIT`] (1/16): the leading terms of [`segment_weights_thin`].
///
/// Taylor series of e^(-m/2) to its fourth term and of Q to the third power of m and δ; the first terms left out are below
/// 1e-6 of the weights (measured by test `very_thin_weights_keep_their_digits`: 5e-7). Half the operations of the thin form.
///
/// ```
/// # use cellfan::optics::integral::{segment_weights_thin, segment_weights_very_thin};
/// let (thin, very_thin) = (segment_weights_thin(0.02, 0.07), segment_weights_very_thin(0.02, 0.07));
/// assert!((very_thin.w0 / thin.w0 - 1.0).abs() < 1e-6);
/// ```
#[inline(always)]
pub fn segment_weights_very_thin(x: f32, y: f32) -> SegmentWeights {
    let (m, delta) = (0.5 * (x + y), 0.5 * (y - x));
    let half = 0.5 * m;
    let loss = half * (1.0 - half * (0.5 - half * (1.0 / 6.0 - half * (1.0 / 24.0))));
    let h = 1.0 - loss;
    // Q of `attenuation`, whose coefficients there are fitted for depths up to 2.
    let mm = m * m;
    let by_delta = (1.0 / 6.0 + mm * (1.0 / 240.0)) + delta * (1.0 / 60.0 + delta * (1.0 / 840.0));
    let excess = mm * (1.0 / 24.0) + delta * by_delta;
    SegmentWeights { w0: loss - h * excess, w1: h * (loss + excess), transmittance: h * h }
}

/// The exact integral for any x, y >= 0: absolute error of weights and transmittance below 1e-6.
///
/// Measured over [0, 1e4]²: 6.1e-7, transmittance 1.1e-7; where (x + y)/2 <= 2 it is [`segment_weights_thin`] to the bit.
///
/// ```
/// # use cellfan::optics::integral::segment_weights;
/// let rising = segment_weights(0.0, 4.0); // ∫ e^(-2 t²) dt = 0.598144
/// assert!((rising.w0 - (1.0 - 0.598_144)).abs() < 1e-6);
/// assert!((rising.transmittance - 0.135_335).abs() < 1e-6);
/// ```
#[inline(always)]
pub fn segment_weights(x: f32, y: f32) -> SegmentWeights {
    let m = 0.5 * x + 0.5 * y;
    let thin = segment_weights_thin(x, y);
    let transmittance = exp_neg(m);
    let j = thick(x, y, transmittance);
    let is_thin = m <= THIN_LIMIT;
    SegmentWeights {
        w0: if is_thin { thin.w0 } else { 1.0 - j },
        w1: if is_thin { thin.w1 } else { j - transmittance },
        transmittance: if is_thin { thin.transmittance } else { transmittance },
    }
}

/// The average of both ends (Shirley and Tuchman 1990, and `CellFast`): opacity 1 - e^(-(x + y)/2), exact; colour the plain mean.
///
/// Light is wrong by up to half the colour difference in an opaque segment.
///
/// ```
/// # use cellfan::optics::integral::segment_weights_average;
/// let thick = segment_weights_average(100.0, 100.0);
/// assert_eq!((thick.w0, thick.w1), (0.5, 0.5)); // where the exact weights are 0.99 and 0.01
/// ```
#[inline(always)]
pub fn segment_weights_average(x: f32, y: f32) -> SegmentWeights {
    let m = 0.5 * x + 0.5 * y;
    let half = 0.5 * one_minus_exp_neg(m);
    SegmentWeights { w0: half, w1: half, transmittance: exp_neg(m) }
}

/// ∫₀¹ (k0 + (k1 - k0) t)(c0 + (c1 - c0) t) dt: times the length, what an emitting segment adds.
///
/// ```
/// # use cellfan::optics::integral::product_mean;
/// assert_eq!(product_mean(0.0, 3.0, 0.0, 1.0), 1.0); // ∫ 3 t² dt
/// ```
#[inline(always)]
pub fn product_mean(k0: f32, k1: f32, c0: f32, c1: f32) -> f32 {
    (k0 * (2.0 * c0 + c1) + k1 * (c0 + 2.0 * c1)) * (1.0 / 6.0)
}

#[cfg(test)]
mod tests;
