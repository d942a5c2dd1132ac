//! `--surface`, `--edges`, `--points`; `--mesh`, `--composite`, `--depth`.

#![expect(clippy::float_cmp, reason = "opaque is exactly 1")]

use serde_json::json;

use super::{Place, npy};

#[test]
fn surface_edges_and_points_are_drawn_and_counted() {
    let place = Place::with_mesh();
    for more in
        ["--surface", "--edges=#ff0000 --line-px 2", "--points=0,0.5,1 --point-px 1", "--surface --edges --points"]
    {
        for method in ["footprints", "fans"] {
            let ran = place.render(&format!("-o out.npy {more} --cpu-method {method} --stats -")).succeeds();
            let geometry = &ran.json()["geometry"];
            let drawn = |name: &str| geometry[name].as_u64().unwrap();
            let asked = |option: &str| more.contains(option);
            assert_eq!(drawn("triangles") > 0, asked("--surface"), "{geometry}");
            assert_eq!(drawn("lines") > 0, asked("--edges"), "{geometry}");
            assert_eq!(drawn("points") > 0, asked("--points"), "{geometry}");
            assert_eq!(drawn("bytes"), 36 * drawn("triangles") + 24 * drawn("lines") + 12 * drawn("points"));
            assert_eq!(geometry["uploaded_bytes"], json!(0));
            let (_, pixels) = npy(&place.path("out.npy"));
            let opaque = pixels.chunks(4).filter(|pixel| pixel[3] > 0.999_999).count();
            assert!(opaque > 20, "{more}: {opaque}");
        }
    }
}

#[test]
fn a_surface_shows_its_back_unless_all_of_it_is_asked_for() {
    let place = Place::with_mesh();
    let image = |more: &str| {
        place.render(&format!("-o out.npy {more}")).succeeds();
        npy(&place.path("out.npy")).1
    };
    let [volume, back, all] = ["", "--surface", "--surface --surface-faces all"].map(image);
    let at = |image: &[f32]| [0, 1, 2].map(|k| image[(20 * 48 + 24) * 4 + k]);
    // C60 stands in the middle: seen before its wall, hidden by the near ones, which are grey.
    assert_ne!(at(&volume).map(f32::to_bits), at(&back).map(f32::to_bits));
    let [r, g, b] = at(&all);
    assert!(r < g && g < b && b - r < 0.1, "{r} {g} {b}");
}

#[test]
fn bad_colours_and_widths_are_refused() {
    let place = Place::with_mesh();
    for (option, part) in [
        ("--surface=red", "#rrggbb"),
        ("--edges=#12345", "#rrggbb"),
        ("--points=2,0,0", "between 0 and 1"),
        ("--edges --line-px 0", "1 to 64 pixels"),
        ("--points --point-px 65", "1 to 64 pixels"),
        ("--surface --surface-faces front", "back"),
    ] {
        place.render(&format!("-o out.png {option}")).fails(1, &[part]);
    }
    assert_eq!(place.names(), ["mesh.vtu"]);
}

#[test]
fn triangles_of_files_are_drawn_beside_the_volume() {
    let place = Place::with_mesh();
    place.write("wall.obj", "v -99 -99 0\nv 99 -99 0\nv 0 99 0\nf 1 2 3\n");
    place.write("other.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 1\nendloop\nendfacet\nendsolid\n");
    let ran = place.render("-o out.npy --mesh wall.obj=#ff0000 --mesh other.stl --surface --stats -").succeeds();
    assert!(ran.json()["geometry"]["triangles"].as_u64().unwrap() > 2);
    let ran = place.render("-o out.npy --mesh wall.obj=#ff0000 --mesh other.stl --stats -").succeeds();
    assert_eq!(ran.json()["geometry"]["triangles"], json!(2));
    let (_, pixels) = npy(&place.path("out.npy"));
    let red = pixels.chunks(4).filter(|pixel| pixel[0] > 0.2 && pixel[1] < 0.01 && pixel[3] > 0.999_999).count();
    assert!(red > 100, "{red}");
    place.write("bad.obj", "f 1 2 3\n");
    for (option, parts) in [
        ("--mesh bad.obj", vec!["bad.obj", "line 1", "no such position"]),
        ("--mesh none.stl", vec!["none.stl"]),
        ("--mesh mesh.vtu", vec!["mesh.vtu", "no STL, PLY or OBJ"]),
        ("--mesh wall.obj=red", vec!["wall.obj=red", "after FILE="]),
    ] {
        place.render(&format!("-o bad.png {option}")).fails(1, &parts);
    }
    assert!(!place.names().contains(&"bad.png".to_owned()));
}

