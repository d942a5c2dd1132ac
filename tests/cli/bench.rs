//! `bench`: small runs of every benchmark, their tables, their JSON and records; figures themselves are not judged.

use serde_json::Value;

use super::{Place, Ran};

/// Runs `bench` with `--quick`, one run that counts, and more arguments, in a line.
fn bench(place: &Place, line: &str) -> Ran {
    place.run(["bench"].into_iter().chain(line.split_whitespace()).chain(["--quick", "--runs", "2"]))
}

/// The record of a run, with what all have.
#[track_caller]
fn record(place: &Place, line: &str) -> Value {
    let record = bench(place, &format!("{line} --json -")).succeeds().json();
    let machine = &record["machine"];
    for key in ["cpu", "os", "architecture", "instruction_set"] {
        assert!(machine[key].as_str().is_some_and(|text| !text.is_empty()), "{key}: {machine}");
    }
    assert!(machine["threads"].as_u64() >= Some(1) && machine["memory_bytes"].as_u64() > Some(1 << 20), "{machine}");
    assert_eq!(record["benchmark"], line.split_whitespace().next().unwrap());
    let date = record["date"].as_str().unwrap();
    assert!(date.len() == 20 && date.starts_with("20") && date.ends_with('Z'), "{date}");
    assert_eq!((&record["is_quick"], &record["warm_up"]), (&Value::Bool(true), &1.into()));
    assert_eq!(record["left_out"].as_array().map(Vec::len), Some(0), "{}", record["left_out"]);
    record
}

fn rows<'a>(record: &'a Value, key: &str) -> &'a [Value] {
    record["results"][key].as_array().map_or(&[], Vec::as_slice)
}

/// Of two runs: positive, in order.
#[track_caller]
fn is_a_time(time: &Value) {
    let of = |key: &str| time[key].as_f64().unwrap_or(f64::NAN);
    let [low, high] = [0, 1].map(|i| time["quartiles_ms"][i].as_f64().unwrap_or(f64::NAN));
    assert_eq!(time["runs"], 2, "{time}");
    let in_order = [0.0, of("least_ms"), low, of("median_ms"), high];
    assert!(in_order[1] > 0.0 && in_order.is_sorted(), "{time}");
}

#[test]
fn sorts_are_compared_beside_the_papers() {
    let place = Place::new();
    let found = record(&place, "sort --threads 2 --max-keys 100000");
    let sorts = rows(&found, "rows");
    // Two sizes, three inputs, two routines on one thread and two on all.
    assert_eq!(sorts.len(), 2 * 3 * 4);
    for row in sorts {
        is_a_time(&row["time"]);
    }
    // One mesh: three steps by two ways, and one way that knows none.
    let views = rows(&found, "views");
    assert_eq!(views.len(), 3 * 2 + 1);
    for row in views {
        is_a_time(&row["sorting"]);
        assert!(row["cells"].as_u64() > Some(90_000), "{row}");
    }
    assert_eq!(found["results"]["paper"]["rows"][0]["seconds"][4], 755.56);
    assert_eq!(found["threads"], 2);

    let text = bench(&place, "sort --threads 1").succeeds().out;
    let line = text.lines().find(|line| line.contains("quicksort (CellFast)") && line.contains("sorted")).unwrap();
    assert!(line.contains("0.01") && line.contains("0.05"), "{line}");
    assert!(text.contains("radix::sort_local (ours)") && !text.contains("par_sort_unstable"), "{text}");
    // What the paper prints itself.
    let saved = text.lines().rfind(|line| line.contains("quicksort (CellFast)") && line.contains("random")).unwrap();
    assert!(saved.contains("75 %") && saved.contains("73 %"), "{saved}");
}

#[test]
fn frames_are_drawn_of_generated_and_of_given_meshes() {
    let place = Place::with_mesh();
    let found = record(&place, "cellfast --threads 2");
    let [row] = rows(&found, "rows") else { panic!("{found}") };
    is_a_time(&row["frames"]["time"]);
    assert_eq!((&row["paper"]["name"], &row["paper"]["megapixels_per_s"][2]), (&"phoenix".into(), &42.74.into()));
    assert_eq!(row["culled_share"], 0.0);
    let seconds = row["frames"]["time"]["median_ms"].as_f64().unwrap() * 1e-3;
    let rate = row["megapixels_per_s"].as_f64().unwrap();
    assert!((rate * seconds - 320.0 * 256.0 * 1e-6).abs() < 1e-9, "{rate}");

    // A share of the cells that is asked for is left out, of a mesh of its own.
    let found = record(&place, "cellfast mesh.vtu --culled 40 --size 64x48,48x64");
    let [row, other] = rows(&found, "rows") else { panic!("{found}") };
    let culled = row["culled_share"].as_f64().unwrap();
    assert!((culled - 0.4).abs() < 0.01, "{culled}");
    assert_eq!((&row["cells"], &row["paper"], &other["size_px"][0]), (&3072.into(), &Value::Null, &48.into()));
    let text = bench(&place, "cellfast mesh.vtu --transfer viridis --size 1280x1024").succeeds().out;
    assert!(text.contains("| mesh | 1280x1024 | CellFast |") && text.contains("3,072"), "{text}");
}

