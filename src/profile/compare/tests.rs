use std::time::Duration;

use super::super::Profile;
use super::*;

/// Frames of an orbit: views differ by a factor of two, frames by 3 % of noise that lasts for some of them; `cull` takes a fifth
/// and is `cull_scale` times as long, the rest `scale` times.
fn report(seed: u64, frames: u32, scale: f64, cull_scale: f64) -> Report {
    let mut state = seed;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut noise = 0.0;
    let frame = |view: u32| {
        noise = 0.6 * noise + 0.08 * uniform();
        let ms = 15.0 - 5.0 * (f64::from(view) / f64::from(frames) * std::f64::consts::TAU).cos();
        let (cull, rest) = (0.2 * ms * cull_scale * (1.0 + noise), 0.8 * ms * scale * (1.0 + noise));
        let mut profile = Profile::default();
        profile.add("cull", Duration::from_secs_f64(cull * 1e-3), 0);
        profile.add("composite", Duration::from_secs_f64(rest * 1e-3), 0);
        FrameRecord::new(view, cull + rest, &profile)
    };
    Report { frames: (0..frames).map(frame).collect(), ..Report::default() }
}

fn names<'a>(changes: impl Iterator<Item = &'a Change>) -> Vec<&'a str> {
    changes.map(|change| change.name.as_str()).collect()
}

#[test]
fn nothing_changed_is_said_of_runs_that_differ_by_noise_alone() {
    let alarms = (0..40).filter(|&seed| {
        let comparison = Comparison::new(&report(2 * seed, 200, 1.0, 1.0), &report(2 * seed + 1, 200, 1.0, 1.0));
        comparison.beyond_noise().next().is_some()
    });
    // 5 % of 40 are 2.
    let alarms = alarms.count();
    assert!(alarms <= 6, "{alarms}");
}

#[test]
fn small_changes_are_seen_in_the_stage_that_changed() {
    let a = report(1, 200, 1.0, 1.0);
    let comparison = Comparison::new(&a, &report(2, 200, 1.0, 0.9));
    assert!(names(comparison.beyond_noise()).contains(&"cull"));
    let change = |name: &str| comparison.changes.iter().find(|change| change.name == name).unwrap();
    let Ratio { value, low, high } = change("cull").ratio.unwrap();
    assert!(low < 0.9 && 0.9 < high && (value - 0.9).abs() < 0.02, "{value} {low} {high}");
    assert!(!change("composite").is_beyond_noise());
    let text = comparison.to_string();
    assert!(
        text.contains("cull faster by ") && text.contains("composite") && text.contains("within the noise"),
        "{text}"
    );
    assert!(text.contains("same mesh, views") && text.contains("200 frames, compared view by view"), "{text}");
}

#[test]
fn views_cancel_where_they_are_the_same_and_not_elsewhere() {
    let (a, mut b) = (report(1, 200, 1.0, 1.0), report(2, 200, 1.05, 1.05));
    let width = |comparison: &Comparison| {
        let ratio = comparison.changes[0].ratio.unwrap();
        ratio.high - ratio.low
    };
    let paired = Comparison::new(&a, &b);
    b.views.orbit_degrees = 180.0;
    let other = Comparison::new(&a, &b);
    assert!(paired.is_paired && !other.is_paired);
    assert!(paired.changes[0].is_beyond_noise());
    assert!(width(&other) > 3.0 * width(&paired), "{} {}", width(&other), width(&paired));
    assert!(other.to_string().contains("differs: views.orbit_degrees: 0.0 -> 180.0"), "{other}");
}

#[test]
fn what_is_not_the_same_is_named() {
    let a = report(1, 20, 1.0, 1.0);
    let mut b = a.clone();
    b.mesh.cells = 1_000_000;
    b.machine.cpu = Some("another".to_owned());
    b.settings.insert("sort".to_owned(), "power".into());
    for frame in &mut b.frames {
        frame.stages.retain(|stage| stage.name != "cull");
        frame.stages[0].name = "draw".to_owned();
    }
    let comparison = Comparison::new(&a, &b);
    let text = comparison.to_string();
    for line in [
        "mesh.cells: 0 -> 1,000,000",
        "machine.cpu: none -> another",
        "settings.sort: none -> power",
        "only in a",
        "only in b",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    assert_eq!(names(comparison.changes.iter()), ["frame", "cull", "composite", "draw", "other"]);
    // The frames are the same to the bit.
    let ratio = comparison.changes[0].ratio.unwrap();
    assert_eq!((ratio.low, ratio.value, ratio.high), (1.0, 1.0, 1.0));
}

#[test]
fn few_frames_tell_nothing() {
    let comparison = Comparison::new(&report(1, 5, 1.0, 1.0), &report(2, 5, 2.0, 2.0));
    assert_eq!(comparison.changes[0].ratio, None);
    assert!(comparison.to_string().contains("nothing can be told from fewer than 8 frames"));
    let comparison = Comparison::new(&Report::default(), &Report::default());
    assert_eq!(comparison.changes[0].a_ms, None);
}
