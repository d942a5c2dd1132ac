//! Files: meshes in, meshes and pictures out.
//!
//! In: a path, or several. Out: a [`Dataset`] ([`open`], [`open_all`]), or the mesh as the files have it ([`open_mesh`],
//! [`open_meshes`]).
//! To add a format that is read: a file with a function from bytes to a [`Mesh`] and its line in
//! [`formats::READ`]. To refuse one by its name: a line in [`formats::REFUSED`].

mod any_mesh;
mod assemble;
mod collection;
mod concat;
pub mod container;
mod expansion;
mod face_streams;
pub mod formats;
mod join;
mod mapping;
mod mesh;
mod nrrd;
mod numbers;
mod offsets;
mod openfoam;
mod overlap;
mod plot3d;
mod pvtu;
mod raw;
mod rectilinear;
mod samples;
mod scratch;
mod source;
mod structured;
mod triangles;
mod volume;
mod vti;
mod vtk_legacy;
mod vtk_xml;
mod vts;
mod vtu;
mod write_vtu;

use std::fs::File;
use std::io::Read;
use std::path::Path;

pub use crate::atomic::{check_target, write_text};
pub use any_mesh::{Mesh, WholeCells};
pub use collection::{read_pvd, read_vtm};
pub use mesh::UnstructuredMesh;
pub use nrrd::{read_nrrd, write_nrrd};
pub use openfoam::{openfoam_time, read_openfoam};
pub use plot3d::read_plot3d;
pub use pvtu::read_pvtu;
pub use raw::{RawLayout, open_raw, open_raw_in, read_raw};
pub use scratch::Scratch;
pub use structured::{StructuredBlock, StructuredMesh};
pub use triangles::{open_triangles, read_triangles};
pub use vti::{read_pvti, read_vti};
pub use vtk_legacy::read_vtk;
pub use vts::{read_pvtr, read_pvts, read_vtr, read_vts};
pub use vtu::read_vtu;
pub use write_vtu::{Compression, write_vtu};

use self::mapping::Mapped;
use crate::atomic::io_at;
use crate::columns::Dataset;
use crate::error::{Error, Result};

/// Most arrays that the points or the cells of a piece may have: their names are compared with each other.
const MOST_ARRAYS: usize = 4096;

/// Reads a file of any format in [`formats::READ`], or a container, and makes it ready to draw as tetrahedra.
///
/// # Errors
/// [`Error::Io`]; [`Error::Unsupported`] where the format or what the file holds is not read; [`Error::Malformed`] and
/// [`Error::InFile`] where the file is damaged or holds nothing to draw.
///
/// ```no_run
/// let data = cellfan::io::open("mesh.vtu".as_ref())?;
/// println!("{} cells", data.counts.in_file);
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn open(path: &Path) -> Result<Dataset> {
    open_with(path, true)
}

/// As [`open`]; a container is mapped (`use_map`) or read whole. Other formats are always read whole. Cells with more than four
/// corners are cut into tetrahedra: [`container::open`] and [`Mesh::into_whole_dataset`] leave them as they are.
///
/// # Errors
/// Those of [`open`].
pub fn open_with(path: &Path, use_map: bool) -> Result<Dataset> {
    if path.is_file() && container::is_container(path)? {
        return container::open(path, use_map)?.into_tetrahedra().map_err(|error| error.in_file(path));
    }
    open_mesh(path)?.into_dataset().map_err(|error| error.in_file(path))
}

/// Reads several files of any format as one mesh, made ready to draw in one visibility order; a single one as [`open`] does.
///
/// # Errors
/// Those of [`open`], [`open_meshes`] and [`Mesh::into_dataset`].
///
/// ```no_run
/// let data = cellfan::io::open_all(&["rotor.vtu", "stator.vtu"])?;
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn open_all<P: AsRef<Path>>(paths: &[P]) -> Result<Dataset> {
    match paths {
        [path] => open(path.as_ref()),
        _ => open_meshes(paths)?.into_dataset(),
    }
}

