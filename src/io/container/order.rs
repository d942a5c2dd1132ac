//! Cells in order, found by a sort that keeps to its memory.
//!
//! In: cells in file order. Out: those with a volume along the curve in space, tetrahedra, hexahedra and polyhedra each by themselves;
//! the order is that of [`Dataset::from_cells`], to the bit. Polyhedra, whose faces are in memory, are sorted there.

use std::path::Path;

use glam::DVec3;
use rayon::prelude::*;

use super::external_sort::{ExternalSort, Sorted};
use super::write::Phase;
use crate::columns::{
    Built, CellCounts, CellSource, Dataset, FaceLists, HexShape, Placement, canonical_from_point, describe,
    orientation_of,
};
use crate::error::{Error, Result};

/// Cells that are handled at once: enough for all threads, some tens of megabytes.
pub(super) const CELLS_AT_ONCE: usize = 64 * Dataset::BLOCK_CELLS;

/// What is told of the progress: phase, done, of how many.
pub(super) type Tell<'a> = &'a (dyn Fn(Phase, u64, u64) + Sync);

/// Words of a record: key in two words, tetrahedron.
pub(super) const TET_WORDS: usize = 3;

/// Words of a record: key in two words, hexahedron, shape. What its shape follows from is not kept until it is written.
pub(super) const HEX_WORDS: usize = 4;

/// Cells with a volume, in order.
pub(super) struct Ordered<'a> {
    pub(super) placement: Placement,
    pub(super) counts: CellCounts,
    pub(super) tets: InOrder<'a, TET_WORDS>,
    pub(super) hexahedra: InOrder<'a, HEX_WORDS>,
    pub(super) polyhedra: Built,
    /// What the points of polyhedra are compared by; of no length where there are none.
    pub(super) canonical: Vec<u32>,
}

/// Cells of one kind in order.
pub(super) struct InOrder<'a, const N: usize> {
    pub(super) cells: usize,
    sorted: Sorted<'a, N>,
}

impl<const N: usize> InOrder<'_, N> {
    /// The next records, at most [`CELLS_AT_ONCE`]; none at the end.
    pub(super) fn next(&mut self) -> Result<Vec<[u32; N]>> {
        let mut records = Vec::new();
        while records.len() < CELLS_AT_ONCE
            && let Some(record) = self.sorted.next()?
        {
            records.push(record);
        }
        Ok(records)
    }
}

/// Checks the cells of `source` and puts those with a volume in order.
pub(super) fn order<'a>(source: &dyn CellSource, path: &'a Path, memory_bytes: u64, tell: Tell) -> Result<Ordered<'a>> {
    let (low, high) = extent(source)?;
    let points = source.points();
    let placement = Placement::new(points, low, high);
    let position = |v: u32| placement.position(points.get(v as usize));
    let (tets, hexahedra) = (source.tets(), source.hexahedra());
    // Both wait to be written: each has its part of the memory.
    let of_tets = share(memory_bytes, tets * TET_WORDS, hexahedra.len() * HEX_WORDS);
    let no_faces = FaceLists::default();
    let (faces, file_from) = source.polyhedra().unwrap_or((&no_faces, &[]));
    let mut sorting = Sorting { path, counts: source.counts(), done: 0, cells: tets + hexahedra.len(), tell };

    let of_tet = |tet: u32| {
        let corners = source.tet(tet as usize).map(position);
        let sign = orientation_of(corners);
        let [high, low] = words_of(placement.key(corners));
        (sign != 0).then_some(([high, low, tet], sign < 0))
    };
    let tets = sorting.sort(tets, of_tets, of_tet)?;
    let has_names = !hexahedra.is_empty() || !faces.is_empty();
    let canonical = if has_names { canonical_from_point(points) } else { Vec::new() };
    let of_hexahedron = |hexahedron: u32| {
        let corners = hexahedra[hexahedron as usize];
        let positions = corners.map(position);
        let shape = HexShape::new(positions, corners.map(|v| canonical[v as usize]));
        let [high, low] = words_of(placement.key(positions));
        let bits: u16 = bytemuck::cast(shape);
        (!shape.is_absent()).then_some(([high, low, hexahedron, bits.into()], shape.is_mirrored()))
    };
    let hexahedra = sorting.sort(hexahedra.len(), memory_bytes - of_tets, of_hexahedron)?;
    let polyhedra = Built::new(faces, file_from, &canonical, position, &placement)?;
    let mut counts = sorting.counts;
    counts.inverted += polyhedra.mirrored;
    counts.degenerate += polyhedra.flat;
    if tets.cells + hexahedra.cells + polyhedra.len() == 0 {
        return Err(Error::NoCells { found: describe(&counts) });
    }
    let canonical = if polyhedra.len() == 0 { Vec::new() } else { canonical };
    Ok(Ordered { placement, counts, tets, hexahedra, polyhedra, canonical })
}

