//! `Mesh`: what a file holds, whichever kind of grid it is.

use super::{Scratch, StructuredMesh, UnstructuredMesh};
use crate::columns::{Array, Association, Dataset, Points, TetMesh};
use crate::error::Result;

/// A mesh in file order.
#[derive(Clone, Debug)]
pub enum Mesh {
    /// Cells of any kinds, which name their points.
    Unstructured(UnstructuredMesh),
    /// Blocks of points in rows, columns and layers.
    Structured(StructuredMesh),
}

impl Mesh {
    /// All points of the file.
    pub fn points(&self) -> &Points {
        match self {
            Self::Unstructured(mesh) => &mesh.points,
            Self::Structured(mesh) => mesh.points(),
        }
    }

    /// Arrays over the points and cells.
    pub fn arrays(&self) -> &[Array] {
        match self {
            Self::Unstructured(mesh) => &mesh.arrays,
            Self::Structured(mesh) => mesh.arrays(),
        }
    }

    /// The array of that name and association, if there is one.
    pub fn array(&self, name: &str, association: Association) -> Option<&Array> {
        self.arrays().iter().find(|array| array.name == name && array.association == association)
    }

    /// How many cells there are, of any kind.
    pub fn cells(&self) -> usize {
        match self {
            Self::Unstructured(mesh) => mesh.cells(),
            Self::Structured(mesh) => mesh.cells(),
        }
    }

    /// How many cells have each of VTK's codes.
    pub fn cells_by_code(&self) -> [u64; 256] {
        let mut cells = [0; 256];
        match self {
            Self::Unstructured(mesh) => mesh.types.iter().for_each(|&code| cells[usize::from(code)] += 1),
            Self::Structured(mesh) => {
                mesh.blocks().iter().for_each(|block| cells[usize::from(block.code())] += block.cells() as u64);
            }
        }
        cells
    }

    /// Checks the mesh and cuts it into tetrahedra.
    ///
    /// # Errors
    /// Those of [`UnstructuredMesh::into_tets`].
    pub fn into_tets(self) -> Result<TetMesh> {
        self.into_tets_in(&Scratch::memory())
    }

    /// As [`Mesh::into_tets`], the tetrahedra where `scratch` says.
    ///
    /// # Errors
    /// Those of [`UnstructuredMesh::into_tets_in`].
    pub fn into_tets_in(self, scratch: &Scratch) -> Result<TetMesh> {
        match self {
            Self::Unstructured(mesh) => mesh.into_tets_in(scratch),
            Self::Structured(mesh) => mesh.into_tets_in(scratch),
        }
    }

    /// Checks the mesh, cuts it into tetrahedra and brings them into the order in which they are drawn.
    ///
    /// # Errors
    /// Those of [`Mesh::into_tets`] and [`Dataset::from_tets`].
    pub fn into_dataset(self) -> Result<Dataset> {
        Dataset::from_tets(self.into_tets()?)
    }

    /// As [`Mesh::into_dataset`], cells whole.
    ///
    /// # Errors
    /// Those of [`UnstructuredMesh::into_whole_dataset`] and [`StructuredMesh::into_whole_dataset`].
    pub fn into_whole_dataset(self) -> Result<Dataset> {
        match self {
            Self::Unstructured(mesh) => mesh.into_whole_dataset(),
            Self::Structured(mesh) => mesh.into_whole_dataset(),
        }
    }
}

impl From<UnstructuredMesh> for Mesh {
    fn from(mesh: UnstructuredMesh) -> Self {
        Self::Unstructured(mesh)
    }
}

impl From<StructuredMesh> for Mesh {
    fn from(mesh: StructuredMesh) -> Self {
        Self::Structured(mesh)
    }
}
