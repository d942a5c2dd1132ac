//! `profile`: the table, its files, and `--compare`.

use serde_json::{Value, json};

use super::{Place, Ran};

/// Runs `profile mesh.vtu` at 48x40 pixels with more arguments, in a line.
fn profile(place: &Place, more: &str) -> Ran {
    place.run(["profile", "mesh.vtu", "--size", "48x40"].into_iter().chain(more.split_whitespace()))
}

fn read_json(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&place.read(name)).unwrap()
}

#[test]
fn table_and_files_tell_the_same() {
    let place = Place::with_mesh();
    let files = "--cpu-method footprints --frames 20 --orbit 90 --warm-up 2 --stats p.json --csv p.csv --plot p.png \
                 --trace t.json";
    let ran = profile(&place, files).succeeds();
    assert_eq!(place.names(), ["mesh.vtu", "p.csv", "p.json", "p.png", "t.json"]);
    let report = read_json(&place, "p.json");
    assert_eq!(
        [&report["frames"], &report["warm_up"], &report["half_size"]].map(|list| list.as_array().unwrap().len()),
        [20, 2, 5]
    );
    assert_eq!(report["views"]["orbit_degrees"], json!(90.0));
    assert_eq!(
        [&report["settings"]["backend"], &report["settings"]["model"]],
        [&json!("cpu"), &json!("emission-absorption")]
    );
    assert!(
        report["machine"]["cores"].as_u64().unwrap() >= 1 && report["program"]["version"] == env!("CARGO_PKG_VERSION")
    );

    // Frames sorted here, the nearest of the median on either side.
    let mut times: Vec<f64> =
        report["frames"].as_array().unwrap().iter().map(|frame| frame["ms"].as_f64().unwrap()).collect();
    let in_order = times.clone();
    times.sort_by(f64::total_cmp);
    let median = f64::midpoint(times[9], times[10]);
    let figures = &report["figures"];
    assert!((figures["frame_ms"]["median"].as_f64().unwrap() - median).abs() < 1e-9);
    assert_eq!([&figures["frame_ms"]["least"], &figures["frame_ms"]["most"]], [&json!(times[0]), &json!(times[19])]);
    assert!((figures["frames_per_second"].as_f64().unwrap() * median - 1e3).abs() < 1e-6);
    let cells = report["mesh"]["cells"].as_f64().unwrap();
    assert!((figures["cells_per_second"].as_f64().unwrap() * median / cells - 1e3).abs() < 1e-6);

    // The table has the same median, and a line for each stage; hints follow.
    assert!(ran.out.contains(&format!("{median:>10.3}")), "{}", ran.out);
    for stage in ["project", "cull", "footprints", "sort", "composite", "other"] {
        assert!(ran.out.lines().any(|line| line.starts_with(&format!("{stage} "))), "{stage}: {}", ran.out);
    }
    assert!(
        ran.out.contains("\n- ") && ran.out.contains("cells a pixel") && ran.out.contains("a quarter of the pixels"),
        "{}",
        ran.out
    );
    assert!(ran.err.contains("view 35,20") && ran.err.contains("wrote t.json"), "{}", ran.err);

    let csv = String::from_utf8(place.read("p.csv")).unwrap();
    assert!(csv.starts_with("frame,view,frame_ms,drawn_cells,covered_px,project_ms,cull_ms,"), "{csv}");
    let column: Vec<f64> = csv.lines().skip(1).map(|row| row.split(',').nth(2).unwrap().parse().unwrap()).collect();
    assert_eq!(column, in_order);

    let plot = image::open(place.path("p.png")).unwrap().into_rgba8();
    assert!(plot.pixels().any(|pixel| *pixel != *plot.get_pixel(0, 0)));
}

