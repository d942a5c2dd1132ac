//! From a [`StructuredMesh`] to tetrahedra: the corners of each cell are made when it is cut.

use super::super::StructuredMesh;
use super::{Hidden, Scratch, Splitter};
use crate::cells::HEXAHEDRON;
use crate::columns::{CellCounts, Dataset, TetMesh};
use crate::error::Result;

impl StructuredMesh {
    /// Cuts the mesh into tetrahedra.
    ///
    /// # Errors
    /// As [`StructuredMesh::into_tets_in`].
    pub fn into_tets(self) -> Result<TetMesh> {
        self.into_tets_in(&Scratch::memory())
    }

    /// As [`StructuredMesh::into_tets`], the tetrahedra where `scratch` says.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io) where a nameless file cannot be written.
    pub fn into_tets_in(self, scratch: &Scratch) -> Result<TetMesh> {
        let hidden = Hidden::of(self.arrays());
        let mut counts = CellCounts { in_file: self.cells() as u64, ..CellCounts::default() };
        let mut tets = Splitter::of(self.points(), scratch);
        for block in self.blocks() {
            if !block.has_volume() {
                counts.lower_dimensional += block.cells() as u64;
                continue;
            }
            for in_block in 0..block.cells() {
                let (cell, corners) = (block.first_cell() + in_block, block.corners(in_block));
                if hidden.cell(cell) || corners.iter().any(|&point| hidden.point(point)) {
                    counts.ghost += 1;
                    continue;
                }
                counts.split += 1;
                tets.split(&HEXAHEDRON, &corners, cell)?;
            }
        }
        let (tets, file_from_tet) = tets.finish()?;
        let (points, arrays) = self.into_columns();
        Ok(TetMesh { points, tets, file_from_tet, arrays, counts })
    }

    /// Cuts the mesh into tetrahedra and brings them into the order in which they are drawn.
    ///
    /// # Errors
    /// Those of [`Dataset::from_tets`].
    pub fn into_dataset(self) -> Result<Dataset> {
        Dataset::from_tets(self.into_tets()?)
    }
}
