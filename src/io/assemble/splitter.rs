//! `Splitter`: the tetrahedra of a mesh while its cells are cut.

use glam::DVec3;

use super::super::scratch::{Growing, Scratch};
use crate::cells::{self, CellKind};
use crate::columns::{Column, FaceLists, Points, canonical_from_point};
use crate::error::Result;

/// The tetrahedra so far, each with the cell that it is of.
pub(super) struct Splitter<'a> {
    points: &'a Points,
    /// For each point the lowest at the same place; empty until the first cell is split.
    canonical: Vec<u32>,
    tets: Growing<'a, [u32; 4]>,
    file_from_tet: Growing<'a, u32>,
}

impl<'a> Splitter<'a> {
    pub(super) fn of(points: &'a Points, scratch: &'a Scratch) -> Self {
        Self { points, canonical: Vec::new(), tets: scratch.column(), file_from_tet: scratch.column() }
    }

    /// Adds cell `cell`, which is a tetrahedron.
    pub(super) fn push(&mut self, tet: [u32; 4], cell: usize) -> Result<()> {
        self.tets.push(tet)?;
        self.file_from_tet.push(cell as u32)
    }

    /// Adds the tetrahedra of cell `cell`, whose corners are all points of the mesh.
    pub(super) fn split(&mut self, kind: &CellKind, corners: &[u32], cell: usize) -> Result<()> {
        let Self { points, canonical, tets, file_from_tet } = self;
        if canonical.is_empty() {
            *canonical = canonical_from_point(points);
        }
        let canonical = |point: u32| canonical[point as usize];
        let mut pushed = Ok(());
        cells::split(kind, corners, canonical, |tet| {
            if pushed.is_ok() {
                pushed = tets.push(tet).and_then(|()| file_from_tet.push(cell as u32));
            }
        });
        pushed
    }

    /// Adds the tetrahedra of cell `cell`, a polyhedron with these faces; whether it could be cut.
    pub(super) fn split_polyhedron(&mut self, faces: &FaceLists, cell: usize) -> Result<bool> {
        let Self { points, canonical, tets, file_from_tet } = self;
        if canonical.is_empty() {
            *canonical = canonical_from_point(points);
        }
        // What is cut agrees as the file has it; a few ulp from the positions that are drawn.
        let origin = faces.faces(cell).flatten().next().map_or(DVec3::ZERO, |&point| points.get(point as usize));
        let position = |point: u32| (points.get(point as usize) - origin).as_vec3();
        let Some(fan) = faces.split(cell, |point| canonical[point as usize], position) else { return Ok(false) };
        for tet in fan {
            tets.push(tet)?;
            file_from_tet.push(cell as u32)?;
        }
        Ok(true)
    }

    /// The columns: tetrahedra, and the cell of each.
    pub(super) fn finish(self) -> Result<(Column<[u32; 4]>, Column<u32>)> {
        Ok((self.tets.finish()?, self.file_from_tet.finish()?))
    }
}
