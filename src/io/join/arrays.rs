//! The arrays of several meshes, matched by name and association.

use std::collections::HashMap;

use super::Part;
use crate::columns::{Array, Association, NumericColumn, Points};
use crate::error::{Result, presentable};
use crate::io::assemble::{GHOST_LEVELS, GHOST_TYPE};
use crate::io::numbers;
use crate::io::scratch::{Scratch, collect};

/// Values that are made up for arrays that meshes lack may be this many times the numbers that are there (coordinates, cells,
/// values): blocks that all have arrays of their own would grow as the square of their number.
const MOST_MADE_UP: usize = 64;

/// Arrays that a message lists.
const MOST_SHOWN: usize = 8;

/// All arrays of one name and association, by part.
struct Same<'a> {
    name: &'a str,
    association: Association,
    by_part: Vec<Option<&'a Array>>,
}

/// The arrays over all points and cells: first those that every part has, then those that some lack.
pub(super) fn join(parts: &[Part], scratch: &Scratch) -> Result<Vec<Array>> {
    let all = matched(parts);
    let numbers = |Part { mesh, .. }: &Part| {
        let of_arrays: usize = mesh.arrays().iter().map(|array| array.values.len()).sum();
        3 * mesh.points().map_or(0, Points::len) + mesh.cells() + of_arrays
    };
    let mut left = parts.iter().map(numbers).sum::<usize>().saturating_mul(MOST_MADE_UP);
    let (mut complete, mut partial) = (Vec::new(), Vec::new());
    let (mut lacking, mut left_out) = (Vec::new(), Vec::new());
    for same in &all {
        let Some(components) = same.components() else {
            left_out.push(format!("\"{}\" (it has different numbers of components)", same.name));
            continue;
        };
        let made_up: usize = same.lacking(parts).map(|part| same.tuples(part).saturating_mul(components)).sum();
        let Some(rest) = left.checked_sub(made_up) else {
            left_out.push(format!("\"{}\" (too few meshes have it)", same.name));
            continue;
        };
        left = rest;
        let array = Array {
            name: same.name.to_owned(),
            association: same.association,
            components,
            values: same.values(parts, components, scratch)?,
        };
        match same.lacking(parts).next() {
            Some(first) if !same.marks_ghosts() => {
                let more = same.lacking(parts).count() - 1;
                let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                lacking.push(format!("\"{}\" (not in {}{more})", same.name, first.path.display()));
                partial.push(array);
            }
            _ => complete.push(array),
        }
    }
    warn("not in every mesh, and cells without a value are not drawn", &lacking);
    warn("left out", &left_out);
    complete.append(&mut partial);
    Ok(complete)
}

fn warn(what: &str, arrays: &[String]) {
    if arrays.is_empty() {
        return;
    }
    let shown = arrays.iter().take(MOST_SHOWN).map(|name| presentable(name.clone())).collect::<Vec<_>>().join(", ");
    let more = arrays.len().saturating_sub(MOST_SHOWN);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    tracing::warn!("arrays {what}: {shown}{more}");
}

/// The arrays in the order in which the parts first name them.
fn matched(parts: &[Part]) -> Vec<Same<'_>> {
    let mut all: Vec<Same<'_>> = Vec::new();
    let mut place_from_key = HashMap::new();
    for (i, part) in parts.iter().enumerate() {
        for array in part.mesh.arrays() {
            let (name, association) = (array.name.as_str(), array.association);
            let place = *place_from_key.entry((name, association)).or_insert_with(|| {
                all.push(Same { name, association, by_part: vec![None; parts.len()] });
                all.len() - 1
            });
            // Of several of one name the first counts.
            all[place].by_part[i].get_or_insert(array);
        }
    }
    all
}

impl Same<'_> {
    fn found(&self) -> impl Iterator<Item = &Array> {
        self.by_part.iter().flatten().copied()
    }

    /// How many values a tuple has; none where parts differ in it.
    fn components(&self) -> Option<usize> {
        let first = self.found().next()?.components;
        self.found().all(|array| array.components == first).then_some(first)
    }

    /// How many tuples the array has, or would have, in a part.
    fn tuples(&self, part: &Part) -> usize {
        match self.association {
            Association::Point => part.mesh.point_count(),
            Association::Cell => part.mesh.cells(),
        }
    }

    /// The parts with points or cells and without the array.
    fn lacking<'p>(&'p self, parts: &'p [Part]) -> impl Iterator<Item = &'p Part> {
        let parts = parts.iter().zip(&self.by_part);
        parts.filter(|(part, array)| array.is_none() && self.tuples(part) > 0).map(|(part, _)| part)
    }

    /// Whether it says which cells are hidden: without it none is.
    fn marks_ghosts(&self) -> bool {
        [GHOST_TYPE, GHOST_LEVELS].contains(&self.name)
    }

    /// The values of all parts; NaN where a part lacks them, of the array's type where that has a NaN.
    fn values(&self, parts: &[Part], components: usize, scratch: &Scratch) -> Result<NumericColumn> {
        let is_single = self.found().all(|array| matches!(array.values, NumericColumn::F32(_)));
        let mut columns: Vec<NumericColumn> = Vec::with_capacity(parts.len());
        for (part, array) in parts.iter().zip(&self.by_part) {
            let len = self.tuples(part).saturating_mul(components);
            columns.push(match array {
                Some(array) => array.values.clone(),
                // A part without points or cells does not widen the others.
                None if len == 0 => continue,
                None if self.marks_ghosts() => collect(scratch, (0..len).map(|_| Ok(0_u8)))?.into(),
                None if is_single => collect(scratch, (0..len).map(|_| Ok(f32::NAN)))?.into(),
                None => collect(scratch, (0..len).map(|_| Ok(f64::NAN)))?.into(),
            });
        }
        numbers::concat(&columns.iter().collect::<Vec<_>>(), scratch)
    }
}
