//! Opening a container: its columns in place, none copied, none read through.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use bytemuck::Pod;
use glam::{DVec3, Vec3};

use super::directory::{Directory, MAGIC, Span};
use crate::cells::{HEXAHEDRON, PYRAMID, TETRAHEDRON, WEDGE};
use crate::columns::{
    Array, ArrayRanges, Association, BitColumn, Block, Bounds, Column, Dataset, Hexahedra, Neighbours, NumericColumn,
    Polyhedra, SharedBytes, Tets, ValueRanges,
};
use crate::error::{Error, Result, presentable, without_controls};
use crate::io::face_streams::POLYHEDRON;
use crate::io::mapping::bytes_of;

/// Whether the file at `path` begins as a container does.
///
/// # Errors
/// [`Error::Io`] where it cannot be read.
pub fn is_container(path: &Path) -> Result<bool> {
    let at = |source| Error::Io { path: path.to_owned(), source };
    let mut head = Vec::new();
    File::open(path).map_err(at)?.take(MAGIC.len() as u64).read_to_end(&mut head).map_err(at)?;
    Ok(head == MAGIC)
}

/// Opens a container: in place through a memory map, or (`use_map` false) read whole.
///
/// Header, directory, and the layout of all columns are checked, the contents are not: that would read all of a file that may be
/// larger than memory. [`check`](super::check()) does. Only the faces of polyhedra are read through, into memory. A vertex number beyond the last vertex reads as the last one. Whole cells
/// stay whole; [`Dataset::into_tetrahedra`] cuts them.
///
/// # Errors
/// [`Error::Io`]; [`Error::Malformed`] with the column and what is wrong with it.
pub fn open(path: &Path, use_map: bool) -> Result<Dataset> {
    if cfg!(target_endian = "big") {
        let (what, advice) = ("a container on a big-endian machine", "open the file it was made from");
        return Err(Error::Unsupported { path: path.to_owned(), what: what.to_owned(), advice: advice.to_owned() });
    }
    let file = File::open(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
    let (bytes, backing) = bytes_of(path, file, use_map)?;
    let directory = Directory::read((*bytes).as_ref(), path)?;
    let columns = Columns { bytes, path };

    let vertices = directory.vertices as usize;
    let by_kind = directory.by_kind().map(|cells| cells as usize);
    let [of_tets, of_hexahedra, _] = by_kind;
    let positions = columns.of("positions", directory.positions)?;
    let words = columns.of("orientation", directory.orientation)?;
    let wrong = |place: &str, problem: &str| columns.malformed(place, problem.to_owned());
    let positive = BitColumn::from_words(words, of_tets).ok_or_else(|| wrong("orientation", "bits are missing"))?;
    let tets = Tets::blocked(
        columns.of("tetrahedra", directory.tetrahedra)?,
        columns.of("tetrahedra", directory.tetrahedra)?,
        columns.of("block_ids", directory.block_ids)?,
        of_tets,
        vertices,
    )
    .map_err(|error| columns.malformed("column tetrahedra", error.to_string()))?;
    let of_listed = directory.hexahedra.as_ref().and_then(|entry| entry.adjacency);
    let hexahedra = directory
        .hexahedra
        .as_ref()
        .map_or_else(|| Ok(Hexahedra::none()), |entry| entry.column(&columns.bytes, vertices));
    let hexahedra = hexahedra.map_err(|error| columns.malformed("hexahedra", error.to_string()))?;

    let polyhedra =
        directory.polyhedra.map_or_else(|| Ok(Polyhedra::none()), |entry| entry.column(&columns.bytes, vertices));
    let polyhedra = polyhedra.map_err(|(column, problem)| columns.malformed(&format!("column {column}"), problem))?;

    let neighbours = |from_tet: Span| {
        let from_hexahedron = of_listed.map(|span| columns.of("adjacency of hexahedra", span)).transpose()?;
        let from_hexahedron = from_hexahedron.unwrap_or_else(|| Vec::new().into());
        Ok(Neighbours { from_tet: columns.of("adjacency", from_tet)?, from_hexahedron })
    };
    let adjacency = directory.adjacency.map(neighbours).transpose()?;

    let block_bounds: Column<[[f32; 3]; 2]> = columns.of("block_bounds", directory.block_bounds)?;
    let mut blocks = Vec::with_capacity(block_bounds.len());
    let mut bounds = Bounds::EMPTY;
    for (i, (cells, &[min, max])) in Dataset::runs(by_kind).zip(&block_bounds[..]).enumerate() {
        let block = Bounds { min: Vec3::from_array(min), max: Vec3::from_array(max) };
        let is_box = block.min.cmple(block.max).all() && block.min.is_finite() && block.max.is_finite();
        // Of hexahedra, a block may have none that is drawn.
        let may_be_empty = (of_tets..of_tets + of_hexahedra).contains(&cells.start) && block == Bounds::EMPTY;
        if !is_box && !may_be_empty {
            return Err(columns.malformed("column block_bounds", format!("the box of block {i} is none")));
        }
        bounds = bounds.union(block);
        blocks.push(Block { cells, bounds: block });
    }
    if bounds == Bounds::EMPTY {
        return Err(columns.malformed("column block_bounds", "there is nothing in any block".to_owned()));
    }

    let (arrays, array_ranges) = columns.arrays(&directory)?;
    Ok(Dataset {
        origin: DVec3::from_array(directory.origin),
        positions,
        tets,
        hexahedra,
        polyhedra,
        positive,
        file_from_vertex: None,
        file_from_cell: None,
        arrays,
        array_ranges,
        adjacency,
        blocks,
        bounds,
        counts: directory.counts,
        read_bytes: if use_map { 0 } else { (*columns.bytes).as_ref().len() as u64 },
        backing,
    })
}

/// The cells of a container by VTK's code of their kind, those included that are not drawn; from its directory. Prisms are polyhedra there.
///
/// # Errors
/// As [`open`].
pub fn cells_by_kind(path: &Path, use_map: bool) -> Result<Vec<(u8, u64)>> {
    let file = File::open(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
    let (bytes, _) = bytes_of(path, file, use_map)?;
    let directory = Directory::read((*bytes).as_ref(), path)?;
    let [tets, hexahedra, polyhedra] = directory.by_kind();
    let (wedges, pyramids) = directory.hexahedra.map_or((0, 0), |entry| (entry.wedges, entry.pyramids));
    let all = [
        (TETRAHEDRON.code, tets),
        (HEXAHEDRON.code, hexahedra - wedges - pyramids),
        (WEDGE.code, wedges),
        (PYRAMID.code, pyramids),
        (POLYHEDRON, polyhedra),
    ];
    Ok(all.into_iter().filter(|&(_, cells)| cells > 0).collect())
}

/// The bytes of a container, of which columns are parts.
pub(super) struct Columns<'a> {
    pub(super) bytes: SharedBytes,
    pub(super) path: &'a Path,
}

impl Columns<'_> {
    /// The arrays, and what is known of their values.
    pub(super) fn arrays(&self, directory: &Directory) -> Result<(Vec<Array>, Vec<ArrayRanges>)> {
        let mut arrays = Vec::with_capacity(directory.arrays.len());
        let mut array_ranges = Vec::with_capacity(directory.arrays.len());
        for entry in &directory.arrays {
            let tuples = match entry.association {
                Association::Point => directory.vertices,
                Association::Cell => directory.cells,
            };
            let size = entry.values.bytes / (tuples * entry.components).max(1);
            let len = entry.values.bytes / size.max(1);
            let shared = NumericColumn::shared(
                &entry.number_type,
                &entry.name,
                Arc::clone(&self.bytes),
                entry.values.offset as usize,
                len as usize,
            );
            let not_in_place = || self.malformed(&format!("array {:?}", entry.name), "not in place".to_owned());
            let values = shared.ok().flatten().ok_or_else(not_in_place)?;
            let mut by_component = Vec::with_capacity(entry.ranges.len());
            for range in &entry.ranges {
                let [low, high] = range.range.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
                by_component.push(ValueRanges {
                    range: (low, high),
                    invalid: range.invalid_cells,
                    blocks: self.of("ranges", range.block_ranges)?,
                });
            }
            array_ranges.push(ArrayRanges { by_component });
            let (association, components) = (entry.association, entry.components as usize);
            arrays.push(Array { name: without_controls(entry.name.clone()), association, components, values });
        }
        Ok((arrays, array_ranges))
    }

    pub(super) fn of<T: Pod>(&self, name: &str, span: Span) -> Result<Column<T>> {
        span.column(name, &self.bytes).map_err(|error| self.malformed(&format!("column {name}"), error.to_string()))
    }

    pub(super) fn malformed(&self, place: &str, problem: String) -> Error {
        let (place, problem) = (presentable(place.to_owned()), presentable(problem));
        Error::Malformed { path: self.path.to_owned(), place, problem }
    }
}
