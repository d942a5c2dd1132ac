//! Writing a container, in bounded memory and in one go: the file appears under its name when it is whole.

use std::path::Path;
use std::sync::Arc;

use twox_hash::XxHash3_64;

use super::adjacency;
use super::cells::{self, WrittenCells, append_values};
use super::directory::{ArrayEntry, Directory, Header, HexahedraEntry, Span};
use super::order::{self, Tell};
use super::ranges::{self, Cells};
use super::sink::Sink;
use crate::atomic::AtomicFile;
use crate::columns::{
    Association, BitColumn, CellColumns, CellSource, Column, Dataset, Hexahedra, NumericColumn, Polyhedra, SharedBytes,
    Tets,
};
use crate::error::{Error, Result};
use crate::io::mapping::bytes_of;

/// What to write a container with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WriteOptions {
    /// Memory to keep to, beside the source's points; the sort gets at least 256 KiB.
    pub memory_bytes: u64,
    /// Also write which cells share a face: 16 bytes a tetrahedron, 24 a listed hexahedron.
    pub adjacency: bool,
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self { memory_bytes: 1 << 30, adjacency: false }
    }
}

/// What is going on while a container is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Finding the order of the cells.
    Order,
    /// Writing the cells and their arrays.
    Cells,
    /// Writing the vertices and their arrays.
    Vertices,
    /// Finding which cells share a face.
    Neighbours,
    /// Finding the ranges of the arrays.
    Ranges,
    /// Building the octrees over the arrays of a regular grid.
    Octrees,
}

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written {
    /// Cells with a volume.
    pub cells: u64,
    /// Points that cells use.
    pub vertices: u64,
    /// Length of the file.
    pub file_bytes: u64,
    /// Blocks whose vertices have 16-bit numbers, and all blocks.
    pub narrow_blocks: (u64, u64),
    /// What became of the source's cells.
    pub counts: crate::columns::CellCounts,
}

/// Vertices whose columns are gathered at once.
const VERTICES_AT_ONCE: usize = 1 << 18;

