//! Parallel files: a grid in several files, which are named by one.

use std::collections::HashSet;
use std::fs::File;
use std::path::{Path, PathBuf};

use super::super::scratch::Scratch;
use super::super::source::{Source, quote};
use super::document::{Element, parse};
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
    let mut files = NamedFiles::new(source);
    let mut pieces = Vec::new();
    for piece in grid.children_named("Piece") {
        let missing = || source.malformed(piece.place(), "has no attribute \"Source\"");
        let piece_path = files.path(piece, "Source").ok_or_else(missing)??;
        let file = File::open(&piece_path).map_err(io_at(&piece_path))?;
        let bytes = source.scratch.bytes_of(&piece_path, file)?;
        pieces.push(read((*bytes).as_ref(), &piece_path, source.scratch)?);
    }
    Ok(pieces)
}

/// The files that one file names relative to its folder, each once.
pub(in crate::io) struct NamedFiles<'a> {
    source: Source<'a>,
    already_named: HashSet<PathBuf>,
}

impl<'a> NamedFiles<'a> {
    /// No file has been named.
    pub(in crate::io) fn new(source: Source<'a>) -> Self {
        Self { source, already_named: HashSet::new() }
    }

    /// The file that `attribute` of `element` names; none where there is no such attribute.
    pub(in crate::io) fn path(&mut self, element: &Element<'_>, attribute: &str) -> Option<Result<PathBuf>> {
        Some(self.resolve(element, attribute, element.attribute(attribute)?))
    }

    fn resolve(&mut self, element: &Element<'_>, attribute: &str, name: &str) -> Result<PathBuf> {
        let bad = |what: &str| {
            let problem = format!("{attribute}={} {what}", quote(name.as_bytes()));
            Err(self.source.malformed(element.place(), problem))
        };
        if name.len() > LONGEST_NAME || name.contains(char::is_control) {
            return bad("is no name of a file");
        }
        let path = self.source.path.parent().unwrap_or(Path::new("")).join(name);
        // A device or a pipe may never end.
        if path.exists() && !path.is_file() {
            return bad("is no file");
        }
        // Cells that are there twice cannot be drawn, and a small file must not become a large mesh.
        if path.canonicalize().is_ok_and(|canonical| !self.already_named.insert(canonical)) {
            return bad("is the file of an earlier piece too; each piece has a file of its own");
        }
        Ok(path)
    }
}
