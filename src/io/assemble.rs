//! From a mesh to tetrahedra: check, leave out, split.
//!
//! In: cells of any kinds in file order. Out: [`TetMesh`], every index in range, and the counts of what became of the
//! cells. A mesh of tetrahedra keeps its points; cells with more corners are split by [`cells::split`]. `structured.rs` makes
//! the cells of a block as it goes, `hidden.rs` knows which cells are left out.

mod hidden;
mod splitter;
mod structured;

use arrayvec::ArrayVec;

use self::hidden::Hidden;
pub(super) use self::hidden::{DUPLICATE_CELL, GHOST_LEVELS, GHOST_TYPE, HIDDEN_CELL, HIDDEN_POINT};
use self::splitter::Splitter;
use super::UnstructuredMesh;
use super::scratch::Scratch;
use super::source::quote;
use crate::cells::{self, CellClass, CellKind, Nodes};
use crate::columns::{Array, Association, CellCounts, CellMesh, Dataset, FaceLists, Points, TetMesh};
use crate::error::{Error, Result};

impl UnstructuredMesh {
    /// Checks the mesh and cuts it into tetrahedra.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] where offsets, types or arrays do not fit each other, [`Error::IndexOutOfRange`], and
    /// [`Error::TooLarge`].
    pub fn into_tets(self) -> Result<TetMesh> {
        self.into_tets_in(&Scratch::memory())
    }

    /// As [`UnstructuredMesh::into_tets`], the tetrahedra where `scratch` says.
    ///
    /// # Errors
    /// Those of [`UnstructuredMesh::into_tets`], and [`Error::Io`] where a nameless file cannot be written.
    pub fn into_tets_in(self, scratch: &Scratch) -> Result<TetMesh> {
        let mut tets = Splitter::of(&self.points, scratch);
        let mut split = 0;
        let mut uncut = 0;
        let mut counts = self.for_each_volume(|cell, volume| {
            match volume {
                Volume::Kind(kind, corners) => {
                    if let Some(tet) = tet_of(kind, corners) {
                        return tets.push(tet, cell as usize);
                    }
                    tets.split(kind, corners, cell as usize)?;
                }
                Volume::Polyhedron if !tets.split_polyhedron(&self.faces, cell as usize)? => {
                    uncut += 1;
                    return Ok(());
                }
                Volume::Polyhedron => {}
            }
            split += 1;
            Ok(())
        })?;
        counts.split = split;
        self.warn_of_kinds(&counts);
        if uncut > 0 {
            counts.unsupported += uncut;
            tracing::warn!(cells = uncut, "polyhedra that are open or not convex cannot be cut into tetrahedra");
        }
        let (tets, file_from_tet) = tets.finish()?;
        let Self { points, arrays, .. } = self;
        Ok(TetMesh { points, tets, file_from_tet, arrays, counts })
    }

    /// The cells with a volume, whole: tetrahedra, hexahedra that stand for other kinds with up to eight corners, and polyhedra.
    ///
    /// # Errors
    /// Those of [`UnstructuredMesh::into_tets`].
    pub fn into_cells(self) -> Result<CellMesh> {
        self.into_cells_in(&Scratch::memory())
    }