#[test]
fn hexahedra_are_counted_by_case() {
    let place = Place::new();
    let found = record(&place, "hexahedra --size 80x80 --max-cells 2000");
    let [shell, ball] = rows(&found, "rows") else { panic!("{found}") };
    assert_eq!(shell["counts"]["cells"], 300);
    assert!(shell["layers"].as_u64() > Some(10), "{shell}");
    let counts = &ball["counts"];
    let of = |key: &str| counts[key].as_u64().unwrap();
    let by_case: u64 = counts["by_case"].as_object().unwrap().values().filter_map(Value::as_u64).sum();
    assert_eq!(by_case + of("split") + of("edge_on") + of("absent"), of("cells"), "{counts}");
    assert!(by_case > 1000 && of("degenerate") > 100, "{counts}");
    is_a_time(&ball["classify"]);
    let max = &found["results"]["paper"]["figure_13"]["by_case"];
    assert_eq!((&max["count1"], &max["count1_c"], &max["count0"]), (&78_146.into(), &16.into(), &161.into()));

    place.run(["generate", "tets", "--cells", "100", "-o", "tets.vtu"]).succeeds();
    bench(&place, "hexahedra tets.vtu").fails(1, &["tets.vtu", "four corners"]);
}

#[test]
fn polyhedra_are_drawn_with_and_without_an_order() {
    let place = Place::new();
    let found = record(&place, "polyhedra --size 64x48 --cells 60");
    let all = rows(&found, "rows");
    // The search light alone is small, as both kinds and with both data; and two meshes of polyhedra.
    assert_eq!(all.len(), 2 * 2 + 2 * 2, "{found}");
    assert_eq!((&all[0]["paper"]["hexahedra"], &all[0]["paper"]["frames_per_s"]), (&1395.into(), &115.8.into()));
    assert!(all[0]["cells"].as_u64() > Some(1000), "{}", all[0]);
    for row in all {
        for model in ["emission", "mip", "emission_absorption"] {
            is_a_time(&row[model]["time"]);
        }
    }
    let text = bench(&place, "polyhedra --size 64x48 --cells 60").succeeds().out;
    assert!(text.contains("MIP : emission") && text.contains(" 1,395 |"), "{text}");
}

#[test]
fn frames_grow_with_cells_threads_and_pixels() {
    let place = Place::new();
    let found = record(&place, "scaling --max-cells 3000 --max-side 64 --threads 3 --folder .");
    let sizes =
        |key: &str, of: &str| -> Vec<u64> { rows(&found, key).iter().filter_map(|row| row[of].as_u64()).collect() };
    assert_eq!(sizes("by_cells", "cells"), [3072]);
    assert_eq!(sizes("by_threads", "threads"), [1, 2, 3]);
    assert_eq!(rows(&found, "by_pixels").len(), 1);
    for key in ["by_cells", "by_threads", "by_pixels"] {
        for row in rows(&found, key) {
            is_a_time(&row["frames"]["time"]);
        }
    }
    assert_eq!(place.names(), Vec::<String>::new(), "the meshes are gone");
    let ran = bench(&place, "scaling --max-cells 3000 --max-side 64 --time 1e-9").succeeds();
    assert!(ran.err.contains("left out"), "{}", ran.err);
}

