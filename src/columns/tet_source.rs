//! `TetSource`: tetrahedra that need not be in memory, for a mesh larger than it.

use super::build::check_arrays;
use super::{Association, CellCounts, Points, TetMesh};
use crate::error::{Error, Result};

/// Tetrahedra in file order that can be asked for one by one: a [`TetMesh`], or a rule that makes them.
///
/// Points are in memory; cells and values may be computed when they are asked for.
pub trait TetSource: Sync {
    /// All points.
    fn points(&self) -> &Points;
    /// How many tetrahedra there are.
    fn tets(&self) -> usize;
    /// The points of tetrahedron `tet`, in either orientation.
    fn tet(&self, tet: usize) -> [u32; 4];
    /// The file's cell of tetrahedron `tet`.
    fn file_cell(&self, tet: usize) -> u32;
    /// The arrays over points and file cells.
    fn arrays(&self) -> Vec<ArrayHead>;
    /// Appends the values of some tuples of array `array`, little-endian.
    fn append_values(&self, array: usize, tuples: &[u32], bytes: &mut Vec<u8>);
    /// What became of the file's cells so far.
    fn counts(&self) -> CellCounts;
    /// What the methods above take for granted: there is a file cell for each tetrahedron, and a tuple for each point or file cell.
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

impl TetSource for TetMesh {
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
        let head = |array: &super::Array| ArrayHead {
            name: array.name.clone(),
            association: array.association,
            components: array.components,
            type_name: array.values.type_name(),
        };
        self.arrays.iter().map(head).collect()
    }

    fn append_values(&self, array: usize, tuples: &[u32], bytes: &mut Vec<u8>) {
        let array = &self.arrays[array];
        array.values.append_tuples(array.components, tuples, bytes);
    }

    fn counts(&self) -> CellCounts {
        self.counts
    }

    fn check(&self) -> Result<()> {
        let (len, expected) = (self.file_from_tet.len() as u64, self.tets.len() as u64);
        if len != expected {
            return Err(Error::LengthMismatch { column: "file_from_tet".to_owned(), len, expected });
        }
        check_arrays(self.points.len() as u64, &self.arrays, self.counts.in_file)
    }
}
