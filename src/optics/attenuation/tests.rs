use super::super::exp::{exp_neg, one_minus_exp_neg_small};
use super::super::quadrature::{depths, j_slow};
use super::*;

#[test]
fn the_twin_agrees_with_closed_forms() {
    // Constant: (1 - e^-x)/x. Falling to zero and rising from zero: tables of Dawson's integral and erf.
    assert!((j_slow(3.0, 3.0) - (1.0 - (-3f64).exp()) / 3.0).abs() < 1e-13);
    assert!((j_slow(0.0, 2.0) - 0.746_824_132_812_427).abs() < 1e-13);
    assert!((j_slow(2.0, 0.0) - 0.538_079_506_912_768_4).abs() < 1e-13);
    assert!((j_slow(1e4, 1e4) - 1e-4).abs() < 1e-13);
}

#[test]
fn thick_and_thin_stay_within_their_bound() {
    let (mut worst_thin, mut worst_thick) = (0.0_f64, 0.0_f64);
    for &x in &depths() {
        for &y in &depths() {
            let exact = j_slow(x.into(), y.into());
            let m = 0.5 * (x + y);
            if m <= THIN_LIMIT {
                let loss = one_minus_exp_neg_small(0.5 * m);
                let j = (1.0 - loss) * (1.0 + thin_excess(m, 0.5 * (y - x)));
                worst_thin = worst_thin.max((f64::from(j) - exact).abs());
            }
            if m >= THIN_LIMIT {
                worst_thick = worst_thick.max((f64::from(thick(x, y, exp_neg(m))) - exact).abs());
            }
        }
    }
    println!("absolute error of J: thin {worst_thin:.2e}, thick {worst_thick:.2e}");
    assert!(worst_thin < 3e-7 && worst_thick < 1e-6);
}

#[test]
fn thick_survives_any_depth() {
    for &x in &[0.0, 1.0, 1e5, 1e20, f32::MAX, f32::INFINITY] {
        for &y in &[0.0, 3.0, 1e5, 1e20, f32::MAX, f32::INFINITY] {
            if x + y > 4.0 {
                let j = thick(x, y, exp_neg(0.5 * (x + y)));
                assert!((0.0..=1.0).contains(&j), "J({x}, {y}) = {j}");
            }
        }
    }
    assert!(thick(f32::NAN, 5.0, 0.1).is_nan());
}
