//! Prisms and polyhedra: generated, drawn, refused where they cannot be; `OpenFOAM` cases at their times.

use super::{Place, covered};

#[test]
fn polyhedra_are_generated_and_drawn() {
    let place = Place::new();
    for (kind, cells) in [("honeycomb", "35 cells"), ("voronoi", "30 cells")] {
        let ran = place.run(["generate", kind, "--cells", "30", "-o", "mesh.vtu"]).succeeds();
        assert!(ran.err.contains(cells), "{}", ran.err);
        for model in ["emission-absorption", "absorption", "emission", "mip"] {
            place.render(&format!("-o out.png --model {model}")).succeeds();
            assert!(covered(&place.path("out.png")) > 0.2, "{kind}, {model}");
        }
        place.render("-o out.png --surface=#ffffff --edges=#000000 --array cell_value").succeeds();
        let info = place.run(["info", "mesh.vtu", "--json"]).succeeds().json();
        assert_eq!(info["kinds"][0]["name"], "polyhedron", "{info}");
    }
    place.render("-o out.png --cells tetrahedra").succeeds();
    place.render("-o out.png --sort topological").fails(1, &["--sort", "exact"]);
    place.render("-o out.png --cpu-method fans --sort centroid").fails(1, &["--cpu-method", "tetrahedra"]);
    place.render("-o out.png --time 3").fails(1, &["mesh.vtu", "--time"]);
    place.run(["convert", "--cells", "tetrahedra", "mesh.vtu", "mesh.cells"]).succeeds();
}

/// The picture of a container is that of the file it was made of, to the byte.
#[test]
fn a_container_of_polyhedra_is_the_same_mesh() {
    let place = Place::new();
    for kind in ["honeycomb", "voronoi"] {
        place.run(["generate", kind, "--cells", "60", "-o", "mesh.vtu"]).succeeds();
        place.run(["convert", "mesh.vtu", "converted.cells"]).succeeds();
        place.run(["generate", kind, "--cells", "60", "-o", "generated.cells"]).succeeds();
        place.run(["convert", "--adjacency", "mesh.vtu", "other.cells"]).fails(1, &["--adjacency"]);
        for array in ["value", "cell_value"] {
            let picture = |mesh: &str| {
                let line = format!("render {mesh} --array {array} -o out.npy --size 60x40 --backend cpu");
                place.run(line.split_whitespace()).succeeds();
                std::fs::read(place.path("out.npy")).unwrap()
            };
            let expected = picture("mesh.vtu");
            assert!(
                picture("converted.cells") == expected && picture("generated.cells") == expected,
                "{kind}, {array}"
            );
        }
        let info = place.run(["info", "converted.cells", "--json", "--check"]).succeeds().json();
        assert_eq!(
            (&info["kinds"][0]["name"], info["kinds"][0]["code"].as_u64()),
            (&"polyhedron".into(), Some(42)),
            "{info}"
        );
    }
    place.run(["render", "converted.cells", "-o", "out.png", "--cells", "tetrahedra"]).succeeds();
}

#[test]
fn a_case_is_drawn_at_a_time() {
    let place = Place::new();
    let write = |name: &str, class: &str, body: &str| {
        let path = place.path("case").join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        let header = format!("FoamFile {{ version 2.0; format ascii; class {class}; }}");
        std::fs::write(path, format!("{header}\n{body}\n")).unwrap();
    };
    write("constant/polyMesh/points", "vectorField", "5((0 0 0)(1 0 0)(0 1 0)(0 0 1)(1 1 1))");
    let faces = "7(3(1 2 3) 3(0 2 1) 3(0 1 3) 3(0 3 2) 3(1 2 4) 3(2 3 4) 3(3 1 4))";
    write("constant/polyMesh/faces", "faceList", faces);
    write("constant/polyMesh/owner", "labelList", "7(0 0 0 0 1 1 1)");
    write("constant/polyMesh/neighbour", "labelList", "1(1)");
    write("0/p", "volScalarField", "internalField nonuniform List<scalar> 2(1 2);");
    write("0.5/p", "volScalarField", "internalField nonuniform List<scalar> 2(1 8);");
    std::fs::write(place.path("case/case.foam"), "").unwrap();
    for (mesh, more, range) in
        [("case", "", "1 to 8"), ("case/case.foam", "--time 0", "1 to 2"), ("case/0", "", "1 to 2")]
    {
        let line = format!("render {mesh} -o out.png --size 48x40 {more}");
        let ran = place.run(line.split_whitespace()).succeeds();
        assert!(ran.err.contains(range), "{mesh}: {}", ran.err);
        assert!(covered(&place.path("out.png")) > 0.05);
    }
    place.run("render case -o out.png --time 7".split(' ')).fails(1, &["--time", "0, 0.5"]);
    let info = place.run(["info", "case"]).succeeds().out;
    assert!(info.contains("2  tetrahedron"), "{info}");
}
