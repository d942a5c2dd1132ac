//! `OpenFOAM` cases: a `polyMesh` and the fields of one time.
//!
//! In: the folder of a case, or that of one of its times. Out: an [`UnstructuredMesh`] with a cell array for each field of values at cells.
//! `case.rs` finds the times and what each has, `tokens.rs` reads lists in ASCII and in binary, `fields.rs` fields. A `polyMesh` lists faces,
//! each with the cell that it points out of (owner) and the cell behind it (neighbour); cells whose faces are those of a hexahedron, wedge,
//! pyramid or tetrahedron become one, the others polyhedra.

mod case;
mod fields;
#[cfg(test)]
mod tests;
mod tokens;

use std::path::{Path, PathBuf};

use self::case::Case;
use self::tokens::Foam;
use super::UnstructuredMesh;
use super::face_streams::{POLYHEDRON, points_of};
use super::scratch::Scratch;
use super::source::Source;
use crate::cells::recognise;
use crate::columns::{FaceLists, Points};
use crate::error::{Error, Result};

/// Whether `folder` is that of a case, or of one of its times.
pub(super) fn is_case(folder: &Path) -> bool {
    Case::at(folder).is_some()
}

/// The folder of the time `time` of the case that `path` names: its folder, or its `.foam` file.
///
/// # Errors
/// [`Error::Unsupported`] where it names none; [`Error::Option`] where the case has no such time.
pub fn openfoam_time(path: &Path, time: f64) -> Result<PathBuf> {
    let is_file = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("foam"));
    let folder = if is_file { path.parent().unwrap_or(path) } else { path };
    let Some(case) = Case::at(folder) else {
        let (what, advice) = ("choosing its time".to_owned(), "leave --time out, or name an OpenFOAM case".to_owned());
        return Err(Error::Unsupported { path: path.to_owned(), what, advice });
    };
    case.folder_of(time)
}

/// Reads the case in `folder`, or the time of a case that `folder` is; of a case the last time.
///
/// # Errors
/// [`Error::Io`], [`Error::Malformed`] and [`Error::Unsupported`] with the name of the file.
pub fn read_openfoam(folder: &Path) -> Result<UnstructuredMesh> {
    read_openfoam_in(folder, &Scratch::memory())
}

/// As [`read_openfoam`], the columns where `scratch` says.
#[expect(clippy::redundant_closure_for_method_calls, reason = "a method's name has one lifetime, a closure any")]
pub(super) fn read_openfoam_in(folder: &Path, scratch: &Scratch) -> Result<UnstructuredMesh> {
    let Some(case) = Case::at(folder) else {
        let advice = if folder.join("processor0").is_dir() {
            "put its parts together with reconstructPar"
        } else {
            "it needs constant/polyMesh/faces; name the folder that holds \"constant\""
        };
        return Err(Source { path: folder, scratch }.unsupported("an OpenFOAM case without a mesh", advice));
    };
    let points = read(&case, "points", scratch, |file| file.vectors())?;
    let faces = read(&case, "faces", scratch, |file| file.faces())?;
    let len = faces.faces(0).len();
    let owner = read(&case, "owner", scratch, |file| file.labels(len))?;
    let neighbour = read(&case, "neighbour", scratch, |file| file.labels(len))?;
    let path = case.mesh_file("owner")?;
    let mut mesh = mesh_of(points, &faces, &owner, &neighbour, Source { path: &path, scratch })?;
    mesh.arrays = fields::read(&case, mesh.cells(), scratch)?;
    Ok(mesh)
}

/// What `take` takes out of a file of the mesh.
fn read<T>(case: &Case, name: &str, scratch: &Scratch, take: impl FnOnce(&mut Foam<'_>) -> Result<T>) -> Result<T> {
    let path = case.mesh_file(name)?;
    let bytes = case::read(&path)?;
    take(&mut Foam::open(&bytes, Source { path: &path, scratch })?)
}

/// The cells that lie at `faces`, the faces of the one cell of a list.
fn mesh_of(
    points: Vec<[f64; 3]>,
    faces: &FaceLists,
    owner: &[u32],
    neighbour: &[u32],
    source: Source<'_>,
) -> Result<UnstructuredMesh> {
    let len = faces.faces(0).len();
    if owner.len() != len || neighbour.len() > len {
        let problem = format!("{} owners and {} neighbours of {len} faces: damaged", owner.len(), neighbour.len());
        return Err(source.malformed("owner", problem));
    }
    // Some versions write a neighbour for each face, −1 where there is none.
    let sides = || owner.iter().zip(0..).chain(neighbour.iter().zip(0..)).filter(|&(&cell, _)| cell != u32::MAX);
    let cells = sides().map(|(&cell, _)| u64::from(cell) + 1).max().unwrap_or(0);
    if cells > 2 * len as u64 {
        return Err(source.malformed("owner", format!("names cell {} with {len} faces in all: damaged", cells - 1)));
    }
    let cells = cells as usize;
    // Count, scan, write: the faces of each cell, those that it owns first.
    let mut starts = vec![0; cells + 1];
    for (&cell, _) in sides() {
        starts[cell as usize + 1] += 1;
    }
    for cell in 0..cells {
        starts[cell + 1] += starts[cell];
    }
    let mut place = starts.clone();
    let mut side_from_place = vec![(0_u32, false); starts[cells]];
    for (of, is_owner) in [(owner, true), (neighbour, false)] {
        for (&cell, face) in of.iter().zip(0..).filter(|&(&cell, _)| cell != u32::MAX) {
            side_from_place[place[cell as usize]] = (face, is_owner);
            place[cell as usize] += 1;
        }
    }

    let around: Vec<&[u32]> = faces.faces(0).collect();
    let mut mesh = UnstructuredMesh { points: Points::F64(points), ..UnstructuredMesh::empty() };
    let (mut types, mut offsets, mut connectivity) = (Vec::with_capacity(cells), vec![0], Vec::new());
    let mut of_cell = Vec::new();
    for cell in 0..cells {
        let mut list = FaceLists::default();
        for &(face, is_owner) in &side_from_place[starts[cell]..starts[cell + 1]] {
            of_cell.clear();
            of_cell.extend_from_slice(around[face as usize]);
            if !is_owner {
                of_cell.reverse();
            }
            list.push_face(&of_cell);
        }
        list.end_cell();
        if let Some((kind, corners)) = recognise(&list.faces(0)) {
            types.push(kind.code);
            connectivity.extend_from_slice(&corners);
        } else {
            types.push(POLYHEDRON);
            mesh.faces.pad(cell);
            mesh.faces.push_cell(&list, 0);
            points_of(&list, 0, &mut of_cell);
            connectivity.extend_from_slice(&of_cell);
        }
        offsets.push(connectivity.len() as u64);
    }
    (mesh.types, mesh.offsets, mesh.connectivity) = (types.into(), offsets.into(), connectivity.into());
    Ok(mesh)
}
