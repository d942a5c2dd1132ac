//! `render`: what it draws by default and as it is told.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::common::data_folder;
use super::{Place, covered, npy};

#[test]
fn without_options_a_picture_shows_something_and_stderr_says_what() {
    let place = Place::with_mesh();
    let ran = place.run(["render", "mesh.vtu"]).succeeds();
    assert_eq!(ran.out, "");
    for part in ["3,072 cells", "point array \"value\"", "viridis", "view 35,20", "order exact", "wrote mesh.png"] {
        assert!(ran.err.contains(part), "{part:?} is not in {}", ran.err);
    }
    let image = image::open(place.path("mesh.png")).unwrap();
    assert_eq!((image.width(), image.height()), (512, 512));
    let covered = covered(&place.path("mesh.png"));
    assert!((0.1..0.9).contains(&covered), "{covered}");
}

#[test]
fn every_model_and_method_draws() {
    let place = Place::with_mesh();
    for model in ["emission-absorption", "absorption", "emission", "mip"] {
        for method in ["footprints", "fans"] {
            place.render(&format!("-o out.png --model {model} --cpu-method {method}")).succeeds();
            let covered = covered(&place.path("out.png"));
            assert!((0.1..0.9).contains(&covered), "{model} {method}: {covered}");
        }
    }
    for more in [
        "--integral average",
        "--integral texture",
        "--sort none",
        "--sort centroid",
        "--sort power",
        "--sort topological",
        "--stop 0",
    ] {
        place.render(&format!("-o out.png {more}")).succeeds();
        assert!(covered(&place.path("out.png")) > 0.1, "{more}");
    }
}

#[test]
fn linear_formats_have_the_size_that_was_asked_for() {
    let place = Place::with_mesh();
    place.render("-o out.npy").succeeds();
    let (shape, values) = npy(&place.path("out.npy"));
    assert_eq!((shape, values.len()), (vec![40, 48, 4], 40 * 48 * 4));
    assert!(values.iter().all(|value| value.is_finite()) && values.iter().any(|&value| value > 0.1));
    place.render("-o out.exr").succeeds();
    let exr = image::open(place.path("out.exr")).unwrap().into_rgba32f();
    assert!(exr.iter().zip(&values).all(|(a, b)| a.to_bits() == b.to_bits()));
}

#[test]
fn frames_are_numbered_stacked_and_turned() {
    let place = Place::with_mesh();
    place.render("-o turn.png --frames 3 --orbit 90 --background 0,0,0").succeeds();
    assert_eq!(place.names(), ["mesh.vtu", "turn.0000.png", "turn.0001.png", "turn.0002.png"]);
    assert_ne!(place.read("turn.0000.png"), place.read("turn.0001.png"));

    place.render("-o turn.npy --frames 4 --orbit -90 --view 100,20").succeeds();
    let (shape, frames) = npy(&place.path("turn.npy"));
    assert_eq!(shape, [4, 40, 48, 4]);
    // Frame 0 is the view itself; frame 2 has turned by half of the angle about the centre.
    place.render("-o one.npy --view 100,20").succeeds();
    // A single frame is drawn by footprints, several by rays from cell to cell.
    let one = npy(&place.path("one.npy")).1;
    assert!(one.iter().zip(&frames).all(|(a, b)| (a - b).abs() < 1e-4));
    place.render("-o one.npy --view 100,20 --cpu-method rays").succeeds();
    assert_eq!(npy(&place.path("one.npy")).1, frames[..frames.len() / 4]);
    let middle = &frames[frames.len() / 2..frames.len() * 3 / 4];
    place.render("-o one.npy --view 55,20").succeeds();
    let turned = npy(&place.path("one.npy")).1;
    // The framing differs a little: the same view from another distance.
    let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
    assert!((mean(middle) / mean(&turned) - 1.0).abs() < 0.3, "{} {}", mean(middle), mean(&turned));

    place.render("-o single.png --frames 1").succeeds();
    assert!(place.path("single.0000.png").exists());
}

