//! Several meshes as one: those of a command line, or the blocks of a collection.
//!
//! In: meshes of any kinds, each with a name for messages. Out: one [`Mesh`], the points and cells of all one after the other;
//! structured while all are, else with every cell listed. Points at one place stay as many as they are: their values may differ.
//! `arrays.rs` matches the arrays, `listed.rs` lists the cells of blocks and of datasets.

mod arrays;
mod listed;

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::volume::{Use, from_volume};
use super::{Mesh, Scratch, StructuredMesh, UnstructuredMesh, container, open_mesh_in};
use crate::error::{Error, Result};

/// A mesh, and what messages call it.
pub(super) struct Part {
    pub(super) path: PathBuf,
    pub(super) mesh: Mesh,
}

/// Reads the meshes at `paths`, each at one path only.
pub(super) fn open(paths: &[&Path], scratch: &Scratch) -> Result<Mesh> {
    let mut already_read = HashSet::new();
    let mut parts = Vec::with_capacity(paths.len());
    for &path in paths {
        if let Ok(canonical) = path.canonicalize()
            && !already_read.insert(canonical)
        {
            let problem = format!("\"{}\" is given twice: its cells would be drawn twice", path.display());
            return Err(Error::Option { option: "MESH", problem });
        }
        let mesh = if path.is_file() && container::is_container(path)? {
            listed::of_dataset(&container::open(path, true)?, scratch).map_err(|error| error.in_file(path))?.into()
        } else {
            open_mesh_in(path, scratch)?
        };
        parts.push(Part { path: path.to_owned(), mesh });
    }
    join(parts, scratch)
}

/// The parts as one mesh, in order. Each is checked by itself first, so that an error names the part it is in.
pub(super) fn join(mut parts: Vec<Part>, scratch: &Scratch) -> Result<Mesh> {
    if parts.len() == 1 {
        return Ok(parts.swap_remove(0).mesh);
    }
    for Part { path, mesh } in &parts {
        mesh.check().map_err(|error| error.in_file(path))?;
    }
    let arrays = arrays::join(&parts, scratch)?;
    let (mut blocks, mut listed) = (Vec::new(), Vec::new());
    let has_lists = parts.iter().any(|part| matches!(part.mesh, Mesh::Unstructured(_)));
    for Part { path, mesh } in parts {
        let stored = |volume| from_volume(volume, Use::Whole).map_err(|error| error.in_file(path));
        match mesh {
            Mesh::Volume(volume) if has_lists => listed.push(listed::of_blocks(stored(volume)?, scratch)?),
            Mesh::Volume(volume) => blocks.push(stored(volume)?),
            Mesh::Structured(mesh) if has_lists => listed.push(listed::of_blocks(mesh, scratch)?),
            Mesh::Structured(mesh) => blocks.push(mesh),
            Mesh::Unstructured(mesh) => listed.push(mesh),
        }
    }
    if has_lists {
        UnstructuredMesh::concat_with(listed, arrays, scratch).map(Mesh::from)
    } else {
        StructuredMesh::concat_with(&blocks, arrays).map(Mesh::from)
    }
}

impl Mesh {
    /// Several meshes as one: points and cells of all, one after the other. Each mesh has a name for messages, such as its
    /// file's.
    ///
    /// Arrays are the same where name and association are. Numbers of different types become `f64`. An array that some
    /// meshes lack has no value there (NaN), and cells without a value are not drawn with it; that is said in a
    /// warning. One with different numbers of components is left out, with a warning too.
    ///
    /// Structured meshes stay blocks where all are structured; otherwise their cells are listed. Points at the same place are not
    /// merged, so that values may jump from mesh to mesh; faces of four corners at them are cut alike on both sides.
    ///
    /// # Errors
    /// Those of [`UnstructuredMesh::into_tets`] and [`Error::NonFinitePosition`], with the name of the mesh;
    /// [`Error::TooLarge`] where all together are.
    ///
    /// ```
    /// # use cellfan::{columns::Points, io::{Mesh, StructuredMesh}};
    /// let block = |x: f32| {
    ///     let points = (0..8).map(|i| [x + (i % 2) as f32, (i / 2 % 2) as f32, (i / 4) as f32]).collect();
    ///     StructuredMesh::new(&[[2, 2, 2]], Points::F32(points), Vec::new()).map(Mesh::from)
    /// };
    /// let mesh = Mesh::join(vec![("left".into(), block(0.0)?), ("right".into(), block(1.0)?)])?;
    /// let dataset = mesh.into_whole_dataset()?;
    /// assert_eq!((dataset.cells(), dataset.positions.len()), (2, 16));
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn join(meshes: Vec<(PathBuf, Self)>) -> Result<Self> {
        join(meshes.into_iter().map(|(path, mesh)| Part { path, mesh }).collect(), &Scratch::memory())
    }

    fn check(&self) -> Result<()> {
        match self {
            Self::Unstructured(mesh) => mesh.check(),
            Self::Structured(mesh) => mesh.check(),
            // Every point of a volume follows from its lattice.
            Self::Volume(_) => Ok(()),
        }
    }
}
