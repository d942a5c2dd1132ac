use super::*;
use crate::columns::{CellCounts, Points, TetMesh};

fn two_tets(arrays: Vec<Array>) -> Dataset {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
    Dataset::from_tets(TetMesh {
        points: Points::F32(points),
        tets: vec![[0, 1, 2, 3], [1, 2, 3, 4]].into(),
        file_from_tet: vec![0, 1].into(),
        arrays,
        counts: CellCounts { in_file: 2, ..CellCounts::default() },
    })
    .unwrap()
}

fn array(name: &str, association: Association, components: usize, values: Vec<f64>) -> Array {
    Array { name: name.to_owned(), association, components, values: values.into() }
}

#[test]
fn a_vector_is_its_norm_or_a_component() {
    let values = (0..5).flat_map(|i| [3.0 * f64::from(i), 4.0 * f64::from(i), 0.0]).collect();
    let data = two_tets(vec![array("v", Association::Point, 3, values)]);
    let norm = data.field(&FieldSelection::parse("v", &data.arrays)).unwrap();
    assert_eq!(norm.range, (0.0, 20.0));
    let second = data.field(&FieldSelection::parse("v[1]", &data.arrays)).unwrap();
    assert_eq!((second.range, second.name.as_str()), ((0.0, 16.0), "v[1]"));
    assert!(matches!(data.field(&FieldSelection::parse("v[3]", &data.arrays)), Err(Error::UnusableArray { .. })));
}

#[test]
fn cells_with_nan_are_counted_and_no_value_at_all_is_an_error() {
    let data = two_tets(vec![
        array("hole", Association::Point, 1, vec![f64::NAN, 1.0, 2.0, 3.0, 4.0]),
        array("none", Association::Cell, 1, vec![f64::NAN; 2]),
    ]);
    let hole = data.field(&FieldSelection::parse("hole", &data.arrays)).unwrap();
    assert_eq!((hole.invalid, hole.range, hole.block_ranges[0]), (1, (1.0, 4.0), (1.0, 4.0)));
    assert!(data.field(&FieldSelection::parse("none", &data.arrays)).is_err());
}

#[test]
fn a_small_variation_around_a_large_value_keeps_its_digits() {
    let values = (0..5).map(|i| 1e9 + f64::from(i) * 1e-3).collect();
    let data = two_tets(vec![array("p", Association::Point, 1, values)]);
    let field = data.field(&FieldSelection::parse("p", &data.arrays)).unwrap();
    for vertex in 0..data.positions.len() {
        let value = field.offset + f64::from(field.values[vertex]);
        assert!((value - (1e9 + data.point_tuple(vertex) as f64 * 1e-3)).abs() < 2e-7);
    }
}

#[test]
fn names_with_brackets_and_both_associations() {
    let data = two_tets(vec![
        array("s[0]", Association::Point, 1, vec![0.0; 5]),
        array("t", Association::Point, 1, vec![1.0; 5]),
        array("t", Association::Cell, 1, vec![2.0; 2]),
    ]);
    let parse = |text| FieldSelection::parse(text, &data.arrays);
    assert_eq!(parse("s[0]").component, Component::Magnitude);
    assert_eq!(data.field(&parse("t")).unwrap().range, (1.0, 1.0));
    assert_eq!(data.field(&parse("cell:t")).unwrap().range, (2.0, 2.0));
    assert!(matches!(data.field(&parse("u")), Err(Error::UnknownArray { .. })));
}
