//! Containers: `convert`, `generate -o mesh.cells`, `info --check`, and the same picture from both files.

use serde_json::json;

use super::Place;

/// A bent grid of 6 × 5 × 4 cells as a legacy file, structured or as a list of hexahedra, wedges, pyramids and tetrahedra.
fn grid(structured: bool) -> String {
    let index = |i: u32, j: u32, k: u32| i + 7 * (j + 6 * k);
    let all = (0..5).flat_map(|k| (0..6).flat_map(move |j| (0..7).map(move |i| [i, j, k])));
    let point = |[i, j, k]: [u32; 3]| {
        let [x, y, z] = [i, j, k].map(f64::from);
        format!("{} {} {}", x + 0.2 * (y + z).sin(), y + 0.1 * (x * z).sin(), z + 0.15 * (x + y).cos())
    };
    let points: Vec<String> = all.clone().map(point).collect();
    let values: Vec<String> = all.clone().map(|[i, j, k]| (i * j + 3 * k).to_string()).collect();
    let mut cells = Vec::new();
    for [i, j, k] in all.filter(|&[i, j, k]| i < 6 && j < 5 && k < 4) {
        let around = |k: u32| [index(i, j, k), index(i + 1, j, k), index(i + 1, j + 1, k), index(i, j + 1, k)];
        let ([a, b, c, d], [e, f, g, h]) = (around(k), around(k + 1));
        match (i + j + k) % 4 {
            0 => cells.extend([(13, vec![a, c, b, e, g, f]), (13, vec![a, d, c, e, h, g])]),
            1 => cells.extend([(14, vec![a, b, c, d, e]), (10, vec![e, g, f, b]), (10, vec![d, c, g, e])]),
            _ => cells.push((12, vec![a, b, c, d, e, f, g, h])),
        }
    }
    if structured {
        cells = vec![(12, Vec::new()); 6 * 5 * 4];
    }
    let dataset = if structured { "STRUCTURED_GRID\nDIMENSIONS 7 6 5" } else { "UNSTRUCTURED_GRID" };
    let count = cells.len();
    let mut lines = vec![format!("# vtk DataFile Version 3.0\ngrid\nASCII\nDATASET {dataset}\nPOINTS 210 double")];
    lines.extend(points);
    if !structured {
        let size: usize = cells.iter().map(|(_, corners)| corners.len() + 1).sum();
        lines.push(format!("CELLS {count} {size}"));
        for (_, corners) in &cells {
            let numbers = std::iter::once(corners.len() as u32).chain(corners.iter().copied());
            lines.push(numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(" "));
        }
        lines.push(format!("CELL_TYPES {count}"));
        lines.extend(cells.iter().map(|(code, _)| code.to_string()));
    }
    lines.push("POINT_DATA 210\nSCALARS value double 1\nLOOKUP_TABLE default".to_owned());
    lines.extend(values);
    lines.push(format!("CELL_DATA {count}\nSCALARS of_cell float 1\nLOOKUP_TABLE default"));
    lines.extend((0..count).map(|i| (i * 37 % 101).to_string()));
    // Every ninth cell is hidden.
    lines.push("SCALARS vtkGhostType unsigned_char 1\nLOOKUP_TABLE default".to_owned());
    lines.extend((0..count).map(|i| if i % 9 == 4 { "32".to_owned() } else { "0".to_owned() }));
    lines.join("\n") + "\n"
}

