//! In: optical depths x, y >= 0 of a segment, as if its whole length had the extinction of its entry, of its exit.
//! Out: J(x, y) = ∫₀¹ e^(-(x t + (y - x) t²/2)) dt, the mean transmittance along a segment of linear extinction.
//!
//! With m = (x + y)/2, δ = (y - x)/2 and h = e^(-m/2), so that T = e^-m = h² is the transmittance of the segment:
//!
//! * Thin, m <= 2: x t + δ t² = m t - δ t (1 - t), so J = h (1 + Q), Q = ∫ e^(m(1/2 - t) + δ t(1 - t)) dt - 1. Q is even in
//!   m, and a short polynomial in m² and δ.
//! * δ > 0: completing the square, J = √π/(2√δ) (erfcx(x/2√δ) - T erfcx(y/2√δ)), the T because the two squares differ by m.
//! * δ < 0, ε = -δ: J = (F(x/2√ε) - T F(y/2√ε))/√ε with Dawson's integral F.
//!
//! Both erfcx and F are written as a factor that has the right limits times a rational function of p in [0, 1], where p = 0
//! stands for δ = 0; so nothing is singular at δ = 0 and both ends of both signs share one evaluation with selected coefficients.

use super::exp::polynomial;

/// The largest m = (x + y)/2 that the thin form holds for.
pub const THIN_LIMIT: f32 = 2.0;

/// Beyond this an optical depth is as good as infinite: J changes by less than 1e-9.
pub(super) const DEPTH_LIMIT: f32 = 1e9;

// Q = Σ c_ik m^2i δ^k, by powers of δ, each by powers of m². Minimax fit (Lawson) to 40-point Gauss-Legendre quadrature over
// 0 < m <= 2, |δ| <= m, of h Q / m: error 4.4e-8, so the error of Q h vanishes with m.
pub(super) const Q0: [f32; 4] = [0.041_666_64, 5.209_367e-4, 3.057_824_2e-6, 1.631_816_1e-8];
pub(super) const Q1: [f32; 4] = [0.166_666_66, 0.004_166_823, 3.714_308e-5, 1.802_863e-7];
pub(super) const Q2: [f32; 3] = [0.016_666_738, 2.973_532_2e-4, 2.092_739e-6];
pub(super) const Q3: [f32; 3] = [0.001_190_312_3, 1.646_350_4e-5, 1.183_360_8e-7];
pub(super) const Q4: [f32; 2] = [6.620_592e-5, 9.292_365e-7];
pub(super) const Q5: f32 = 3.155_743e-6;

// √π (z + a) erfcx(z), z = a (1 - p)/p, a = 1.4: degree 4 over 4, weighted by what J makes of it for m >= 2: error 3.6e-8.
pub(super) const RISING_SHIFT: f32 = 2.8;
pub(super) const RISING_TOP: [f32; 7] = [1.000_000_1, 0.695_131_84, 2.096_696_1, 1.501_353_6, 1.111_188_3, 0.0, 0.0];
pub(super) const RISING_BOTTOM: [f32; 7] = [1.0, -0.304_851_7, 1.656_046, -0.154_003_07, 0.383_721_3, 0.0, 0.0];

// 2 (v + b) F(√v)/√v, v = b (1 - p)/p, b = 2.5: degree 6 over 6, weighted likewise: error 3.3e-7.
pub(super) const FALLING_SHIFT: f32 = 10.0;
pub(super) const FALLING_TOP: [f32; 7] =
    [1.000_000_6, -5.566_057, 22.459_263, -32.816_45, 65.146_88, -46.490_032, 222.252_24];
pub(super) const FALLING_BOTTOM: [f32; 7] =
    [1.0, -6.765_767_6, 29.036_5, -58.839_977, 94.233_87, -59.461_876, 45.994_93];

/// Q in J = e^(-m/2) (1 + Q), for m = (x + y)/2 <= [`THIN_LIMIT`] and δ = (y - x)/2; error below 5e-8 m e^(m/2).
#[inline(always)]
pub(super) fn thin_excess(m: f32, delta: f32) -> f32 {
    let mm = m * m;
    let by_delta = [polynomial(&Q1, mm), polynomial(&Q2, mm), polynomial(&Q3, mm), polynomial(&Q4, mm), Q5];
    mm * polynomial(&Q0, mm) + delta * polynomial(&by_delta, delta)
}

/// J for (x + y)/2 >= [`THIN_LIMIT`], given T = e^(-(x + y)/2); below the limit it is less exact, and NaN at 0.
#[inline(always)]
pub(super) fn thick(x: f32, y: f32, transmittance: f32) -> f32 {
    let x = if x > DEPTH_LIMIT { DEPTH_LIMIT } else { x };
    let y = if y > DEPTH_LIMIT { DEPTH_LIMIT } else { y };
    let delta = 0.5 * (y - x);
    let rising = delta > 0.0;
    let root = delta.abs().sqrt();
    let shift = if rising { RISING_SHIFT * root } else { FALLING_SHIFT * delta.abs() };
    let mut top = [0.0; 7];
    let mut bottom = [0.0; 7];
    for k in 0..7 {
        top[k] = if rising { RISING_TOP[k] } else { FALLING_TOP[k] };
        bottom[k] = if rising { RISING_BOTTOM[k] } else { FALLING_BOTTOM[k] };
    }
    let end = |depth: f32| {
        let base = if rising { depth } else { depth * depth };
        let factor = if rising { 1.0 } else { depth };
        let reciprocal = 1.0 / (base + shift);
        let p = shift * reciprocal;
        factor * reciprocal * polynomial(&top, p) / polynomial(&bottom, p)
    };
    end(x) - transmittance * end(y)
}

#[cfg(test)]
mod tests;
