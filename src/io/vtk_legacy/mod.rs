//! `.vtk`: VTK's legacy files, text or big-endian binary, versions 1.0 to 5.1, with an unstructured, structured,
//! rectilinear or regular grid.
//!
//! In: the bytes of a file. Out: [`Mesh`]. A file is a sequence of sections, each begun by a keyword; `cursor.rs` reads
//! words and arrays, `cells.rs` the two forms of CELLS, `attributes.rs` the arrays.
//! To add a keyword: its line in `unstructured.rs`, `structured.rs` or `attributes.rs`. To add a kind of dataset: its line in
//! [`read_vtk_in`].

mod attributes;
mod cells;
mod cursor;
mod structured;
mod unstructured;

use std::path::Path;

use self::attributes::Attributes;
use self::cursor::Cursor;
use super::Mesh;
use super::scratch::Scratch;
use super::source::{Source, quote};
use crate::error::Result;

/// Reads a legacy `.vtk` file that is in memory; `path` is its name in messages.
///
/// # Errors
/// [`Error::Malformed`](crate::Error::Malformed); [`Error::Unsupported`](crate::Error::Unsupported) where the dataset is of another
/// kind; [`Error::IndexOutOfRange`](crate::Error::IndexOutOfRange) and [`Error::TooLarge`](crate::Error::TooLarge) with the file's name.
pub fn read_vtk(bytes: &[u8], path: &Path) -> Result<Mesh> {
    read_vtk_in(bytes, path, &Scratch::memory())
}

/// As [`read_vtk`], the columns where `scratch` says.
pub(super) fn read_vtk_in(bytes: &[u8], path: &Path, scratch: &Scratch) -> Result<Mesh> {
    let source = Source { path, scratch };
    let mut cursor = Cursor::new(bytes, source);
    match read_head(&mut cursor)?.as_str() {
        "UNSTRUCTURED_GRID" => unstructured::read(&mut cursor).map(Mesh::from),
        "STRUCTURED_GRID" => structured::read_structured(&mut cursor).map(Mesh::from),
        "STRUCTURED_POINTS" => structured::read_points(&mut cursor, bytes.len()).map(Mesh::from),
        "RECTILINEAR_GRID" => structured::read_rectilinear(&mut cursor, bytes.len()).map(Mesh::from),
        other => {
            let what = format!("a VTK legacy file with DATASET {other}");
            Err(source.unsupported(what, "convert it to an unstructured grid (.vtu)"))
        }
    }
}

/// The first four lines: version, title, text or binary, and the kind of dataset, which comes back.
fn read_head(cursor: &mut Cursor<'_>) -> Result<String> {
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
    let kind = cursor.next_keyword();
    cursor.end_line();
    kind.ok_or_else(|| source.malformed("line 4", "names no dataset: the file is truncated"))
}

/// Sections that every dataset may have: `keyword` begins one.
fn read_common(keyword: &str, attributes: &mut Attributes, cursor: &mut Cursor<'_>) -> Result<()> {
    match keyword {
        "METADATA" => {
            cursor.skip_metadata();
            Ok(())
        }
        // Outside point and cell data: values of the dataset as a whole.
        "FIELD" if attributes.is_outside() => attributes::skip_field(cursor),
        _ => attributes.read(keyword, cursor),
    }
}
