//! Containers: `convert`, `generate -o mesh.cells`, `info --check`, and the same picture from both files.

use serde_json::json;

use super::Place;

#[test]
fn the_same_picture_from_a_file_and_its_container() {
    let place = Place::with_mesh();
    place.run(["convert", "mesh.vtu", "mesh.cells"]).succeeds();
    let cases = [
        "--view 70,-20",
        "--array cell_value --view 10,80",
        "--model absorption",
        "--model mip --transfer cool-warm",
        "--sort centroid --cpu-method fans",
    ];
    for more in cases {
        let draw = |mesh: &str, how: &str| {
            let arguments = format!("render {mesh} --size 61x50 -o out.npy {how} {more}");
            place.run(arguments.split_whitespace()).succeeds();
            place.read("out.npy")
        };
        let expected = draw("mesh.vtu", "");
        assert!(expected.windows(4).any(|four| four != [0; 4]), "blank");
        for how in ["", "--threads 1", "--threads 3", "--no-mmap", "--memory 100M --threads 2"] {
            // Fans keep no budget.
            if how.contains("--memory") && more.contains("fans") {
                continue;
            }
            assert!(draw("mesh.cells", how) == expected, "{more} {how}");
        }
    }
}

#[test]
fn a_generated_container_is_a_converted_file() {
    let place = Place::new();
    for kind in ["tets", "orbital", "delaunay"] {
        for name in ["a.vtu", "a.cells"] {
            place.run(["generate", kind, "--cells", "20000", "-o", name]).succeeds();
        }
        place.run(["convert", "a.vtu", "b.cells"]).succeeds();
        assert!(place.read("a.cells") == place.read("b.cells"), "{kind}");
    }
    assert_eq!(place.names(), ["a.cells", "a.vtu", "b.cells"]);
}

#[test]
fn any_memory_gives_the_same_container() {
    let place = Place::new();
    place.run(["generate", "delaunay", "--cells", "20000", "-o", "mesh.vtu"]).succeeds();
    for (name, memory) in [("large.cells", "1Gi"), ("small.cells", "1"), ("other.cells", "300k")] {
        place.run(["convert", "mesh.vtu", name, "--memory", memory]).succeeds();
        assert!(place.read(name) == place.read("large.cells"), "{memory}");
    }
    assert_eq!(place.names(), ["large.cells", "mesh.vtu", "other.cells", "small.cells"]);
}

#[test]
fn info_reads_a_container_and_checks_it() {
    let place = Place::with_mesh();
    place.run(["convert", "mesh.vtu", "mesh.cells"]).succeeds();
    let both = ["mesh.vtu", "mesh.cells"].map(|name| place.run(["info", name, "--json"]).succeeds().json());
    for key in ["points", "cells", "kinds", "bounds", "arrays", "counts", "skipped", "problem"] {
        assert_eq!(both[0][key], both[1][key], "{key}");
    }
    assert_eq!(both[1]["format"], json!("cellfan container"));
    let ran = place.run(["info", "mesh.cells", "--check"]).succeeds();
    assert!(ran.err.contains("9 columns"), "{}", ran.err);

    let mut bytes = place.read("mesh.cells");
    bytes[1000] ^= 4;
    std::fs::write(place.path("mesh.cells"), &bytes).unwrap();
    place.run(["info", "mesh.cells"]).succeeds();
    place.run(["info", "mesh.cells", "--check"]).fails(1, &["mesh.cells", "checksum is wrong"]);
    place.run(["info", "mesh.vtu", "--check"]).fails(1, &["--check", "no container"]);
}

#[test]
fn what_cannot_be_converted_says_so_and_leaves_nothing() {
    let place = Place::with_mesh();
    place.run(["convert", "mesh.vtu", "mesh.vtk"]).fails(1, &["mesh.vtk", ".cells"]);
    place.run(["convert", "mesh.vtu", "no/mesh.cells"]).fails(1, &["no folder"]);
    place.run(["convert", "missing.vtu", "mesh.cells"]).fails(1, &["missing.vtu"]);
    let mut bytes = place.read("mesh.vtu");
    bytes.truncate(bytes.len() / 2);
    std::fs::write(place.path("half.vtu"), &bytes).unwrap();
    place.run(["convert", "half.vtu", "mesh.cells"]).fails(1, &["half.vtu"]);
    assert_eq!(place.names(), ["half.vtu", "mesh.vtu"]);

    place.run(["convert", "mesh.vtu", "mesh.cells"]).succeeds();
    place.run(["convert", "mesh.cells", "again.cells"]).fails(1, &["a container already"]);
    let bytes = place.read("mesh.cells");
    std::fs::write(place.path("mesh.cells"), &bytes[..bytes.len() - 1]).unwrap();
    place.run(["render", "mesh.cells"]).fails(1, &["mesh.cells", "header", "not the"]);
    assert_eq!(place.names(), ["half.vtu", "mesh.cells", "mesh.vtu"]);
}
