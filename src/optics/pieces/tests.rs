use super::*;
use proptest::prelude::*;

fn point(value: f64, extinction: f64) -> ControlPoint {
    ControlPoint { value, color: [extinction * 0.5, 1.0, 0.0], extinction }
}

fn transfer(points: Vec<ControlPoint>) -> TransferFunction {
    TransferFunction::new(points).unwrap()
}

/// The slow twin: counts.
fn piece_of_slow(pieces: &Pieces, s: f32) -> usize {
    pieces.knots().iter().filter(|&&knot| knot <= s).count()
}

fn assert_found(pieces: &Pieces, s: f32) {
    assert_eq!(pieces.piece_of(s), piece_of_slow(pieces, s), "s = {s}, knots {:?}", pieces.knots());
}

/// Values at and around every knot, and what no field should hold.
fn probes(pieces: &Pieces) -> Vec<f32> {
    let mut probes = vec![0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, f32::MIN_POSITIVE];
    probes.extend(pieces.knots().iter().flat_map(|&knot| [knot, knot.next_up(), knot.next_down()]));
    probes
}

#[test]
fn a_constant_is_one_piece() {
    let pieces = TransferFunction::constant([0.1, 0.2, 0.3], 4.0).unwrap().pieces(7.0);
    assert_eq!((pieces.len(), pieces.knots().len()), (1, 0));
    assert_eq!(pieces.piece(pieces.piece_of(f32::NAN)).extinction_at(1e30), 4.0);
    assert_eq!(transfer(vec![point(0.0, 1.0), point(1.0, 1.0), point(5.0, 1.0)]).pieces(0.0).len(), 1);
}

#[test]
fn a_step_has_no_piece_of_its_own() {
    let pieces =
        transfer(vec![point(0.0, 1.0), point(1.0, 2.0), point(1.0, 9.0), point(1.0, 5.0), point(3.0, 7.0)]).pieces(0.0);
    assert_eq!(pieces.knots(), [0.0, 1.0, 3.0]);
    assert_eq!(pieces.piece(pieces.piece_of(1.0)).extinction_at(1.0), 5.0);
    assert_eq!(pieces.piece(1).extinction_at(1.0), 2.0);
    assert_eq!(pieces.piece(pieces.piece_of(-4.0)).extinction_at(-4.0), 1.0);
    assert_eq!(pieces.piece(pieces.piece_of(f32::MAX)).extinction_at(f32::MAX), 7.0);
}

#[test]
fn knots_that_narrow_to_one_f32_become_a_step() {
    let pieces =
        transfer(vec![point(1.0, 0.0), point(1.0 + 1e-12, 3.0), point(1.0 + 2e-12, 6.0), point(2.0, 6.0)]).pieces(0.0);
    assert_eq!(pieces.knots(), [1.0]);
    assert_eq!((pieces.piece(0).extinction, pieces.piece(1).extinction), (0.0, 6.0));
    // With the offset taken off first, they are told apart.
    let pieces = transfer(vec![point(1.0, 0.0), point(1.0 + 1e-12, 3.0), point(2.0, 6.0)]).pieces(1.0);
    assert_eq!(pieces.knots().len(), 3);
}

#[test]
fn narrow_and_huge_ranges_stay_finite() {
    for (low, high) in [(0.0, 1e-44), (0.0, 1e-30), (-1e300, 1e300), (1e30, 1e38), (-3e38, 3e38)] {
        let pieces = transfer(vec![point(low, 0.0), point(0.5 * (low + high), 1.0), point(high, 1e30)]).pieces(0.0);
        for s in probes(&pieces) {
            assert_found(&pieces, s);
            let piece = pieces.piece(pieces.piece_of(s));
            assert!(piece.extinction.is_finite() && piece.extinction_slope.is_finite());
        }
        for &knot in pieces.knots() {
            assert!(pieces.piece(pieces.piece_of(knot)).extinction_at(knot).is_finite());
        }
    }
}

#[test]
fn clustered_knots_are_found() {
    let mut points: Vec<ControlPoint> = (0..300).map(|i| point(1e-6 * f64::from(i), f64::from(i % 7))).collect();
    points.extend((1..40).map(|i| point(1e3 * f64::from(i), f64::from(i % 5))));
    let pieces = transfer(points).pieces(0.0);
    for s in probes(&pieces) {
        assert_found(&pieces, s);
    }
}

pub(in crate::optics) fn random_transfer() -> impl Strategy<Value = TransferFunction> {
    let value = prop_oneof![(-8..8).prop_map(f64::from), -8.0..8.0_f64];
    let extinction = prop_oneof![Just(0.0), Just(0.0), 0.0..5.0_f64];
    prop::collection::vec((value, extinction), 1..24).prop_map(|mut pairs| {
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        transfer(pairs.into_iter().map(|(value, extinction)| point(value, extinction)).collect())
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn pieces_are_the_transfer_function(transfer in random_transfer(), offset in -1e3..1e3_f64, inside in prop::collection::vec(-10.0..10.0_f32, 40)) {
        let offset = offset.round();
        let pieces = transfer.pieces(offset);
        prop_assert!(pieces.knots().is_sorted_by(|a, b| a < b));
        let shifted = inside.iter().map(|s| s - offset as f32);
        for s in shifted.chain(probes(&pieces)) {
            assert_found(&pieces, s);
            if s.is_finite() && s.abs() < 1e4 {
                let piece = pieces.piece(pieces.piece_of(s));
                let exact = transfer.eval(offset + f64::from(s));
                // Values next to a knot that the narrowing moved are compared with the function there.
                let near_knot = pieces.knots().iter().any(|knot| (knot - s).abs() <= 1e-3);
                if !near_knot {
                    let scale = f64::from(piece.extinction_slope.abs()).max(5.0) * 2e-4;
                    prop_assert!((f64::from(piece.extinction_at(s)) - exact.extinction).abs() <= scale);
                    prop_assert!((f64::from(piece.color_at(s)[0]) - exact.color[0]).abs() <= scale);
                }
            }
        }
    }

    #[test]
    fn far_ends_come_out_right(from in 0.0..1e3_f64, to in 0.0..1e3_f64, low in -1e4..1e4_f64, log_width in -4.0..4.0_f64) {
        let high = low + 10f64.powf(log_width);
        let pieces = transfer(vec![point(low, from), point(high, to)]).pieces(0.0);
        if let [start, end] = *pieces.knots() {
            let piece = pieces.piece(1);
            prop_assert_eq!(piece.extinction_at(start), from as f32);
            let error = (f64::from(piece.extinction_at(end)) - to).abs();
            let ulp = f64::from(f32::EPSILON) * from.max(to);
            prop_assert!(error <= 2.0 * ulp, "{} ulp", error / ulp);
        }
    }
}
