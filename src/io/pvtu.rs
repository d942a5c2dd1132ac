//! `.pvtu`: an unstructured grid in several `.vtu` files, one after the other.

use std::path::Path;

use super::scratch::Scratch;
use super::source::Source;
use super::vtu::read_vtu_in;
use super::{UnstructuredMesh, vtk_xml};
use crate::error::Result;

/// Reads a `.pvtu` file that is in memory, and the pieces it names relative to the folder of `path`.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) where a piece cannot be read, and those of [`read_vtu`](super::read_vtu).
pub fn read_pvtu(bytes: &[u8], path: &Path) -> Result<UnstructuredMesh> {
    read_pvtu_in(bytes, path, &Scratch::memory())
}

/// As [`read_pvtu`], the columns where `scratch` says.
pub(super) fn read_pvtu_in(bytes: &[u8], path: &Path, scratch: &Scratch) -> Result<UnstructuredMesh> {
    let source = Source { path, scratch };
    let pieces = vtk_xml::read_pieces(bytes, "PUnstructuredGrid", source, read_vtu_in)?;
    UnstructuredMesh::concat(pieces, scratch).map_err(|error| error.in_file(path))
}
