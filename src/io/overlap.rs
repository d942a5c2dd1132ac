//! Cells that several pieces of a structured grid have: layers around each piece that belong to its neighbours.

use std::collections::HashSet;
use std::ops::Range;

use super::StructuredMesh;
use super::assemble::DUPLICATE_CELL;
use super::vtk_xml::Extent;

/// How often cells may be there on average. A block of two cells an axis with a layer all around it has each cell eight times.
const MOST_TIMES: usize = 64;

/// Marks all cells but the first of those that several blocks have; block b holds `extents[b]`. The error is a sentence about
/// the extents.
///
/// A sweep along the axis with the most different beginnings; only blocks that meet there are compared.
pub(super) fn hide_shared_cells(mesh: &mut StructuredMesh, extents: &[Extent]) -> Result<(), String> {
    let axis = (0..3).max_by_key(|&axis| extents.iter().map(|extent| extent.first(axis)).collect::<HashSet<_>>().len());
    let axis = axis.unwrap_or(0);
    let mut order: Vec<usize> = (0..extents.len()).collect();
    order.sort_by_key(|&block| extents[block].first(axis));

    let mut left = mesh.cells().saturating_mul(MOST_TIMES);
    let mut shared_cells = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    for block in order {
        open.retain(|&other| extents[other].last(axis) > extents[block].first(axis));
        for &other in &open {
            let (earlier, later) = (block.min(other), block.max(other));
            let Some(shared) = shared(extents[earlier], extents[later]) else { continue };
            let count: usize = shared.iter().map(ExactSizeIterator::len).product();
            left = left.checked_sub(count).ok_or("overlap too often: each cell belongs to one piece")?;
            let block = mesh.blocks()[later];
            let [ni, nj, _] = block.dims();
            let [i, j, k] = shared;
            for (j, k) in k.flat_map(|k| j.clone().map(move |j| (j, k))) {
                let row = block.first_cell() + (ni - 1) * (j + (nj - 1) * k);
                shared_cells.extend(i.clone().map(|i| row + i));
            }
        }
        open.push(block);
    }
    if !shared_cells.is_empty() {
        mesh.mark(DUPLICATE_CELL, &shared_cells);
    }
    Ok(())
}

/// The cells that both have, as `later` numbers them along its axes.
fn shared(earlier: Extent, later: Extent) -> Option<[Range<usize>; 3]> {
    let along = |axis: usize| {
        let (low, high) = (earlier.first(axis).max(later.first(axis)), earlier.last(axis).min(later.last(axis)));
        let from_first = |point: i64| (point - later.first(axis)) as usize;
        (low < high).then(|| from_first(low)..from_first(high))
    };
    Some([along(0)?, along(1)?, along(2)?])
}
