//! Cells as they stand in the file, written block by block in the order in which the sort hands them over.
//!
//! The numbers of the vertices, orientations and shapes are those of [`Dataset::from_cells`], to the bit.

use glam::Vec3;
use rayon::prelude::*;

use super::directory::{HexahedraEntry, PolyhedraEntry, Span};
use super::order::{CELLS_AT_ONCE, HEX_WORDS, InOrder, Ordered, TET_WORDS, Tell};
use super::sink::{ColumnWriter, Sink};
use super::write::Phase;
use crate::columns::{
    Association, BlockIds, Bounds, Built, CellSource, Dataset, HexShape, Placement, Polyhedra, UNUSED, orientation_of,
};
use crate::error::Result;

/// The columns of the cells.
pub(super) struct WrittenCells {
    pub(super) orientation: Span,
    pub(super) tetrahedra: Span,
    pub(super) hexahedra: Option<HexahedraEntry>,
    /// And what they are in memory.
    pub(super) polyhedra: Option<(PolyhedraEntry, Polyhedra)>,
    pub(super) block_ids: Vec<BlockIds>,
    pub(super) block_bounds: Vec<[[f32; 3]; 2]>,
    /// Of the cell arrays, in their order.
    pub(super) cell_arrays: Vec<Span>,
    /// The file's point of each vertex.
    pub(super) file_from_vertex: Vec<u32>,
}

/// Writes the cells of `ordered` and their arrays.
pub(super) fn write(
    source: &dyn CellSource,
    ordered: &mut Ordered,
    sink: &mut Sink,
    tell: Tell,
) -> Result<WrittenCells> {
    let (tets, hexahedra) = (ordered.tets.cells, ordered.hexahedra.cells);
    let cells = tets + hexahedra + ordered.polyhedra.len();
    let orientation = sink.column(Some(tets.div_ceil(64) as u64 * 8));
    let mut cell_arrays: Vec<(usize, ColumnWriter)> = Vec::new();
    for (i, head) in source.arrays().into_iter().enumerate() {
        if head.association == Association::Cell {
            let mut one = Vec::new();
            source.append_values(i, &[0], &mut one);
            cell_arrays.push((i, sink.column(Some((one.len() * cells) as u64))));
        }
    }
    let mut writer = Writer {
        source,
        placement: ordered.placement,
        sink,
        tell,
        vertices: Vertices { vertex_from_file: vec![UNUSED; source.points().len()], file_from_vertex: Vec::new() },
        block_bounds: Vec::new(),
        cell_arrays,
        done: 0,
        cells,
    };
    let (orientation, tetrahedra, block_ids) = writer.tets(&mut ordered.tets, orientation)?;
    let hexahedra = (hexahedra > 0).then(|| writer.hexahedra(&mut ordered.hexahedra)).transpose()?;
    let polyhedra = std::mem::take(&mut ordered.polyhedra);
    let polyhedra = (polyhedra.len() > 0).then(|| writer.polyhedra(polyhedra, &ordered.canonical)).transpose()?;
    let Writer { vertices, block_bounds, cell_arrays, sink, .. } = writer;
    let cell_arrays = cell_arrays.into_iter().map(|(_, column)| sink.finish(column)).collect::<Result<_>>()?;
    let file_from_vertex = vertices.file_from_vertex;
    Ok(WrittenCells {
        orientation,
        tetrahedra,
        hexahedra,
        polyhedra,
        block_ids,
        block_bounds,
        cell_arrays,
        file_from_vertex,
    })
}

/// The columns that cells of all kinds share, while they are written.
struct Writer<'a, 'f> {
    source: &'a dyn CellSource,
    placement: Placement,
    sink: &'a mut Sink<'f>,
    tell: Tell<'a>,
    vertices: Vertices,
    block_bounds: Vec<[[f32; 3]; 2]>,
    /// Arrays over cells, each with its number among all.
    cell_arrays: Vec<(usize, ColumnWriter)>,
    done: usize,
    cells: usize,
}