/// The part of `bytes` for the first of two that need it like `first` to `second`.
fn share(bytes: u64, first: usize, second: usize) -> u64 {
    (bytes as f64 * (first as f64 / (first + second).max(1) as f64)) as u64
}

fn words_of(key: u64) -> [u32; 2] {
    [(key >> 32) as u32, key as u32]
}

/// What the sorts of both kinds have in common.
struct Sorting<'a, 'b> {
    path: &'a Path,
    counts: CellCounts,
    done: usize,
    cells: usize,
    tell: Tell<'b>,
}

impl<'a> Sorting<'a, '_> {
    /// Sorts `cells` cells by their records; `record` also says whether the cell had to be turned, and nothing of one without volume.
    fn sort<const N: usize>(
        &mut self,
        cells: usize,
        memory_bytes: u64,
        record: impl Fn(u32) -> Option<([u32; N], bool)> + Sync,
    ) -> Result<InOrder<'a, N>> {
        let mut sort = ExternalSort::new(self.path, memory_bytes);
        let (mut kept, mut first) = (0, 0);
        while first < cells {
            let end = (first + CELLS_AT_ONCE.min(sort.room())).min(cells);
            let records: Vec<Option<([u32; N], bool)>> =
                (first..end).into_par_iter().map(|cell| record(cell as u32)).collect();
            let with_volume = records.par_iter().flatten();
            let found = with_volume.clone().count();
            kept += found;
            self.counts.degenerate += (records.len() - found) as u64;
            self.counts.inverted += with_volume.clone().filter(|(_, is_inverted)| *is_inverted).count() as u64;
            sort.push(with_volume.map(|&(record, _)| record))?;
            self.done += end - first;
            first = end;
            (self.tell)(Phase::Order, self.done as u64, self.cells as u64);
        }
        Ok(InOrder { cells: kept, sorted: sort.sorted()? })
    }
}

/// The lowest and highest corner of a box.
type Extent = Result<(DVec3, DVec3)>;

/// The box around all corners of cells.
fn extent(source: &dyn CellSource) -> Extent {
    let (points, limit) = (source.points(), u64::from(u32::MAX) - 1);
    let polyhedra = source.polyhedra();
    let cells = source.tets() + source.hexahedra().len() + polyhedra.map_or(0, |(faces, _)| faces.cells());
    for (column, len) in [("points", points.len() as u64), ("cells", cells as u64)] {
        if len > limit {
            return Err(Error::TooLarge { column, len, limit });
        }
    }
    let nothing = || Ok((DVec3::INFINITY, DVec3::NEG_INFINITY));
    let include_of = |column: &'static str, all: Extent, corners: &[u32], file_cell: &dyn Fn() -> u32| {
        let (mut low, mut high) = all?;
        for &v in corners {
            if v as usize >= points.len() {
                let (cell, len) = (u64::from(file_cell()), points.len() as u64);
                return Err(Error::IndexOutOfRange { column, cell, index: v.into(), len });
            }
            let p = points.get(v as usize);
            if !p.is_finite() {
                return Err(Error::NonFinitePosition { point: v.into(), position: p.to_array() });
            }
            (low, high) = (low.min(p), high.max(p));
        }
        Ok((low, high))
    };
    let include =
        |all: Extent, corners: &[u32], file_cell: &dyn Fn() -> u32| include_of("connectivity", all, corners, file_cell);
    let union = |a: Extent, b: Extent| {
        let ((low, high), (other_low, other_high)) = (a?, b?);
        Ok((low.min(other_low), high.max(other_high)))
    };
    let include_tet = |all, tet| include(all, &source.tet(tet), &|| source.file_cell(tet));
    let include_hexahedron = |all, (hexahedron, corners): (usize, &[u32; 8])| {
        include(all, corners, &|| source.file_from_hexahedron()[hexahedron])
    };
    let tets = (0..source.tets()).into_par_iter().fold(nothing, include_tet);
    let hexahedra = source.hexahedra().par_iter().enumerate().fold(nothing, include_hexahedron);
    let Some((faces, file_from)) = polyhedra else { return tets.chain(hexahedra).reduce(nothing, union) };
    let include_polyhedron = |all, cell: usize| {
        faces.faces(cell).fold(all, |all, around| include_of("faces", all, around, &|| file_from[cell]))
    };
    let polyhedra = (0..faces.cells()).into_par_iter().fold(nothing, include_polyhedron);
    tets.chain(hexahedra).chain(polyhedra).reduce(nothing, union)
}