/// Writes the cells of `source` to the container `path`: what [`Dataset::from_cells`] makes of them, to the bit.
///
/// `tell` hears of the progress: phase, done, of how many. Sorting more than the memory holds takes 12 bytes a tetrahedron and 16
/// a hexahedron in a nameless file in the folder of `path`.
///
/// # Errors
/// Those of [`Dataset::from_cells`], [`Error::Io`], [`Error::Unsupported`] on a big-endian machine; what was at `path` is then as it was.
///
/// ```
/// use cellfan::{Dataset, generate, io};
/// let mesh = generate::tets(&generate::Settings { cells: 750, ..Default::default() })?;
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("mesh.cells");
/// let written = io::container::write(&mesh, &path, &Default::default(), &|_, _, _| {})?;
/// assert_eq!((written.cells, written.vertices), (750, 216));
/// let dataset = io::open(&path)?;
/// assert_eq!(dataset.tets.get(7), Dataset::from_tets(mesh)?.tets.get(7));
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn write(source: &dyn CellSource, path: &Path, options: &WriteOptions, tell: Tell) -> Result<Written> {
    check_machine(path)?;
    source.check()?;
    if options.adjacency && source.polyhedra().is_some() {
        let problem = "prisms and polyhedra name the faces that they share; leave it out".to_owned();
        return Err(Error::Option { option: "--adjacency", problem });
    }
    let points = source.points();
    let fixed_bytes = points.len() as u64 * 12;
    let sort_bytes = options.memory_bytes.saturating_sub(fixed_bytes).max(1 << 18);
    let mut file = AtomicFile::create(path)?;
    let mut ordered = order::order(source, path, sort_bytes, tell)?;

    let mut sink = Sink::new(&mut file.writer, path);
    let mut cells = cells::write(source, &mut ordered, &mut sink, tell)?;
    let positions = write_positions(source, &ordered.placement, &cells.file_from_vertex, &mut sink)?;
    let heads = source.arrays();
    let count = heads.len() as u64;
    let mut cell_arrays = cells.cell_arrays.iter().copied();
    let mut arrays = Vec::with_capacity(heads.len());
    for (i, head) in heads.into_iter().enumerate() {
        let values = match head.association {
            Association::Cell => cell_arrays.next().unwrap_or(positions),
            Association::Point => write_point_array(source, i, &cells.file_from_vertex, &mut sink)?,
        };
        tell(Phase::Vertices, i as u64 + 1, count);
        arrays.push(ArrayEntry::new(head, values));
    }
    let block_ids = sink.whole(bytemuck::cast_slice(&cells.block_ids))?;
    let block_bounds = sink.whole(bytemuck::cast_slice(&cells.block_bounds))?;
    let (polyhedra, in_memory) = cells.polyhedra.take().unzip();
    let so_far = SoFar::new((&cells, in_memory), positions, ordered.tets.cells, path, &mut sink)?;
    let mut adjacency = None;
    if options.adjacency {
        let [of_tets, of_hexahedra] = adjacency::write(so_far.cells(), path, sort_bytes, &mut sink, tell)?;
        adjacency = Some(of_tets);
        cells.hexahedra = cells.hexahedra.map(|entry| HexahedraEntry { adjacency: Some(of_hexahedra), ..entry });
    }
    so_far.write_ranges(&mut arrays, &mut sink, tell)?;

    let is_mixed = cells.hexahedra.is_some() || polyhedra.is_some();
    let kind = if is_mixed { Directory::MIXED } else { Directory::TETRAHEDRON };
    let directory = Directory {
        cell_kind: kind.to_owned(),
        cells: (ordered.tets.cells + ordered.hexahedra.cells) as u64 + polyhedra.map_or(0, |entry| entry.cells),
        vertices: cells.file_from_vertex.len() as u64,
        cells_per_block: Dataset::BLOCK_CELLS as u64,
        origin: ordered.placement.origin.to_array(),
        counts: ordered.counts,
        positions,
        orientation: cells.orientation,
        tetrahedra: cells.tetrahedra,
        hexahedra: cells.hexahedra,
        polyhedra,
        block_ids,
        block_bounds,
        adjacency,
        arrays,
        lattice: None,
    };
    let file_bytes = finish(&directory, path, sink)?;
    file.commit()?;
    let narrow = cells.block_ids.iter().filter(|ids| ids.base != crate::columns::BlockIds::WIDE).count();
    Ok(directory.written(file_bytes, (narrow as u64, cells.block_ids.len() as u64)))
}

/// Columns are written as they are in memory.
pub(super) fn check_machine(path: &Path) -> Result<()> {
    if cfg!(target_endian = "little") {
        return Ok(());
    }
    let (what, advice) = ("a container on a big-endian machine", "write it on another");
    Err(Error::Unsupported { path: path.to_owned(), what: what.to_owned(), advice: advice.to_owned() })
}

/// Writes directory and header; the length of the file.
pub(super) fn finish(directory: &Directory, path: &Path, mut sink: Sink) -> Result<u64> {
    let encode = |error: serde_json::Error| Error::Io { path: path.to_owned(), source: error.into() };
    let text = serde_json::to_vec(directory).map_err(encode)?;
    let Span { offset: directory_offset, bytes: directory_bytes, .. } = sink.whole(&text)?;
    let (version, directory_checksum) = (directory.version(), XxHash3_64::oneshot(&text));
    let file_bytes = sink.end();
    sink.header(&Header { version, file_bytes, directory_offset, directory_bytes, directory_checksum }.to_bytes())?;
    Ok(file_bytes)
}

