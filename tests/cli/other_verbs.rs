//! `info`, `generate`, `completions`, help and verbosity.

use serde_json::json;

use super::{Place, covered};

#[test]
fn info_says_what_is_in_a_file() {
    let place = Place::with_mesh();
    let ran = place.run(["info", "mesh.vtu", "--json"]).succeeds();
    let info = ran.json();
    assert_eq!(info["cells"], 3072);
    assert_eq!(info["points"], 9 * 9 * 9);
    assert_eq!(info["kinds"], json!([{ "name": "tetrahedron", "code": 10, "count": 3072 }]));
    assert_eq!(info["bounds"], json!({ "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 1.0] }));
    assert_eq!((&info["skipped"], &info["problem"]), (&json!(0), &json!(null)));
    assert_eq!(info["drawn"]["tetrahedra"], 3072);
    let arrays = info["arrays"].as_array().unwrap();
    let names: Vec<_> = arrays.iter().map(|array| (&array["name"], &array["association"])).collect();
    assert_eq!(names, [(&json!("value"), &json!("point")), (&json!("cell_value"), &json!("cell"))]);
    let [low, high] = [0, 1].map(|end| arrays[0]["ranges"][0][end].as_f64().unwrap());
    assert!(low >= 0.0 && high > 0.5, "{low} {high}");

    let text = place.run(["info", "mesh.vtu"]).succeeds().out;
    for part in ["VTK XML unstructured grid", "729 points, 3,072 cells", "tetrahedron", "value", "bounds"] {
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
}

#[test]
fn structured_grids_are_described_converted_and_drawn() {
    let place = Place::new();
    // Two blocks of PLOT3D text and the solution beside them.
    let dims = "2\n3 2 2\n2 2 2\n";
    let axis = |n: usize, of: fn(usize, usize) -> usize, row: usize| {
        (0..n).map(|point| format!("{} ", of(point, row))).collect::<Vec<_>>().concat()
    };
    let block = |n: usize, row: usize| {
        axis(n, |p, row| p % row, row) + &axis(n, |p, row| p / row % 2, row) + &axis(n, |p, row| p / row / 2, row)
    };
    place.write("two.xyz", &format!("{dims}{}{}", block(12, 3), block(8, 2)));
    let info = place.run(["info", "two.xyz", "--json"]).succeeds().json();
    assert_eq!((&info["format"], &info["arrays"]), (&json!("PLOT3D"), &json!([])));
    let values = |n: usize| "0 0 0 0 ".to_owned() + &(0..5 * n).map(|i| format!("{i} ")).collect::<Vec<_>>().concat();
    place.write("two.q", &format!("{dims}{}{}", values(12), values(8)));
    let info = place.run(["info", "two.xyz", "--json"]).succeeds().json();
    assert_eq!((&info["cells"], &info["dims"]), (&json!(3), &json!([[3, 2, 2], [2, 2, 2]])));
    assert_eq!(info["kinds"], json!([{ "name": "hexahedron", "code": 12, "count": 3 }]));
    assert_eq!(info["arrays"].as_array().map(Vec::len), Some(3));
    let text = place.run(["info", "two.xyz"]).succeeds().out;
    assert!(text.contains("block of 3 x 2 x 2 points") && text.contains("Momentum"), "{text}");

    place.run(["convert", "two.xyz", "two.cells"]).succeeds();
    for mesh in ["two.xyz", "two.cells"] {
        place.run(["render", mesh, "-o", "two.png", "--array", "Density", "--size", "32x32"]).succeeds();
        assert!(covered(&place.path("two.png")) > 0.1, "{mesh}");
    }
    place.run(["info", "two.q"]).fails(1, &["two.q", "PLOT3D solution"]);
    place.write("two.q", "2\n3 2 2\n2 2 3\n");
    place.run(["render", "two.xyz", "-o", "no.png"]).fails(1, &["two.q"]);
}

#[test]
fn info_on_a_surface_says_that_it_cannot_be_drawn() {
    let place = Place::new();
    place.write(
        "surface.vtk",
        "# vtk DataFile Version 3.0\nsurface\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\n\
         CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n",
    );
    let text = place.run(["info", "surface.vtk"]).succeeds().out;
    assert!(text.contains("triangle") && text.contains("cannot be drawn"), "{text}");
    let info = place.run(["info", "surface.vtk", "--json"]).succeeds().json();
    assert_eq!((&info["drawn"], &info["skipped"]), (&json!(null), &json!(1)));
    assert!(info["problem"].as_str().unwrap().contains("no cell with a volume"));
    place.run(["render", "surface.vtk"]).fails(1, &["surface.vtk", "no cell with a volume"]);
}

#[test]
fn generated_files_follow_their_options() {
    let place = Place::new();
    let generate = |name: &str, more: &str| {
        let arguments = format!("generate {more} -o {name}");
        place.run(arguments.split_whitespace()).succeeds();
        place.read(name)
    };
    for kind in ["tets", "buckyball", "orbital", "delaunay"] {
        let file = generate("a.vtu", &format!("{kind} --cells 400"));
        assert_eq!(file, generate("b.vtu", &format!("{kind} --cells 400 --threads 1")), "{kind}");
    }
    let file = generate("a.vtu", "delaunay --cells 400");
    assert_ne!(file, generate("b.vtu", "delaunay --cells 400 --seed 2"));
    assert_ne!(file, generate("b.vtu", "delaunay --cells 400 --no-fill"));
    let file = generate("a.vtu", "orbital --cells 400");
    assert_ne!(file, generate("b.vtu", "orbital --cells 400 --orbital 3,2,-1"));
    assert_ne!(file, generate("b.vtu", "orbital --cells 400 --scheme 5"));
    assert_ne!(file, generate("b.vtu", "orbital --cells 400 --jitter 0"));
    assert!(file.len() < generate("b.vtu", "orbital --cells 400 --raw").len());
    place.run(["render", "b.vtu", "--size", "16x16"]).succeeds();
}

#[test]
fn completions_for_every_shell() {
    let place = Place::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = place.run(["completions", shell]).succeeds().out;
        assert!(script.contains("cellfan") && script.contains("transfer"), "{shell}");
    }
}

#[test]
fn help_has_examples_and_version_a_number() {
    let place = Place::new();
    for verb in ["", "render", "info", "generate", "completions"] {
        let help = place.run(verb.split_whitespace().chain(["--help"])).succeeds().out;
        assert!(help.contains("Example"), "{verb}: {help}");
    }
    assert!(place.run(["--version"]).succeeds().out.starts_with("cellfan "));
}

#[test]
fn verbosity() {
    let place = Place::with_mesh();
    let lines = |flags: &str| place.render(flags).succeeds().err.lines().count();
    let (quiet, normal, verbose) = (lines("-q"), lines(""), lines("-v"));
    assert!(quiet == 0 && normal > 0 && verbose > normal, "{quiet} {normal} {verbose}");
    let filtered = place.command().args(["render", "mesh.vtu", "-v"]).env("RUST_LOG", "off").output().unwrap();
    assert!(filtered.status.success() && filtered.stderr.is_empty());
}
