//! The values of an array over the blocks: what culling and the choice of colours need, so that no one reads them all again.

use std::ops::Range;

use rayon::prelude::*;

use super::directory::RangeEntry;
use super::sink::Sink;
use crate::columns::{Association, Dataset, Hexahedra, NumericColumn, Polyhedra, Tets};
use crate::error::Result;

/// Beyond this many components only the magnitude's range is kept.
const COMPONENTS_MAX: usize = 9;

/// The cells whose values are looked at.
#[derive(Clone, Copy)]
pub(super) struct Cells<'a> {
    pub(super) tets: &'a Tets,
    pub(super) hexahedra: &'a Hexahedra,
    pub(super) polyhedra: &'a Polyhedra,
}

/// The ranges of one scalar of an array.
pub(super) struct Ranges {
    /// None where no value is finite.
    range: Option<[f64; 2]>,
    invalid_cells: u64,
    /// Empty (min > max) in blocks without a valid cell.
    blocks: Vec<[f64; 2]>,
}

impl Ranges {
    /// Writes the column of the blocks' ranges.
    pub(super) fn write(self, sink: &mut Sink) -> Result<RangeEntry> {
        let block_ranges = sink.whole(bytemuck::cast_slice(&self.blocks))?;
        Ok(RangeEntry { range: self.range, invalid_cells: self.invalid_cells, block_ranges })
    }
}

const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Of the value or magnitude, then, where there are several, of each component.
pub(super) fn of_array(
    cells: Cells,
    values: &NumericColumn,
    association: Association,
    components: usize,
) -> Vec<Ranges> {
    let mut all = Vec::new();
    if components == 1 {
        all.push(of_scalar(cells, values.len(), association, |tuple| values.get(tuple)));
        return all;
    }
    let tuples = values.len() / components;
    let magnitude = |tuple: usize| {
        (tuple * components..(tuple + 1) * components).map(|i| values.get(i).powi(2)).sum::<f64>().sqrt()
    };
    all.push(of_scalar(cells, tuples, association, magnitude));
    if components <= COMPONENTS_MAX {
        for component in 0..components {
            all.push(of_scalar(cells, tuples, association, |tuple| values.get(tuple * components + component)));
        }
    }
    all
}

fn of_scalar(
    Cells { tets, hexahedra, polyhedra }: Cells,
    tuples: usize,
    association: Association,
    value: impl Fn(usize) -> f64 + Sync,
) -> Ranges {
    let [low, high] = (0..tuples)
        .into_par_iter()
        .map(&value)
        .filter(|value| value.is_finite())
        .fold(|| NOTHING, |[low, high], value| [low.min(value), high.max(value)])
        .reduce(|| NOTHING, |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let (of_tets, of_hexahedra, first) = (tets.view(), hexahedra.view(), tets.len());
    let (of_polyhedra, first_polyhedron) = (polyhedra.view(), first + hexahedra.len());
    let of_vertex = |v: u32| value(v as usize);
    let of_run = |run: Range<usize>| match association {
        Association::Cell => of_block(run, |cell| [value(cell)]),
        Association::Point if run.start < first => of_block(run, |cell| of_tets.get(cell).map(of_vertex)),
        Association::Point if run.start < first_polyhedron => {
            of_block(run, |cell| of_hexahedra.get(cell - first).map(of_vertex))
        }
        Association::Point => {
            of_block(run, |cell| of_polyhedra.corners(cell - first_polyhedron).iter().map(|&v| of_vertex(v)))
        }
    };
    let runs: Vec<Range<usize>> = Dataset::runs([first, hexahedra.len(), polyhedra.len()]).collect();
    let per_block: Vec<([f64; 2], u64)> = runs.into_par_iter().map(of_run).collect();
    Ranges {
        range: (low <= high).then_some([low, high]),
        invalid_cells: per_block.iter().map(|(_, bad)| bad).sum(),
        blocks: per_block.into_iter().map(|(range, _)| range).collect(),
    }
}

/// Smallest and largest value of the cells whose values are all finite, and how many are not such.
fn of_block<I: IntoIterator<Item = f64> + Clone>(cells: Range<usize>, values: impl Fn(usize) -> I) -> ([f64; 2], u64) {
    cells.map(values).fold((NOTHING, 0), |([low, high], bad), values| {
        if values.clone().into_iter().all(f64::is_finite) {
            (values.into_iter().fold([low, high], |[low, high], value| [low.min(value), high.max(value)]), bad)
        } else {
            ([low, high], bad + 1)
        }
    })
}
