//! Volumes: generated, described, drawn and converted; raw samples by `--raw`.

use serde_json::json;

use super::{Place, covered};

#[test]
fn volumes_are_generated_described_drawn_and_converted() {
    let place = Place::new();
    place.run(["generate", "volume", "--cells", "500", "--raw", "-o", "a.nrrd"]).succeeds();
    let info = place.run(["info", "a.nrrd", "--json"]).succeeds().json();
    assert_eq!((&info["format"], &info["cells"], &info["dims"]), (&json!("NRRD"), &json!(512), &json!([[9, 9, 9]])));
    assert_eq!(info["lattice"]["spacing"], json!([0.125, 0.125, 0.125]));
    assert_eq!(info["lattice"]["directions"], json!([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]));
    assert_eq!(info["bounds"], json!({ "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 1.0] }));
    assert_eq!(info["kinds"], json!([{ "name": "voxel", "code": 11, "count": 512 }]));
    let array = &info["arrays"][0];
    assert_eq!(
        (&array["name"], &array["type"], &array["ranges"]),
        (&json!("value"), &json!("u8"), &json!([[0.0, 255.0]]))
    );
    assert_eq!((&info["drawn"]["hexahedra"], &info["drawn"]["memory_bytes"]), (&json!(512), &json!(0)), "in place");
    let whole = place.run(["info", "a.nrrd", "--json", "--no-mmap"]).succeeds().json();
    assert_eq!(whole["drawn"]["memory_bytes"], 729);
    let text = place.run(["info", "a.nrrd"]).succeeds().out;
    assert!(
        text.contains("block of 9 x 9 x 9 points") && text.contains("spacing: 0.125 x 0.125 x 0.125, origin (0, 0, 0)"),
        "{text}"
    );

    place.run(["convert", "a.nrrd", "a.cells"]).succeeds();
    for arguments in ["a.nrrd", "a.cells", "a.nrrd --no-mmap", "a.nrrd --cells tetrahedra"] {
        let arguments = format!("render {arguments} -o a.png --backend cpu --size 48x40");
        place.run(arguments.split_whitespace()).succeeds();
        assert!(covered(&place.path("a.png")) > 0.1, "{arguments}");
    }
    for (arguments, part) in [
        ("generate volume -o a.vtu", ".nrrd or .cells"),
        ("generate volume --dims 1x2x2 -o b.nrrd", "--dims"),
        ("generate volume --dims 1x2 -o b.nrrd", "256x256x110"),
        ("generate volume --cells 0 -o b.nrrd", "at least 1 cell"),
        ("generate volume --signal orbital --orbital 1,1,0 -o b.nrrd", "l < n"),
    ] {
        place.run(arguments.split_whitespace()).fails(1, &[part]);
    }
    place.run("generate volume --dims 9x7x5 --signal orbital --samples f32 -o b.nrrd".split_whitespace()).succeeds();
    let info = place.run(["info", "b.nrrd", "--json"]).succeeds().json();
    assert_eq!((&info["dims"], &info["arrays"][0]["type"]), (&json!([[9, 7, 5]]), &json!("f32")));
}

#[test]
fn containers_of_volumes_are_drawn_in_place_as_the_volumes_are() {
    let place = Place::new();
    let generate = "generate volume --dims 21x18x15 --signal buckyball -o";
    for name in ["v.nrrd", "generated.cells"] {
        place.run(format!("{generate} {name}").split_whitespace()).succeeds();
    }
    place.run(["convert", "v.nrrd", "converted.cells"]).succeeds();
    for name in ["generated.cells", "converted.cells"] {
        let checked = place.run(["info", name, "--check"]).succeeds();
        assert!(checked.err.contains("all right"), "{}", checked.err);
        for (way, more) in [("cubes", "--error 10%"), ("cubes", "--filter trilinear --shade"), ("depth-planes", "")] {
            let draw = |file: &str, out: &str| {
                let line = format!("render {file} --method {way} {more} --size 40x32 --backend cpu -q -o {out}");
                place.run(line.split_whitespace()).succeeds();
                place.read(out)
            };
            assert!(draw("v.nrrd", "a.npy") == draw(name, "b.npy"), "{name} {way} {more}");
            assert!(draw(&format!("{name} --no-mmap"), "c.npy") == place.read("a.npy"), "{name} {way} {more}");
        }
        // As cells too, as every container.
        place.run(format!("render {name} --shade -q -o cells.png --size 40x32").split_whitespace()).succeeds();
        assert!(covered(&place.path("cells.png")) > 0.1);
    }
    // A container of something else has no regular grid.
    place.run("generate tets --cells 50 -o t.cells -q".split_whitespace()).succeeds();
    place.run("render t.cells --method cubes -o t.png".split_whitespace()).fails(1, &["regular grid"]);
}

#[test]
fn raw_samples_need_their_layout() {
    let place = Place::new();
    let samples: Vec<u8> = (0..3 * 4 * 5_u16).flat_map(|i| (i * 11).to_be_bytes()).collect();
    std::fs::write(place.path("a.raw"), [b"head".as_slice(), &samples].concat()).unwrap();
    std::fs::write(place.path("b"), samples).unwrap();
    place.run(["info", "a.raw"]).fails(1, &["a.raw", "--raw 256x256x110:u8", ".nhdr"]);
    for (file, layout) in [("a.raw", "3x4x5:u16be@4"), ("b", "3x4x5:u16be")] {
        let info = place.run(["info", "--raw", layout, "--spacing", "1,1,-2.5", file, "--json"]).succeeds().json();
        assert_eq!((&info["format"], &info["cells"]), (&json!("raw volume"), &json!(24)));
        assert_eq!(info["bounds"], json!({ "min": [0.0, 0.0, -10.0], "max": [2.0, 3.0, 0.0] }));
        assert_eq!(info["arrays"][0]["ranges"], json!([[0.0, 59.0 * 11.0]]));
        place.run(["render", "--raw", layout, file, "-o", "a.png", "--backend", "cpu", "--size", "48x40"]).succeeds();
        assert!(covered(&place.path("a.png")) > 0.1);
    }
    place.run(["convert", "--raw", "3x4x5:u16be", "b", "b.cells"]).succeeds();
    for (arguments, parts) in [
        ("info a.raw --raw 3x4x6:u16be", vec!["a.raw", "144 bytes", "124"]),
        ("info a.raw --raw 3x4:u16", vec!["256x256x110:u8"]),
        ("info a.raw --spacing 1,1,1", vec!["--raw"]),
        ("info a.raw --raw 3x4x5:u8 --spacing 1,0,1", vec!["one place"]),
        ("info a.raw b --raw 3x4x5:u8", vec!["--raw", "one file"]),
        ("info none.raw --raw 3x4x5:u8", vec!["none.raw"]),
        ("render a.raw --raw 4294967296x4294967296x4:u8 -o c.png", vec!["a.raw", "cannot be"]),
    ] {
        place.run(arguments.split_whitespace()).fails(1, &parts);
    }
    let longer = place.run("info b --raw 3x4x4:u16be".split_whitespace()).succeeds();
    assert!(longer.err.contains("24 bytes follow"), "{}", longer.err);
}
