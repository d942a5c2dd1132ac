//! `--region`: a part of the picture, the same values as in the whole.

use serde_json::json;

use super::{Place, npy};

/// Rows `y0..y1` and columns `x0..x1` of a picture of four channels, `width` pixels wide.
fn part(values: &[f32], width: usize, [x0, y0, x1, y1]: [usize; 4]) -> Vec<f32> {
    (y0..y1).flat_map(|y| values[4 * (y * width + x0)..4 * (y * width + x1)].to_vec()).collect()
}

#[test]
fn a_region_is_that_part_of_the_picture() {
    let place = Place::with_mesh();
    // 48x40 pixels.
    place.render("-o whole.npy").succeeds();
    let whole = npy(&place.path("whole.npy")).1;
    for more in ["", "--memory 1Gi", "--threads 1"] {
        for region in [[0, 0, 48, 40], [10, 5, 43, 37], [32, 0, 48, 32], [20, 20, 21, 21]] {
            let [x0, y0, x1, y1] = region;
            place.render(&format!("-o part.npy --region {x0},{y0},{x1},{y1} --stats stats.json {more}")).succeeds();
            let (shape, values) = npy(&place.path("part.npy"));
            assert_eq!(shape, [y1 - y0, x1 - x0, 4].map(|side| side as u64));
            assert!(values == part(&whole, 48, region), "{region:?} {more}: other values");
            let stats: serde_json::Value = serde_json::from_slice(&place.read("stats.json")).unwrap();
            assert_eq!((&stats["size"], &stats["region"]), (&json!([48, 40]), &json!(region)));
        }
    }
    let ran = place.render("-o part.png --region 0,0,20,10").succeeds();
    assert!(ran.err.contains("region 0,0,20,10 of 48x40"), "{}", ran.err);
    let image = image::open(place.path("part.png")).unwrap();
    assert_eq!((image.width(), image.height()), (20, 10));
}

#[test]
fn four_displays_show_one_picture() {
    let place = Place::with_mesh();
    let command = "render mesh.vtu -q --size 96x64 --model absorption --output depth --frames 2 --orbit 90";
    let draw = |more: &str| place.run(command.split_whitespace().chain(more.split_whitespace())).succeeds();
    draw("-o whole.npy");
    let whole = npy(&place.path("whole.npy")).1;
    let (of_frame, mut seen) = (96 * 64 * 4, 0);
    for [x0, x1] in [[0, 41], [41, 96]] {
        for [y0, y1] in [[0, 29], [29, 64]] {
            draw(&format!("-o part.npy --region {x0},{y0},{x1},{y1}"));
            let values = npy(&place.path("part.npy")).1;
            let both = whole.chunks(of_frame).flat_map(|frame| part(frame, 96, [x0, y0, x1, y1]));
            assert!(values == both.collect::<Vec<_>>());
            seen += values.len();
        }
    }
    assert_eq!(seen, whole.len());
}

#[test]
fn camera_files_may_name_a_region() {
    let place = Place::with_mesh();
    let camera = |more: &str| {
        let text = format!(r#"{{"eye":[3,2,1.5],"target":[0.5,0.5,0.5],"width":64,"height":32{more}}}"#);
        std::fs::write(place.path("cam.json"), text).unwrap();
    };
    let render =
        |more: &str| place.run("render mesh.vtu --camera cam.json -q -o".split(' ').chain(more.split_whitespace()));
    camera("");
    render("whole.npy").succeeds();
    render("given.npy --region 20,3,50,30").succeeds();
    camera(r#", "region": [20, 3, 50, 30]"#);
    render("named.npy").succeeds();
    assert_eq!(npy(&place.path("given.npy")).0, [27, 30, 4]);
    assert!(place.read("given.npy") == place.read("named.npy"));
    // The command line goes before the file.
    render("named.npy --region 0,0,64,32").succeeds();
    assert!(place.read("named.npy") == place.read("whole.npy"));
    render("small.npy --size 40x32").fails(1, &["--region", "beyond the picture of 40x32"]);
    camera(r#", "region": [20, 3, 65, 30]"#);
    render("bad.npy").fails(1, &["cam.json", "--region", "beyond"]);
}

#[test]
fn what_is_no_region_is_refused_before_the_mesh_is_read() {
    let place = Place::new();
    let render = |region: &str| place.run(["render", "none.vtu", "--size", "48x40", "--region", region]);
    for bad in ["", "0,0,5", "0,0,5,5,5", "-1,0,5,5", "0,0,x,5", "0,0,1.5,2", "0x0,5x5"] {
        render(bad).fails(1, &["--region", "X0,Y0,X1,Y1"]);
    }
    for (bad, why) in [
        ("0,0,49,40", "beyond the picture of 48x40"),
        ("0,40,1,41", "beyond the picture of 48x40"),
        ("5,5,5,9", "no pixel"),
        ("9,5,5,9", "no pixel"),
    ] {
        render(bad).fails(1, &["--region", why]);
    }
    assert!(place.names().is_empty());
}

#[test]
fn parts_of_the_largest_picture_take_the_memory_of_the_part() {
    let place = Place::with_mesh();
    let command = "render mesh.vtu --size 32768x32768 --memory 100M --stats stats.json -o part.npy --region";
    let draw = |region: &str| place.run(command.split_whitespace().chain([region]));
    for region in ["16384,16384,16484,16464", "32668,32688,32768,32768"] {
        draw(region).succeeds();
        assert_eq!(npy(&place.path("part.npy")).0, [80, 100, 4]);
        let stats: serde_json::Value = serde_json::from_slice(&place.read("stats.json")).unwrap();
        println!("{region}: {} ms, {} bytes", stats["frame_ms"], stats["peak_anonymous_bytes"]);
        assert!(stats["peak_anonymous_bytes"].as_u64().is_none_or(|peak| peak <= 100_000_000));
    }
    draw("0,0,32768,32768").fails(1, &["memory"]);
}

#[test]
fn profiles_name_the_region() {
    let place = Place::with_mesh();
    let command = "profile mesh.vtu --size 96x64 --region 32,16,81,63 --frames 4 --half-size 2 --stats p.json";
    let ran = place.run(command.split(' ')).succeeds();
    assert!(ran.out.contains("96x64 (region 32,16,81,63)"), "{}", ran.out);
    let report: serde_json::Value = serde_json::from_slice(&place.read("p.json")).unwrap();
    assert_eq!(report["views"]["camera"]["region"], json!([32, 16, 81, 63]));
    let covered = |list: &str| report[list][0]["covered_px"].as_u64().unwrap();
    assert!(covered("frames") > 100 && covered("frames") <= 49 * 47 && covered("half_size") <= 25 * 24);
}
