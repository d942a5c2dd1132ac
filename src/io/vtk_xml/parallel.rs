//! Parallel files: a grid in several files, which are named by one.

use std::collections::HashSet;
use std::fs::File;
use std::path::Path;

use super::super::scratch::Scratch;
use super::super::source::{Source, quote};
use super::document::parse;
use super::grid::grid_of;
use crate::atomic::io_at;
use crate::error::Result;

/// Bytes of the longest path of a piece: Linux opens none that is longer.
const LONGEST_NAME: usize = 4096;

/// Reads the pieces that a parallel file of kind `kind` names relative to its folder, each by `read`.
pub(in crate::io) fn read_pieces<T>(
    bytes: &[u8],
    kind: &str,
    source: Source<'_>,
    read: impl Fn(&[u8], &Path, &Scratch) -> Result<T>,
) -> Result<Vec<T>> {
    let text = String::from_utf8_lossy(bytes);
    let root = parse(&text, false, source)?;
    let grid = grid_of(&root, kind, source)?;
    let folder = source.path.parent().unwrap_or(Path::new(""));
    let mut pieces = Vec::new();
    let mut already_read = HashSet::new();
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
            && !already_read.insert(canonical)
        {
            return Err(bad("is the file of an earlier piece too; each piece has a file of its own"));
        }
        let file = File::open(&piece_path).map_err(io_at(&piece_path))?;
        let bytes = source.scratch.bytes_of(&piece_path, file)?;
        pieces.push(read((*bytes).as_ref(), &piece_path, source.scratch)?);
    }
    Ok(pieces)
}
