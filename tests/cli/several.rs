//! Several meshes on a command line, and files that name several.

use serde_json::json;

use super::{Place, npy};

/// A tetrahedron at `x`, with a point array `value` and more arrays of the cell.
fn tetrahedron(x: f64, value: &str, more: &str) -> String {
    let array =
        |kind: &str, name: &str, values: &str| format!("<DataArray type='{kind}' Name='{name}'>{values}</DataArray>");
    let points = format!("{x} 0 0 {} 0 0 {x} 1 0 {x} 0 1", x + 1.0);
    format!(
        "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='4' NumberOfCells='1'><Points>\
         <DataArray type='Float32' NumberOfComponents='3'>{points}</DataArray></Points><Cells>{}{}{}</Cells>\
         <PointData>{}</PointData><CellData>{more}</CellData></Piece></UnstructuredGrid></VTKFile>",
        array("Int32", "connectivity", "0 1 2 3"),
        array("Int32", "offsets", "4"),
        array("UInt8", "types", "10"),
        array("Float32", "value", value),
    )
}

/// A cell array of one value.
fn of_cell(name: &str, value: f64) -> String {
    format!("<DataArray type='Float32' Name='{name}'>{value}</DataArray>")
}

/// `a.vtu`, `b.vtu` and `c.vtu`, one cell each, side by side; only a and b have the array `own`.
fn three() -> Place {
    let place = Place::new();
    place.write("a.vtu", &tetrahedron(0.0, "0 1 0 0", &of_cell("own", 1.0)));
    place.write("b.vtu", &tetrahedron(2.0, "0 1 1 0", &of_cell("own", 2.0)));
    place.write("c.vtu", &tetrahedron(4.0, "1 1 0 0", ""));
    place
}

/// Each file in a block of its own, beside an empty one.
fn multi_block(files: &[&str]) -> String {
    let block = |file: &&str| format!("<Block><DataSet index='0' file='{file}'/><DataSet index='1'/></Block>");
    format!(
        "<VTKFile type='vtkMultiBlockDataSet' version='1.0'><vtkMultiBlockDataSet>{}</vtkMultiBlockDataSet></VTKFile>",
        files.iter().map(block).collect::<String>()
    )
}

#[test]
fn files_containers_and_multi_block_files_give_one_picture() {
    let place = three();
    place.write("all.vtm", &multi_block(&["a.vtu", "b.vtu", "c.vtu"]));
    place.write(
        "series.pvd",
        "<VTKFile type='Collection'><Collection><DataSet timestep='2' file='none.vtu'/>\
         <DataSet timestep='1' part='0' file='all.vtm'/></Collection></VTKFile>",
    );
    place.run("convert a.vtu b.vtu c.vtu all.cells".split(' ')).succeeds();
    place.run("convert b.vtu b.cells".split(' ')).succeeds();
    let draw = |meshes: &str, more: &str| {
        let arguments = format!("render {meshes} --size 60x40 --view -70,20 -o out.npy {more}");
        let ran = place.run(arguments.split_whitespace()).succeeds();
        (npy(&place.path("out.npy")).1, ran.err)
    };
    let (expected, note) = draw("a.vtu b.vtu c.vtu", "");
    assert!(note.contains("a.vtu, b.vtu, c.vtu: 3 cells; point array \"value\""), "{note}");
    assert!(expected.iter().filter(|&&value| value > 0.0).count() > 200, "blank");
    for meshes in
        ["all.vtm", "series.pvd", "all.cells", "a.vtu b.cells c.vtu", "c.vtu a.vtu b.vtu", "all.vtm --memory 1Gi"]
    {
        let (found, _) = draw(meshes, "");
        let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-6, "{meshes}: {off}");
    }
    // Without -o, the picture is called after the first.
    place.run("render b.vtu c.vtu --size 8x8".split(' ')).succeeds();
    assert!(place.names().contains(&"b.png".to_owned()), "{:?}", place.names());
}

#[test]
fn cells_without_a_value_are_not_drawn_and_that_is_said() {
    let place = three();
    let ran = place
        .run("render a.vtu b.vtu c.vtu --array own --size 40x30 -o out.png --stats stats.json".split(' '))
        .succeeds();
    for part in ["\"own\" (not in c.vtu)", "1 cell left out: a value of theirs is not finite"] {
        assert!(ran.err.contains(part), "{part:?} is not in {}", ran.err);
    }
    let stats: serde_json::Value = serde_json::from_slice(&place.read("stats.json")).unwrap();
    assert_eq!((&stats["cells"]["total"], &stats["cells"]["drawn"]), (&json!(3), &json!(2)));
    // An array that all have goes before one that some lack.
    place.write("d.vtu", &tetrahedron(6.0, "0 1 0 0", "").replace("'value'", "'other'"));
    place.write("e.vtu", &tetrahedron(8.0, "0 1 0 0", &of_cell("own", 3.0)).replace("'value'", "'third'"));
    let ran = place.run("render a.vtu e.vtu --size 8x8 -o out.png".split(' ')).succeeds();
    assert!(ran.err.contains("cell array \"own\""), "{}", ran.err);
    place.run("render a.vtu d.vtu --array none -q".split(' ')).fails(1, &["a.vtu, d.vtu", "value, own, other"]);
}