impl Writer<'_, '_> {
    /// The tetrahedra: orientations, vertex numbers, and how each block numbers them.
    fn tets(
        &mut self,
        ordered: &mut InOrder<TET_WORDS>,
        mut orientation: ColumnWriter,
    ) -> Result<(Span, Span, Vec<BlockIds>)> {
        let (source, placement) = (self.source, self.placement);
        let mut tetrahedra = self.sink.column(None);
        let (mut ids_bytes, mut block_ids) = (0, Vec::new());
        while let records = ordered.next()?
            && !records.is_empty()
        {
            let corners: Vec<[u32; 4]> = records.par_iter().map(|&[.., tet]| source.tet(tet as usize)).collect();
            self.vertices.number(corners.as_flattened());
            let vertices = &self.vertices;
            let encode =
                |cells: &[[u32; 4]]| EncodedBlock::new(cells, vertices, |point| place(source, placement, point));
            let blocks: Vec<EncodedBlock> = corners.par_chunks(Dataset::BLOCK_CELLS).map(encode).collect();
            for block in &blocks {
                block_ids.push(BlockIds { start: (ids_bytes / BlockIds::UNIT_BYTES) as u32, base: block.base });
                self.block_bounds.push(corners_of(block.bounds));
                ids_bytes += block.ids.len();
                self.sink.append(&mut orientation, bytemuck::cast_slice(&block.orientation))?;
                self.sink.append(&mut tetrahedra, &block.ids)?;
            }
            self.append_arrays(
                &records.par_iter().map(|&[.., tet]| source.file_cell(tet as usize)).collect::<Vec<_>>(),
            )?;
        }
        let tetrahedra = self.sink.finish(tetrahedra)?;
        Ok((self.sink.finish(orientation)?, tetrahedra, block_ids))
    }

    /// The hexahedra: corners as they run in the source, and shapes.
    fn hexahedra(&mut self, ordered: &mut InOrder<HEX_WORDS>) -> Result<HexahedraEntry> {
        let (source, placement) = (self.source, self.placement);
        let (listed, file_from) = (source.hexahedra(), source.file_from_hexahedron());
        let cells = ordered.cells as u64;
        let mut corners_column = self.sink.column(Some(cells * size_of::<[u32; 8]>() as u64));
        let mut shapes_column = self.sink.column(Some(cells * size_of::<HexShape>() as u64));
        let (mut wedges, mut pyramids) = (0, 0);
        while let records = ordered.next()?
            && !records.is_empty()
        {
            let corners: Vec<[u32; 8]> =
                records.par_iter().map(|&[_, _, hexahedron, _]| listed[hexahedron as usize]).collect();
            self.vertices.number(corners.as_flattened());
            let bounds_of = |cells: &[[u32; 8]]| {
                let positions = cells.iter().flatten().map(|&point| place(source, placement, point));
                corners_of(positions.fold(Bounds::EMPTY, Bounds::include))
            };
            self.block_bounds.par_extend(corners.par_chunks(Dataset::BLOCK_CELLS).map(bounds_of));
            wedges += corners.iter().filter(|corners| is_wedge(corners)).count() as u64;
            pyramids += corners.iter().filter(|corners| is_pyramid(corners)).count() as u64;
            let numbered: Vec<[u32; 8]> =
                corners.par_iter().map(|corners| corners.map(|point| self.vertices.of(point))).collect();
            let shapes: Vec<u16> = records.par_iter().map(|&[.., shape]| shape as u16).collect();
            self.sink.append(&mut corners_column, bytemuck::cast_slice(&numbered))?;
            self.sink.append(&mut shapes_column, bytemuck::cast_slice(&shapes))?;
            let file_cells = records.par_iter().map(|&[_, _, hexahedron, _]| file_from[hexahedron as usize]);
            self.append_arrays(&file_cells.collect::<Vec<_>>())?;
        }
        let (corners, shapes) = (self.sink.finish(corners_column)?, self.sink.finish(shapes_column)?);
        Ok(HexahedraEntry {
            cells,
            absent: 0,
            wedges,
            pyramids,
            corners: Some(corners),
            blocks: None,
            shapes,
            adjacency: None,
        })
    }

