//! Checking a container through and through: everything that opening one leaves unread.

use std::fs::File;
use std::path::Path;

use glam::Vec3;
use rayon::prelude::*;
use twox_hash::XxHash3_64;

use super::directory::{ColumnSpan, Directory};
use super::read::open;
use crate::columns::{BlockCells, Dataset, orientation_of};
use crate::error::{Error, Result, presentable};
use crate::io::mapping::bytes_of;

/// What was checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checked {
    /// Columns whose checksums are right.
    pub columns: u64,
    /// Their bytes.
    pub bytes: u64,
}

/// Reads the whole container: checksums, vertex numbers (ascending, in range), positions (finite, within their block's
/// box), orientation bits, neighbours.
///
/// # Errors
/// [`Error::Malformed`] with the first column, block or cell that is wrong.
pub fn check(path: &Path, use_map: bool) -> Result<Checked> {
    let at = |source| Error::Io { path: path.to_owned(), source };
    let (bytes, _) = bytes_of(path, File::open(path).map_err(at)?, use_map)?;
    let bytes = (*bytes).as_ref();
    let directory = Directory::read(bytes, path)?;
    let malformed = |place: String, problem: String| Error::Malformed {
        path: path.to_owned(),
        place: presentable(place),
        problem: presentable(problem),
    };
    let spans = directory.spans().map_err(|(place, problem)| malformed(place, problem))?;
    let is_wrong = |(_, span, _): &&ColumnSpan| {
        XxHash3_64::oneshot(&bytes[span.offset as usize..][..span.bytes as usize]) != span.xxh3
    };
    if let Some((name, _, _)) = spans.par_iter().find_first(is_wrong) {
        return Err(malformed(format!("column {name}"), "its checksum is wrong; the file is damaged".to_owned()));
    }

    let dataset = open(path, use_map)?;
    if let Some(vertex) = dataset.positions.par_iter().position_first(|p| !Vec3::from_array(*p).is_finite()) {
        return Err(malformed("column positions".to_owned(), format!("vertex {vertex} is not at a finite place")));
    }
    let problem = (0..dataset.blocks.len()).into_par_iter().find_map_first(|block| problem_of(&dataset, block));
    if let Some((cell, problem)) = problem {
        return Err(malformed(format!("cell {cell}"), problem.to_owned()));
    }
    let bytes = spans.iter().map(|(_, span, _)| span.bytes).sum();
    Ok(Checked { columns: spans.len() as u64, bytes })
}

/// The first cell of a block that is not as it must be.
fn problem_of(dataset: &Dataset, block: usize) -> Option<(usize, &'static str)> {
    let view = dataset.block(block);
    let BlockCells::Tets(tets) = &view.cells else { return None };
    let wrong = |(cell, tet): (usize, [u32; 4])| {
        // A number beyond the last vertex reads as the last one: not ascending, but for a cell that has just one such.
        if !tet.is_sorted_by(|a, b| a < b) {
            return Some((cell, "its vertices are not ascending, or there are none of these numbers"));
        }
        let corners = tet.map(|v| Vec3::from_array(view.positions[v as usize]));
        if corners.iter().any(|p| p.cmplt(view.bounds.min).any() || p.cmpgt(view.bounds.max).any()) {
            return Some((cell, "it lies outside its block's box"));
        }
        let sign = orientation_of(corners);
        if sign == 0 || (sign > 0) != dataset.positive.get(view.base + cell) {
            return Some((cell, "its orientation bit is wrong"));
        }
        let Some(adjacency) = &dataset.adjacency else { return None };
        let cell = view.base + cell;
        let is_mutual = |other: u32| adjacency.get(other as usize).is_some_and(|back| back.contains(&(cell as u32)));
        let is_wrong = adjacency[cell].iter().any(|&other| other != u32::MAX && !is_mutual(other));
        is_wrong.then_some((cell - view.base, "it has a neighbour whose neighbour it is not"))
    };
    tets.iter().enumerate().find_map(wrong).map(|(cell, problem)| (view.base + cell, problem))
}
