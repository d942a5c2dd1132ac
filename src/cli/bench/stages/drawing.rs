//! What happens in pixels: the ray integral alone, and the tile compositor's stages within whole frames.

use std::hint::black_box;

use cellfan::optics::integral::segment_weights_average;
use cellfan::optics::{SegmentWeights, segment_weights, segment_weights_thin};
use cellfan::{RenderOptions, Renderer, Scene};
use rayon::prelude::*;

use super::seen::Seen;
use super::{Bench, Stage};
use crate::cli::bench::frames::Shots;
use crate::cli::bench::spread::Spread;
use crate::cli::bench::{Outcome, ensure, pool};

pub(super) fn run(bench: &mut Bench, seen: Seen) -> Outcome {
    // Function items, so that each gets a loop of its own into which it is inlined.
    integral(bench, "optics/integral/thin", 2.0, segment_weights_thin)?;
    integral(bench, "optics/integral", 20.0, segment_weights)?;
    integral(bench, "optics/integral/average", 20.0, segment_weights_average)?;
    frames(bench, seen)
}

/// Segments that a thread integrates at a time; their numbers stay in its nearest cache.
const CHUNK: usize = 1 << 10;
const SEGMENTS: usize = 1 << 20;

/// Optical depths at both ends of each segment, and its three weights.
struct Segments {
    ends: [Vec<f32>; 2],
    weights: [Vec<f32>; 3],
}

fn integral(
    bench: &mut Bench,
    name: &'static str,
    deepest: f32,
    kernel: impl Fn(f32, f32) -> SegmentWeights + Sync,
) -> Outcome {
    let depth = |i: usize| (i * 7919 % SEGMENTS) as f32 / SEGMENTS as f32 * deepest;
    let zeros = || vec![0.0_f32; SEGMENTS];
    let ends = [(0..SEGMENTS).map(depth).collect(), (0..SEGMENTS).map(|i| depth(SEGMENTS - i)).collect()];
    let work = |Segments { ends: [x, y], weights: [w0, w1, t] }: &mut Segments| {
        let ends = black_box(&*x).par_chunks(CHUNK).zip(y.par_chunks(CHUNK));
        let weights = w0.par_chunks_mut(CHUNK).zip(w1.par_chunks_mut(CHUNK)).zip(t.par_chunks_mut(CHUNK));
        ends.zip(weights).for_each(|((x, y), ((w0, w1), t))| {
            for ((((&x, &y), w0), w1), t) in x.iter().zip(y).zip(w0).zip(w1).zip(t) {
                let weights = kernel(x, y);
                (*w0, *w1, *t) = (weights.w0, weights.w1, weights.transmittance);
            }
        });
    };
    let check = |Segments { ends: [x, y], weights: [w0, w1, t] }: &Segments| {
        (0..SEGMENTS).step_by(61).try_for_each(|i| {
            let exact = (-0.5 * (f64::from(x[i]) + f64::from(y[i]))).exp();
            let is_near =
                (f64::from(t[i]) - exact).abs() < 1e-6 && (f64::from(w0[i] + w1[i]) - (1.0 - exact)).abs() < 1e-6;
            ensure(is_near, || format!("{name}: T({}, {}) is {}, not {exact}", x[i], y[i], t[i]))
        })
    };
    let segments = Segments { ends, weights: [zeros(), zeros(), zeros()] };
    let stage = Stage { name, unit: "segments", units: SEGMENTS as u64, bytes: SEGMENTS as u64 * 20 };
    bench.stage(stage, segments, |_| {}, work, check)
}

/// The stages of the tile compositor as its frames have them, and the whole frame.
const OF_FRAME: [(&str, &str); 5] = [
    ("project", "frame: project"),
    ("cull", "frame: cull"),
    ("footprints", "frame: footprints"),
    ("sort", "frame: sort"),
    ("composite", "frame: composite"),
];

fn frames(bench: &mut Bench, seen: Seen) -> Outcome {
    let Seen { dataset, field, transfer, view, .. } = seen;
    let cells = dataset.cells() as u64;
    let scene = Scene::new(dataset, field, &transfer);
    let options = RenderOptions::default();
    let shots = Shots { scene: &scene, name: "frames", size_px: view.size_px, options, runs: bench.session.runs(11) };
    for bandwidth in bench.bandwidths.clone() {
        let frames = pool(bandwidth.threads)?.install(|| shots.draw(bench.session, &mut Renderer::new(options)))?;
        for (stage, name) in OF_FRAME {
            let times_ms: Vec<f64> =
                frames.profiles.iter().filter_map(|frame| Some(frame.get(stage)?.duration_ms)).collect();
            if let (Some(median), false) = (frames.stages_ms.get(stage), times_ms.is_empty()) {
                let stage = Stage { name, unit: "cells", units: cells, bytes: median.bytes };
                bench.add(stage, bandwidth, Spread::of(times_ms));
            }
        }
        bench.add(Stage { name: "frame", unit: "cells", units: cells, bytes: 0 }, bandwidth, frames.time);
    }
    bench.progress.step();
    Ok(())
}