#[test]
fn trace_shows_workers_and_what_they_do() {
    let place = Place::with_mesh();
    let files = "--cpu-method footprints --frames 3 --warm-up 1 --half-size 1 --threads 2 --trace t.json --plot p.svg";
    profile(&place, files).succeeds();
    let trace = read_json(&place, "t.json");
    let events = trace["traceEvents"].as_array().unwrap();
    let spans = |name: &str| events.iter().filter(|e| e["ph"] == "X" && e["name"] == name).collect::<Vec<_>>();
    let views: Vec<u64> = spans("frame").iter().map(|e| e["args"]["view"].as_u64().unwrap()).collect();
    // The frame that does not count and three that do; the smaller pictures are left out.
    assert_eq!(views, [2, 0, 1, 2]);
    // 48x40 pixels are four tiles, the same in each frame.
    assert_eq!(spans("tile").len(), 4 * 4);
    for name in ["chunk", "cull", "footprints", "sort_keys", "sort", "composite", "project"] {
        assert!(!spans(name).is_empty(), "{name}");
    }
    // Chunks lie in frames.
    let frames: Vec<(f64, f64)> =
        spans("frame").iter().map(|e| (e["ts"].as_f64().unwrap(), e["dur"].as_f64().unwrap())).collect();
    for chunk in spans("chunk") {
        let ts = chunk["ts"].as_f64().unwrap();
        assert!(frames.iter().any(|&(start, duration)| start <= ts && ts <= start + duration));
    }
    let threads: Vec<&str> =
        events.iter().filter(|e| e["name"] == "thread_name").map(|e| e["args"]["name"].as_str().unwrap()).collect();
    assert!(threads.iter().any(|name| name.starts_with("worker ")), "{threads:?}");
    assert!(String::from_utf8(place.read("p.svg")).unwrap().contains("frames a second"));
}

#[test]
fn rays_from_cell_to_cell_are_profiled() {
    let place = Place::with_mesh();
    let ran = profile(&place, "--frames 3 --half-size 0 --threads 2 --trace t.json --stats p.json").succeeds();
    for stage in ["project", "entrances", "rays", "other"] {
        assert!(ran.out.lines().any(|line| line.starts_with(&format!("{stage} "))), "{stage}: {}", ran.out);
    }
    let trace = read_json(&place, "t.json");
    let names: Vec<_> =
        trace["traceEvents"].as_array().unwrap().iter().filter_map(|event| event["name"].as_str()).collect();
    for name in ["entrances", "rays", "project"] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
}

#[test]
fn runs_are_compared() {
    let place = Place::with_mesh();
    profile(&place, "--frames 12 --half-size 0 --stats a.json").succeeds();
    profile(&place, "--frames 12 --half-size 0 --sort centroid --stats b.json").succeeds();
    let ran = place.run(["profile", "--compare", "a.json", "b.json"]).succeeds();
    for part in [
        "a: a.json",
        "differs: settings.sort: auto -> centroid",
        "12 frames, compared view by view",
        "composite",
        "beyond the noise",
        "\nframe ",
    ] {
        assert!(ran.out.contains(part), "{part}: {}", ran.out);
    }
    // A run and itself with every time doubled: found, by exactly that.
    let mut doubled = read_json(&place, "a.json");
    for frame in doubled["frames"].as_array_mut().unwrap() {
        frame["ms"] = json!(2.0 * frame["ms"].as_f64().unwrap());
        for stage in frame["stages"].as_array_mut().unwrap() {
            stage["ms"] = json!(2.0 * stage["ms"].as_f64().unwrap());
        }
    }
    place.write("c.json", &doubled.to_string());
    let ran = place.run(["profile", "--compare", "a.json", "c.json"]).succeeds();
    assert!(
        ran.out.contains("2.000 to 2.000   slower by 100.0 %") && ran.out.contains("same mesh, views"),
        "{}",
        ran.out
    );
    let ran = place.run(["profile", "--compare", "c.json", "c.json"]).succeeds();
    assert!(ran.out.contains("nothing changed beyond the noise"), "{}", ran.out);
}

#[test]
fn json_on_stdout_takes_the_place_of_the_table() {
    let place = Place::with_mesh();
    let ran = profile(&place, "--frames 1 --warm-up 0 --half-size 0 --orbit 0 --stats -").succeeds();
    assert_eq!(ran.json()["format"], json!("cellfan profile 1"));
    assert_eq!(place.names(), ["mesh.vtu"]);
}

