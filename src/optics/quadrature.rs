//! The slow twin of the ray integrals: composite Gauss-Legendre quadrature in f64. For tests.

/// Nodes and weights of the 5-point Gauss-Legendre rule on [-1, 1].
const GAUSS: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// ∫₀¹ f(τ(t)) dt in f64, on panels that shrink towards t = 0, where all the light of a thick segment is lost.
pub(super) fn integrate_depth(x: f64, y: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
    let tau = |t: f64| x * t + 0.5 * (y - x) * t * t;
    let mut ends: Vec<f64> = (0..=160).map(|k| 2f64.powf(-0.25 * f64::from(k))).collect();
    ends.push(0.0);
    ends.windows(2)
        .map(|end| {
            let (middle, half) = (0.5 * (end[0] + end[1]), 0.5 * (end[0] - end[1]));
            GAUSS
                .iter()
                .map(|&(node, weight)| weight * half * f(middle + half * node, tau(middle + half * node)))
                .sum::<f64>()
        })
        .sum()
}

pub(super) fn j_slow(x: f64, y: f64) -> f64 {
    integrate_depth(x, y, |_, tau| (-tau).exp())
}

/// Depths from 0 to 1e4, dense where something happens.
pub(super) fn depths() -> Vec<f32> {
    let mut depths = vec![0.0];
    depths.extend((0..150).map(|k| 1e-7 * 10f32.powf(11.0 * k as f32 / 149.0)));
    depths.extend((1..100).map(|k| 0.08 * k as f32));
    depths
}
