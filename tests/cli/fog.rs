//! Ground fog: pictures and flights, checked against all points of the terrain, and what is refused.

use super::Place;

const SMALL: &str = "--points 65 --size 96x72 --backend cpu";

fn fog(place: &Place, arguments: &str) -> super::Ran {
    place.run(["fog"].into_iter().chain(SMALL.split(' ')).chain(arguments.split(' ')))
}

#[test]
fn a_flight_is_checked_against_all_points() {
    let place = Place::new();
    let ran = fog(&place, "--frames 3 --part 0.03 --start 0.3 --check --stats stats.json -o flight.png").succeeds();
    assert!(ran.err.contains("of 3 frames") && ran.err.contains("0 pixels of sky in the ground"), "{}", ran.err);
    assert_eq!(place.names(), ["flight.0000.png", "flight.0001.png", "flight.0002.png", "stats.json"]);
    let text = std::fs::read_to_string(place.path("stats.json")).unwrap();
    let stats: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&stats["backend"], stats["frames"].as_array().unwrap().len()), (&"cpu".into(), 3));
    let check = &stats["fog"]["check"];
    assert_eq!((check["frames"].as_array().unwrap().len(), &check["most"]["holes_px"]), (3, &0.into()));
    let most = check["most"]["difference"].as_f64().unwrap();
    assert!(most > 0.0 && most < 2.0 && check["most"]["popping"].as_f64() > Some(0.0), "{check}");
    // Two triangles for mountains are too few.
    let ran = fog(&place, "--tolerance 1000 --check -o coarse.png");
    assert!(ran.code == Some(1) && ran.err.contains("error: wrong answer: frame 0 differs"), "{}", ran.err);
    fog(&place, "--full --check -o full.png").fails(1, &["--check"]);
}

#[test]
fn fog_is_seen_from_a_camera_file() {
    let place = Place::new();
    place.write("cam.json", r#"{"eye":[5,5,4],"target":[5,5.5,0],"up":[0,0,1],"fov":40,"width":40,"height":30}"#);
    let ran = place.run("fog --points 33 --backend cpu --camera cam.json --stats - -o a.png".split(' ')).succeeds();
    assert_eq!(ran.json()["size"], serde_json::json!([40, 30]));
    place.run("fog --camera cam.json --frames 3 -o a.png".split(' ')).fails(1, &["--camera"]);
    place.run("fog --camera none.json -o a.png".split(' ')).fails(1, &["none.json"]);
    place.run("fog --model absorption -o a.png".split(' ')).fails(1, &["--model"]);
}