    /// The polyhedra: their faces, each once.
    fn polyhedra(&mut self, built: Built, canonical: &[u32]) -> Result<(PolyhedraEntry, Polyhedra)> {
        let (source, placement) = (self.source, self.placement);
        built.points().for_each(|point| self.vertices.number(&[point]));
        let file_cells = built.file_from_cell.clone();
        let polyhedra = built.finish(|point| self.vertices.of(point), canonical)?;
        let view = polyhedra.view();
        for first in (0..polyhedra.len()).step_by(Dataset::BLOCK_CELLS) {
            let run = first..(first + Dataset::BLOCK_CELLS).min(polyhedra.len());
            let position = |&v: &u32| place(source, placement, self.vertices.file_from_vertex[v as usize]);
            let positions = run.flat_map(|cell| view.corners(cell)).map(position);
            self.block_bounds.push(corners_of(positions.fold(Bounds::EMPTY, Bounds::include)));
        }
        let columns = polyhedra.columns();
        let mut whole = |words: &[u32]| self.sink.whole(bytemuck::cast_slice(words));
        let entry = PolyhedraEntry {
            cells: polyhedra.len() as u64,
            faces: polyhedra.faces() as u64,
            starts: whole(columns.starts.as_flattened())?,
            sides: whole(&columns.sides)?,
            corners: whole(&columns.corners)?,
            face_starts: whole(&columns.face_starts)?,
            around: whole(&columns.around)?,
        };
        file_cells.chunks(CELLS_AT_ONCE).try_for_each(|some| self.append_arrays(some))?;
        Ok((entry, polyhedra))
    }

    /// Appends the values of the next cells to the arrays over cells.
    fn append_arrays(&mut self, file_cells: &[u32]) -> Result<()> {
        for (array, column) in &mut self.cell_arrays {
            let values = |tuples: &[u32], bytes: &mut Vec<u8>| self.source.append_values(*array, tuples, bytes);
            append_values(&values, file_cells, self.sink, column)?;
        }
        self.done += file_cells.len();
        (self.tell)(Phase::Cells, self.done as u64, self.cells as u64);
        Ok(())
    }
}

/// A number for each point of the source that a cell has named, in the order in which they first did.
struct Vertices {
    vertex_from_file: Vec<u32>,
    file_from_vertex: Vec<u32>,
}

impl Vertices {
    fn number(&mut self, points: &[u32]) {
        for &point in points {
            let vertex = &mut self.vertex_from_file[point as usize];
            if *vertex == UNUSED {
                *vertex = self.file_from_vertex.len() as u32;
                self.file_from_vertex.push(point);
            }
        }
    }

    fn of(&self, point: u32) -> u32 {
        self.vertex_from_file[point as usize]
    }
}

fn place(source: &dyn CellSource, placement: Placement, point: u32) -> Vec3 {
    placement.position(source.points().get(point as usize))
}

fn corners_of(Bounds { min, max }: Bounds) -> [[f32; 3]; 2] {
    [min.to_array(), max.to_array()]
}

/// Whether the corners repeat as those of a wedge do: see [`hexahedron_of`](crate::cells::hexahedron_of).
fn is_wedge([a, b, c, d, e, f, g, h]: &[u32; 8]) -> bool {
    c == d && g == h && a != b && e != f
}

/// Whether the corners repeat as those of a pyramid do.
fn is_pyramid([a, b, c, d, e, f, g, h]: &[u32; 8]) -> bool {
    e == f && f == g && g == h && a != b && c != d
}

/// Appends the values of some tuples, gathered in parallel by `values`.
pub(super) fn append_values(
    values: &(dyn Fn(&[u32], &mut Vec<u8>) + Sync),
    tuples: &[u32],
    sink: &mut Sink,
    column: &mut ColumnWriter,
) -> Result<()> {
    let gather = |tuples: &[u32]| {
        let mut bytes = Vec::new();
        values(tuples, &mut bytes);
        bytes
    };
    let parts: Vec<Vec<u8>> = tuples.par_chunks(Dataset::BLOCK_CELLS).map(gather).collect();
    parts.iter().try_for_each(|bytes| sink.append(column, bytes))
}

/// A block of tetrahedra as it stands in the file.
struct EncodedBlock {
    /// Vertex numbers of 16 or of 32 bits, to a multiple of 64 bytes.
    ids: Vec<u8>,
    base: u32,
    orientation: Vec<u64>,
    bounds: Bounds,
}

impl EncodedBlock {
    fn new(cells: &[[u32; 4]], vertices: &Vertices, position: impl Fn(u32) -> Vec3) -> Self {
        let mut bounds = Bounds::EMPTY;
        let mut orientation = vec![0; cells.len().div_ceil(64)];
        let mut numbered: Vec<[u32; 4]> = Vec::with_capacity(cells.len());
        for (cell, corners) in cells.iter().enumerate() {
            let mut corners = corners.map(|point| (vertices.of(point), point));
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
