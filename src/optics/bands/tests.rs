use super::*;
use crate::optics::band_pieces::{BandPasses, BandPiece};
use crate::optics::{LinearPiece, Pieces, TransferFunction};
use proptest::prelude::*;

fn names(bands: usize) -> Vec<String> {
    numbered(bands)
}

fn table(rows: &[(f64, &[f64])]) -> BandTable {
    let points = rows.iter().map(|&(value, extinctions)| BandPoint { value, extinctions: extinctions.to_vec() });
    BandTable::new(names(rows[0].1.len()), points.collect()).unwrap()
}

fn refused(names: Vec<String>, rows: &[(f64, &[f64])]) -> String {
    let points = rows.iter().map(|&(value, extinctions)| BandPoint { value, extinctions: extinctions.to_vec() });
    BandTable::new(names, points.collect()).unwrap_err().to_string()
}

#[test]
fn what_is_no_table_is_refused() {
    for (message, part) in [
        (refused(vec![], &[(0.0, &[])]), "0 bands and 1 control points"),
        (refused(names(1), &[]), "1 bands and 0 control points"),
        (refused(vec!["a".into(), "a".into()], &[(0.0, &[1.0, 2.0])]), "two bands are called \"a\""),
        (refused(vec![" ".into()], &[(0.0, &[1.0])]), "band 1 has no name"),
        (refused(names(2), &[(0.0, &[1.0, 2.0]), (1.0, &[1.0])]), "point 2: 1 extinctions where there are 2 bands"),
        (refused(names(1), &[(f64::NAN, &[1.0])]), "point 1: value is NaN"),
        (refused(names(1), &[(0.0, &[-1.0])]), "extinction of \"band1\" is -1"),
        (refused(names(1), &[(0.0, &[f64::NAN])]), "is NaN; it must be finite"),
        (refused(names(1), &[(0.0, &[1e300])]), "it must be finite"),
        (refused(names(1), &[(2.0, &[1.0]), (1.0, &[1.0])]), "point 2: value 1 is below the one before (2)"),
    ] {
        assert!(message.starts_with("bands: ") && message.contains(part), "{message}");
    }
}

#[test]
fn csv_with_and_without_names() {
    let rows = "# keV\n0; 1\t2 # first\n\n1, 3, 4\n";
    let plain = BandTable::parse_csv(rows).unwrap();
    assert_eq!((plain.names(), plain.eval(0.5)), (&names(2)[..], vec![2.0, 3.0]));
    let named = BandTable::parse(&format!("\u{feff}s soft hard\n{rows}"), "CSV").unwrap();
    assert_eq!((&named.names()[1][..], named.points()), ("hard", plain.points()));
    let json = r#"{"bands": ["soft", "hard"],
        "points": [{"value": 0, "extinctions": [1, 2]}, {"value": 1, "extinctions": [3, 4]}]}"#;
    assert_eq!(BandTable::parse(json, "json").unwrap(), named);
}

#[test]
fn malformed_files_name_the_place() {
    for (text, extension, part) in [
        ("", "csv", "0 bands and 0 control points"),
        ("s a b\n", "csv", "2 bands and 0 control points"),
        ("1\n", "csv", "line 1: one column"),
        ("s\n", "csv", "line 1: one column"),
        ("0 1 2\n1 2\n", "csv", "line 2: 2 fields where 3 are needed"),
        ("s a\n0 1 2\n", "csv", "line 2: 3 fields where 2 are needed"),
        ("0 1\n1 x\n", "csv", "line 2: \"x\" is not a number"),
        ("0 1\n1 nan\n", "csv", "line 2: extinction of \"band1\" is NaN"),
        ("0 1\n1 -2\n", "csv", "line 2: extinction of \"band1\" is -2"),
        ("5 1\n4 1\n", "csv", "line 2: value 4 is below"),
        ("s a a\n0 1 2\n", "csv", "two bands are called \"a\""),
        ("{\"points\": 3}", "json", "not a table of bands"),
        ("{\"points\": []}", "json", "at least one of each"),
        ("{\"points\": [{\"value\": 0}]}", "json", "extinctions"),
        ("{\"points\": [{\"value\": 0, \"extinctions\": [1], \"color\": 2}]}", "json", "color"),
        (
            "{\"bands\": [\"a\"], \"points\": [{\"value\": 0, \"extinctions\": [1, 2]}]}",
            "json",
            "2 extinctions where there are 1",
        ),
        ("0 1\n", "png", "give a .json or .csv file"),
    ] {
        let message = BandTable::parse(text, extension).unwrap_err().to_string();
        assert!(message.contains(part), "{text:?}: {message}");
    }
}

