//! From spans of a file's bytes to columns that use them in place.

use std::sync::Arc;

use bytemuck::Pod;

use super::directory::{HexahedraEntry, PolyhedraEntry, Span};
use crate::columns::{Column, HexCorners, Hexahedra, Polyhedra, PolyhedraColumns, SharedBytes, StructuredBlock};
use crate::error::{Error, Result};

impl Span {
    /// The values of the column called `name`.
    pub(super) fn column<T: Pod>(self, name: &str, bytes: &SharedBytes) -> Result<Column<T>> {
        Column::shared(name, Arc::clone(bytes), self.offset as usize, self.bytes as usize / size_of::<T>())
    }
}

impl HexahedraEntry {
    /// The cells, of so many vertices.
    pub(super) fn column(&self, bytes: &SharedBytes, vertices: usize) -> Result<Hexahedra> {
        let shapes = self.shapes.column("shapes", bytes)?;
        let corners = match (self.corners, self.blocks) {
            (Some(corners), _) => HexCorners::Listed(corners.column("corners", bytes)?),
            // Copied: a file that is changed in place must not change what was found right.
            (None, Some(blocks)) => {
                let blocks: Column<StructuredBlock> = blocks.column("structured blocks", bytes)?;
                HexCorners::Structured(blocks.to_vec())
            }
            (None, None) => HexCorners::Structured(Vec::new()),
        };
        Hexahedra::in_file(corners, shapes, self.absent as usize, vertices)
    }
}

impl PolyhedraEntry {
    /// The cells, of so many vertices; what is wrong with them otherwise, and in which column.
    pub(super) fn column(&self, bytes: &SharedBytes, vertices: usize) -> Result<Polyhedra, (&'static str, String)> {
        // Copied: a file that is changed in place must not change what was found right.
        let words = |name, span: Span| -> Result<Column<u32>, (&'static str, String)> {
            let column = span.column::<u32>(name, bytes).map_err(|error: Error| (name, error.to_string()))?;
            Ok(column.to_vec().into())
        };
        let starts = words("starts of polyhedra", self.starts)?;
        let columns = PolyhedraColumns {
            starts: starts.chunks_exact(2).map(|two| [two[0], two[1]]).collect(),
            sides: words("faces of polyhedra", self.sides)?,
            corners: words("corners of polyhedra", self.corners)?,
            face_starts: words("starts of faces", self.face_starts)?,
            around: words("corners of faces", self.around)?,
        };
        Polyhedra::in_file(columns, vertices)
    }
}
