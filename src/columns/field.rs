//! `Field`: one scalar per vertex or per cell of a dataset, taken from an array, ready for the stages.

use rayon::prelude::*;

use super::{Array, Association, Column, Dataset, NumericColumn, ValueRanges};
use crate::error::{Error, Result, presentable};

/// How several components become one scalar.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Component {
    /// The value of a scalar, the Euclidean norm of a vector.
    #[default]
    Magnitude,
    /// Component `i`, from 0.
    Index(usize),
}

/// Which array of a dataset, and which component of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldSelection {
    /// The array's name.
    pub name: String,
    /// Point or cell data, where both have an array of that name; point data comes first.
    pub association: Option<Association>,
    /// The component.
    pub component: Component,
}

impl FieldSelection {
    /// Reads `NAME`, `NAME[component]`, `point:NAME` or `cell:NAME` as the command line writes them; an array whose
    /// whole name is `text` comes first.
    pub fn parse(text: &str, arrays: &[Array]) -> Self {
        let whole =
            |name: &str, association| Self { name: name.to_owned(), association, component: Component::Magnitude };
        if arrays.iter().any(|array| array.name == text) {
            return whole(text, None);
        }
        let prefixed = [("point:", Association::Point), ("cell:", Association::Cell)];
        let split = prefixed.iter().find_map(|&(prefix, a)| Some((text.strip_prefix(prefix)?, Some(a))));
        let (text, association) = split.unwrap_or((text, None));
        let indexed = text
            .strip_suffix(']')
            .and_then(|rest| rest.rsplit_once('['))
            .and_then(|(name, index)| Some((name, index.parse().ok()?)))
            .filter(|_| !arrays.iter().any(|array| array.name == text));
        match indexed {
            Some((name, index)) => Self { name: name.to_owned(), association, component: Component::Index(index) },
            None => whole(text, association),
        }
    }
}

/// One scalar per vertex or per cell, in the dataset's order.
///
/// The value is `offset + values[i]`: where a field varies little around a large value, the offset keeps its digits.
#[derive(Clone, Debug)]
pub struct Field {
    /// What it is called, component included.
    pub name: String,
    /// Per vertex or per cell.
    pub association: Association,
    /// Added to a stored value, it gives the array's value.
    pub offset: f64,
    /// Stored values; NaN where the array has no finite value.
    pub values: Column<f32>,
    /// Smallest and largest finite value of the array on the mesh.
    pub range: (f64, f64),
    /// Smallest and largest stored value of the cells of each block; empty (min > max) where all are invalid.
    pub block_ranges: Vec<(f32, f32)>,
    /// Cells that are left out because a value of theirs is not finite.
    pub invalid: u64,
}

/// The selected array and its place; its component exists.
///
/// # Errors
/// [`Error::UnknownArray`]; [`Error::UnusableArray`] where the component does not exist.
pub(super) fn select<'a>(arrays: &'a [Array], selection: &FieldSelection) -> Result<(usize, &'a Array)> {
    let candidates = arrays.iter().enumerate().filter(|(_, array)| array.name == selection.name);
    let (place, array) = candidates
        .filter(|(_, array)| selection.association.is_none_or(|association| association == array.association))
        .min_by_key(|(_, array)| array.association == Association::Cell)
        .ok_or_else(|| Error::UnknownArray {
            name: selection.name.clone(),
            available: arrays.iter().map(|array| array.name.clone()).collect(),
        })?;
    match selection.component {
        Component::Index(index) if index >= array.components => {
            let last = array.components - 1;
            Err(unusable(array, format!("there is no component {index}; use 0 to {last}")))
        }
        Component::Index(_) | Component::Magnitude => Ok((place, array)),
    }
}

/// An array cannot be drawn.
pub(super) fn unusable(array: &Array, problem: String) -> Error {
    Error::UnusableArray { name: presentable(array.name.clone()), problem }
}

impl Dataset {
    /// Takes one scalar per vertex or cell out of the selected array.
    ///
    /// # Errors
    /// [`Error::UnknownArray`]; [`Error::UnusableArray`] where no value is finite or the component does not exist.
    pub fn field(&self, selection: &FieldSelection) -> Result<Field> {
        let (place, array) = select(&self.arrays, selection)?;
        self.field_of(array, selection.component, self.known_ranges(place, selection.component))
    }

