use super::*;

fn point(value: f64, extinction: f64) -> ControlPoint {
    ControlPoint { value, color: [1.0, 0.5, 0.0], extinction }
}

#[test]
fn a_step_is_right_continuous() {
    let step = TransferFunction::new(vec![
        point(0.0, 1.0),
        point(1.0, 1.0),
        point(1.0, 7.0),
        point(1.0, 5.0),
        point(2.0, 5.0),
    ]);
    let step = step.unwrap();
    assert_eq!(step.eval(1.0_f64.next_down()).extinction, 1.0);
    assert_eq!(step.eval(1.0).extinction, 5.0);
    assert_eq!(step.eval(-9.0).extinction, 1.0);
    assert_eq!(step.eval(f64::INFINITY).extinction, 5.0);
    assert_eq!(step.eval(f64::NAN).extinction, 1.0);
}

#[test]
fn huge_values_do_not_overflow() {
    let wide = TransferFunction::new(vec![point(-f64::MAX, 0.0), point(f64::MAX, 2.0)]).unwrap();
    assert_eq!(wide.eval(0.0).extinction, 1.0);
    assert_eq!(wide.stretched((0.0, 1.0)).unwrap().eval(0.5).extinction, 1.0);
}

#[test]
fn stretching_over_one_value_makes_a_step_there() {
    let ramp = TransferFunction::new(vec![point(0.0, 0.0), point(1.0, 3.0)]).unwrap();
    assert_eq!(ramp.stretched((5.0, 5.0)).unwrap().eval(5.0).extinction, 3.0);
}

#[test]
fn bad_points_are_refused_by_number() {
    let message = |points: Vec<ControlPoint>| TransferFunction::new(points).unwrap_err().to_string();
    assert!(message(vec![]).contains("no control points"));
    assert!(message(vec![point(0.0, 0.0), point(f64::NAN, 0.0)]).contains("value of point 2 is NaN"));
    assert!(message(vec![point(0.0, -1.0)]).contains("extinction of point 1 is -1"));
    assert!(message(vec![point(0.0, f64::INFINITY)]).contains("extinction of point 1 is inf"));
    assert!(message(vec![point(1.0, 0.0), point(0.5, 0.0)]).contains("below the one before (1)"));
    let green = ControlPoint { value: 0.0, color: [0.0, f64::NAN, 0.0], extinction: 0.0 };
    assert!(message(vec![green]).contains("green of point 1"));
}

#[test]
fn bad_factors_and_ranges_are_refused() {
    let one = TransferFunction::constant([1.0; 3], 2.0).unwrap();
    assert!(one.scaled_extinction(-1.0).is_err() && one.scaled_extinction(f64::NAN).is_err());
    assert_eq!(one.scaled_extinction(0.5).unwrap().eval(3.0).extinction, 1.0);
    assert!(one.stretched((1.0, 0.0)).is_err() && one.stretched((0.0, f64::NAN)).is_err());
}

#[test]
fn opacity_one_stays_finite() {
    assert!((extinction_from_opacity(1.0, 1.0) - 10_000_f64.ln()).abs() < 1e-9);
    assert_eq!(extinction_from_opacity(0.0, 3.0), 0.0);
}