    /// As [`UnstructuredMesh::into_cells`], the cells where `scratch` says.
    ///
    /// # Errors
    /// Those of [`UnstructuredMesh::into_tets_in`].
    pub fn into_cells_in(self, scratch: &Scratch) -> Result<CellMesh> {
        let (mut tets, mut file_from_tet) = (scratch.column(), scratch.column());
        let (mut hexahedra, mut file_from_hexahedron) = (scratch.column(), scratch.column());
        let (mut polyhedra, mut file_from_polyhedron) = (FaceLists::default(), Vec::new());
        let counts = self.for_each_volume(|cell, volume| {
            let Volume::Kind(kind, corners) = volume else {
                polyhedra.push_cell(&self.faces, cell as usize);
                file_from_polyhedron.push(cell);
                return Ok(());
            };
            if let Some(tet) = tet_of(kind, corners) {
                tets.push(tet)?;
                return file_from_tet.push(cell);
            }
            if let Some(hexahedron) = cells::hexahedron_of(kind) {
                hexahedra.push(hexahedron.map(|corner| corners[corner]))?;
                return file_from_hexahedron.push(cell);
            }
            for face in kind.faces {
                let around: ArrayVec<u32, 12> = face.iter().map(|&corner| corners[usize::from(corner)]).collect();
                polyhedra.push_face(&around);
            }
            polyhedra.end_cell();
            file_from_polyhedron.push(cell);
            Ok(())
        })?;
        self.warn_of_kinds(&counts);
        let (tets, file_from_tet) = (tets.finish()?, file_from_tet.finish()?);
        let (hexahedra, file_from_hexahedron) = (hexahedra.finish()?, file_from_hexahedron.finish()?);
        let file_from_polyhedron = file_from_polyhedron.into();
        let Self { points, arrays, .. } = self;
        Ok(CellMesh {
            points,
            tets,
            file_from_tet,
            hexahedra,
            file_from_hexahedron,
            polyhedra,
            file_from_polyhedron,
            arrays,
            counts,
        })
    }

    /// Checks the mesh by itself: everything that names a point or an entry, and the positions of what is drawn.
    ///
    /// # Errors
    /// Those of [`UnstructuredMesh::into_tets`] and [`Error::NonFinitePosition`].
    pub(super) fn check(&self) -> Result<()> {
        let are_finite = |cell: u32, volume: Volume<'_>| match volume {
            Volume::Kind(kind, corners) => {
                corners.iter().take(kind.corners).try_for_each(|&point| check_position(&self.points, point))
            }
            Volume::Polyhedron => {
                let mut points = self.faces.faces(cell as usize).flatten();
                points.try_for_each(|&point| check_position(&self.points, point))
            }
        };
        self.for_each_volume(are_finite).map(drop)
    }

    /// Names the first cell of a kind that is not drawn, where there is one.
    fn warn_of_kinds(&self, counts: &CellCounts) {
        let unsupported = |(cell, &code): (usize, &u8)| match cells::classify(code) {
            CellClass::Unsupported(name) => Some((cell, code, name)),
            _ => None,
        };
        if counts.unsupported > 0
            && let Some((cell, code, kind)) = self.types.iter().enumerate().find_map(unsupported)
        {
            tracing::warn!(cell, code, kind, "cells of this kind are not drawn");
        }
    }

    /// Checks the mesh, counts its cells, and hands those that are drawn to `take`, with their numbers.
    fn for_each_volume(&self, mut take: impl FnMut(u32, Volume<'_>) -> Result<()>) -> Result<CellCounts> {
        check(self)?;
        let hidden = Hidden::of(&self.arrays);
        let mut counts = CellCounts { in_file: self.cells() as u64, ..CellCounts::default() };
        for (cell, &code) in self.types.iter().enumerate() {
            let corners = corners_of(self, cell)?;
            let (kind, nodes) = match cells::classify(code) {
                CellClass::Unsupported(_) => {
                    counts.unsupported += 1;
                    continue;
                }
                CellClass::LowerDimensional => {
                    check_indices(self, cell, corners)?;
                    counts.lower_dimensional += 1;
                    continue;
                }
                CellClass::Polyhedron => {
                    check_faces(self, cell)?;
                    let mut points = self.faces.faces(cell).flatten();
                    if hidden.cell(cell) || points.any(|&point| hidden.point(point)) {
                        counts.ghost += 1;
                    } else {
                        take(cell as u32, Volume::Polyhedron)?;
                    }
                    continue;
                }
                CellClass::Volume { kind, nodes } => (kind, nodes),
            };
            check_indices(self, cell, corners)?;
            check_nodes(kind, nodes, cell, corners.len())?;
            if hidden.cell(cell) || corners.iter().any(|&point| hidden.point(point)) {
                counts.ghost += 1;
                continue;
            }
            counts.quadratic += u64::from(nodes != Nodes::Linear);
            take(cell as u32, Volume::Kind(kind, corners))?;
        }
        Ok(counts)
    }

    /// Checks the mesh, cuts it into tetrahedra and brings them into the order in which they are drawn.
    ///
    /// # Errors
    /// Those of [`UnstructuredMesh::into_tets`] and [`Dataset::from_tets`].
    pub fn into_dataset(self) -> Result<Dataset> {
        Dataset::from_tets(self.into_tets()?)
    }

    /// As [`UnstructuredMesh::into_dataset`], cells whole.
    ///
    /// # Errors
    /// Those of [`UnstructuredMesh::into_cells`] and [`Dataset::from_cells`].
    pub fn into_whole_dataset(self) -> Result<Dataset> {
        Dataset::from_cells(self.into_cells()?)
    }
}

