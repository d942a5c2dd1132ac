use super::*;
use crate::optics::color::linear_from_srgb;

fn message(text: &str, extension: &str) -> String {
    TransferFunction::parse(text, extension, 1.0, (0.0, 1.0)).unwrap_err().to_string()
}

#[test]
fn csv_takes_any_separator_comments_and_a_header() {
    let text = "value,r,g,b,extinction\r\n# nothing\r\n0 0 0 0 0\r\n1;0.5;0.25;1;2 # step below\n1\t1\t1\t1\t4\n\n2, 1, 1, 1, 4";
    let transfer = TransferFunction::parse(text, "CSV", 1.0, (0.0, 1.0)).unwrap();
    assert_eq!(transfer.points().len(), 4);
    assert_eq!(transfer.eval(0.5).color, [0.25, 0.125, 0.5]);
    assert_eq!(transfer.eval(1.0).extinction, 4.0);
}

#[test]
fn csv_errors_name_the_line() {
    assert!(message("0 0 0 0 0\n1 0 0 0\n", "csv").contains("line 2: 4 fields where 5"));
    assert!(message("0 0 0 0 0\n\n1 0 x 0 0\n", "csv").contains("line 3: \"x\" is not a number"));
    assert!(message("0 0 0 0 0\n-1 0 0 0 0\n", "csv").contains("line 2: value -1 is below"));
    assert!(message("0 0 0 0 nan\n", "csv").contains("line 1: NaN is not finite"));
    assert!(message("0 0 -2 0 1\n", "csv").contains("line 1: -2 is negative"));
    assert!(message("# only\n", "csv").contains("no control points"));
    assert!(message("", "csv").contains("no control points"));
}

#[test]
fn json_with_extinction_or_opacity() {
    let text = r#"{"points": [{"value": 0, "color": [0, 0, 1], "opacity": 0.25}, {"value": 1, "color": [1, 0, 0], "extinction": 3}]}"#;
    let transfer = TransferFunction::parse(text, "json", 0.5, (0.0, 1.0)).unwrap();
    assert!((transfer.eval(0.0).extinction - (4.0_f64 / 3.0).ln() * 2.0).abs() < 1e-12);
    assert_eq!(transfer.eval(1.0).extinction, 3.0);
    assert_eq!(transfer.eval(0.5).color, [0.5, 0.0, 0.5]); // linear, as given
}

