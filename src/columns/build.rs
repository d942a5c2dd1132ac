//! From tetrahedra in file order to a [`Dataset`]: check, re-centre, orient, drop what has no volume, order in space.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::placement::{Placement, orientation_of};
use super::spatial_order::{self, UNUSED};
use super::{Array, Association, Block, Bounds, CellCounts, Column, Dataset};
use crate::error::{Error, Result};

/// Point coordinates as a file holds them.
#[derive(Clone, Debug)]
pub enum Points {
    /// Single precision.
    F32(Vec<[f32; 3]>),
    /// Double precision; re-centred before it is narrowed.
    F64(Vec<[f64; 3]>),
}

impl Points {
    /// How many points there are.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(points) => points.len(),
            Self::F64(points) => points.len(),
        }
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Point `i` in double precision.
    ///
    /// # Panics
    /// If there is no such point.
    #[inline]
    pub fn get(&self, i: usize) -> DVec3 {
        match self {
            Self::F32(points) => Vec3::from_array(points[i]).as_dvec3(),
            Self::F64(points) => DVec3::from_array(points[i]),
        }
    }
}

/// Tetrahedra in file order: what a reader or a generator hands over.
#[derive(Clone, Debug)]
pub struct TetMesh {
    /// All points of the file.
    pub points: Points,
    /// Four points each, in either orientation.
    pub tets: Column<[u32; 4]>,
    /// The file's cell of each tetrahedron; ascending.
    pub file_from_tet: Column<u32>,
    /// Arrays over the file's points and cells.
    pub arrays: Vec<Array>,
    /// What the reader left out or split; `inverted` and `degenerate` are counted here.
    pub counts: CellCounts,
}