/// A cell that is drawn.
enum Volume<'a> {
    /// Its kind, and its nodes, corners first.
    Kind(&'static CellKind, &'a [u32]),
    /// One whose faces the mesh lists.
    Polyhedron,
}

/// The corners of a cell that is a tetrahedron.
fn tet_of(kind: &CellKind, corners: &[u32]) -> Option<[u32; 4]> {
    if kind.corners == 4 { corners.first_chunk().copied() } else { None }
}

fn check(mesh: &UnstructuredMesh) -> Result<()> {
    let (points, cells) = (mesh.points.len() as u64, mesh.types.len() as u64);
    let limit = u64::from(u32::MAX) - 1;
    for (column, len) in [("points", points), ("cells", cells)] {
        if len > limit {
            return Err(Error::TooLarge { column, len, limit });
        }
    }
    if mesh.offsets.len() as u64 != cells + 1 {
        let (len, expected) = (mesh.offsets.len() as u64, cells + 1);
        return Err(Error::LengthMismatch { column: "offsets".to_owned(), len, expected });
    }
    check_lengths(&mesh.arrays, points, cells)
}

/// Every array has a tuple for each of `points` points or `cells` cells.
pub(super) fn check_lengths(arrays: &[Array], points: u64, cells: u64) -> Result<()> {
    for array in arrays {
        let tuples = if array.association == Association::Point { points } else { cells };
        let (len, expected) = (array.values.len() as u64, tuples.saturating_mul(array.components as u64));
        if len != expected {
            return Err(Error::LengthMismatch {
                column: format!("array {}", quote(array.name.as_bytes())),
                len,
                expected,
            });
        }
    }
    Ok(())
}

/// The point, which exists, has a position.
fn check_position(points: &Points, point: u32) -> Result<()> {
    let position = points.get(point as usize);
    if position.is_finite() {
        return Ok(());
    }
    Err(Error::NonFinitePosition { point: point.into(), position: position.to_array() })
}

fn corners_of(mesh: &UnstructuredMesh, cell: usize) -> Result<&[u32]> {
    mesh.cell(cell).ok_or_else(|| {
        let (start, end) = (mesh.offsets[cell], mesh.offsets[cell + 1]);
        let column = format!("connectivity (cell {cell} takes entries {start} to {end} of it)");
        Error::LengthMismatch { column, len: mesh.connectivity.len() as u64, expected: end.max(start) }
    })
}

fn check_indices(mesh: &UnstructuredMesh, cell: usize, corners: &[u32]) -> Result<()> {
    let len = mesh.points.len() as u64;
    match corners.iter().find(|&&point| u64::from(point) >= len) {
        Some(&index) => {
            Err(Error::IndexOutOfRange { column: "connectivity", cell: cell as u64, index: index.into(), len })
        }
        None => Ok(()),
    }
}

/// A polyhedron has faces, of points that exist.
fn check_faces(mesh: &UnstructuredMesh, cell: usize) -> Result<()> {
    let mut faces = mesh.faces.faces(cell);
    if faces.len() == 0 {
        let column = format!("faces of cell {cell} (polyhedron)");
        return Err(Error::LengthMismatch { column, len: 0, expected: 4 });
    }
    faces.try_for_each(|face| check_indices(mesh, cell, face))
}

fn check_nodes(kind: &CellKind, nodes: Nodes, cell: usize, found: usize) -> Result<()> {
    if nodes.accept(kind, found) {
        return Ok(());
    }
    let column = format!("cell {cell} ({})", kind.name);
    Err(Error::LengthMismatch { column, len: found as u64, expected: nodes.least(kind) as u64 })
}
