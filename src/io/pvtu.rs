//! `.pvtu`: an unstructured grid in several `.vtu` files, one after the other.

use std::path::Path;

use super::source::{Source, quote};
use super::{UnstructuredMesh, read_vtu, vtk_xml};
use crate::error::{Error, Result};

/// Reads a `.pvtu` file that is in memory, and the pieces it names relative to the folder of `path`.
///
/// # Errors
/// [`Error::Io`] where a piece cannot be read, and those of [`read_vtu`].
pub fn read_pvtu(bytes: &[u8], path: &Path) -> Result<UnstructuredMesh> {
    let source = Source { path };
    let text = String::from_utf8_lossy(bytes);
    let root = vtk_xml::parse(&text, false, source)?;
    vtk_xml::check_root(&root, "PUnstructuredGrid", source)?;
    let grid = root
        .child("PUnstructuredGrid")
        .ok_or_else(|| source.malformed(root.place(), "holds no <PUnstructuredGrid>: damaged or truncated"))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut pieces = Vec::new();
    for piece in grid.children_named("Piece") {
        let name =
            piece.attribute("Source").ok_or_else(|| source.malformed(piece.place(), "has no attribute \"Source\""))?;
        let piece_path = folder.join(name);
        // A device or a pipe may never end.
        if piece_path.exists() && !piece_path.is_file() {
            let problem = format!("Source={} is no file", quote(name.as_bytes()));
            return Err(source.malformed(piece.place(), problem));
        }
        let bytes = std::fs::read(&piece_path).map_err(|source| Error::Io { path: piece_path.clone(), source })?;
        pieces.push(read_vtu(&bytes, &piece_path)?);
    }
    UnstructuredMesh::concat(pieces).map_err(|error| error.in_file(path))
}
