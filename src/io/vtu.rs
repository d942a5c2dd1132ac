//! `.vtu`: VTK XML unstructured grids, all pieces of a file.

use std::path::Path;

use super::numbers::{push_whole_numbers, whole_numbers};
use super::scratch::Scratch;
use super::source::Source;
use super::vtk_xml::{self, Element, Encoding};
use super::{UnstructuredMesh, offsets};
use crate::error::{Error, Result};

/// Reads a `.vtu` file that is in memory; `path` is its name in messages.
///
/// # Errors
/// [`Error::Malformed`], [`Error::Unsupported`], and [`Error::IndexOutOfRange`] with the file's name.
pub fn read_vtu(bytes: &[u8], path: &Path) -> Result<UnstructuredMesh> {
    read_vtu_in(bytes, path, &Scratch::memory())
}

/// As [`read_vtu`], the columns where `scratch` says.
pub(super) fn read_vtu_in(bytes: &[u8], path: &Path, scratch: &Scratch) -> Result<UnstructuredMesh> {
    let source = Source { path, scratch };
    let pieces = vtk_xml::read_grid(bytes, "UnstructuredGrid", source, |grid, encoding| {
        grid.children_named("Piece").map(|piece| read_piece(piece, encoding, source)).collect()
    })?;
    UnstructuredMesh::concat(pieces, scratch).map_err(|error| error.in_file(path))
}

fn read_piece(piece: &Element<'_>, encoding: &Encoding<'_>, source: Source<'_>) -> Result<UnstructuredMesh> {
    let count = |name| piece.count(name, Some(0), source);
    let (point_count, cell_count) = (count("NumberOfPoints")?, count("NumberOfCells")?);
    let mut mesh = UnstructuredMesh::empty();
    if point_count > 0 {
        mesh.points = vtk_xml::points(piece, point_count, encoding, source)?;
    }
    if cell_count > 0 {
        read_cells(piece, cell_count, encoding, source, &mut mesh)?;
    }
    mesh.arrays = vtk_xml::arrays(piece, point_count, cell_count, encoding, source)?;
    Ok(mesh)
}

fn read_cells(
    piece: &Element<'_>,
    cell_count: usize,
    encoding: &Encoding<'_>,
    source: Source<'_>,
    mesh: &mut UnstructuredMesh,
) -> Result<()> {
    let cells = vtk_xml::child(piece, "Cells", source)?;
    let array = |name: &str| {
        let mut arrays = cells.children_named("DataArray");
        arrays
            .find(|array| array.attribute("Name") == Some(name))
            .ok_or_else(|| source.malformed(cells.place(), format!("holds no <DataArray> {name:?}")))
    };
    let (types, ends, connectivity) = (array("types")?, array("offsets")?, array("connectivity")?);
    let no_number = |array: &Element<'_>, limit| {
        let place = array.place();
        move |i, found| source.malformed(&place, format!("value {i} is {found}, which is no number from 0 to {limit}"))
    };
    let values = encoding.values(types, Some(cell_count))?;
    mesh.types = whole_numbers(&values, 255, source.scratch, no_number(types, 255))?;

    let values = encoding.values(ends, Some(cell_count))?;
    let mut offsets = source.scratch.column();
    offsets.reserve(1);
    offsets.push(0)?;
    push_whole_numbers(&values, i64::MAX as u64, &mut offsets, no_number(ends, i64::MAX))?;
    mesh.offsets = offsets.finish()?;
    let values = encoding.values(connectivity, None)?;
    offsets::check(&mesh.offsets, values.len()).map_err(|problem| source.malformed(ends.place(), problem))?;

    let len = mesh.points.len() as u64;
    let limit = u64::from(u32::MAX) - 1;
    if len > limit {
        return Err(Error::TooLarge { column: "points", len, limit }.in_file(source.path));
    }
    let out_of_range = |i, index| {
        let cell = offsets::cell_of(&mesh.offsets, i);
        Error::IndexOutOfRange { column: "connectivity", cell, index, len }.in_file(source.path)
    };
    mesh.connectivity = whole_numbers(&values, len.saturating_sub(1), source.scratch, out_of_range)?;
    mesh.faces = vtk_xml::faces(cells, &mesh.types, encoding, source)?;
    Ok(())
}
