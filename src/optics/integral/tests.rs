use super::super::quadrature::{depths, integrate_depth, j_slow};
use super::*;
use proptest::prelude::*;

/// W0, W1, T in f64; W0 = ∫ (1 - e^-τ) dt keeps its digits.
fn weights_slow(x: f64, y: f64) -> [f64; 3] {
    let w0 = integrate_depth(x, y, |_, tau| -(-tau).exp_m1());
    let opacity = -(-0.5 * (x + y)).exp_m1();
    // ∫ t τ'(t) e^-τ dt: positive, so without cancellation.
    let w1 = integrate_depth(x, y, |t, tau| t * (x + (y - x) * t) * (-tau).exp());
    assert!((w0 + w1 - opacity).abs() < 1e-10, "the quadrature itself is off at {x}, {y}");
    [w0, w1, 1.0 - opacity]
}

fn parts(weights: SegmentWeights) -> [f64; 3] {
    [weights.w0.into(), weights.w1.into(), weights.transmittance.into()]
}

/// The largest absolute error of w0, w1 and T over a grid of depths from 0 to 1e4.
fn worst_absolute(f: impl Fn(f32, f32) -> SegmentWeights) -> [f64; 3] {
    let mut worst = [0.0_f64; 3];
    for &x in &depths() {
        for &y in &depths() {
            let exact = weights_slow(x.into(), y.into());
            for (worst, (got, exact)) in worst.iter_mut().zip(parts(f(x, y)).into_iter().zip(exact)) {
                *worst = worst.max((got - exact).abs());
            }
        }
    }
    worst
}

#[test]
fn exact_weights_stay_within_1e_6_and_the_average_does_not() {
    let exact = worst_absolute(segment_weights);
    let average = worst_absolute(segment_weights_average);
    println!("absolute error of w0, w1, T: exact {exact:?}, average {average:?}");
    assert!(exact.iter().all(|&error| error < 1e-6), "{exact:?}");
    // The control: the same measure tells the approximation from the integral.
    assert!(average[0] > 0.4 && average[1] > 0.4 && average[2] < 1e-6, "{average:?}");
}

#[test]
fn thin_weights_keep_their_digits() {
    let (mut weight, mut opacity, mut transmittance) = (0.0_f64, 0.0_f64, 0.0_f64);
    for &x in &depths() {
        for &y in &depths() {
            if x + y > 0.0 && 0.5 * (x + y) <= THIN_LIMIT {
                let exact = weights_slow(x.into(), y.into());
                let got = segment_weights_thin(x, y);
                let [w0, w1, t] = parts(got);
                weight = weight.max((w0 / exact[0] - 1.0).abs()).max((w1 / exact[1] - 1.0).abs());
                opacity = opacity.max((f64::from(got.w0 + got.w1) / (exact[0] + exact[1]) - 1.0).abs());
                transmittance = transmittance.max((t / exact[2] - 1.0).abs());
            }
        }
    }
    println!("relative error, thin: weights {weight:.2e}, opacity {opacity:.2e}, T {transmittance:.2e}");
    assert!(weight < 1e-6 && opacity < 4e-7 && transmittance < 6e-7);
}

#[test]
fn an_empty_segment_adds_nothing() {
    let nothing = SegmentWeights { w0: 0.0, w1: 0.0, transmittance: 1.0 };
    assert_eq!(segment_weights_thin(0.0, 0.0), nothing);
    assert_eq!(segment_weights(0.0, 0.0), nothing);
    assert_eq!(segment_weights_average(0.0, 0.0), nothing);
}

#[test]
fn infinite_depth_is_opaque_and_nan_stays_nan() {
    for (x, y) in [(f32::INFINITY, f32::INFINITY), (f32::MAX, f32::MAX), (1e20, 0.0)] {
        let opaque = segment_weights(x, y);
        assert!((opaque.w0 - 1.0).abs() < 1e-6 && opaque.w1.abs() < 1e-6 && opaque.transmittance == 0.0, "{opaque:?}");
    }
    assert!(segment_weights(f32::NAN, 1.0).w0.is_nan());
}

#[test]
fn the_two_forms_meet_at_the_limit() {
    for k in 0..=400 {
        let x = 0.01 * k as f32;
        let (below, above) = (segment_weights(x, 3.999_999 - x), segment_weights(x, 4.000_002 - x));
        assert!(
            (below.w0 - above.w0).abs() < 1.5e-6 && (below.w1 - above.w1).abs() < 1.5e-6,
            "at {x}: {below:?} {above:?}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn random_segments(log_x in -8.0..4.0_f64, log_y in -8.0..4.0_f64) {
        let (x, y) = (10f64.powf(log_x) as f32, 10f64.powf(log_y) as f32);
        let got = parts(segment_weights(x, y));
        for (got, exact) in got.into_iter().zip(weights_slow(x.into(), y.into())) {
            prop_assert!((got - exact).abs() < 1e-6);
        }
        // Light of a colour that does not change is that colour times the opacity.
        prop_assert!((got[0] + got[1] - (1.0 - got[2])).abs() < 2e-7);
        prop_assert!((1.0 - got[0] - j_slow(x.into(), y.into())).abs() < 1e-6);
    }

    #[test]
    fn a_cut_segment_composes(x in 0.0..6.0_f32, y in 0.0..6.0_f32, cut in 0.01..0.99_f32) {
        // Front part, then back part seen through it, with colours 0 at entry and 1 at exit.
        let middle = x + (y - x) * cut;
        let whole = segment_weights(x, y);
        let front = segment_weights(x * cut, middle * cut);
        let back = segment_weights(middle * (1.0 - cut), y * (1.0 - cut));
        let light = front.w1 * cut + front.transmittance * (back.w0 * cut + back.w1);
        prop_assert!((whole.w1 - light).abs() < 2e-6);
        prop_assert!((whole.transmittance - front.transmittance * back.transmittance).abs() < 4e-7);
    }

    #[test]
    fn product_mean_is_the_integral(k0 in 0.0..9.0_f32, k1 in 0.0..9.0_f32, c0 in 0.0..1.0_f32, c1 in 0.0..1.0_f32) {
        let n = 2000;
        let slow = (0..n).map(|i| {
            let t = (f64::from(i) + 0.5) / f64::from(n);
            let mix = |a: f32, b: f32| f64::from(a) + (f64::from(b) - f64::from(a)) * t;
            mix(k0, k1) * mix(c0, c1)
        }).sum::<f64>() / f64::from(n);
        prop_assert!((f64::from(product_mean(k0, k1, c0, c1)) - slow).abs() < 1e-5);
    }
}
