//! Cells in order: found by a sort that keeps to its memory, then written block by block.
//!
//! The order, the numbers of the vertices and the orientations are those of [`Dataset::from_tets`], to the bit.

use std::path::Path;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::directory::Span;
use super::external_sort::{ExternalSort, Sorted};
use super::sink::{ColumnWriter, Sink};
use super::write::Phase;
use crate::columns::{
    Association, BlockIds, Bounds, CellCounts, Dataset, Placement, TetSource, UNUSED, describe, orientation_of,
};
use crate::error::{Error, Result};

/// Cells that are handled at once: enough for all threads, some tens of megabytes.
const CELLS_AT_ONCE: usize = 64 * Dataset::BLOCK_CELLS;

/// What is told of the progress: phase, done, of how many.
pub(super) type Tell<'a> = &'a (dyn Fn(Phase, u64, u64) + Sync);

/// Cells with a volume, in order.
pub(super) struct Ordered<'a> {
    pub(super) placement: Placement,
    pub(super) counts: CellCounts,
    pub(super) cells: usize,
    /// Key in two words, tetrahedron.
    sorted: Sorted<'a, 3>,
}

/// Checks the tetrahedra of `source` and puts those with a volume in order.
pub(super) fn order<'a>(source: &dyn TetSource, path: &'a Path, memory_bytes: u64, tell: Tell) -> Result<Ordered<'a>> {
    let (low, high) = extent(source)?;
    let placement = Placement::new(source.points(), low, high);
    let mut counts = source.counts();
    let mut sort = ExternalSort::new(path, memory_bytes);
    let mut cells = 0;
    let mut first = 0;
    while first < source.tets() {
        let end = (first + CELLS_AT_ONCE.min(sort.room())).min(source.tets());
        let keyed: Vec<Option<(u64, u32, bool)>> = (first..end)
            .into_par_iter()
            .map(|tet| {
                let corners = source.tet(tet).map(|v| placement.position(source.points().get(v as usize)));
                let sign = orientation_of(corners);
                (sign != 0).then(|| (placement.key(corners), tet as u32, sign < 0))
            })
            .collect();
        let with_volume = keyed.par_iter().flatten();
        let kept = with_volume.clone().count();
        cells += kept;
        counts.degenerate += (keyed.len() - kept) as u64;
        counts.inverted += with_volume.clone().filter(|(_, _, is_inverted)| *is_inverted).count() as u64;
        sort.push(with_volume.map(|&(key, tet, _)| [(key >> 32) as u32, key as u32, tet]))?;
        first = end;
        tell(Phase::Order, first as u64, source.tets() as u64);
    }
    if cells == 0 {
        return Err(Error::NoCells { found: describe(&counts) });
    }
    Ok(Ordered { placement, counts, cells, sorted: sort.sorted()? })
}

/// The box around all corners of cells.
fn extent(source: &dyn TetSource) -> Result<(DVec3, DVec3)> {
    let (points, limit) = (source.points(), u64::from(u32::MAX) - 1);
    for (column, len) in [("points", points.len() as u64), ("cells", source.tets() as u64)] {
        if len > limit {
            return Err(Error::TooLarge { column, len, limit });
        }
    }
    let nothing = || Ok((DVec3::INFINITY, DVec3::NEG_INFINITY));
    let include = |all: Result<(DVec3, DVec3)>, tet: usize| {
        let (mut low, mut high) = all?;
        for v in source.tet(tet) {
            if v as usize >= points.len() {
                let (cell, len) = (u64::from(source.file_cell(tet)), points.len() as u64);
                return Err(Error::IndexOutOfRange { column: "connectivity", cell, index: v.into(), len });
            }
            let p = points.get(v as usize);
            if !p.is_finite() {
                return Err(Error::NonFinitePosition { point: v.into(), position: p.to_array() });
            }
            (low, high) = (low.min(p), high.max(p));
        }
        Ok((low, high))
    };
    let union = |a: Result<(DVec3, DVec3)>, b: Result<(DVec3, DVec3)>| {
        let ((low, high), (other_low, other_high)) = (a?, b?);
        Ok((low.min(other_low), high.max(other_high)))
    };
    (0..source.tets()).into_par_iter().fold(nothing, include).reduce(nothing, union)
}

/// The columns of the cells.
pub(super) struct WrittenCells {
    pub(super) orientation: Span,
    pub(super) tetrahedra: Span,
    pub(super) block_ids: Vec<BlockIds>,
    pub(super) block_bounds: Vec<[[f32; 3]; 2]>,
    /// Of the cell arrays, in their order.
    pub(super) cell_arrays: Vec<Span>,
    /// The file's point of each vertex.
    pub(super) file_from_vertex: Vec<u32>,
}

