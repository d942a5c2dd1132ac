//! `Splitter`: the tetrahedra of a mesh while its cells are cut.

use super::super::scratch::{Growing, Scratch};
use crate::cells::{self, CellKind};
use crate::columns::{Column, Points, canonical_from_point};
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

    /// The columns: tetrahedra, and the cell of each.
    pub(super) fn finish(self) -> Result<(Column<[u32; 4]>, Column<u32>)> {
        Ok((self.tets.finish()?, self.file_from_tet.finish()?))
    }
}
