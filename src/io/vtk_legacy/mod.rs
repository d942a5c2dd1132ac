//! `.vtk`: VTK's legacy files, text or big-endian binary, versions 1.0 to 5.1, with an unstructured grid.
//!
//! In: the bytes of a file. Out: [`UnstructuredMesh`]. A file is a sequence of sections, each begun by a keyword;
//! `cursor.rs` reads words and arrays, `cells.rs` the two forms of CELLS, `attributes.rs` the arrays.
//! To add a keyword: its line in [`read_vtk`] or in `attributes.rs`.

mod attributes;
mod cells;
mod cursor;

use std::path::Path;

use self::attributes::Attributes;
use self::cells::Cells;
use self::cursor::Cursor;
use super::UnstructuredMesh;
use super::numbers::{points_from, whole_numbers};
use super::scratch::Scratch;
use super::source::{Source, quote};
use crate::error::Result;

/// Reads a legacy `.vtk` file that is in memory; `path` is its name in messages.
///
/// # Errors
/// [`Error::Malformed`](crate::Error::Malformed); [`Error::Unsupported`](crate::Error::Unsupported) where the dataset is no unstructured grid; [`Error::IndexOutOfRange`](crate::Error::IndexOutOfRange)
/// with the file's name.
pub fn read_vtk(bytes: &[u8], path: &Path) -> Result<UnstructuredMesh> {
    read_vtk_in(bytes, path, &Scratch::memory())
}

/// As [`read_vtk`], the columns where `scratch` says.
pub(super) fn read_vtk_in(bytes: &[u8], path: &Path, scratch: &Scratch) -> Result<UnstructuredMesh> {
    let source = Source { path, scratch };
    let mut cursor = Cursor::new(bytes, source);
    read_head(&mut cursor)?;

    let mut mesh = UnstructuredMesh::empty();
    let mut attributes = Attributes::default();
    let mut cells = None;
    let mut types = None;
    while let Some(keyword) = cursor.next_keyword() {
        match keyword.as_str() {
            "POINTS" => {
                let count = cursor.count("the number of points")?;
                let number = cursor.number_type()?;
                mesh.points = points_from(&cursor.tuples(number, count, 3)?);
            }
            "CELLS" => cells = Some(Cells::read(&mut cursor)?),
            "CELL_TYPES" => {
                let count = cursor.count("the number of cells")?;
                types = Some(cursor.integers(count)?);
            }
            "METADATA" => cursor.skip_metadata(),
            // Outside point and cell data: values of the dataset as a whole.
            "FIELD" if attributes.is_outside() => attributes::skip_field(&mut cursor)?,
            _ => attributes.read(&keyword, &mut cursor)?,
        }
    }

    let cells = cells.unwrap_or_else(Cells::none);
    let types = types.unwrap_or_else(|| Vec::<i32>::new().into());
    if types.len() != cells.count() {
        let problem = format!("names {} cells where CELLS has {}: damaged or truncated", types.len(), cells.count());
        return Err(source.malformed("CELL_TYPES", problem));
    }
    let bad = |cell, code| source.malformed("CELL_TYPES", format!("cell {cell} has type {code}"));
    mesh.types = whole_numbers(&types, 255, scratch, bad)?;
    (mesh.offsets, mesh.connectivity) = cells.into_columns(mesh.points.len() as u64, source)?;
    mesh.arrays = attributes.into_arrays(mesh.points.len(), mesh.types.len(), source)?;
    Ok(mesh)
}

/// The first four lines: version, title, text or binary, kind of dataset.
fn read_head(cursor: &mut Cursor<'_>) -> Result<()> {
    let source = cursor.source;
    let first = cursor.line().trim_ascii();
    if !first.starts_with(b"# vtk DataFile") {
        let problem = format!("is {}, not \"# vtk DataFile Version …\": this is no VTK legacy file", quote(first));
        return Err(source.malformed("line 1", problem));
    }
    cursor.line();
    cursor.binary = match cursor.next_keyword().as_deref() {
        Some("ASCII") => false,
        Some("BINARY") => true,
        other => {
            let problem = format!("is {}, not ASCII or BINARY", quote(other.unwrap_or_default().as_bytes()));
            return Err(source.malformed("line 3", problem));
        }
    };
    match cursor.next_keyword().as_deref() {
        Some("DATASET") => {}
        other => {
            let problem = format!("is {}, not DATASET", quote(other.unwrap_or_default().as_bytes()));
            return Err(source.malformed("line 4", problem));
        }
    }
    match cursor.next_keyword().as_deref() {
        Some("UNSTRUCTURED_GRID") => {
            cursor.end_line();
            Ok(())
        }
        Some(other) => {
            let what = format!("a VTK legacy file with DATASET {other}");
            Err(source.unsupported(what, "convert it to an unstructured grid (.vtu)"))
        }
        None => Err(source.malformed("line 4", "names no dataset: the file is truncated")),
    }
}
