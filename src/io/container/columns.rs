//! From spans of a file's bytes to columns that use them in place.

use std::sync::Arc;

use bytemuck::Pod;

use super::directory::{HexahedraEntry, Span};
use crate::columns::{Column, HexCorners, Hexahedra, SharedBytes, StructuredBlock};
use crate::error::Result;

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
