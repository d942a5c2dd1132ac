//! `Field`: one scalar per vertex or per cell of a dataset, taken from an array, ready for the stages.

use rayon::prelude::*;

use super::{Array, Association, Dataset};
use crate::error::{Error, Result};

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
    pub values: Vec<f32>,
    /// Smallest and largest finite value of the array on the mesh.
    pub range: (f64, f64),
    /// Smallest and largest stored value of the cells of each block; empty (min > max) where all are invalid.
    pub block_ranges: Vec<(f32, f32)>,
    /// Cells that are left out because a value of theirs is not finite.
    pub invalid: u64,
}

impl Dataset {
    /// Takes one scalar per vertex or cell out of the selected array.
    ///
    /// # Errors
    /// [`Error::UnknownArray`]; [`Error::UnusableArray`] where no value is finite or the component does not exist.
    pub fn field(&self, selection: &FieldSelection) -> Result<Field> {
        let candidates = self.arrays.iter().filter(|array| array.name == selection.name);
        let array = candidates
            .filter(|array| selection.association.is_none_or(|association| association == array.association))
            .min_by_key(|array| array.association == Association::Cell)
            .ok_or_else(|| Error::UnknownArray {
                name: selection.name.clone(),
                available: self.arrays.iter().map(|array| array.name.clone()).collect(),
            })?;
        let unusable = |problem: String| Error::UnusableArray { name: array.name.clone(), problem };
        if let Component::Index(index) = selection.component
            && index >= array.components
        {
            let last = array.components - 1;
            return Err(unusable(format!("there is no component {index}; use 0 to {last}")));
        }

        let scalar = |file: u32| scalar_of(array, selection.component, file as usize);
        let file_from = match array.association {
            Association::Point => &self.file_from_vertex,
            Association::Cell => &self.file_from_cell,
        };
        let nothing = (f64::INFINITY, f64::NEG_INFINITY);
        let range = file_from
            .par_iter()
            .map(|&file| scalar(file))
            .filter(|value| value.is_finite())
            .fold(|| nothing, |(low, high), value| (low.min(value), high.max(value)))
            .reduce(|| nothing, |a, b| (a.0.min(b.0), a.1.max(b.1)));
        if range.0 > range.1 {
            return Err(unusable("it has no finite value; choose another array".to_owned()));
        }

        let offset = offset_of(range);
        let values: Vec<f32> = file_from
            .par_iter()
            .map(|&file| {
                let stored = (scalar(file) - offset) as f32;
                if stored.is_finite() { stored } else { f32::NAN }
            })
            .collect();
        let name = match selection.component {
            Component::Magnitude => array.name.clone(),
            Component::Index(index) => format!("{}[{index}]", array.name),
        };
        Ok(self.finish_field(name, array.association, offset, values, range))
    }

    /// The field of a mesh without an array: the same value everywhere.
    pub fn homogeneous_field(&self) -> Field {
        let values = vec![0.0; self.tets.len()];
        self.finish_field("homogeneous".to_owned(), Association::Cell, 0.0, values, (0.0, 0.0))
    }

    fn finish_field(
        &self,
        name: String,
        association: Association,
        offset: f64,
        values: Vec<f32>,
        range: (f64, f64),
    ) -> Field {
        let of_cell = |cell: usize| match association {
            Association::Point => self.tets[cell].map(|v| values[v as usize]),
            Association::Cell => [values[cell]; 4],
        };
        let per_block: Vec<((f32, f32), u64)> = self
            .blocks
            .par_iter()
            .map(|block| {
                block.cells.clone().map(of_cell).fold(((f32::INFINITY, f32::NEG_INFINITY), 0), |(range, bad), s| {
                    if s.iter().any(|value| value.is_nan()) {
                        return (range, bad + 1);
                    }
                    (s.iter().fold(range, |(low, high), &value| (low.min(value), high.max(value))), bad)
                })
            })
            .collect();
        let invalid = per_block.iter().map(|(_, bad)| bad).sum();
        let block_ranges = per_block.into_iter().map(|(range, _)| range).collect();
        Field { name, association, offset, values, range, block_ranges, invalid }
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