#[test]
fn whole_cells_make_the_same_picture_from_a_file_and_its_container() {
    let place = Place::new();
    for structured in [true, false] {
        std::fs::write(place.path("grid.vtk"), grid(structured)).unwrap();
        place.run(["convert", "grid.vtk", "grid.cells"]).succeeds();
        place.run(["info", "grid.cells", "--check"]).succeeds();
        let draw = |mesh: &str, how: &str| {
            let arguments = format!("render {mesh} --backend cpu --size 61x50 -o out.npy --stats stats.json {how}");
            place.run(arguments.split_whitespace()).succeeds();
            let stats: serde_json::Value = serde_json::from_slice(&place.read("stats.json")).unwrap();
            (place.read("out.npy"), stats["cells"].clone())
        };
        for what in [
            "--array value",
            "--array of_cell --view 70,-20",
            "--array value --model mip",
            "--array of_cell --model absorption",
        ] {
            let expected = draw("grid.vtk", what);
            assert!(expected.0.windows(4).any(|four| four != [0; 4]), "blank");
            for how in ["", "--threads 1", "--threads 3", "--no-mmap", "--memory 100M --threads 2"] {
                assert!(
                    draw("grid.cells", &format!("{what} {how}")) == expected,
                    "structured {structured}: {what} {how}"
                );
            }
        }
        // Other methods draw the same cells.
        for how in ["--cells tetrahedra", "--cpu-method fans", "--sort topological", "--check-order"] {
            let what = format!("--array of_cell {how}");
            let (expected, found) = (draw("grid.vtk", &what), draw("grid.cells", &what));
            assert_eq!(found.1["drawn"], expected.1["drawn"], "{what}");
            assert_eq!(found.1["total"], expected.1["total"], "{what}");
            let values = |npy: &[u8]| npyz::NpyFile::new(npy).unwrap().into_vec::<f32>().unwrap();
            let off = values(&found.0).iter().zip(values(&expected.0)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(off < 1e-4, "structured {structured}, {what}: {off}");
        }
    }
}

#[test]
fn convert_cuts_cells_where_it_is_told() {
    let place = Place::new();
    std::fs::write(place.path("grid.vtk"), grid(false)).unwrap();
    std::fs::write(place.path("blocks.vtk"), grid(true)).unwrap();
    for (mesh, of_mixed) in [("grid.vtk", true), ("blocks.vtk", false)] {
        place.run(["convert", mesh, "whole.cells"]).succeeds();
        place.run(["convert", mesh, "tetrahedra.cells", "--cells", "tetrahedra", "--adjacency"]).succeeds();
        let [file, whole, cut] =
            [mesh, "whole.cells", "tetrahedra.cells"].map(|name| place.run(["info", name, "--json"]).json());
        let names = |info: &serde_json::Value| {
            let kinds = info["kinds"].as_array().unwrap();
            kinds.iter().map(|kind| kind["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
        };
        let (expected, dims): (&[&str], _) = if of_mixed {
            (&["tetrahedron", "hexahedron", "wedge", "pyramid"], json!([]))
        } else {
            (&["hexahedron"], json!([[7, 6, 5]]))
        };
        assert_eq!(names(&whole), expected);
        assert_eq!(
            (names(&cut), &cut["drawn"]["tetrahedra"]),
            (vec!["tetrahedron".to_owned()], &file["drawn"]["tetrahedra"])
        );
        assert_eq!((&whole["dims"], &whole["counts"]["ghost"]), (&dims, &file["counts"]["ghost"]));
        assert_eq!(whole["counts"]["split"], json!(0));
        let drawn = &whole["drawn"];
        let drawn = drawn["tetrahedra"].as_u64().unwrap() + drawn["hexahedra"].as_u64().unwrap();
        let skipped = whole["skipped"].as_u64().unwrap() + whole["counts"]["degenerate"].as_u64().unwrap();
        assert_eq!(drawn + skipped, file["cells"].as_u64().unwrap());
        for (name, memory) in [("large.cells", "1Gi"), ("small.cells", "1")] {
            place.run(["convert", mesh, name, "--memory", memory]).succeeds();
            assert!(place.read(name) == place.read("whole.cells"), "{mesh}, {memory}");
        }
    }
    // Of tetrahedra both are the same file.
    place.run(["generate", "tets", "--cells", "3000", "-o", "tets.vtu"]).succeeds();
    place.run(["convert", "tets.vtu", "a.cells"]).succeeds();
    place.run(["convert", "tets.vtu", "b.cells", "--cells", "tetrahedra"]).succeeds();
    assert!(place.read("a.cells") == place.read("b.cells") && place.read("a.cells")[8] == 1, "version 1");
    assert_eq!(place.read("whole.cells")[8], 2);
}

/// The bytes of the column that `adjacency` of a container's directory, or of its hexahedra, points at.
fn adjacency_columns(container: &[u8]) -> Vec<std::ops::Range<usize>> {
    let word = |at: usize| u64::from_le_bytes(container[at..at + 8].try_into().unwrap()) as usize;
    let directory: serde_json::Value = serde_json::from_slice(&container[word(24)..][..word(32)]).unwrap();
    let span = |entry: &serde_json::Value| {
        let number = |name: &str| entry["adjacency"][name].as_u64().map(|number| number as usize);
        number("offset").zip(number("bytes")).map(|(offset, bytes)| offset..offset + bytes)
    };
    [&directory, &directory["hexahedra"]].into_iter().filter_map(span).collect()
}

#[test]
fn stored_neighbours_give_the_order_where_they_are_right() {
    let place = Place::new();
    std::fs::write(place.path("mixed.vtk"), grid(false)).unwrap();
    std::fs::write(place.path("block.vtk"), grid(true)).unwrap();
    place.run(["generate", "delaunay", "--cells", "3000", "-o", "tets.vtu"]).succeeds();
    let order = |mesh: &str, size: &str| {
        let arguments = format!("render {mesh} --sort topological --size {size} -o out.npy --stats stats.json");
        place.run(arguments.split_whitespace()).succeeds();
        let stats: serde_json::Value = serde_json::from_slice(&place.read("stats.json")).unwrap();
        let layers = stats["order"]["layers"].as_u64().unwrap();
        (place.read("out.npy"), layers, stats["order"]["adjacency"].as_str().unwrap().to_owned())
    };
    for (mesh, columns) in [("mixed.vtk", 2), ("tets.vtu", 1), ("block.vtk", 0)] {
        place.run(["convert", mesh, "without.cells"]).succeeds();
        place.run(["convert", mesh, "with.cells", "--adjacency"]).succeeds();
        place.run(["info", "with.cells", "--check"]).succeeds();
        let spans = adjacency_columns(&place.read("with.cells"));
        assert_eq!((spans.len(), adjacency_columns(&place.read("without.cells")).len()), (columns, 0), "{mesh}");
        let (expected, found) = (order("without.cells", "61x50"), order("with.cells", "61x50"));
        assert!((&expected.0, expected.1) == (&found.0, found.1), "{mesh}: another order");
        let origin = if columns > 0 { "stored" } else { "built" };
        assert_eq!((expected.2.as_str(), found.2.as_str()), ("built", origin), "{mesh}");

        let write_columns_of = |byte: u8| {
            let mut bytes = place.read("with.cells");
            for span in &spans {
                bytes[span.clone()].fill(byte);
            }
            std::fs::write(place.path("other.cells"), &bytes).unwrap();
        };
        if columns > 0 {
            // That there are no neighbours is believed: four rays alone relate cells, which leaves fewer layers.
            write_columns_of(0xff);
            let [some, all] = ["other.cells", "with.cells"].map(|mesh| order(mesh, "2x2"));
            assert!(some.2 == "stored" && some.1 < all.1, "{mesh}: {} of {} layers", some.1, all.1);
            // That cell 0 is everyone's is not.
            write_columns_of(0);
            let wrong = order("other.cells", "61x50");
            assert!((wrong.0, wrong.1, wrong.2.as_str()) == (expected.0, expected.1, "built"), "{mesh}");
            place.run(["info", "other.cells", "--check"]).fails(1, &["column adjacency", "checksum is wrong"]);
        }
    }
}

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