    /// The same for an array of the caller's, which has a tuple for each point or cell of it; it is read once.
    ///
    /// # Errors
    /// Those of [`Dataset::field`].
    pub(crate) fn field_of_lent(&self, array: &Array, component: Component) -> Result<Field> {
        let selection = FieldSelection { name: array.name.clone(), association: None, component };
        select(std::slice::from_ref(array), &selection)?;
        self.field_of(array, component, None)
    }

    fn field_of(&self, array: &Array, component: Component, known: Option<&ValueRanges>) -> Result<Field> {
        let scalars = Scalars { dataset: self, array, component };
        let range = known.map_or_else(|| scalars.range(), |known| known.range);
        if range.0 > range.1 {
            return Err(unusable(array, "it has no finite value; choose another array".to_owned()));
        }
        let offset = offset_of(range);
        let name = match component {
            Component::Magnitude => array.name.clone(),
            Component::Index(index) => format!("{}[{index}]", array.name),
        };
        let association = array.association;
        let Some(known) = known else {
            return Ok(self.finish_field(name, association, offset, scalars.stored(offset).into(), range));
        };
        // Narrowing keeps the order of values, so the narrowed ends are the ends of the narrowed values.
        let narrow = |value: f64| (value - offset) as f32;
        let block_ranges = known.blocks.iter().map(|&[low, high]| (narrow(low), narrow(high))).collect();
        let in_place = scalars.in_place().filter(|_| offset == 0.0 && known.invalid == 0);
        let values = in_place.unwrap_or_else(|| scalars.stored(offset).into());
        Ok(Field { name, association, offset, values, range, block_ranges, invalid: known.invalid })
    }

    /// What the container says of an array's values, where f32 holds them.
    fn known_ranges(&self, array: usize, component: Component) -> Option<&ValueRanges> {
        let by_component = &self.array_ranges.get(array)?.by_component;
        let known = match component {
            Component::Index(index) if by_component.len() > 1 => by_component.get(index + 1)?,
            _ => by_component.first()?,
        };
        let largest = known.range.0.abs().max(known.range.1.abs());
        let is_plain =
            self.arrays[array].components == 1 || component == Component::Magnitude || by_component.len() > 1;
        (is_plain && largest < f64::from(f32::MAX) && known.blocks.len() == self.blocks.len()).then_some(known)
    }

    /// The field of a mesh without an array: the same value everywhere.
    pub fn homogeneous_field(&self) -> Field {
        let values = vec![0.0; self.cells()];
        self.finish_field("homogeneous".to_owned(), Association::Cell, 0.0, values.into(), (0.0, 0.0))
    }

    /// The largest value in each cell of several fields of cell data, those of them that are numbers.
    pub(crate) fn largest_of_cells(&self, name: String, fields: &[&Field]) -> Field {
        let of_cell = |cell: usize| {
            let values = fields.iter().map(|field| (field.offset + f64::from(field.values[cell])) as f32);
            values.fold(f32::NAN, f32::max)
        };
        let values: Vec<f32> = (0..self.cells()).into_par_iter().map(of_cell).collect();
        let ends = fields.iter().map(|field| field.range);
        let range = ends.reduce(|(low, high), (a, b)| (low.min(a), high.max(b))).unwrap_or((0.0, 0.0));
        self.finish_field(name, Association::Cell, 0.0, values.into(), range)
    }

    /// `field`, of `before`, the same cells of the caller's at other places, on this dataset. Where a cell is here that was not there, its
    /// value is not known.
    pub(crate) fn field_from(&self, before: &Self, field: &Field) -> Field {
        if self.cells() == before.cells() && self.file_from_cell == before.file_from_cell {
            return field.clone();
        }
        let values = match field.association {
            Association::Point => field.values.clone(),
            Association::Cell => {
                let mut value_from_file = vec![f32::NAN; self.counts.in_file as usize];
                for (cell, &value) in field.values.iter().enumerate() {
                    value_from_file[before.cell_tuple(cell)] = value;
                }
                (0..self.cells()).map(|cell| value_from_file[self.cell_tuple(cell)]).collect()
            }
        };
        self.finish_field(field.name.clone(), field.association, field.offset, values, field.range)
    }