#[test]
fn json_errors_say_what_is_wrong() {
    let point = |rest: &str| format!(r#"{{"points": [{{"value": 0, "color": [1, 1, 1]{rest}}}]}}"#);
    assert!(message(&point(""), "json").contains("point 1 has neither"));
    assert!(message(&point(r#", "opacity": 1, "extinction": 1"#), "json").contains("point 1 has both"));
    assert!(message(&point(r#", "opacity": 1.5"#), "json").contains("opacity is 1.5"));
    assert!(message(&point(r#", "extintion": 1"#), "json").contains("unknown field `extintion`"));
    assert!(message(&point(r#", "extinction": -1"#), "json").contains("extinction of point 1 is -1"));
    assert!(message(r#"{"points": []}"#, "json").contains("no control points"));
    assert!(message(r#"{"points": [}"#, "json").contains("line 1"));
    let bad_unit = r#"{"points": [{"value": 0, "color": [1, 1, 1], "opacity": 0.5}], "unit_distance": 0}"#;
    assert!(message(bad_unit, "json").contains("unit distance is 0"));
    assert!(message("3", "json").contains("not a list of points"));
    assert!(message("x", "xml").contains("xml"));
}

const DIVERGING: &str = r#"[{"ColorSpace": "Diverging", "Name": "Cool to Warm", "NanColor": [1, 1, 0],
    "RGBPoints": [-2, 0.231373, 0.298039, 0.752941, 6, 0.705882, 0.0156863, 0.14902]}]"#;

#[test]
fn paraview_maps_stretch_over_the_range_and_become_linear() {
    let transfer = TransferFunction::parse(DIVERGING, "json", 1.0, (10.0, 20.0)).unwrap();
    let middle = transfer.eval(15.0).color;
    let white = linear_from_srgb([221.0 / 255.0; 3]);
    assert!((0..3).all(|k| (middle[k] - white[k]).abs() < 0.01), "{middle:?} {white:?}");
    assert_eq!(transfer.eval(10.0).extinction, 0.0);
    assert!((transfer.eval(20.0).extinction - 2.0 * transfer.eval(15.0).extinction).abs() < 1e-9);
    assert!(transfer.points().len() <= 33);
}

#[test]
fn paraview_opacity_has_its_own_range_midpoint_and_sharpness() {
    let map = |points: &str| {
        let text = format!(r#"{{"ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1], "Points": [{points}]}}"#);
        TransferFunction::parse(&text, "json", 1.0, (0.0, 1.0)).unwrap()
    };
    let straight = map("5, 0, 0.5, 0, 7, 0.5, 0.5, 0");
    assert!((straight.eval(1.0).extinction - 2_f64.ln()).abs() < 1e-12);
    assert!((straight.eval(0.5).extinction + 0.75_f64.ln()).abs() < 1e-3);
    let step = map("0, 0, 0.3, 1, 1, 0.5, 0.5, 0");
    assert_eq!(step.eval(0.299).extinction, 0.0);
    assert!((step.eval(0.3).extinction - 2_f64.ln()).abs() < 1e-9);
    let smooth = map("0, 0, 0.5, 0.5, 1, 0.5, 0.5, 0");
    assert!((smooth.eval(0.5).extinction + 0.75_f64.ln()).abs() < 1e-3);
    assert!(smooth.eval(0.1).extinction < straight.eval(0.1).extinction);
}

#[test]
fn paraview_steps_stay_steps() {
    let text = r#"[{"ColorSpace": "Step", "RGBPoints": [0, 1, 0, 0, 0.5, 0, 1, 0, 1, 0, 0, 1]}]"#;
    let transfer = TransferFunction::parse(text, "json", 1.0, (0.0, 2.0)).unwrap();
    assert_eq!(transfer.eval(0.999).color, [1.0, 0.0, 0.0]);
    assert_eq!(transfer.eval(1.0).color, [0.0, 1.0, 0.0]);
}

#[test]
fn paraview_maps_with_hundreds_of_points_are_thinned() {
    let rows: Vec<String> = (0..512).map(|i| format!("{i}, {}, 0, 1", f64::from(i) / 511.0)).collect();
    let text = format!(r#"[{{"ColorSpace": "Lab", "RGBPoints": [{}]}}]"#, rows.join(", "));
    let transfer = TransferFunction::parse(&text, "json", 1.0, (0.0, 1.0)).unwrap();
    assert!(transfer.points().len() < 100, "{}", transfer.points().len());
}

#[test]
fn bad_paraview_maps_are_refused() {
    assert!(message("[]", "json").contains("RGBPoints"));
    assert!(message(r#"[{"RGBPoints": [0, 1, 1]}]"#, "json").contains("has 3 numbers"));
    assert!(message(r#"[{"RGBPoints": []}]"#, "json").contains("has 0 numbers"));
    assert!(message(r#"[{"RGBPoints": [1, 0, 0, 0, 0, 1, 1, 1]}]"#, "json").contains("do not ascend"));
    assert!(message(r#"[{"RGBPoints": [0, 0, 0, 255]}]"#, "json").contains("outside 0 to 1"));
    assert!(message(r#"[{"ColorSpace": "CMYK", "RGBPoints": [0, 0, 0, 1]}]"#, "json").contains("CMYK"));
    assert!(message(r#"[{"RGBPoints": "red"}]"#, "json").contains("not a ParaView colour map"));
    assert!(message(r#"[{"RGBPoints": [0, 0, 0, 1], "Points": [0, 2, 0.5, 0]}]"#, "json").contains("opacity is 2"));
}