impl Dataset {
    /// Checks `mesh` and brings it into the order in which it is drawn.
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`], [`Error::NonFinitePosition`], [`Error::LengthMismatch`], [`Error::TooLarge`], and
    /// [`Error::NoCells`] where no tetrahedron has a volume.
    pub fn from_tets(mesh: TetMesh) -> Result<Self> {
        let TetMesh { points, mut tets, mut file_from_tet, arrays, mut counts } = mesh;
        check(&points, &tets, &file_from_tet, &arrays, counts.in_file)?;

        let (low, high) = tets
            .par_iter()
            .flatten()
            .map(|&v| points.get(v as usize))
            .fold(|| (DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
            .reduce(|| (DVec3::INFINITY, DVec3::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        let placement = Placement::new(&points, low, high);
        let position = |v: u32| placement.position(points.get(v as usize));

        // Orientation and volume of what is drawn: of the narrowed positions, by an exact predicate.
        let orientation: Vec<i8> = tets.par_iter().map(|&tet| orientation_of(tet.map(position))).collect();
        counts.inverted = orientation.par_iter().filter(|&&sign| sign < 0).count() as u64;
        counts.degenerate = orientation.par_iter().filter(|&&sign| sign == 0).count() as u64;
        if counts.degenerate > 0 {
            let has_volume = |tet: &usize| orientation[*tet] != 0;
            file_from_tet = (0..tets.len()).filter(has_volume).map(|tet| file_from_tet[tet]).collect();
            tets = (0..tets.len()).filter(has_volume).map(|tet| tets[tet]).collect();
        }
        if tets.is_empty() {
            return Err(Error::NoCells { found: describe(&counts) });
        }

        let tet_from_cell = spatial_order::tet_from_cell(&tets, |tet| placement.key(tet.map(position)));
        let vertex_from_file = spatial_order::vertex_from_file(points.len(), &tets, &tet_from_cell);
        let file_from_vertex = spatial_order::invert(&vertex_from_file);

        let positions: Vec<[f32; 3]> = file_from_vertex.par_iter().map(|&v| position(v).to_array()).collect();
        let cells: Vec<[u32; 4]> = tet_from_cell
            .par_iter()
            .map(|&tet| {
                let mut cell = tets[tet as usize].map(|v| vertex_from_file[v as usize]);
                debug_assert!(!cell.contains(&UNUSED));
                cell.sort_unstable();
                cell
            })
            .collect();
        let signs: Vec<bool> = cells
            .par_iter()
            .map(|cell| orientation_of(cell.map(|v| Vec3::from_array(positions[v as usize]))) > 0)
            .collect();
        let file_from_cell: Vec<u32> = tet_from_cell.par_iter().map(|&tet| file_from_tet[tet as usize]).collect();

        let blocks: Vec<Block> = (0..cells.len())
            .step_by(Self::BLOCK_CELLS)
            .map(|start| {
                let range = start..(start + Self::BLOCK_CELLS).min(cells.len());
                let corners = cells[range.clone()].iter().flatten();
                let bounds = corners.fold(Bounds::EMPTY, |b, &v| b.include(Vec3::from_array(positions[v as usize])));
                Block { cells: range, bounds }
            })
            .collect();
        let bounds = blocks.iter().fold(Bounds::EMPTY, |all, block| all.union(block.bounds));

        Ok(Self {
            origin: placement.origin,
            positions: positions.into(),
            tets: cells.into(),
            positive: signs.into_iter().collect(),
            file_from_vertex: Some(file_from_vertex.into()),
            file_from_cell: Some(file_from_cell.into()),
            arrays,
            array_ranges: Vec::new(),
            adjacency: None,
            blocks,
            bounds,
            counts,
            read_bytes: 0,
            backing: None,
        })
    }
}

fn check(
    points: &Points,
    tets: &[[u32; 4]],
    file_from_tet: &[u32],
    arrays: &[Array],
    cells_in_file: u64,
) -> Result<()> {
    let limit = u64::from(u32::MAX) - 1;
    for (column, len) in [("points", points.len() as u64), ("cells", tets.len().max(file_from_tet.len()) as u64)] {
        if len > limit {
            return Err(Error::TooLarge { column, len, limit });
        }
    }
    if tets.len() != file_from_tet.len() {
        let (len, expected) = (file_from_tet.len() as u64, tets.len() as u64);
        return Err(Error::LengthMismatch { column: "file_from_tet".to_owned(), len, expected });
    }
    let len = points.len() as u64;
    let bad = tets.par_iter().position_first(|tet| tet.iter().any(|&v| u64::from(v) >= len));
    if let Some(tet) = bad {
        let index = tets[tet].iter().copied().max().map_or(0, i64::from);
        let cell = u64::from(file_from_tet[tet]);
        return Err(Error::IndexOutOfRange { column: "connectivity", cell, index, len });
    }
    let bad = tets.par_iter().flatten().find_first(|&&v| !points.get(v as usize).is_finite());
    if let Some(&point) = bad {
        let position = points.get(point as usize).to_array();
        return Err(Error::NonFinitePosition { point: point.into(), position });
    }
    check_arrays(len, arrays, cells_in_file)
}

/// Every array has a tuple for each point, or for each cell of the file.
pub(super) fn check_arrays(points: u64, arrays: &[Array], cells_in_file: u64) -> Result<()> {
    for array in arrays {
        let tuples = match array.association {
            Association::Point => points,
            Association::Cell => cells_in_file,
        };
        let expected = tuples.saturating_mul(array.components as u64);
        if array.values.len() as u64 != expected || array.components == 0 {
            let column = format!("array {:?}", array.name);
            return Err(Error::LengthMismatch { column, len: array.values.len() as u64, expected });
        }
    }
    Ok(())
}

pub(crate) fn describe(counts: &CellCounts) -> String {
    let kinds = [
        (counts.lower_dimensional, "without volume by kind (points, lines, faces)"),
        (counts.ghost, "hidden by vtkGhostType"),
        (counts.unsupported, "of unsupported kinds"),
        (counts.degenerate, "flat"),
    ];
    let found: Vec<String> =
        kinds.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} cells {what}")).collect();
    if found.is_empty() { "it has no cells at all".to_owned() } else { found.join(", ") }
}

#[cfg(test)]
mod tests;
