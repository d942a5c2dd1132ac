//! `.vtu`: VTK XML unstructured grids, all pieces of a file.

use std::path::Path;

use super::numbers::{points_from, push_whole_numbers, whole_numbers};
use super::scratch::Scratch;
use super::source::Source;
use super::vtk_xml::{self, Element, Encoding};
use super::{MOST_ARRAYS, UnstructuredMesh, offsets};
use crate::columns::{Array, Association, Points};
use crate::error::{Error, Result, without_controls};

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
    let (xml, appended) = vtk_xml::split_appended(bytes);
    let text = String::from_utf8_lossy(xml);
    let root = vtk_xml::parse(&text, xml.len() < bytes.len(), source)?;
    vtk_xml::check_root(&root, "UnstructuredGrid", source)?;
    let grid = root
        .child("UnstructuredGrid")
        .ok_or_else(|| source.malformed(root.place(), "holds no <UnstructuredGrid>: damaged or truncated"))?;
    let encoding = Encoding::new(&root, appended, bytes.len(), source)?;
    let pieces = grid.children_named("Piece").map(|piece| read_piece(piece, &encoding, source));
    UnstructuredMesh::concat(pieces.collect::<Result<_>>()?, scratch).map_err(|error| error.in_file(path))
}

fn read_piece(piece: &Element<'_>, encoding: &Encoding<'_>, source: Source<'_>) -> Result<UnstructuredMesh> {
    let count = |name| piece.count(name, Some(0), source);
    let (point_count, cell_count) = (count("NumberOfPoints")?, count("NumberOfCells")?);
    let mut mesh = UnstructuredMesh::empty();
    if point_count > 0 {
        mesh.points = read_points(piece, point_count, encoding, source)?;
    }
    if cell_count > 0 {
        read_cells(piece, cell_count, encoding, source, &mut mesh)?;
    }
    for (name, association, tuples) in
        [("PointData", Association::Point, point_count), ("CellData", Association::Cell, cell_count)]
    {
        if let Some(data) = piece.child(name) {
            mesh.arrays.extend(read_arrays(data, association, tuples, encoding, source)?);
        }
    }
    Ok(mesh)
}

fn child<'e, 'a>(element: &'e Element<'a>, name: &str, source: Source<'_>) -> Result<&'e Element<'a>> {
    element.child(name).ok_or_else(|| source.malformed(element.place(), format!("holds no <{name}>")))
}

/// `tuples` times `components`, where the product exists.
fn values_of(array: &Element<'_>, tuples: usize, components: usize, source: Source<'_>) -> Result<usize> {
    tuples
        .checked_mul(components)
        .ok_or_else(|| source.malformed(array.place(), format!("{tuples} tuples of {components} values cannot be")))
}

fn read_points(piece: &Element<'_>, point_count: usize, encoding: &Encoding<'_>, source: Source<'_>) -> Result<Points> {
    let array = child(child(piece, "Points", source)?, "DataArray", source)?;
    let components = array.count("NumberOfComponents", Some(3), source)?;
    if components != 3 {
        return Err(source.malformed(array.place(), format!("points have {components} coordinates, not 3")));
    }
    Ok(points_from(&encoding.values(array, Some(values_of(array, point_count, 3, source)?))?))
}

fn read_cells(
    piece: &Element<'_>,
    cell_count: usize,
    encoding: &Encoding<'_>,
    source: Source<'_>,
    mesh: &mut UnstructuredMesh,
) -> Result<()> {
    let cells = child(piece, "Cells", source)?;
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
    Ok(())
}

fn read_arrays(
    data: &Element<'_>,
    association: Association,
    tuples: usize,
    encoding: &Encoding<'_>,
    source: Source<'_>,
) -> Result<Vec<Array>> {
    let mut arrays: Vec<Array> = Vec::new();
    for element in data.children_named("DataArray") {
        let name = without_controls(element.attribute("Name").unwrap_or("unnamed").to_owned());
        if !vtk_xml::is_numeric(element) {
            tracing::debug!(name, "the array holds no numbers, left out");
            continue;
        }
        if arrays.iter().any(|array| array.name == name) {
            tracing::warn!(name, "there are several arrays of this name, the first is used");
            continue;
        }
        if arrays.len() == MOST_ARRAYS {
            return Err(source.malformed(data.place(), format!("holds more than {MOST_ARRAYS} arrays; leave some out")));
        }
        let components = element.count("NumberOfComponents", Some(1), source)?.max(1);
        let values = encoding.values(element, Some(values_of(element, tuples, components, source)?))?;
        arrays.push(Array { name, association, components, values });
    }
    Ok(arrays)
}
