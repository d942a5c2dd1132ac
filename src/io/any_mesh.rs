//! `Mesh`: what a file holds, whichever kind of grid it is; `WholeCells`: what of it is drawn, no cell cut.

use std::sync::Arc;

use super::volume::{Use, from_volume};
use super::{Scratch, StructuredMesh, UnstructuredMesh};
use crate::columns::{Array, Association, Backing, CellMesh, Dataset, Points, StructuredCells, TetMesh, Volume};
use crate::error::Result;

/// A mesh in file order.
#[derive(Clone, Debug)]
pub enum Mesh {
    /// Cells of any kinds, which name their points.
    Unstructured(UnstructuredMesh),
    /// Blocks of points in rows, columns and layers.
    Structured(StructuredMesh),
    /// A regular grid, whose points follow from three numbers and a matrix.
    Volume(Volume),
}

impl Mesh {
    /// The points that are stored: all of the file, and none of a volume.
    pub fn points(&self) -> Option<&Points> {
        match self {
            Self::Unstructured(mesh) => Some(&mesh.points),
            Self::Structured(mesh) => Some(mesh.points()),
            Self::Volume(_) => None,
        }
    }

    /// How many points the file has, stored or not.
    pub fn point_count(&self) -> usize {
        match self {
            Self::Unstructured(mesh) => mesh.points.len(),
            Self::Structured(mesh) => mesh.points().len(),
            Self::Volume(volume) => volume.points(),
        }
    }

    /// Arrays over the points and cells.
    pub fn arrays(&self) -> &[Array] {
        match self {
            Self::Unstructured(mesh) => &mesh.arrays,
            Self::Structured(mesh) => mesh.arrays(),
            Self::Volume(volume) => &volume.arrays,
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
            Self::Volume(volume) => volume.cells(),
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
            Self::Volume(volume) => cells[usize::from(volume.code())] += volume.cells() as u64,
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
            Self::Volume(volume) => from_volume(volume, Use::Tetrahedra)?.into_tets_in(scratch),
        }
    }

    /// Checks the mesh, cuts it into tetrahedra and brings them into the order in which they are drawn.
    ///
    /// # Errors
    /// Those of [`Mesh::into_tets`] and [`Dataset::from_tets`].
    pub fn into_dataset(self) -> Result<Dataset> {
        let backing = self.backing();
        Ok(Dataset { backing, ..Dataset::from_tets(self.into_tets()?)? })
    }

    /// Checks the mesh and leaves out what is not drawn; what is listed of the others goes where `scratch` says.
    ///
    /// # Errors
    /// Those of [`UnstructuredMesh::into_cells_in`] and [`StructuredMesh::into_whole_in`].
    pub fn into_whole_in(self, scratch: &Scratch) -> Result<WholeCells> {
        match self {
            Self::Unstructured(mesh) => mesh.into_cells_in(scratch).map(WholeCells::Listed),
            Self::Structured(mesh) => mesh.into_whole_in(scratch),
            Self::Volume(volume) => from_volume(volume, Use::Whole)?.into_whole_in(scratch),
        }
    }

    /// As [`Mesh::into_dataset`], cells whole.
    ///
    /// # Errors
    /// Those of [`Mesh::into_whole_in`] and [`WholeCells::into_dataset`].
    pub fn into_whole_dataset(self) -> Result<Dataset> {
        let backing = self.backing();
        Ok(Dataset { backing, ..self.into_whole_in(&Scratch::memory())?.into_dataset()? })
    }

    /// The file that arrays are used in place of.
    fn backing(&self) -> Option<Arc<Backing>> {
        match self {
            Self::Unstructured(_) | Self::Structured(_) => None,
            Self::Volume(volume) => volume.backing.clone(),
        }
    }
}

/// The cells of a mesh that have a volume, none of them cut.
#[derive(Clone, Debug)]
pub enum WholeCells {
    /// Cells that name their points.
    Listed(CellMesh),
    /// Cells that the order of the points implies.
    Structured(StructuredCells),
}

impl WholeCells {
    /// Brings the cells into the order in which they are drawn.
    ///
    /// # Errors
    /// Those of [`Dataset::from_cells`] and [`Dataset::from_structured`].
    pub fn into_dataset(self) -> Result<Dataset> {
        match self {
            Self::Listed(mesh) => Dataset::from_cells(mesh),
            Self::Structured(mesh) => Dataset::from_structured(mesh),
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