#[test]
fn what_cannot_be_is_refused_before_anything_is_drawn() {
    let place = Place::with_mesh();
    profile(&place, "--plot a.pdf").fails(1, &["a.pdf", ".svg or .png"]);
    profile(&place, "--csv no/a.csv").fails(1, &["no/a.csv", "there is no folder"]);
    profile(&place, "--frames 0").fails(1, &["--frames"]);
    profile(&place, "--output depth").fails(1, &["--output"]);
    profile(&place, "--compare a.json b.json").fails(1, &["cannot be used with"]);
    place.run(["profile", "--compare", "a.json", "b.json", "--sort", "none"]).fails(1, &["--sort"]);
    place.run(["profile", "--compare", "a.json", "b.json", "--edges"]).fails(1, &["--edges"]);
    place.run(["profile", "--compare", "a.json", "b.json", "--csv", "c.csv"]).fails(1, &["--csv"]);
    place.run(["profile", "--compare", "a.json", "b.json"]).fails(1, &["a.json"]);
    place.run(["profile"]).fails(1, &["MESH"]);
    place.write("a.json", "{\"frames\": []}");
    place.write("b.json", "no json");
    place
        .run(["profile", "--compare", "a.json", "a.json"])
        .fails(1, &["a.json", "its \"format\" says nothing", "--stats OUT.json"]);
    place.run(["profile", "--compare", "b.json", "b.json"]).fails(1, &["b.json", "cannot be read"]);
    assert_eq!(place.names(), ["a.json", "b.json", "mesh.vtu"]);
}

#[cfg(feature = "gpu")]
#[test]
fn a_gpu_has_its_passes_in_table_and_trace() {
    if super::gpus::gpus("a_gpu_has_its_passes_in_table_and_trace").is_empty() {
        return;
    }
    let place = Place::with_mesh();
    let mut command = place.command();
    command.env_remove("VK_DRIVER_FILES").args([
        "profile",
        "mesh.vtu",
        "--size",
        "48x40",
        "--backend",
        "gpu",
        "--frames",
        "3",
    ]);
    let ran = Ran::of(command.args(["--stats", "p.json", "--trace", "t.json"]).output().unwrap()).succeeds();
    let report = read_json(&place, "p.json");
    let stages = report["frames"][0]["stages"].as_array().unwrap().clone();
    let has_clock = stages.iter().any(|stage| stage["name"] == "gpu_draw");
    assert!(stages.iter().any(|stage| stage["name"] == "submit" && stage["track"] == "thread"));
    assert!(ran.out.contains("meanwhile, on the GPU or a thread of its own:\nsubmit "), "{}", ran.out);
    let trace = read_json(&place, "t.json");
    let events = trace["traceEvents"].as_array().unwrap();
    let on_gpu: Vec<&Value> = events.iter().filter(|e| e["ph"] == "X" && e["pid"] == 2).collect();
    assert_eq!(has_clock, !on_gpu.is_empty());
    // Three frames that do not count and three that do make a picture each.
    let pictures = on_gpu.iter().filter(|e| e["name"] == "gpu_resolve").count();
    assert_eq!(pictures, if has_clock { 6 } else { 0 });
    // No pass begins before the first submission, nor long after the last frame.
    let edge = |name: &str, end: f64| {
        let of = events.iter().filter(|e| e["ph"] == "X" && e["name"] == name);
        of.map(|e| e["ts"].as_f64().unwrap() + end * e["dur"].as_f64().unwrap())
            .fold([f64::MAX, f64::MIN], |[low, high], t| [low.min(t), high.max(t)])
    };
    for pass in on_gpu {
        let (begin, end) = (pass["ts"].as_f64().unwrap(), pass["ts"].as_f64().unwrap() + pass["dur"].as_f64().unwrap());
        assert!(begin >= edge("submit", 0.0)[0] && end <= edge("frame", 1.0)[1] + 1.0, "{pass}");
    }
}
