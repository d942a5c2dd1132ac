//! From a [`StructuredMesh`] to tetrahedra: the corners of each cell are made when it is cut.

use super::super::{StructuredBlock, StructuredMesh};
use super::{Hidden, Scratch, Splitter, check_position};
use crate::cells::HEXAHEDRON;
use crate::columns::{CellCounts, CellMesh, Dataset, StructuredCells, TetMesh};
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

    /// The cells as they are, implied by the order of the points; listed where some blocks are one point thick.
    ///
    /// # Errors
    /// Those of [`Dataset::from_structured`] and [`Dataset::from_cells`].
    pub fn into_whole_dataset(self) -> Result<Dataset> {
        let hidden_of = Hidden::of(self.arrays());
        let mut counts = CellCounts { in_file: self.cells() as u64, ..CellCounts::default() };
        let mut hidden = Vec::with_capacity(self.cells());
        for block in self.blocks() {
            if !block.has_volume() {
                counts.lower_dimensional += block.cells() as u64;
                hidden.extend((0..block.cells()).map(|_| true));
                continue;
            }
            for in_block in 0..block.cells() {
                let is_hidden = hidden_of.cell(block.first_cell() + in_block)
                    || block.corners(in_block).iter().any(|&point| hidden_of.point(point));
                counts.ghost += u64::from(is_hidden);
                hidden.push(is_hidden);
            }
        }
        if counts.lower_dimensional == 0 {
            let dims = self.blocks().iter().map(StructuredBlock::dims).collect();
            let (points, arrays) = self.into_columns();
            let hidden = hidden.into_iter().collect();
            return Dataset::from_structured(StructuredCells { dims, points, hidden, arrays, counts });
        }
        let (mut hexahedra, mut file_from_hexahedron) = (Vec::new(), Vec::new());
        for block in self.blocks().iter().filter(|block| block.has_volume()) {
            for in_block in (0..block.cells()).filter(|cell| !hidden[block.first_cell() + cell]) {
                hexahedra.push(block.corners(in_block));
                file_from_hexahedron.push((block.first_cell() + in_block) as u32);
            }
        }
        let (points, arrays) = self.into_columns();
        let (tets, file_from_tet) = (Vec::new().into(), Vec::new().into());
        let (hexahedra, file_from_hexahedron) = (hexahedra.into(), file_from_hexahedron.into());
        Dataset::from_cells(CellMesh { points, tets, file_from_tet, hexahedra, file_from_hexahedron, arrays, counts })
    }

    /// The cells that are drawn have positions.
    ///
    /// # Errors
    /// [`Error::NonFinitePosition`](crate::Error::NonFinitePosition).
    pub(in crate::io) fn check(&self) -> Result<()> {
        let hidden = Hidden::of(self.arrays());
        for block in self.blocks().iter().filter(|block| block.has_volume()) {
            for in_block in (0..block.cells()).filter(|cell| !hidden.cell(block.first_cell() + cell)) {
                let corners = block.corners(in_block);
                if !corners.iter().any(|&point| hidden.point(point)) {
                    corners.iter().try_for_each(|&point| check_position(self.points(), point))?;
                }
            }
        }
        Ok(())
    }

    /// Cuts the mesh into tetrahedra and brings them into the order in which they are drawn.
    ///
    /// # Errors
    /// Those of [`Dataset::from_tets`].
    pub fn into_dataset(self) -> Result<Dataset> {
        Dataset::from_tets(self.into_tets()?)
    }
}