    fn finish_field(
        &self,
        name: String,
        association: Association,
        offset: f64,
        values: Column<f32>,
        range: (f64, f64),
    ) -> Field {
        let stored = &values[..];
        // Smallest and largest value of a cell, if all are numbers.
        let of_cell = |cell: usize| -> Option<(f32, f32)> {
            let widen = |(low, high): (f32, f32), value: f32| {
                if value.is_nan() { None } else { Some((low.min(value), high.max(value))) }
            };
            let nothing = (f32::INFINITY, f32::NEG_INFINITY);
            match association {
                Association::Point => self.corners(cell).iter().map(|&v| stored[v as usize]).try_fold(nothing, widen),
                Association::Cell => widen(nothing, stored[cell]),
            }
        };
        let per_block: Vec<((f32, f32), u64)> = self
            .blocks
            .par_iter()
            .map(|block| {
                let cells = block.cells.clone().map(of_cell);
                cells.fold(((f32::INFINITY, f32::NEG_INFINITY), 0), |((low, high), bad), cell| match cell {
                    Some((lowest, highest)) => ((low.min(lowest), high.max(highest)), bad),
                    None => ((low, high), bad + 1),
                })
            })
            .collect();
        let invalid = per_block.iter().map(|(_, bad)| bad).sum();
        let block_ranges = per_block.into_iter().map(|(range, _)| range).collect();
        Field { name, association, offset, values, range, block_ranges, invalid }
    }
}

/// One scalar of an array, in the dataset's order.
struct Scalars<'a> {
    dataset: &'a Dataset,
    array: &'a Array,
    component: Component,
}

impl Scalars<'_> {
    /// The tuple of each vertex or cell, and how many there are of these.
    fn tuples(&self) -> impl IndexedParallelIterator<Item = usize> + '_ {
        let (dataset, association) = (self.dataset, self.array.association);
        let len = match association {
            Association::Point => dataset.positions.len(),
            Association::Cell => dataset.cells(),
        };
        (0..len).into_par_iter().map(move |i| match association {
            Association::Point => dataset.point_tuple(i),
            Association::Cell => dataset.cell_tuple(i),
        })
    }

    /// Smallest and largest finite value; empty where there is none.
    fn range(&self) -> (f64, f64) {
        let nothing = (f64::INFINITY, f64::NEG_INFINITY);
        self.tuples()
            .map(|tuple| scalar_of(self.array, self.component, tuple))
            .filter(|value| value.is_finite())
            .fold(|| nothing, |(low, high), value| (low.min(value), high.max(value)))
            .reduce(|| nothing, |a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// The values less `offset`; NaN where that is not finite.
    fn stored(&self, offset: f64) -> Vec<f32> {
        let narrow = |tuple| {
            let stored = (scalar_of(self.array, self.component, tuple) - offset) as f32;
            if stored.is_finite() { stored } else { f32::NAN }
        };
        self.tuples().map(narrow).collect()
    }

    /// The array itself, where it is what a field stores.
    fn in_place(&self) -> Option<Column<f32>> {
        let is_in_order = match self.array.association {
            Association::Point => self.dataset.file_from_vertex.is_none(),
            Association::Cell => self.dataset.file_from_cell.is_none(),
        };
        match &self.array.values {
            NumericColumn::F32(values) if is_in_order && self.array.components == 1 => Some(values.clone()),
            _ => None,
        }
    }
}

fn scalar_of(array: &Array, component: Component, tuple: usize) -> f64 {
    let first = tuple * array.components;
    match component {
        Component::Index(index) => array.values.get(first + index),
        Component::Magnitude if array.components == 1 => array.values.get(first),
        Component::Magnitude => {
            (first..first + array.components).map(|i| array.values.get(i).powi(2)).sum::<f64>().sqrt()
        }
    }
}

/// Zero, or the middle of a range that f32 would blur: one below 2^-8 of its values leaves fewer than 16 bits.
fn offset_of((low, high): (f64, f64)) -> f64 {
    let largest = low.abs().max(high.abs());
    if high - low < largest / 256.0 || largest > f64::from(f32::MAX) { low + (high - low) * 0.5 } else { 0.0 }
}

#[cfg(test)]
mod tests;