#[test]
fn stats_have_their_keys_and_their_cells_add_up() {
    let place = Place::with_mesh();
    place.render("-o out.png --frames 3 --stats stats.json --check-order --threads 2").succeeds();
    let stats: serde_json::Value = serde_json::from_slice(&place.read("stats.json")).unwrap();
    let keys: Vec<_> = stats.as_object().unwrap().keys().map(String::as_str).collect();
    let mut expected = vec![
        "cells",
        "triangles",
        "order",
        "stages",
        "frame_ms",
        "frames",
        "backend",
        "adapter",
        "threads",
        "peak_rss_bytes",
        "peak_anonymous_bytes",
        "memory_bytes",
        "size",
        "region",
        "geometry",
    ];
    expected.sort_unstable();
    let mut keys = keys;
    keys.sort_unstable();
    assert_eq!(keys, expected);
    let cells = &stats["cells"];
    let fates = ["drawn", "culled_transparent", "culled_outside", "degenerate", "invalid", "skipped"];
    let sum: u64 = fates.iter().map(|fate| cells[fate].as_u64().unwrap()).sum();
    assert_eq!((cells["total"].as_u64(), sum), (Some(3072), 3072));
    assert_eq!(stats["frames"].as_array().unwrap().len(), 3);
    assert_eq!((&stats["backend"], &stats["adapter"], &stats["threads"]), (&json!("cpu"), &json!(null), &json!(2)));
    assert!(stats["frame_ms"].as_f64().unwrap() > 0.0);
    assert!(stats["order"]["misordered_pairs"].is_u64());
    for stage in ["read", "order", "field", "write"] {
        assert!(stats["stages"][stage]["ms"].as_f64().unwrap() > 0.0, "{stage}: {}", stats["stages"]);
    }
    assert_eq!(
        stats["stages"]["read"]["bytes"].as_u64(),
        place.path("mesh.vtu").metadata().ok().map(|file| file.len())
    );

    let ran = place.render("-o out.png --stats - -q").succeeds();
    assert_eq!((ran.json()["cells"]["total"].as_u64(), ran.err.as_str()), (Some(3072), ""));
}

#[test]
fn the_picture_does_not_depend_on_the_number_of_threads() {
    let place = Place::new();
    // Several blocks of cells, whose sums must be added up in one order.
    place.run(["generate", "orbital", "--cells", "20000", "-o", "mesh.vtu"]).succeeds();
    for model in ["emission-absorption", "absorption", "emission", "mip"] {
        place.render(&format!("-o one.npy --model {model} --threads 1")).succeeds();
        place.render(&format!("-o two.npy --model {model} --threads 2")).succeeds();
        assert!(place.read("one.npy") == place.read("two.npy"), "{model}");
    }
}

