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
        ("generate volume -o a.vtu", ".nrrd"),
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
