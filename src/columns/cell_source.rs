//! `CellSource`: cells that need not be in memory, for a mesh larger than it.

use super::build::check_arrays;
use super::{Array, Association, CellCounts, CellMesh, FaceLists, Points, TetMesh};
use crate::error::{Error, Result};

/// Cells in file order that can be asked for one by one: a [`TetMesh`], a [`CellMesh`], or a rule that makes tetrahedra.
///
/// Points are in memory, hexahedra listed in memory or in a map; tetrahedra and values may be computed when they are asked for.
pub trait CellSource: Sync {
    /// All points.
    fn points(&self) -> &Points;
    /// How many tetrahedra there are.
    fn tets(&self) -> usize;
    /// The points of tetrahedron `tet`, in either orientation.
    fn tet(&self, tet: usize) -> [u32; 4];
    /// The file's cell of tetrahedron `tet`.
    fn file_cell(&self, tet: usize) -> u32;
    /// The points of each hexahedron in VTK's order, in either orientation; some may coincide (see [`CellMesh::hexahedra`]).
    fn hexahedra(&self) -> &[[u32; 8]] {
        &[]
    }
    /// The file's cell of each hexahedron.
    fn file_from_hexahedron(&self) -> &[u32] {
        &[]
    }
    /// The faces of each polyhedron, and its file's cell.
    fn polyhedra(&self) -> Option<(&FaceLists, &[u32])> {
        None
    }
    /// The arrays over points and file cells.
    fn arrays(&self) -> Vec<ArrayHead>;
    /// Appends the values of some tuples of array `array`, little-endian.
    fn append_values(&self, array: usize, tuples: &[u32], bytes: &mut Vec<u8>);
    /// What became of the file's cells so far.
    fn counts(&self) -> CellCounts;
    /// What the methods above take for granted: there is a file cell for each cell, and a tuple for each point or file cell.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`](crate::Error::LengthMismatch).
    fn check(&self) -> Result<()> {
        Ok(())
    }
}

/// What is known of an array before its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArrayHead {
    /// Its name.
    pub name: String,
    /// What it is attached to.
    pub association: Association,
    /// Values per tuple; 1 for a scalar.
    pub components: usize,
    /// The type of its values, as in Rust: `i8` to `u64`, `f32`, `f64`.
    pub type_name: &'static str,
}

impl From<&Array> for ArrayHead {
    fn from(array: &Array) -> Self {
        let (name, type_name) = (array.name.clone(), array.values.type_name());
        Self { name, association: array.association, components: array.components, type_name }
    }
}

impl CellSource for TetMesh {
    fn points(&self) -> &Points {
        &self.points
    }

    fn tets(&self) -> usize {
        self.tets.len()
    }

    fn tet(&self, tet: usize) -> [u32; 4] {
        self.tets[tet]
    }

    fn file_cell(&self, tet: usize) -> u32 {
        self.file_from_tet[tet]
    }

    fn arrays(&self) -> Vec<ArrayHead> {
        self.arrays.iter().map(ArrayHead::from).collect()
    }

    fn append_values(&self, array: usize, tuples: &[u32], bytes: &mut Vec<u8>) {
        self.arrays[array].append_tuples(tuples, bytes);
    }

    fn counts(&self) -> CellCounts {
        self.counts
    }

    fn check(&self) -> Result<()> {
        check_len("file_from_tet", self.file_from_tet.len(), self.tets.len())?;
        check_arrays(self.points.len() as u64, &self.arrays, self.counts.in_file)
    }
}

impl CellSource for CellMesh {
    fn points(&self) -> &Points {
        &self.points
    }

    fn tets(&self) -> usize {
        self.tets.len()
    }

    fn tet(&self, tet: usize) -> [u32; 4] {
        self.tets[tet]
    }

    fn file_cell(&self, tet: usize) -> u32 {
        self.file_from_tet[tet]
    }

    fn hexahedra(&self) -> &[[u32; 8]] {
        &self.hexahedra
    }

    fn file_from_hexahedron(&self) -> &[u32] {
        &self.file_from_hexahedron
    }

    fn polyhedra(&self) -> Option<(&FaceLists, &[u32])> {
        (self.polyhedra.cells() > 0).then_some((&self.polyhedra, &self.file_from_polyhedron[..]))
    }

    fn arrays(&self) -> Vec<ArrayHead> {
        self.arrays.iter().map(ArrayHead::from).collect()
    }

    fn append_values(&self, array: usize, tuples: &[u32], bytes: &mut Vec<u8>) {
        self.arrays[array].append_tuples(tuples, bytes);
    }

    fn counts(&self) -> CellCounts {
        self.counts
    }

    fn check(&self) -> Result<()> {
        check_len("file_from_tet", self.file_from_tet.len(), self.tets.len())?;
        check_len("file_from_hexahedron", self.file_from_hexahedron.len(), self.hexahedra.len())?;
        check_len("file_from_polyhedron", self.file_from_polyhedron.len(), self.polyhedra.cells())?;
        check_arrays(self.points.len() as u64, &self.arrays, self.counts.in_file)
    }
}

fn check_len(column: &str, len: usize, expected: usize) -> Result<()> {
    if len == expected {
        return Ok(());
    }
    Err(Error::LengthMismatch { column: column.to_owned(), len: len as u64, expected: expected as u64 })
}