#[test]
fn stages_are_set_against_the_memory() {
    let place = Place::new();
    let found = record(&place, "stages --cells 3000 --side 64 --threads 2");
    let bandwidths = rows(&found, "bandwidth");
    assert_eq!(bandwidths.iter().map(|of| of["threads"].as_u64().unwrap()).collect::<Vec<_>>(), [1, 2]);
    let stages = rows(&found, "rows");
    for name in [
        "project",
        "cull",
        "footprints/boxes",
        "footprints/planes",
        "sort/radix",
        "classify",
        "fans",
        "sort/topological",
    ] {
        assert_eq!(stages.iter().filter(|row| row["stage"] == name).count(), 2, "{name}");
    }
    for row in stages {
        is_a_time(&row["time"]);
        let of = |key: &str| row[key].as_f64().unwrap();
        assert!(
            (of("ns_per_unit") * of("units") * 1e-6 / row["time"]["median_ms"].as_f64().unwrap() - 1.0).abs() < 1e-9
        );
        let bandwidth = bandwidths.iter().find(|bandwidth| bandwidth["threads"] == row["threads"]).unwrap();
        let best = ["copy_gb_per_s", "triad_gb_per_s"].map(|key| bandwidth[key].as_f64().unwrap());
        let expected = of("gb_per_s") / best[0].max(best[1]);
        assert!((of("bandwidth_share") - expected).abs() <= 1e-9 * expected.abs(), "{row}");
    }
    let text = bench(&place, "stages --cells 3000 --side 64").succeeds().out;
    assert!(text.contains("| frame: composite") && text.contains("Memory bandwidth"), "{text}");
}

#[test]
fn records_of_a_day_stand_in_one_file() {
    let place = Place::new();
    for line in ["sort --max-keys 10000", "cellfast --size 32x32"] {
        let ran = bench(&place, &format!("{line} --record records --label trial")).succeeds();
        assert!(ran.err.contains("recorded in") && ran.out.contains("CellFast"), "{}", ran.err);
    }
    let [machine] = &names_in(&place.path("records"))[..] else { panic!("one machine") };
    let [day] = &names_in(&place.path("records").join(machine))[..] else { panic!("one day") };
    let path = format!("records/{machine}/{day}");
    let of_day: Value = serde_json::from_slice(&place.read(&path)).unwrap();
    assert_eq!(of_day.as_object().unwrap().keys().collect::<Vec<_>>(), ["cellfast", "sort"]);
    assert_eq!(of_day["sort"]["label"], "trial");

    // What is no record is not overwritten.
    place.write(&path, "[]");
    bench(&place, "sort --record records").fails(1, &[day, "no record of benchmarks"]);
    assert_eq!(place.read(&path), b"[]");
}

#[test]
fn commits_come_from_the_environment_and_what_does_not_fit_is_said() {
    let place = Place::new();
    let line = "bench sort --quick --runs 1 --max-keys 100000 --time 1e-9 --json out.json";
    let output = place.command().args(line.split_whitespace()).env("CELLFAN_COMMIT", "abc123").output().unwrap();
    let ran = Ran::of(output).succeeds();
    let found: Value = serde_json::from_slice(&place.read("out.json")).unwrap();
    if option_env!("CELLFAN_COMMIT").is_none() {
        assert_eq!(found["commit"], "abc123");
    }
    assert!(ran.err.contains("warning: left out: sorting 100,000 keys") && ran.err.contains("--time"), "{}", ran.err);
    assert!(found["left_out"][1].as_str().unwrap().contains("100,000 keys"), "{found}");
}

#[test]
fn wrong_use_is_refused_before_anything_runs() {
    let place = Place::new();
    bench(&place, "").fails(1, &["Usage"]);
    bench(&place, "sort --max-keys 10").fails(1, &["--max-keys"]);
    bench(&place, "sort --time 0").fails(1, &["--time", "positive"]);
    bench(&place, "sort --json nowhere/out.json").fails(1, &["nowhere"]);
    bench(&place, "cellfast none.vtu").fails(1, &["none.vtu"]);
    bench(&place, "cellfast --culled 96").fails(1, &["--culled"]);
}

fn names_in(folder: &std::path::Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn an_octree_is_measured_beside_the_papers() {
    let place = Place::new();
    let found = record(&place, "hierarchy --errors 0,18%,48%");
    let rows = rows(&found, "rows");
    assert_eq!(rows.len(), 3);
    let cubes: Vec<u64> = rows.iter().map(|row| row["cubes"].as_u64().unwrap()).collect();
    assert!(cubes[0] > cubes[1] && cubes[1] > cubes[2] && cubes[2] > 0, "{cubes:?}");
    for row in rows {
        for time in ["select_one_thread", "select", "footprints"] {
            is_a_time(&row[time]);
        }
        // Ten or twelve triangles a cube.
        let (cubes, triangles) = (row["cubes"].as_u64().unwrap(), row["triangles"].as_u64().unwrap());
        assert!((10 * cubes..=12 * cubes).contains(&triangles), "{row}");
    }
    is_a_time(&found["results"]["build"]);
    let ran = bench(&place, "hierarchy").succeeds();
    assert!(ran.out.contains("18 %") && ran.out.contains("5,200,000"), "{}", ran.out);
}
