//! Structured blocks in a container: columns in the order of the source, and no list of corners.
//!
//! In: [`StructuredCells`]. Out: a file, whose columns are those of [`Dataset::from_structured`].

use std::path::Path;

use super::cells::append_values;
use super::directory::{ArrayEntry, Directory, HexahedraEntry};
use super::octree::LatticeEntry;
use super::order::Tell;
use super::ranges::{self, Cells};
use super::sink::Sink;
use super::write::{Phase, Written, check_machine, finish};
use crate::atomic::AtomicFile;
use crate::columns::{Array, ArrayHead, Dataset, HexShape, StructuredCells, Volume};
use crate::error::Result;

/// Tuples whose values are gathered at once.
const TUPLES_AT_ONCE: usize = 1 << 18;

/// Writes structured blocks to the container `path`: what [`Dataset::from_structured`] makes of them, to the bit.
///
/// There is nothing to sort: beside the source's points and arrays it takes 14 bytes a point, and 36 more while coincident points
/// are found. Which cells share a face is not written: it follows from i, j and k.
///
/// # Errors
/// Those of [`Dataset::from_structured`] and [`write()`](super::write()).
///
/// ```
/// use cellfan::io::{self, StructuredMesh, WholeCells};
/// # use cellfan::Points;
/// let points: Vec<[f32; 3]> = (0..12).map(|i| [i % 3, i / 3 % 2, i / 6].map(|c| c as f32)).collect();
/// let mesh = StructuredMesh::new(&[[3, 2, 2]], Points::F32(points), Vec::new())?;
/// let WholeCells::Structured(cells) = mesh.into_whole_in(&io::Scratch::memory())? else { panic!("all have a volume") };
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("mesh.cells");
/// io::container::write_structured(cells, &path, &|_, _, _| {})?;
/// let dataset = io::container::open(&path, true)?;
/// assert_eq!(dataset.hexahedra.view().get(1), [1, 2, 5, 4, 7, 8, 11, 10]);
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn write_structured(cells: StructuredCells, path: &Path, tell: Tell) -> Result<Written> {
    write(cells, None, path, tell)
}

/// The same, beside them the octrees of the regular grid that they are the cells of.
pub(super) fn write(cells: StructuredCells, grid: Option<&Volume>, path: &Path, tell: Tell) -> Result<Written> {
    check_machine(path)?;
    let dataset = Dataset::from_structured(cells)?;
    let mut file = AtomicFile::create(path)?;
    let mut sink = Sink::new(&mut file.writer, path);

    let cells = dataset.hexahedra.len() as u64;
    let positions = sink.whole(bytemuck::cast_slice(&dataset.positions))?;
    let shapes: Vec<HexShape> = (0..dataset.hexahedra.len()).map(|cell| dataset.hexahedra.view().shape(cell)).collect();
    let hexahedra = HexahedraEntry {
        cells,
        absent: dataset.hexahedra.absent() as u64,
        wedges: 0,
        pyramids: 0,
        corners: None,
        blocks: Some(sink.whole(bytemuck::cast_slice(dataset.hexahedra.structured_blocks()))?),
        shapes: sink.whole(bytemuck::cast_slice(&shapes))?,
        adjacency: None,
    };
    drop(shapes);
    tell(Phase::Cells, cells, cells);
    let [orientation, tetrahedra, block_ids] = [sink.whole(&[])?, sink.whole(&[])?, sink.whole(&[])?];
    let bounds = |block: &crate::columns::Block| [block.bounds.min.to_array(), block.bounds.max.to_array()];
    let block_bounds: Vec<[[f32; 3]; 2]> = dataset.blocks.iter().map(bounds).collect();
    let block_bounds = sink.whole(bytemuck::cast_slice(&block_bounds))?;
    let count = dataset.arrays.len() as u64;
    let mut arrays = Vec::with_capacity(dataset.arrays.len());
    for (i, array) in dataset.arrays.iter().enumerate() {
        arrays.push(write_array(array, &dataset, &mut sink)?);
        tell(Phase::Ranges, i as u64 + 1, count);
    }

    let lattice = grid.map(|grid| LatticeEntry::write(grid, &arrays, &mut sink, tell)).transpose()?;
    let directory = Directory {
        cell_kind: Directory::MIXED.to_owned(),
        cells,
        vertices: dataset.positions.len() as u64,
        cells_per_block: Dataset::BLOCK_CELLS as u64,
        origin: dataset.origin.to_array(),
        counts: dataset.counts,
        positions,
        orientation,
        tetrahedra,
        hexahedra: Some(hexahedra),
        polyhedra: None,
        block_ids,
        block_bounds,
        adjacency: None,
        arrays,
        lattice,
    };
    let file_bytes = finish(&directory, path, sink)?;
    file.commit()?;
    Ok(directory.written(file_bytes, (0, 0)))
}

/// Writes an array and the ranges of its values.
fn write_array(array: &Array, dataset: &Dataset, sink: &mut Sink) -> Result<ArrayEntry> {
    let mut column = sink.column(None);
    for first in (0..array.tuples()).step_by(TUPLES_AT_ONCE) {
        let end = (first + TUPLES_AT_ONCE).min(array.tuples());
        let tuples: Vec<u32> = (first as u32..end as u32).collect();
        append_values(&|tuples, bytes| array.append_tuples(tuples, bytes), &tuples, sink, &mut column)?;
    }
    let values = sink.finish(column)?;
    let mut entry = ArrayEntry::new(ArrayHead::from(array), values);
    let cells = Cells { tets: &dataset.tets, hexahedra: &dataset.hexahedra, polyhedra: &dataset.polyhedra };
    for ranges in ranges::of_array(cells, &array.values, array.association, array.components) {
        entry.ranges.push(ranges.write(sink)?);
    }
    Ok(entry)
}
