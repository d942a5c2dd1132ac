//! `--method cubes`: a regular grid as cubes of its octree.

use super::{Place, npy};

fn place() -> Place {
    let place = Place::new();
    let line = "generate volume --dims 24x20x17 --signal buckyball -o v.nrrd -q";
    place.run(line.split_whitespace()).succeeds();
    place
}

fn render(place: &Place, more: &str) -> super::Ran {
    let line = format!("render v.nrrd -q --method cubes --size 64x48 --stats stats.json {more}");
    place.run(line.split_whitespace())
}

fn cells(place: &Place, key: &str) -> u64 {
    let stats: serde_json::Value = serde_json::from_slice(&place.read("stats.json")).unwrap();
    assert_eq!(stats["order"]["exactness"], "exact");
    stats["cells"][key].as_u64().unwrap()
}

#[test]
fn cubes_are_drawn_in_every_way_and_fewer_where_more_error_is_allowed() {
    let place = place();
    render(&place, "-o all.npy").succeeds();
    let all = cells(&place, "total");
    assert!(cells(&place, "drawn") > 100);
    let (shape, values) = npy(&place.path("all.npy"));
    assert_eq!(shape, [48, 64, 4]);
    assert!(values.iter().any(|&value| value > 0.1), "the picture is blank");
    let difference = |name: &str| {
        let (_, found) = npy(&place.path(name));
        values.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    render(&place, "-o fans.npy --cpu-method fans").succeeds();
    assert!(cells(&place, "drawn") > 0 && difference("fans.npy") < 2e-3);
    let mut last = all;
    for error in ["5%", "0.2", "48%"] {
        render(&place, &format!("-o coarse.npy --error {error}")).succeeds();
        let drawn = cells(&place, "drawn");
        assert!(drawn < last && difference("coarse.npy") > 0.0, "{error}: {drawn}");
        last = drawn;
    }
    for bound in [0.004, 0.1] {
        render(&place, &format!("-o bounded.npy --error-image {bound}")).succeeds();
        assert!(difference("bounded.npy") <= bound + 1e-4);
    }
    // The same view, frame after frame: finer each time.
    render(&place, "-o still.npy --budget-ms 10000 --frames 2 --orbit 0").succeeds();
    render(&place, "-o moving.png --budget-ms 5 --model mip").succeeds();
    // Values between points, and light, are other pictures.
    for more in ["--filter trilinear", "--shade", "--filter trilinear --strength --light 1,0,0:1,0.5,0.2"] {
        render(&place, &format!("-o other.npy {more}")).succeeds();
        assert!(difference("other.npy") > 0.01, "{more}");
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let place = place();
    for (more, message) in [
        ("--error -1", "share"),
        ("--error 10% --budget-ms 5", "--budget-ms"),
        ("--bands b.csv", "--bands"),
        ("--memory 1Gi", "--memory"),
        ("--surface", "--surface"),
        ("--filter b-spline", "trilinear"),
        ("--filter trilinear --error-image 0.1", "--error-image"),
        ("--filter trilinear --cpu-method fans", "footprints"),
        ("--shade --cpu-method fans", "footprints"),
        ("--shade --model mip", "--shade"),
        ("--shadows", "depth planes"),
    ] {
        let ran = render(&place, &format!("-o out.npy {more}"));
        assert!(ran.err.contains(message), "{more}: {}", ran.err);
        assert!(!place.path("out.npy").exists(), "{more}");
    }
    let ran = place.run("render v.nrrd -q -o out.npy --error 10%".split_whitespace());
    assert!(ran.err.contains("add --method cubes"), "{}", ran.err);
}