/// Writes the cells of `ordered` and their arrays.
pub(super) fn write(
    source: &dyn TetSource,
    ordered: &mut Ordered,
    sink: &mut Sink,
    tell: Tell,
) -> Result<WrittenCells> {
    let cells = ordered.cells;
    let mut orientation = sink.column(Some(cells.div_ceil(64) as u64 * 8));
    let mut cell_arrays: Vec<(usize, ColumnWriter)> = Vec::new();
    for (i, head) in source.arrays().into_iter().enumerate() {
        if head.association == Association::Cell {
            let mut one = Vec::new();
            source.append_values(i, &[0], &mut one);
            cell_arrays.push((i, sink.column(Some((one.len() * cells) as u64))));
        }
    }
    let mut tetrahedra = sink.column(None);
    let mut ids_bytes = 0;

    let mut vertex_from_file = vec![UNUSED; source.points().len()];
    let mut file_from_vertex = Vec::new();
    let (mut block_ids, mut block_bounds) = (Vec::new(), Vec::new());
    let mut tets = Vec::new();
    let mut done = 0;
    while done < cells {
        tets.clear();
        while tets.len() < CELLS_AT_ONCE
            && let Some([_, _, tet]) = ordered.sorted.next()?
        {
            tets.push(tet);
        }
        let corners: Vec<[u32; 4]> = tets.par_iter().map(|&tet| source.tet(tet as usize)).collect();
        for &point in corners.as_flattened() {
            let vertex = &mut vertex_from_file[point as usize];
            if *vertex == UNUSED {
                *vertex = file_from_vertex.len() as u32;
                file_from_vertex.push(point);
            }
        }
        let position = |point: u32| ordered.placement.position(source.points().get(point as usize));
        let encode = |cells: &[[u32; 4]]| EncodedBlock::new(cells, &vertex_from_file, position);
        let blocks: Vec<EncodedBlock> = corners.par_chunks(Dataset::BLOCK_CELLS).map(encode).collect();
        for block in &blocks {
            block_ids.push(BlockIds { start: (ids_bytes / BlockIds::UNIT_BYTES) as u32, base: block.base });
            block_bounds.push([block.bounds.min.to_array(), block.bounds.max.to_array()]);
            ids_bytes += block.ids.len();
            sink.append(&mut orientation, bytemuck::cast_slice(&block.orientation))?;
            sink.append(&mut tetrahedra, &block.ids)?;
        }

        let file_cells: Vec<u32> = tets.par_iter().map(|&tet| source.file_cell(tet as usize)).collect();
        for (array, column) in &mut cell_arrays {
            append_values(source, *array, &file_cells, sink, column)?;
        }
        done += tets.len();
        tell(Phase::Cells, done as u64, cells as u64);
    }
    let tetrahedra = sink.finish(tetrahedra)?;
    let orientation = sink.finish(orientation)?;
    let cell_arrays = cell_arrays.into_iter().map(|(_, column)| sink.finish(column)).collect::<Result<_>>()?;
    Ok(WrittenCells { orientation, tetrahedra, block_ids, block_bounds, cell_arrays, file_from_vertex })
}

/// Appends the values of some tuples, gathered in parallel.
pub(super) fn append_values(
    source: &dyn TetSource,
    array: usize,
    tuples: &[u32],
    sink: &mut Sink,
    column: &mut ColumnWriter,
) -> Result<()> {
    let gather = |tuples: &[u32]| {
        let mut bytes = Vec::new();
        source.append_values(array, tuples, &mut bytes);
        bytes
    };
    let parts: Vec<Vec<u8>> = tuples.par_chunks(Dataset::BLOCK_CELLS).map(gather).collect();
    parts.iter().try_for_each(|bytes| sink.append(column, bytes))
}

/// A block as it stands in the file.
struct EncodedBlock {
    /// Vertex numbers of 16 or of 32 bits, to a multiple of 64 bytes.
    ids: Vec<u8>,
    base: u32,
    orientation: Vec<u64>,
    bounds: Bounds,
}

impl EncodedBlock {
    fn new(cells: &[[u32; 4]], vertex_from_file: &[u32], position: impl Fn(u32) -> Vec3) -> Self {
        let mut bounds = Bounds::EMPTY;
        let mut orientation = vec![0; cells.len().div_ceil(64)];
        let mut numbered: Vec<[u32; 4]> = Vec::with_capacity(cells.len());
        for (cell, corners) in cells.iter().enumerate() {
            let mut corners = corners.map(|point| (vertex_from_file[point as usize], point));
            corners.sort_unstable();
            let positions = corners.map(|(_, point)| position(point));
            bounds = positions.into_iter().fold(bounds, Bounds::include);
            orientation[cell / 64] |= u64::from(orientation_of(positions) > 0) << (cell % 64);
            numbered.push(corners.map(|(vertex, _)| vertex));
        }
        let ids = numbered.as_flattened();
        let (least, greatest) = ids.iter().fold((u32::MAX, 0), |(low, high), &id| (id.min(low), id.max(high)));
        let is_narrow = u16::try_from(greatest - least).is_ok();
        let mut bytes: Vec<u8> = if is_narrow {
            ids.iter().flat_map(|&id| ((id - least) as u16).to_le_bytes()).collect()
        } else {
            ids.iter().flat_map(|&id| id.to_le_bytes()).collect()
        };
        bytes.resize(bytes.len().next_multiple_of(BlockIds::UNIT_BYTES), 0);
        Self { ids: bytes, base: if is_narrow { least } else { BlockIds::WIDE }, orientation, bounds }
    }
}
