//! Checking a container through and through: everything that opening one leaves unread.

use std::fs::File;
use std::path::Path;

use glam::Vec3;
use rayon::prelude::*;
use twox_hash::XxHash3_64;

use super::directory::{ColumnSpan, Directory};
use super::octree;
use super::read::open;
use crate::columns::{BlockCells, BlockView, Dataset, HexShape, orientation_of};
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

/// Reads the whole container: checksums, vertex numbers (in range; of tetrahedra ascending), positions (finite, within their block's
/// box), orientation bits, shapes but for the choice of the diagonals, that polyhedra are closed, neighbours, counts; that points of a
/// regular grid are where it says, and that its octrees are those of its values.
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
    if let Some(cell) = dataset.adjacency.as_ref().and_then(|adjacency| adjacency.first_wrong(&dataset)) {
        let problem = "across one of its faces it names a cell that does not lie there".to_owned();
        return Err(malformed(format!("cell {cell}"), problem));
    }
    let hexahedra = dataset.hexahedra.view();
    let absent = (0..hexahedra.len()).into_par_iter().filter(|&cell| hexahedra.shape(cell).is_absent()).count();
    if absent != dataset.hexahedra.absent() {
        return Err(malformed(
            "column shapes".to_owned(),
            format!("{absent} cells are absent, not as many as it says"),
        ));
    }
    if let Some((place, problem)) = octree::problem_of(path, use_map, &dataset)? {
        return Err(malformed(place, problem));
    }
    let bytes = spans.iter().map(|(_, span, _)| span.bytes).sum();
    Ok(Checked { columns: spans.len() as u64, bytes })
}

/// The first cell of a block that is not as it must be, and what is wrong with it.
fn problem_of(dataset: &Dataset, block: usize) -> Option<(usize, &'static str)> {
    let view = dataset.block(block);
    let of_cell = |cell: usize| match &view.cells {
        BlockCells::Tets(tets) => problem_of_tet(dataset, &view, cell, tets.get(cell)),
        BlockCells::Hexahedra(hexahedra) => {
            problem_of_hexahedron(dataset, &view, view.base + cell, (hexahedra.get(cell), hexahedra.shape(cell)))
        }
        BlockCells::Polyhedra(polyhedra) => {
            let position = |v: u32| Vec3::from_array(view.positions[v as usize]);
            let is_outside = polyhedra.corners(cell).iter().any(|&v| is_outside(&view, position(v)));
            if is_outside { Some(OUTSIDE) } else { polyhedra.problem_of(cell, position) }
        }
    };
    (0..view.len()).find_map(|cell| of_cell(cell).map(|problem| (view.base + cell, problem)))
}

/// Whether a position is outside the block's box.
fn is_outside(view: &BlockView, p: Vec3) -> bool {
    p.cmplt(view.bounds.min).any() || p.cmpgt(view.bounds.max).any()
}

const OUTSIDE: &str = "it lies outside its block's box";

/// Of the block's cell `cell`.
fn problem_of_tet(dataset: &Dataset, view: &BlockView, cell: usize, tet: [u32; 4]) -> Option<&'static str> {
    // A number beyond the last vertex reads as the last one: not ascending, but for a cell that has just one such.
    if !tet.is_sorted_by(|a, b| a < b) {
        return Some("its vertices are not ascending, or there are none of these numbers");
    }
    let corners = tet.map(|v| Vec3::from_array(view.positions[v as usize]));
    if corners.iter().any(|&p| is_outside(view, p)) {
        return Some(OUTSIDE);
    }
    let sign = orientation_of(corners);
    if sign == 0 || (sign > 0) != dataset.positive.get(view.base + cell) {
        return Some("its orientation bit is wrong");
    }
    None
}

/// Of cell `cell` of the dataset.
fn problem_of_hexahedron(
    dataset: &Dataset,
    view: &BlockView,
    cell: usize,
    (corners, shape): ([u32; 8], HexShape),
) -> Option<&'static str> {
    let listed = dataset.hexahedra.listed_corners().get(cell - dataset.tets.len());
    if listed.is_some_and(|listed| listed.iter().any(|&v| v as usize >= view.positions.len())) {
        return Some("it names vertices that there are none of");
    }
    let corners = corners.map(|v| Vec3::from_array(view.positions[v as usize]));
    if !shape.fits(corners) {
        return Some("its shape is not that of its corners");
    }
    let is_drawn_outside = !shape.is_absent() && corners.iter().any(|&p| is_outside(view, p));
    is_drawn_outside.then_some(OUTSIDE)
}
