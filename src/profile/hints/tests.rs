use std::time::Duration;

use super::super::Profile;
use super::*;

fn frame(view: u32, stages: &[(&'static str, f64)], other_ms: f64) -> FrameRecord {
    let mut profile = Profile::default();
    for &(name, ms) in stages {
        let track = if name.starts_with("gpu") { Track::Gpu } else { Track::Frame };
        profile.add_beside(track, name, Duration::from_secs_f64(ms * 1e-3), 0);
    }
    let in_frame = stages.iter().filter(|(name, _)| !name.starts_with("gpu"));
    FrameRecord::new(view, in_frame.map(|(_, ms)| ms).sum::<f64>() + other_ms, &profile)
}

fn report(frames: Vec<FrameRecord>) -> Report {
    Report { frames, ..Report::default() }
}

#[track_caller]
fn hint(report: &Report, topic: &str) -> String {
    let hints = report.hints();
    hints.iter().find(|hint| hint.topic == topic).unwrap_or_else(|| panic!("no {topic} in {hints:?}")).text.clone()
}

fn has(report: &Report, topic: &str) -> bool {
    report.hints().iter().any(|hint| hint.topic == topic)
}

/// A hundred frames alike but for a little.
fn steady() -> Vec<FrameRecord> {
    (0..100).map(|i| frame(i, &[("cull", 2.0), ("composite", 8.0 + 0.01 * f64::from(i % 5))], 0.1)).collect()
}

#[test]
fn steady_frames_have_no_outliers_and_no_slow_first_frame() {
    let report = report(steady());
    for topic in ["outliers", "first", "drift", "other", "gpu", "pixels", "threads", "build"] {
        assert!(!has(&report, topic), "{topic}: {:?}", report.hints());
    }
    assert!(hint(&report, "stage").starts_with(
        "79 % of the frame is composite (8.02 of 10.12 ms): were it twice as fast, the frame would be 1.66"
    ));
}

#[test]
fn outliers_are_counted_and_put_down_to_their_stage() {
    let mut frames = steady();
    frames[40] = frame(40, &[("cull", 12.0), ("composite", 9.0)], 0.1);
    frames[70] = frame(70, &[("cull", 2.0), ("composite", 14.0)], 0.1);
    let text = hint(&report(frames), "outliers");
    assert!(text.starts_with("2 of 100 frames took over 1.3 times as long"), "{text}");
    assert!(
        text.contains("frame 40, 21.10 ms instead of 10.1") && text.ends_with("10.00 ms more than usual of it in cull"),
        "{text}"
    );
}

#[test]
fn noise_is_no_outlier() {
    let mut frames = steady();
    for (i, frame) in frames.iter_mut().enumerate() {
        frame.ms *= if i % 2 == 0 { 1.0 } else { 1.35 };
    }
    assert!(!has(&report(frames), "outliers"));
}

#[test]
fn a_quarter_of_the_pixels_tells_fragments_from_cells() {
    let mut report = report(steady());
    let half =
        |composite: f64| [5, 50, 95].map(|view| frame(view, &[("cull", 2.0), ("composite", composite)], 0.1)).to_vec();
    // Composite is all pixels: 2.1 + 8 / 4.
    report.half_size = half(2.0);
    let text = hint(&report, "pixels");
    assert!(
        text.contains("0.41 times as long (composite 0.25 times) (median of 3 views): about 79 %")
            && text.contains("bound by fragments"),
        "{text}"
    );
    report.half_size = half(8.0);
    let text = hint(&report, "pixels");
    assert!(text.contains("about 0 %") && text.contains("bound by cells"), "{text}");
    report.half_size = half(5.0);
    assert!(hint(&report, "pixels").contains("both count"));
}

#[test]
fn who_waits_for_whom() {
    let of = |gpu_ms: f64, wait_ms: f64| {
        let stages = [("fans", 10.0 - wait_ms), ("wait_for_gpu", wait_ms), ("gpu_draw", gpu_ms)];
        hint(&report((0..9).map(|i| frame(i, &stages, 0.0)).collect()), "gpu")
    };
    assert!(
        of(9.0, 6.0)
            .starts_with("GPU-bound: passes take 90 % of the frame by the GPU's clock, and the program waits 60 %")
    );
    assert!(of(2.0, 0.5).starts_with("CPU-bound: passes take 20 %"));
    assert!(of(2.0, 6.0).starts_with("bound by handing over"));
}

#[test]
fn first_frame_drift_cells_and_the_rest() {
    let mut report = report((0..100).map(|i| frame(i, &[("composite", 10.0 + f64::from(i) / 10.0)], 3.0)).collect());
    report.warm_up = vec![frame(0, &[("adjacency", 50.0), ("composite", 11.0)], 3.0)];
    assert!(
        hint(&report, "first").contains("64.00 ms, 3.6 times")
            && hint(&report, "first").ends_with("50.00 ms of the difference in adjacency")
    );
    assert!(hint(&report, "drift").contains("the view is the same"));
    report.views.orbit_degrees = 360.0;
    let text = hint(&report, "drift");
    assert!(
        text.contains("13.20 ms around frame 0, 22.70 ms around frame 99")
            && text.contains("by the view, or by what else"),
        "{text}"
    );
    assert!(hint(&report, "other").starts_with("17 % of the frame (3.00 ms)"));
    assert!(!has(&report, "cells") && !has(&report, "memory"));
    for frame in &mut report.frames {
        (frame.drawn_cells, frame.covered_px) = (1500, 6000);
    }
    report.mesh.cells = 2000;
    assert_eq!(
        hint(&report, "cells"),
        "1,500 of 2,000 cells are drawn (75 %), on 6,000 pixels that show something: 0.25 cells a pixel"
    );
    (report.peak_rss_bytes, report.machine.threads) = (Some(2_000_000), 8);
    report.settings.insert("threads".to_owned(), 2.into());
    assert!(hint(&report, "memory").starts_with("the process held at most 2.0 MB"));
    assert!(hint(&report, "threads").starts_with("2 of 8 cores"));
}
