//! From a [`StructuredMesh`] to tetrahedra, the corners of each cell made when it is cut; or to its cells as they are.

use super::super::{StructuredBlock, StructuredMesh, WholeCells};
use super::{Hidden, Scratch, Splitter, check_position};
use crate::cells::HEXAHEDRON;
use crate::columns::{BitColumn, CellCounts, CellMesh, Dataset, StructuredCells, TetMesh};
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
    /// [`Error::Io`](crate::Error::Io) where a nameless file cannot be written.
    pub fn into_whole_in(self, scratch: &Scratch) -> Result<WholeCells> {
        let hidden_of = Hidden::of(self.arrays());
        let is_left_out = |block: &StructuredBlock, in_block: usize| {
            !block.has_volume()
                || hidden_of.cell(block.first_cell() + in_block)
                || block.corners(in_block).iter().any(|&point| hidden_of.point(point))
        };
        let of_block = |block| (0..StructuredBlock::cells(block)).map(move |in_block| is_left_out(block, in_block));
        let hidden: BitColumn = self.blocks().iter().flat_map(of_block).collect();
        let flat = self.blocks().iter().filter(|block| !block.has_volume());
        let lower_dimensional = flat.map(|block| block.cells() as u64).sum();
        let left_out = (0..hidden.len()).filter(|&cell| hidden.get(cell)).count() as u64;
        let ghost = left_out - lower_dimensional;
        let counts = CellCounts { in_file: self.cells() as u64, lower_dimensional, ghost, ..CellCounts::default() };
        if lower_dimensional == 0 {
            let dims = self.blocks().iter().map(StructuredBlock::dims).collect();
            let (points, arrays) = self.into_columns();
            return Ok(WholeCells::Structured(StructuredCells { dims, points, hidden, arrays, counts }));
        }
        let (mut hexahedra, mut file_from_hexahedron) = (scratch.column(), scratch.column());
        for block in self.blocks().iter().filter(|block| block.has_volume()) {
            for in_block in (0..block.cells()).filter(|cell| !hidden.get(block.first_cell() + cell)) {
                hexahedra.push(block.corners(in_block))?;
                file_from_hexahedron.push((block.first_cell() + in_block) as u32)?;
            }
        }
        let (hexahedra, file_from_hexahedron) = (hexahedra.finish()?, file_from_hexahedron.finish()?);
        let (points, arrays) = self.into_columns();
        let (tets, file_from_tet) = (Vec::new().into(), Vec::new().into());
        let listed = CellMesh {
            points,
            tets,
            file_from_tet,
            hexahedra,
            file_from_hexahedron,
            arrays,
            counts,
            ..CellMesh::empty()
        };
        Ok(WholeCells::Listed(listed))
    }

    /// As [`StructuredMesh::into_dataset`], cells whole and where it can be without a list of their corners.
    ///
    /// # Errors
    /// Those of [`Dataset::from_structured`] and [`Dataset::from_cells`].
    pub fn into_whole_dataset(self) -> Result<Dataset> {
        self.into_whole_in(&Scratch::memory())?.into_dataset()
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
