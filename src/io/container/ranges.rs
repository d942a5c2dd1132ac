//! The values of an array over the blocks: what culling and the choice of colours need, so that no one reads them all again.

use rayon::prelude::*;

use crate::columns::{Association, Dataset, NumericColumn, Tets};

/// Beyond this many components only the magnitude's range is kept.
const COMPONENTS_MAX: usize = 9;

/// The ranges of one scalar of an array.
pub(super) struct Ranges {
    /// None where no value is finite.
    pub(super) range: Option<[f64; 2]>,
    pub(super) invalid_cells: u64,
    /// Empty (min > max) in blocks without a valid cell.
    pub(super) blocks: Vec<[f64; 2]>,
}

const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Of the value or magnitude, then, where there are several, of each component.
pub(super) fn of_array(
    tets: &Tets,
    values: &NumericColumn,
    association: Association,
    components: usize,
) -> Vec<Ranges> {
    let mut all = Vec::new();
    if components == 1 {
        all.push(of_scalar(tets, values.len(), association, |tuple| values.get(tuple)));
        return all;
    }
    let tuples = values.len() / components;
    let magnitude = |tuple: usize| {
        (tuple * components..(tuple + 1) * components).map(|i| values.get(i).powi(2)).sum::<f64>().sqrt()
    };
    all.push(of_scalar(tets, tuples, association, magnitude));
    if components <= COMPONENTS_MAX {
        for component in 0..components {
            all.push(of_scalar(tets, tuples, association, |tuple| values.get(tuple * components + component)));
        }
    }
    all
}

fn of_scalar(tets: &Tets, tuples: usize, association: Association, value: impl Fn(usize) -> f64 + Sync) -> Ranges {
    let [low, high] = (0..tuples)
        .into_par_iter()
        .map(&value)
        .filter(|value| value.is_finite())
        .fold(|| NOTHING, |[low, high], value| [low.min(value), high.max(value)])
        .reduce(|| NOTHING, |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let view = tets.view();
    let blocks = tets.len().div_ceil(Dataset::BLOCK_CELLS);
    let per_block: Vec<([f64; 2], u64)> = (0..blocks)
        .into_par_iter()
        .map(|block| {
            let first = block * Dataset::BLOCK_CELLS;
            (first..(first + Dataset::BLOCK_CELLS).min(tets.len())).fold((NOTHING, 0), |([low, high], bad), cell| {
                let values = match association {
                    Association::Point => view.get(cell).map(|v| value(v as usize)),
                    Association::Cell => [value(cell); 4],
                };
                if values.iter().all(|value| value.is_finite()) {
                    (values.iter().fold([low, high], |[low, high], &value| [low.min(value), high.max(value)]), bad)
                } else {
                    ([low, high], bad + 1)
                }
            })
        })
        .collect();
    Ranges {
        range: (low <= high).then_some([low, high]),
        invalid_cells: per_block.iter().map(|(_, bad)| bad).sum(),
        blocks: per_block.into_iter().map(|(range, _)| range).collect(),
    }
}