#[test]
fn transfer_functions_from_files_and_presets() {
    let place = Place::with_mesh();
    place.write("tf.csv", "# value r g b extinction\n0 1 0 0 0\n1 1 0 0 50\n");
    let red =
        r#"{"value": 0, "color": [1, 0, 0], "extinction": 0}, {"value": 1, "color": [1, 0, 0], "extinction": 50}"#;
    place.write("tf.json", &format!("{{\"points\": [{red}]}}"));
    let draw = |more: &str| {
        place.render(&format!("-o out.npy {more}")).succeeds();
        npy(&place.path("out.npy")).1
    };
    let csv = draw("--transfer tf.csv");
    assert_eq!(csv, draw("--transfer tf.json"));
    let sum = |channel: usize| csv.iter().skip(channel).step_by(4).sum::<f32>();
    assert!(sum(0) > 10.0 && sum(1).to_bits() == 0 && sum(2).to_bits() == 0, "{} {} {}", sum(0), sum(1), sum(2));

    // Opacity per unit distance: half the distance, twice the extinction.
    place.write("tf.json", r#"{"points": [{"value": 0, "color": [1, 1, 1], "opacity": 0.01}]}"#);
    let depth = |pixels: &[f32]| -(1.0 - pixels[4 * (20 * 48 + 24) + 3]).ln();
    let (once, twice) = (draw("--transfer tf.json"), draw("--transfer tf.json --unit-distance 0.00866025"));
    assert!((depth(&twice) / depth(&once) - 2.0).abs() < 1e-3, "{} {}", depth(&once), depth(&twice));

    assert_ne!(draw("--transfer viridis"), draw("--transfer inferno"));
}

#[test]
fn cameras_from_files() {
    let place = Place::with_mesh();
    let camera =
        r#"{"eye": [4, 0.5, 0.5], "target": [0.5, 0.5, 0.5], "up": [0, 0, 1], "fov": 20, "width": 30, "height": 20}"#;
    place.write("cam.json", camera);
    place.run(["render", "mesh.vtu", "-o", "out.npy", "--camera", "cam.json"]).succeeds();
    assert_eq!(npy(&place.path("out.npy")).0, [20, 30, 4]);
    place.render("-o out.npy --camera cam.json").succeeds();
    assert_eq!(npy(&place.path("out.npy")).0, [40, 48, 4]);
    // Away from the mesh: a picture all the same, and a warning.
    place.write("cam.json", &camera.replace("\"target\": [0.5,", "\"target\": [9,"));
    let ran = place.render("-o out.npy --camera cam.json").succeeds();
    assert!(ran.err.contains("warning: no ray meets anything"), "{}", ran.err);
}

#[test]
fn arrays_by_name_component_and_place() {
    let place = Place::with_mesh();
    for (array, shown) in [("cell_value", "cell array"), ("point:value", "point array"), ("value[0]", "point array")] {
        let ran = place.render(&format!("-o out.png --array {array}")).succeeds();
        assert!(ran.err.contains(shown), "{}", ran.err);
    }
}

#[test]
fn cells_are_drawn_whole_or_split_as_they_are_told() {
    let Some(folder) = data_folder("cells_are_drawn_whole_or_split_as_they_are_told") else { return };
    let place = Place::with_mesh();
    let mesh = folder.join("unstructured/hexa.vtk").to_string_lossy().into_owned();
    let run = |more: &[&str]| place.run([&["render", &mesh, "-o", "out.png"], more].concat());
    let whole = run(&[]).succeeds();
    assert!(whole.err.contains("10,648 cells") && !whole.err.contains("split into tetrahedra"), "{}", whole.err);
    let split = run(&["--cells", "tetrahedra"]).succeeds();
    assert!(split.err.contains("10,648 cells split into tetrahedra"), "{}", split.err);
    for more in [&["--sort", "topological"][..], &["--check-order"], &["--cpu-method", "fans"]] {
        let whole = run(more).succeeds();
        assert!(!whole.err.contains("split into tetrahedra"), "{more:?}: {}", whole.err);
    }
    // The papers' triangles, which footprints have not.
    run(&["--faces", "fan"]).fails(1, &["--faces", "--cpu-method fans"]);
    run(&["--faces", "fan", "--cpu-method", "fans", "--stats", "s.json"]).succeeds();
    let stats: serde_json::Value = serde_json::from_slice(&place.read("s.json")).unwrap();
    let by_class = &stats["cells"]["by_class"];
    assert_eq!((by_class["count1"].as_u64(), by_class["class1"].as_u64()), (Some(10_648), Some(0)));
}

#[test]
fn every_file_that_can_be_drawn_is_not_blank() {
    let Some(folder) = data_folder("every_file_that_can_be_drawn_is_not_blank") else { return };
    let place = Place::new();
    let mut drawn = 0;
    for file in meshes(&folder) {
        let info = place.run(["info".as_ref(), file.as_os_str()]);
        if cellfan::io::open(&file).is_err() {
            continue;
        }
        info.succeeds();
        let arguments = ["render".as_ref(), file.as_os_str()].into_iter();
        let ran = place.run(arguments.chain(["-o", "out.png", "--size", "64x64"].map(OsStr::new))).succeeds();
        let covered = covered(&place.path("out.png"));
        assert!(covered > 0.01 && !ran.err.contains("no ray meets"), "{}: {covered}\n{}", file.display(), ran.err);
        drawn += 1;
    }
    assert!(drawn >= 30, "only {drawn} files were drawn");
}

/// Files that may be meshes, in the folders of `folder`.
fn meshes(folder: &Path) -> Vec<PathBuf> {
    let entries = |folder: &Path| std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let rooms = entries(folder).filter(|path| path.is_dir());
    let files = rooms.flat_map(|room| entries(&room).collect::<Vec<_>>());
    files
        .filter(|file| file.extension().is_some_and(|e| ["vtu", "vtk", "pvtu"].iter().any(|name| e == *name)))
        .collect()
}
