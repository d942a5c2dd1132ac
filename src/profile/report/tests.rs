use std::time::Duration;

use super::*;

fn frame(view: u32, ms: f64, stages: &[(&'static str, u64)]) -> FrameRecord {
    let mut profile = Profile::default();
    for &(name, ms) in stages {
        let track = if name.starts_with("gpu") { Track::Gpu } else { Track::Frame };
        profile.add_beside(track, name, Duration::from_millis(ms), 100);
    }
    FrameRecord::new(view, ms, &profile)
}

fn report() -> Report {
    let frames = vec![
        frame(0, 10.0, &[("cull", 2), ("composite", 6), ("gpu_draw", 9)]),
        frame(1, 12.0, &[("cull", 2), ("sort", 1), ("composite", 6), ("gpu_draw", 9)]),
        frame(2, 20.5, &[("cull", 4), ("composite", 12), ("gpu_draw", 9)]),
    ];
    let mesh = MeshRecord { name: "m".to_owned(), cells: 6000, vertices: 9 };
    Report { program: Program::this(), machine: Machine::here(), mesh, frames, ..Report::default() }
}

#[test]
fn figures_are_those_of_the_frames() {
    let report = report();
    assert_eq!((report.frames_per_second(), report.cells_per_second()), (Some(1e3 / 12.0), Some(500_000.0)));
    let stages = report.stages();
    // Sort stands where the only frame that has it has it, and takes nothing in the others.
    assert_eq!(
        stages.iter().map(|stage| stage.name.as_str()).collect::<Vec<_>>(),
        ["cull", "sort", "composite", "gpu_draw"]
    );
    assert_eq!((stages[1].ms.median, stages[1].ms.most, stages[1].bytes, stages[0].bytes), (0.0, 1.0, 0, 100));
    assert_eq!(stages.iter().map(|stage| stage.track.is_frame()).collect::<Vec<_>>(), [true, true, true, false]);
    assert!((stages[2].share - 0.5).abs() < 1e-12);
    // What the GPU does meanwhile is no part of the frame.
    let other = report.other_ms().unwrap();
    assert!((other.median - 3.0).abs() < 1e-9 && (other.most - 4.5).abs() < 1e-9, "{other:?}");
    assert_eq!((Report::default().frame_ms(), Report::default().stages().len()), (None, 0));
}

#[test]
fn json_is_read_back_to_the_bit() {
    let mut report = report();
    report.frames[0].ms = 0.1 + 0.2;
    report.settings.insert("stop".to_owned(), 1e-5.into());
    report.warm_up = vec![report.frames[1].clone()];
    let text = report.to_json();
    assert_eq!(Report::from_json(&text).unwrap(), report);
    let value: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["figures"]["stages"][0]["name"], "cull");
    assert_eq!(value["frames"][0]["stages"][0], serde_json::json!({"name": "cull", "ms": 2.0, "bytes": 100}));
    assert_eq!(value["frames"][0]["stages"][2]["track"], "gpu");

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.json");
    report.save(&path).unwrap();
    assert_eq!(Report::load(&path).unwrap(), report);
}

#[test]
fn what_is_no_profile_is_refused() {
    let text = report().to_json();
    for (from, to, problem) in [
        ("cellfan profile 1", "cellfan profile 2", "says \"cellfan profile 2\""),
        ("\"ms\": 2.0", "\"ms\": -2.0", "negative"),
        ("\"frames\": [", "\"frames\": [7, ", "cannot be read"),
        ("\"frames\": [", "\"framed\": [", "cannot be read: missing field"),
        ("{\n", "", "cannot be read"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text);
        let error = Report::from_json(&changed).unwrap_err().to_string();
        assert!(error.starts_with("profile: ") && error.contains(problem), "{from}: {error}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.json");
    std::fs::write(&path, "[]").unwrap();
    let error = Report::load(&path).unwrap_err().to_string();
    assert!(error.contains("p.json: profile: it cannot be read"), "{error}");
    assert!(Report::load(folder.path().join("no.json")).unwrap_err().to_string().contains("no.json"));
}
