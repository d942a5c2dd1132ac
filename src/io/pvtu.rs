//! `.pvtu`: an unstructured grid in several `.vtu` files, one after the other.

use std::collections::HashSet;
use std::fs::File;
use std::path::Path;

use super::scratch::Scratch;
use super::source::{Source, quote};
use super::vtu::read_vtu_in;
use super::{UnstructuredMesh, vtk_xml};
use crate::atomic::io_at;
use crate::error::Result;

/// Bytes of the longest path of a piece: Linux opens none that is longer.
const LONGEST_NAME: usize = 4096;

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
    let text = String::from_utf8_lossy(bytes);
    let root = vtk_xml::parse(&text, false, source)?;
    vtk_xml::check_root(&root, "PUnstructuredGrid", source)?;
    let grid = root
        .child("PUnstructuredGrid")
        .ok_or_else(|| source.malformed(root.place(), "holds no <PUnstructuredGrid>: damaged or truncated"))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut pieces = Vec::new();
    let mut read = HashSet::new();
    for piece in grid.children_named("Piece") {
        let name =
            piece.attribute("Source").ok_or_else(|| source.malformed(piece.place(), "has no attribute \"Source\""))?;
        let bad = |what: &str| source.malformed(piece.place(), format!("Source={} {what}", quote(name.as_bytes())));
        if name.len() > LONGEST_NAME || name.contains(char::is_control) {
            return Err(bad("is no name of a file"));
        }
        let piece_path = folder.join(name);
        // A device or a pipe may never end.
        if piece_path.exists() && !piece_path.is_file() {
            return Err(bad("is no file"));
        }
        // Cells that are there twice cannot be drawn, and a small file must not become a large mesh.
        if let Ok(canonical) = piece_path.canonicalize()
            && !read.insert(canonical)
        {
            return Err(bad("is the file of an earlier piece too; each piece has a file of its own"));
        }
        let file = File::open(&piece_path).map_err(io_at(&piece_path))?;
        let bytes = scratch.bytes_of(&piece_path, file)?;
        pieces.push(read_vtu_in((*bytes).as_ref(), &piece_path, scratch)?);
    }
    UnstructuredMesh::concat(pieces, scratch).map_err(|error| error.in_file(path))
}