/// The extinction of band `band` at s, from the passes.
fn found(passes: &BandPasses, per_pass: usize, band: usize, s: f32) -> f32 {
    let pieces: &Pieces<BandPiece> = &passes.passes[band / per_pass];
    pieces.piece(pieces.piece_of(s)).extinction_of(band % per_pass, s)
}

fn random_table() -> impl Strategy<Value = BandTable> {
    let row = (0.0..4.0_f64, prop::collection::vec(prop_oneof![Just(0.0), 0.0..9.0_f64], 7));
    prop::collection::vec(row, 1..8).prop_map(|mut rows| {
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Half of the values twice: steps.
        let snapped = |value: f64| (value * 4.0).round() / 4.0;
        let points = rows.into_iter().map(|(value, extinctions)| BandPoint { value: snapped(value), extinctions });
        BandTable::new(names(7), points.collect()).unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn passes_are_the_table_and_leave_out_only_what_has_no_band(
        table in random_table(),
        values in prop::collection::vec(-1.0..5.0_f32, 20),
        low_high in (-1.0..5.0_f32, 0.0..2.0_f32),
    ) {
        let color = TransferFunction::parse_csv("0 1 0 0 9\n1.1 0 1 0.5 9\n2.3 0.25 1 1 9\n").unwrap();
        for (passes, per_pass) in [(table.passes(0.5), 4), (table.glowing_passes(&color, 0, 0.5), 2)] {
            prop_assert_eq!(passes.passes.len(), 7_usize.div_ceil(per_pass));
            for &s in &values {
                let expected = table.eval(f64::from(s) + 0.5);
                for (band, expected) in expected.iter().enumerate() {
                    let found = f64::from(found(&passes, per_pass, band, s));
                    prop_assert!((found - expected).abs() < 1e-5, "band {} at {}: {} {}", band, s, found, expected);
                }
                if per_pass == 2 {
                    let expected = color.eval(f64::from(s) + 0.5).color;
                    for band in 0..3 {
                        let pieces = &passes.passes[band / 2];
                        let found = pieces.piece(pieces.piece_of(s)).color_of(band % 2, s);
                        prop_assert!((f64::from(found) - expected[band]).abs() < 1e-5);
                    }
                }
            }
            let (low, high) = (low_high.0, low_high.0 + low_high.1);
            let intervals = &passes.passes[0];
            if passes.cull_table.is_transparent(intervals, low, high) {
                for i in 0..=200_u8 {
                    let s = low + (high - low) * f32::from(i) / 200.0;
                    prop_assert!(table.eval(f64::from(s) + 0.5).iter().all(|&extinction| extinction == 0.0));
                }
            }
        }
    }
}

/// A cell may be left out where every band is 0; one band that shows keeps it, in whatever pass.
#[test]
fn one_band_of_a_later_pass_keeps_a_cell() {
    let rows: [(f64, [f64; 6]); 3] = [(0.0, [0.0; 6]), (1.0, [0.0; 6]), (2.0, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0])];
    let rows: Vec<(f64, &[f64])> = rows.iter().map(|(value, bands)| (*value, &bands[..])).collect();
    let BandPasses { passes, cull_table, bands } = table(&rows).passes(0.0);
    assert_eq!((bands, passes.len()), (6, 2));
    assert!(passes[0].as_slice().iter().all(LinearPiece::is_transparent));
    assert!(cull_table.is_transparent(&passes[0], 0.0, 0.9) && !cull_table.is_transparent(&passes[0], 0.0, 1.1));
}
