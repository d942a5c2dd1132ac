//! Triangle meshes of other programs, to be drawn beside the volume: STL, PLY and Wavefront OBJ.
//!
//! In: a path. Out: a [`TriangleMesh`] in the file's coordinates, which are taken for the world's. To add a format: a file with a function
//! from bytes to a mesh, and its line in [`read_triangles`].

mod obj;
mod ply;
mod stl;

use std::path::Path;

use super::Scratch;
use super::source::Source;
use crate::atomic::io_at;
use crate::error::{Error, Result};
use crate::geometry::TriangleMesh;

/// Reads an STL (binary or text), PLY (binary in either byte order or text) or OBJ file.
///
/// Positions, triangles (polygons as fans), the normals and the colours of vertices are read; colours are taken as sRGB. All else is left:
/// materials, textures, the normals of an STL's triangles, which are those of their corners.
///
/// # Errors
/// [`Error::Io`]; [`Error::Unsupported`] for another format; [`Error::Malformed`] where the file is damaged, with the place, or holds no triangle.
///
/// ```
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("wall.obj");
/// std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").unwrap();
/// assert_eq!(cellfan::io::open_triangles(&path)?.triangles, [[0, 1, 2], [0, 2, 3]]);
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn open_triangles(path: impl AsRef<Path>) -> Result<TriangleMesh> {
    let path = path.as_ref();
    if path.is_dir() {
        let advice = "name a file in it".to_owned();
        return Err(Error::Unsupported { path: path.to_owned(), what: "a folder".to_owned(), advice });
    }
    read_triangles(&std::fs::read(path).map_err(io_at(path))?, path)
}

/// Reads a file that is in memory; `path` gives its extension, and its name in messages.
///
/// # Errors
/// Those of [`open_triangles`] that concern the file.
pub fn read_triangles(bytes: &[u8], path: &Path) -> Result<TriangleMesh> {
    let scratch = Scratch::memory();
    let source = Source { path, scratch: &scratch };
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let mesh = if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        ply::read(bytes, source)?
    } else if extension == "stl" || stl::is_binary(bytes) || bytes.starts_with(b"solid ") {
        stl::read(bytes, source)?
    } else if extension == "obj" {
        obj::read(bytes, source)?
    } else {
        let what = "a file that is no STL, PLY or OBJ by its first bytes or its extension";
        return Err(source.unsupported(what, "give a triangle mesh as .stl, .ply or .obj"));
    };
    if mesh.triangles.is_empty() {
        return Err(source.malformed("file", "there is no triangle in it"));
    }
    mesh.check().map_err(|error| error.in_file(path))?;
    Ok(mesh)
}

/// Adds the triangles of a polygon, as a fan from its first corner.
fn add_polygon(triangles: &mut Vec<[u32; 3]>, corners: &[u32]) {
    if let Some((&first, rest)) = corners.split_first() {
        triangles.extend(rest.windows(2).map(|pair| [first, pair[0], pair[1]]));
    }
}

#[cfg(test)]
mod tests;