/// Reads several files of any format as one mesh, joined as [`Mesh::join`] does, the first file's points and cells first.
///
/// Containers among several files are copied into memory as they are drawn; what they left out when they were written is not
/// counted again.
///
/// # Errors
/// Those of [`open`] for each file, with its name; [`Error::Option`] where a file is there twice; those of [`Mesh::join`].
pub fn open_meshes<P: AsRef<Path>>(paths: &[P]) -> Result<Mesh> {
    open_meshes_in(paths, &Scratch::memory())
}

/// As [`open_meshes`], the columns where `scratch` says.
///
/// # Errors
/// Those of [`open_meshes`], and [`Error::Io`] where a nameless file cannot be written.
pub fn open_meshes_in<P: AsRef<Path>>(paths: &[P], scratch: &Scratch) -> Result<Mesh> {
    join::open(&paths.iter().map(AsRef::as_ref).collect::<Vec<_>>(), scratch)
}

/// Reads a file of any format in [`formats::READ`] as it is, in file order.
///
/// # Errors
/// Those of [`open`] that concern the file and not what is drawn.
pub fn open_mesh(path: &Path) -> Result<Mesh> {
    open_mesh_in(path, &Scratch::memory())
}

/// As [`open_mesh`], for a mesh larger than memory: its columns go where `scratch` says.
///
/// # Errors
/// Those of [`open_mesh`], and [`Error::Io`] where a nameless file cannot be written.
///
/// ```
/// use cellfan::{generate, io};
/// let mesh = generate::tets(&generate::Settings { cells: 750, ..Default::default() })?;
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("mesh.vtu");
/// io::write_vtu(&path, &io::UnstructuredMesh::from_tets(&mesh), io::Compression::Zlib)?;
/// let scratch = io::Scratch::in_folder(folder.path(), 0); // no column may stay in memory
/// let tets = io::open_mesh_in(&path, &scratch)?.into_tets_in(&scratch)?.tets;
/// assert_eq!((tets.len(), tets.owned_bytes()), (750, 0));
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn open_mesh_in(path: &Path, scratch: &Scratch) -> Result<Mesh> {
    open_mesh_of(path, scratch, |_| Ok(()))
}

/// As [`open_mesh_in`], for a file whose format `check` accepts.
fn open_mesh_of(path: &Path, scratch: &Scratch, check: impl FnOnce(&formats::Format) -> Result<()>) -> Result<Mesh> {
    if path.is_dir() && openfoam::is_case(path) {
        return openfoam::read_openfoam_in(path, scratch).map(Mesh::from);
    }
    if path.is_dir() {
        let advice = "name a file in it, or an OpenFOAM case".to_owned();
        return Err(Error::Unsupported { path: path.to_owned(), what: "a folder".to_owned(), advice });
    }
    let mut file = File::open(path).map_err(io_at(path))?;
    let mut head = Vec::new();
    // Its beginning is enough to refuse a file.
    file.by_ref().take(formats::HEAD_BYTES as u64).read_to_end(&mut head).map_err(io_at(path))?;
    let format = formats::find(&head, path)?;
    check(format)?;
    if let Some(read) = formats::in_place(format).filter(|_| scratch.maps_volume(&file)) {
        return read(&Mapped::open(path, file)?, path, scratch);
    }
    if scratch.maps(&file) {
        return (format.read)((*scratch.bytes_of(path, file)?).as_ref(), path, scratch);
    }
    let mut bytes = head;
    file.read_to_end(&mut bytes).map_err(io_at(path))?;
    (format.read)(&bytes, path, scratch)
}

/// Reads a file that is in memory; `path` gives its extension, its name in messages, and where its pieces are.
///
/// # Errors
/// Those of [`open_mesh`].
pub fn read_mesh(bytes: &[u8], path: &Path) -> Result<Mesh> {
    (formats::find(bytes, path)?.read)(bytes, path, &Scratch::memory())
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "values are read bit for bit")]
mod tests;
