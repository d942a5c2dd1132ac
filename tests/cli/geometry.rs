//! `--surface`, `--edges`, `--points`.

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