fn write_positions(
    source: &dyn CellSource,
    placement: &crate::columns::Placement,
    file_from_vertex: &[u32],
    sink: &mut Sink,
) -> Result<Span> {
    let mut column = sink.column(Some(file_from_vertex.len() as u64 * 12));
    for some in file_from_vertex.chunks(VERTICES_AT_ONCE) {
        let position = |&point: &u32| placement.position(source.points().get(point as usize)).to_array();
        let positions: Vec<[f32; 3]> = some.iter().map(position).collect();
        sink.append(&mut column, bytemuck::cast_slice(&positions))?;
    }
    sink.finish(column)
}

fn write_point_array(source: &dyn CellSource, array: usize, file_from_vertex: &[u32], sink: &mut Sink) -> Result<Span> {
    let mut one = Vec::new();
    source.append_values(array, &file_from_vertex[..1], &mut one);
    let mut column = sink.column(Some((one.len() * file_from_vertex.len()) as u64));
    for some in file_from_vertex.chunks(VERTICES_AT_ONCE) {
        append_values(&|tuples, bytes| source.append_values(array, tuples, bytes), some, sink, &mut column)?;
    }
    sink.finish(column)
}

/// The file so far, read back: cells and arrays in the order in which they now stand.
struct SoFar {
    bytes: SharedBytes,
    tets: Tets,
    positive: BitColumn,
    hexahedra: Hexahedra,
    polyhedra: Polyhedra,
    positions: Column<[f32; 3]>,
}

impl SoFar {
    fn new(
        (written, polyhedra): (&WrittenCells, Option<Polyhedra>),
        positions: Span,
        tets: usize,
        path: &Path,
        sink: &mut Sink,
    ) -> Result<Self> {
        let (bytes, _) = bytes_of(path, sink.written()?, true)?;
        let vertices = written.file_from_vertex.len();
        let words = written.orientation.column("orientation", &bytes)?;
        let positive = BitColumn::from_words(words, tets).ok_or_else(|| Error::LengthMismatch {
            column: "orientation".to_owned(),
            len: written.orientation.bytes * 8,
            expected: tets as u64,
        })?;
        let (column, ids) = (written.tetrahedra, written.block_ids.clone().into());
        let wide = column.column("tetrahedra", &bytes)?;
        let tets = Tets::blocked(wide, column.column("tetrahedra", &bytes)?, ids, tets, vertices)?;
        let hexahedra = match &written.hexahedra {
            Some(entry) => entry.column(&bytes, vertices)?,
            None => Hexahedra::none(),
        };
        let positions = positions.column("positions", &bytes)?;
        let polyhedra = polyhedra.unwrap_or_else(Polyhedra::none);
        Ok(Self { bytes, tets, positive, hexahedra, polyhedra, positions })
    }

    fn cells(&self) -> CellColumns<'_> {
        let Self { tets, positive, hexahedra, positions, .. } = self;
        CellColumns { tets, positive, hexahedra, positions }
    }

    /// Writes the ranges of the arrays' blocks.
    fn write_ranges(&self, arrays: &mut [ArrayEntry], sink: &mut Sink, tell: Tell) -> Result<()> {
        let count = arrays.len() as u64;
        let Self { tets, hexahedra, polyhedra, positions, .. } = self;
        for (i, array) in arrays.iter_mut().enumerate() {
            let cells = tets.len() + hexahedra.len() + polyhedra.len();
            let tuples = if array.association == Association::Point { positions.len() } else { cells };
            let (components, offset) = (array.components as usize, array.values.offset as usize);
            let bytes = Arc::clone(&self.bytes);
            let values = NumericColumn::shared(&array.number_type, &array.name, bytes, offset, tuples * components)?;
            let Some(values) = values else { continue };
            for ranges in ranges::of_array(Cells { tets, hexahedra, polyhedra }, &values, array.association, components)
            {
                array.ranges.push(ranges.write(sink)?);
            }
            tell(Phase::Ranges, i as u64 + 1, count);
        }
        Ok(())
    }
}
