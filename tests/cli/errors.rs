//! What goes wrong: the message, the exit code, and no file left behind.

use std::io::Read;
use std::process::{Command, Stdio};

use super::{Place, Ran};

#[test]
fn bad_usage_is_1_and_names_what_is_expected() {
    let place = Place::with_mesh();
    for (arguments, part) in [
        ("", "Usage"),
        ("draw", "unrecognized subcommand"),
        ("render", "MESH"),
        ("render mesh.vtu --colour", "unexpected argument"),
        ("render mesh.vtu --size 10", "WIDTHxHEIGHT"),
        ("render mesh.vtu --size 0x10", "1 to 32768"),
        ("render mesh.vtu --view north", "AZIMUTH,ELEVATION"),
        ("render mesh.vtu --background 0,0,255", "between 0 and 1"),
        ("render mesh.vtu --model fog", "emission-absorption"),
        ("render mesh.vtu --sort depth", "topological"),
        ("render mesh.vtu --stop 1", "below 1"),
        ("render mesh.vtu --frames 0", "--frames"),
        ("render mesh.vtu --orbit 90", "--frames"),
        ("render mesh.vtu --threads 0", "--threads"),
        ("render mesh.vtu --threads 100000", "--threads"),
        ("render mesh.vtu --camera a.json --view 0,0", "cannot be used with"),
        ("render mesh.vtu --sort exact --cpu-method fans", "footprints"),
        ("render mesh.vtu --sort topological --memory 1Gi", "--memory"),
        ("render mesh.vtu ./mesh.vtu", "given twice"),
        ("render mesh.vtu -o out.jpg", ".png, .exr or .npy"),
        ("render mesh.vtu --transfer jet", "viridis, inferno, cool-warm, x-ray"),
        ("generate cubes -o a.vtu", "buckyball"),
        ("generate tets -o a.vtk", ".vtu"),
        ("generate tets --jitter 1 -o a.vtu", "0.35"),
        ("generate orbital --orbital 1,1,0 -o a.vtu", "l < n"),
        ("generate orbital --orbital 1,1 -o a.vtu", "N,L,M"),
        ("generate tets --cells 0 -o a.vtu", "at least 1 cell"),
        ("completions csh", "bash"),
    ] {
        place.run(arguments.split_whitespace()).fails(1, &[part]);
        assert_eq!(place.names(), ["mesh.vtu"], "{arguments}");
    }
}

#[test]
fn missing_and_damaged_files_are_named() {
    let place = Place::with_mesh();
    place.write("text.vtu", "hello");
    let whole = place.read("mesh.vtu");
    std::fs::write(place.path("half.vtu"), &whole[..whole.len() / 2]).unwrap();
    place.write("bad.csv", "0 1 1 1 0\n1 1 1\n");
    place.write("bad.json", "{\"points\": 3}");
    place.write("cam.json", "{\"eye\": [0, 0, 0], \"target\": [0, 0, 0]}");
    let before = place.names();
    for (arguments, parts) in [
        ("render none.vtu", vec!["none.vtu"]),
        ("render .", vec!["folder"]),
        ("render text.vtu", vec!["text.vtu"]),
        ("render half.vtu", vec!["half.vtu"]),
        ("info none.vtu", vec!["none.vtu"]),
        ("info half.vtu", vec!["half.vtu"]),
        ("render mesh.vtu --transfer none.csv", vec!["none.csv"]),
        ("render mesh.vtu --transfer bad.csv", vec!["bad.csv", "line 2"]),
        ("render mesh.vtu --transfer bad.json", vec!["bad.json", "points"]),
        ("render mesh.vtu --camera none.json", vec!["none.json"]),
        ("render mesh.vtu --camera cam.json", vec!["cam.json", "same point"]),
        ("render mesh.vtu --array nothing", vec!["mesh.vtu", "\"nothing\"", "value, cell_value"]),
        ("render mesh.vtu --array value[3]", vec!["no component 3"]),
        ("render mesh.vtu -o no/such/out.png", vec!["there is no folder"]),
        ("render mesh.vtu --stats no/stats.json", vec!["there is no folder"]),
        ("generate tets -o no/a.vtu", vec!["there is no folder"]),
    ] {
        place.run(arguments.split_whitespace()).fails(1, &parts);
        assert_eq!(place.names(), before, "{arguments}");
    }
}

#[test]
fn a_file_is_kept_when_its_replacement_fails() {
    let place = Place::with_mesh();
    place.write("out.png", "old");
    place.render("-o out.png --array nothing").fails(1, &["nothing"]);
    assert_eq!(place.read("out.png"), b"old");
}

#[test]
fn no_device_is_2() {
    let place = Place::with_mesh();
    place.render("-o out.png --backend gpu").fails(2, &["no usable device", "--backend cpu"]);
    assert_eq!(place.names(), ["mesh.vtu"]);
    place.render("-o out.png --backend cpu").succeeds();
    let ran = place.render("-o out.png --backend auto").succeeds();
    assert!(!cfg!(feature = "gpu") || ran.err.contains("drawn on the CPU: no driver"), "{}", ran.err);
}

#[test]
fn a_closed_pipe_ends_quietly() {
    let place = Place::with_mesh();
    for arguments in [
        "completions bash",
        "completions zsh",
        "info mesh.vtu --json",
        "info mesh.vtu",
        "render mesh.vtu -o out.png -q --stats -",
        "--help",
        "render --help",
    ] {
        let mut child = place
            .command()
            .args(arguments.split_whitespace())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let mut err = String::new();
        child.stderr.take().unwrap().read_to_string(&mut err).unwrap();
        assert_eq!((child.wait().unwrap().code(), err.as_str()), (Some(0), ""), "{arguments}");
    }
}

#[test]
fn a_closed_stderr_does_not_keep_it_from_drawing() {
    let place = Place::with_mesh();
    let arguments = ["render", "mesh.vtu", "-o", "out.png", "--size", "32x32", "-vv"];
    let mut child = place.command().args(arguments).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(place.path("out.png").exists());
}

/// Runs a line of arguments with 1.5 GiB of address space.
#[cfg(unix)]
fn run_small(place: &Place, arguments: &str) -> Ran {
    let mut command = Command::new("sh");
    let program = env!("CARGO_BIN_EXE_cellfan");
    command.current_dir(place.path("")).env_remove("RUST_LOG");
    Ran::of(command.args(["-c", &format!("ulimit -v 1572864; exec '{program}' {arguments}")]).output().unwrap())
}

#[cfg(unix)]
#[test]
fn what_does_not_fit_into_memory_is_an_error() {
    let place = Place::with_mesh();
    for (arguments, parts) in [
        ("render mesh.vtu --size 30000x30000 -o out.png", ["30000x30000", "27.7 GiB"]),
        ("render mesh.vtu --size 30000x30000 --cpu-method fans -o out.exr", ["30000x30000", "27.7 GiB"]),
        ("render mesh.vtu --size 30000x30000 --frames 2 --orbit 9 -o out.npy", ["30000x30000", "27.7 GiB"]),
        ("generate tets --cells 1000000000 -o out.vtu", ["1000000000 cells", "74.5 GiB"]),
        ("generate delaunay --cells 1000000000 -o out.vtu", ["1000000000 cells", "74.5 GiB"]),
    ] {
        run_small(&place, arguments).fails(1, &parts);
        assert_eq!(place.names(), ["mesh.vtu"], "{arguments}");
    }
    run_small(&place, "render mesh.vtu --size 48x40 -o out.png").succeeds();
}
