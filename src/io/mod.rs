//! Files: meshes in, meshes and pictures out.
//!
//! In: a path. Out: a [`Dataset`] ([`open`]), or the mesh as the file has it ([`open_mesh`]).
//! To add a format that is read: a file with a function from bytes to [`UnstructuredMesh`] and its line in
//! [`formats::READ`]. To refuse one by its name: a line in [`formats::REFUSED`].

mod assemble;
pub mod container;
pub mod formats;
mod mapping;
mod mesh;
mod numbers;
mod offsets;
mod pvtu;
mod source;
mod vtk_legacy;
mod vtk_xml;
mod vtu;
mod write_vtu;

use std::fs::File;
use std::io::Read;
use std::path::Path;

pub use crate::atomic::check_target;
pub use mesh::UnstructuredMesh;
pub use pvtu::read_pvtu;
pub use vtk_legacy::read_vtk;
pub use vtu::read_vtu;
pub use write_vtu::{Compression, write_vtu};

use crate::columns::Dataset;
use crate::error::{Error, Result};

/// Most arrays that the points or the cells of a piece may have: their names are compared with each other.
const MOST_ARRAYS: usize = 4096;

/// Reads a file of any format in [`formats::READ`] and makes it ready to draw.
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

/// As [`open`]; a container is mapped (`use_map`) or read whole. Other formats are always read whole.
///
/// # Errors
/// Those of [`open`].
pub fn open_with(path: &Path, use_map: bool) -> Result<Dataset> {
    if path.is_file() && container::is_container(path)? {
        return container::open(path, use_map);
    }
    open_mesh(path)?.into_dataset().map_err(|error| error.in_file(path))
}

/// Reads a file of any format in [`formats::READ`] as it is: cells of any kinds, in file order.
///
/// # Errors
/// Those of [`open`] that concern the file and not what is drawn.
pub fn open_mesh(path: &Path) -> Result<UnstructuredMesh> {
    if path.is_dir() {
        let advice = "name a file in it".to_owned();
        return Err(Error::Unsupported { path: path.to_owned(), what: "a folder".to_owned(), advice });
    }
    let io_error = |source| Error::Io { path: path.to_owned(), source };
    let mut file = File::open(path).map_err(io_error)?;
    let mut bytes = Vec::new();
    // Its beginning is enough to refuse a file.
    file.by_ref().take(formats::HEAD_BYTES as u64).read_to_end(&mut bytes).map_err(io_error)?;
    let format = formats::find(&bytes, path)?;

    file.read_to_end(&mut bytes).map_err(io_error)?;
    (format.read)(&bytes, path)
}

/// Reads a file that is in memory; `path` gives its extension, its name in messages, and where its pieces are.
///
/// # Errors
/// Those of [`open_mesh`].
pub fn read_mesh(bytes: &[u8], path: &Path) -> Result<UnstructuredMesh> {
    (formats::find(bytes, path)?.read)(bytes, path)
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "values are read bit for bit")]
mod tests;