#[test]
fn pictures_are_composited_by_depth_and_chained() {
    let place = Place::with_mesh();
    place.render("-o walls.npy --surface --depth walls.exr").succeeds();
    place.render("-o walls.png --surface --depth walls.vol").succeeds();
    let image = |more: &str| {
        place.render(&format!("-o out.npy {more}")).succeeds();
        npy(&place.path("out.npy")).1
    };
    let close = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    let [plain, walls] = ["", "--surface"].map(image);
    // The volume stands twice before the walls: once in the picture.
    let twice = image("--composite walls.exr --depth again.exr");
    assert!(close(&plain, &twice) > 0.1 && close(&walls, &twice) > 1e-3);
    // Cells end at the walls, whatever their colour is: black by default.
    let black = image("--composite walls.vol");
    let left = black.chunks(4).zip(walls.chunks(4)).zip(plain.chunks(4));
    let dark = left.filter(|((black, walls), plain)| walls[3] == 1.0 && black[3] == 1.0 && black[0] <= plain[0] + 1e-5);
    assert!(dark.count() > 100);
    let painted = image("--composite walls.vol --composite-color walls.png");
    assert!(close(&painted, &black) > 0.1);
    assert_eq!(place.read("again.exr")[..4], [0x76, 0x2f, 0x31, 0x01]);

    std::fs::write(place.path("cut.vol"), &place.read("walls.vol")[..500]).unwrap();
    std::fs::write(place.path("wrong.vol"), b"wrong").unwrap();
    for (options, parts) in [
        ("--composite none.exr", vec!["none.exr", "(Vol's error 105)"]),
        ("--composite cut.vol", vec!["cut.vol", "(Vol's error 104)"]),
        ("--composite wrong.vol", vec!["wrong.vol", "(Vol's error 101)"]),
        ("--composite .", vec!["(Vol's error 100)"]),
        ("--depth out.png", vec!["out.png", ".exr"]),
        ("--composite walls.vol --frames 2", vec!["--frames"]),
        ("--composite-color walls.png", vec!["--composite"]),
    ] {
        place.render(&format!("-o bad.png {options}")).fails(1, &parts);
    }
    let other_size = "render mesh.vtu -o bad.png --size 48x41 --composite walls.vol";
    place.run(other_size.split(' ')).fails(1, &["walls.vol", "48x40", "48x41", "(Vol's error 102)"]);
    assert!(!place.names().contains(&"bad.png".to_owned()));
}

#[cfg(feature = "gpu")]
#[test]
fn a_gpu_is_sent_geometry_once_for_all_frames() {
    if super::gpus::gpus("a_gpu_is_sent_geometry_once_for_all_frames").is_empty() {
        return;
    }
    let place = Place::with_mesh();
    let mut command = place.command();
    command.env_remove("VK_DRIVER_FILES").args(["render", "mesh.vtu", "--size", "48x40", "-o", "out.npy"]);
    let ran = super::Ran::of(
        command.args("--backend gpu --surface --edges --frames 4 --stats -".split(' ')).output().unwrap(),
    );
    let stats: serde_json::Value = ran.succeeds().json();
    assert_eq!(stats["geometry"]["uploaded_bytes"], stats["geometry"]["bytes"]);
    assert!(stats["geometry"]["bytes"].as_u64().unwrap() > 10_000);
}
