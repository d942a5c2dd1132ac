//! Which array is drawn: the one that was named, or one that shows something.
//!
//! Without a name: scalars of points, vectors of points by magnitude, then those of cells; among them fractional
//! numbers before whole ones, which are often labels; the first that varies and leaves no cell out for want of a value, or if
//! there is none, the first that varies. Arrays that only number or mark things are left out. Where nothing is left, the mesh is drawn homogeneous.

use cellfan::columns::{Array, Association, Component, Volume, VolumeField};
use cellfan::{Dataset, Field, FieldSelection, Result};

/// The field to draw.
///
/// # Errors
/// As [`Dataset::field`], for an array that was named.
pub(super) fn choose(dataset: &Dataset, name: Option<&str>) -> Result<Field> {
    if let Some(name) = name {
        return dataset.field(&FieldSelection::parse(name, &dataset.arrays));
    }
    let field = |selection: &FieldSelection| dataset.field(selection).ok();
    let found = first_that_shows(&dataset.arrays, field, |field| (field.range, field.invalid));
    Ok(found.unwrap_or_else(|| dataset.homogeneous_field()))
}

/// The field of a volume to draw, chosen in the same way.
///
/// # Errors
/// As [`Volume::field`], for an array that was named.
pub(super) fn choose_of_volume(volume: &Volume, name: Option<&str>) -> Result<VolumeField> {
    if let Some(name) = name {
        return volume.field(&FieldSelection::parse(name, &volume.arrays));
    }
    let field = |selection: &FieldSelection| volume.field(selection).ok();
    let found = first_that_shows(&volume.arrays, field, |field| (field.range, field.invalid));
    Ok(found.unwrap_or_else(|| volume.homogeneous_field()))
}

/// The field of the first array that varies and has all its values, or if there is none, of the first that varies.
fn first_that_shows<F>(
    arrays: &[Array],
    field: impl Fn(&FieldSelection) -> Option<F>,
    range_and_invalid: impl Fn(&F) -> ((f64, f64), u64),
) -> Option<F> {
    let mut candidates: Vec<&Array> = arrays.iter().filter(|array| !is_label(array)).collect();
    // Stable: the file's order decides between equals.
    candidates.sort_by_key(|array| (array.association == Association::Cell, array.components > 1, is_whole(array)));
    let mut varying = candidates.into_iter().filter_map(|array| {
        let selection = FieldSelection {
            name: array.name.clone(),
            association: Some(array.association),
            component: Component::Magnitude,
        };
        field(&selection).filter(|field| {
            let ((low, high), _) = range_and_invalid(field);
            low < high
        })
    });
    let first = varying.next()?;
    if range_and_invalid(&first).1 == 0 {
        return Some(first);
    }
    Some(varying.find(|field| range_and_invalid(field).1 == 0).unwrap_or(first))
}

fn is_whole(array: &Array) -> bool {
    !array.values.type_name().starts_with('f')
}

/// Whether an array numbers or marks its points or cells.
fn is_label(array: &Array) -> bool {
    let name: String = array.name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
    let known = ["vtkghost", "vtkoriginal", "vtkvalid", "globalid", "globalnode", "globalelement", "pedigree"];
    known.iter().any(|prefix| name.starts_with(prefix)) || (is_whole(array) && counts_up(array))
}

/// Whether each value is one more than that before, from 0 or 1 or anywhere.
fn counts_up(array: &Array) -> bool {
    let tuples = array.tuples();
    array.components == 1
        && tuples > 2
        && (1..tuples).all(|i| array.values.get(i).total_cmp(&(array.values.get(i - 1) + 1.0)).is_eq())
}

#[cfg(test)]
mod tests {
    use cellfan::columns::{CellCounts, NumericColumn};
    use cellfan::{Points, TetMesh};

    use super::*;

    fn dataset(arrays: Vec<Array>) -> Dataset {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
        let counts = CellCounts { in_file: 2, ..CellCounts::default() };
        let (tets, file_from_tet) = (vec![[0, 1, 2, 3], [1, 2, 3, 4]], vec![0, 1]);
        Dataset::from_tets(TetMesh {
            points: Points::F32(points),
            tets: tets.into(),
            file_from_tet: file_from_tet.into(),
            arrays,
            counts,
        })
        .unwrap()
    }

    fn array(name: &str, association: Association, components: usize, values: impl Into<NumericColumn>) -> Array {
        Array { name: name.to_owned(), association, components, values: values.into() }
    }

    fn point(name: &str, values: impl Into<NumericColumn>) -> Array {
        array(name, Association::Point, 1, values)
    }

    fn chosen(arrays: &[Array]) -> (String, Association) {
        let field = choose(&dataset(arrays.to_vec()), None).unwrap();
        (field.name, field.association)
    }

    #[test]
    fn what_varies_comes_before_what_does_not() {
        let cell = array("c", Association::Cell, 1, vec![1.0, 2.0]);
        let vector = array("v", Association::Point, 3, (0..15).map(f64::from).collect::<Vec<_>>());
        let scalar = point("s", vec![0.0_f32, 1.0, 0.0, 1.0, 0.0]);
        let whole = point("w", vec![0_u8, 1, 0, 1, 0]);
        let constant = point("k", vec![5.0_f64; 5]);
        let broken = point("n", vec![f64::NAN; 5]);
        let labels = [
            point("GlobalNodeId", vec![9_i64, 3, 5, 1, 0]),
            point("GLOBAL_IDS_POINTS", vec![9_i64, 3, 5, 1, 0]),
            point("vtkGhostType", vec![0_u8, 0, 0, 0, 4]),
            point("numbered", vec![1_i32, 2, 3, 4, 5]),
        ];
        let mut arrays = labels.to_vec();
        assert_eq!(chosen(&arrays), ("homogeneous".to_owned(), Association::Cell));
        for (added, name) in [
            (constant, "homogeneous"),
            (broken, "homogeneous"),
            (cell, "c"),
            (vector, "v"),
            (whole, "w"),
            (scalar, "s"),
        ] {
            arrays.push(added);
            assert_eq!(chosen(&arrays).0, name);
        }
        assert_eq!(choose(&dataset(arrays), Some("v[1]")).unwrap().range, (1.0, 13.0));
    }
}
