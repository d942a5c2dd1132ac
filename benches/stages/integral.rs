//! `optics/integral`: the weights of a segment.

use std::hint::black_box;

use cellfan::optics::integral::segment_weights_average;
use cellfan::optics::{SegmentWeights, segment_weights, segment_weights_thin};
use criterion::Criterion;

use crate::seen::throughput;

type Kernel = fn(f32, f32) -> SegmentWeights;

pub(crate) fn bench_integral(criterion: &mut Criterion) {
    const N: usize = 1 << 14;
    let depth = |i: usize, largest: f32| (i * 7919 % N) as f32 / N as f32 * largest;
    let mut group = criterion.benchmark_group("optics/integral");
    throughput(&mut group, N as u64, 20);
    // Function pointers would not inline: a macro makes a loop of each kernel.
    macro_rules! kernel {
        ($name:literal, $kernel:path, $largest:expr, $tolerance:expr) => {
            let _: Kernel = $kernel;
            let x: Vec<f32> = (0..N).map(|i| depth(i, $largest)).collect();
            let y: Vec<f32> = (0..N).map(|i| depth(N - i, $largest)).collect();
            let mut out = [vec![0.0_f32; N], vec![0.0; N], vec![0.0; N]];
            let mut stage = || {
                let [w0, w1, t] = &mut out;
                for ((((&x, &y), w0), w1), t) in black_box(&x).iter().zip(&y).zip(w0).zip(w1).zip(t) {
                    let weights = $kernel(x, y);
                    (*w0, *w1, *t) = (weights.w0, weights.w1, weights.transmittance);
                }
            };
            stage();
            group.bench_function($name, |b| b.iter(&mut stage));
            for i in 0..N {
                let exact = (-0.5 * (f64::from(x[i]) + f64::from(y[i]))).exp();
                assert!((f64::from(out[2][i]) - exact).abs() < $tolerance, "T({}, {})", x[i], y[i]);
                assert!((f64::from(out[0][i] + out[1][i]) - (1.0 - exact)).abs() < $tolerance);
            }
        };
    }
    kernel!("thin", segment_weights_thin, 2.0, 1e-6);
    kernel!("any_depth", segment_weights, 20.0, 1e-6);
    kernel!("average", segment_weights_average, 20.0, 1e-6);
}