#[test]
fn info_describes_several_as_one() {
    let place = three();
    let one = place.run("info a.vtu --json".split(' ')).succeeds().json();
    assert_eq!((&one["file"], &one["files"][0]["file"]), (&json!("a.vtu"), &json!("a.vtu")));
    place.run("convert b.vtu b.cells".split(' ')).succeeds();
    let all = place.run("info a.vtu b.cells c.vtu --json".split(' ')).succeeds().json();
    assert_eq!((&all["file"], &all["points"], &all["cells"]), (&json!(null), &json!(12), &json!(3)));
    assert_eq!(all["files"][1], json!({ "file": "b.cells", "format": "cellfan container" }));
    assert_eq!(all["bounds"], json!({ "min": [0.0, 0.0, 0.0], "max": [5.0, 1.0, 1.0] }));
    assert_eq!(all["arrays"][1]["ranges"], json!([[1.0, 2.0]]));
    let text = place.run("info a.vtu c.vtu".split(' ')).succeeds().out;
    assert!(
        text.contains("a.vtu: VTK XML") && text.contains("c.vtu: VTK XML") && text.contains("8 points, 2 cells"),
        "{text}"
    );
    place.run("info b.cells a.vtu --check".split(' ')).fails(1, &["--check", "a.vtu", "no container"]);
}

#[test]
fn what_is_wrong_names_its_file_and_writes_nothing() {
    let place = three();
    place.write("index.vtu", &tetrahedron(0.0, "0 1 0 0", "").replace("0 1 2 3", "0 1 2 4"));
    place.write("nan.vtu", &tetrahedron(0.0, "0 1 0 0", "").replace("0 0 0 1 0 0 0 1 0", "0 0 0 1 nan 0 0 1 0"));
    place.write("half.vtu", &tetrahedron(0.0, "0 1 0 0", "")[..200]);
    place.write("missing.vtm", &multi_block(&["a.vtu", "gone.vtu"]));
    place.write("twice.vtm", &multi_block(&["a.vtu", "./a.vtu"]));
    place.write("self.vtm", &multi_block(&["a.vtu", "self.vtm"]));
    place.write("folder.vtm", &multi_block(&["."]));
    place.write("only.vtm", &multi_block(&["wall.vtp"]));
    place.run("convert b.vtu b.cells".split(' ')).succeeds();
    let before = place.names();
    for (meshes, parts) in [
        ("a.vtu index.vtu", vec!["index.vtu", "refers to point 4"]),
        ("a.vtu nan.vtu c.vtu", vec!["nan.vtu", "point 1 ", "not finite"]),
        ("a.vtu half.vtu", vec!["half.vtu"]),
        ("a.vtu none.vtu", vec!["none.vtu"]),
        ("a.vtu b.vtu ../a.vtu", vec!["../a.vtu"]),
        ("a.vtu c.vtu a.vtu", vec!["\"a.vtu\" is given twice"]),
        ("missing.vtm", vec!["gone.vtu"]),
        ("twice.vtm", vec!["twice.vtm", "earlier piece"]),
        ("self.vtm", vec!["self.vtm", "only meshes can stand here"]),
        ("folder.vtm", vec!["folder.vtm", "is no file"]),
        ("only.vtm", vec!["only.vtm", "no cell with a volume"]),
    ] {
        for verb in ["render", "convert", "info"] {
            let output = match verb {
                "render" => "-o out.png",
                "convert" => "out.cells",
                _ => "",
            };
            if (verb, meshes) == ("info", "only.vtm") {
                continue;
            }
            place.run(format!("{verb} {meshes} {output} -q").split_whitespace()).fails(1, &parts);
            assert_eq!(place.names(), before, "{verb} {meshes}");
        }
    }
    let budget = "render a.vtu b.cells -o out.png --memory 1Gi";
    place.run(budget.split(' ')).fails(1, &["--memory", "\"b.cells\"", "cellfan convert"]);
    assert_eq!(place.names(), before);
}
