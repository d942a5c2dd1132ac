//! From cells in file order to a [`Dataset`]: check, re-centre, orient, drop what has no volume, order in space.

mod in_place;
mod structured;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::placement::{Placement, orientation_of};
use super::polyhedra::Built;
use super::spatial_order::{self, Numbering, UNUSED};
use super::{
    Array, Association, Block, Bounds, CellCounts, Column, Dataset, FaceLists, HexShape, Hexahedra, Polyhedra,
};
use crate::columns::canonical_from_point;
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

pub(crate) use in_place::{CellsInPlace, PositionsInPlace};
pub use structured::StructuredCells;

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

/// Cells of all kinds in file order: what a reader hands over that keeps cells whole.
#[derive(Clone, Debug)]
pub struct CellMesh {
    /// All points of the file.
    pub points: Points,
    /// Four points each, in either orientation.
    pub tets: Column<[u32; 4]>,
    /// The file's cell of each tetrahedron; ascending.
    pub file_from_tet: Column<u32>,
    /// Eight points each in VTK's order, in either orientation; some may coincide (see [`hexahedron_of`](crate::cells::hexahedron_of)).
    pub hexahedra: Column<[u32; 8]>,
    /// The file's cell of each hexahedron; ascending.
    pub file_from_hexahedron: Column<u32>,
    /// The faces of each polyhedron.
    pub polyhedra: FaceLists,
    /// The file's cell of each polyhedron; ascending.
    pub file_from_polyhedron: Column<u32>,
    /// Arrays over the file's points and cells.
    pub arrays: Vec<Array>,
    /// What the reader left out; `inverted` and `degenerate` are counted here.
    pub counts: CellCounts,
}

impl From<TetMesh> for CellMesh {
    fn from(mesh: TetMesh) -> Self {
        let TetMesh { points, tets, file_from_tet, arrays, counts } = mesh;
        Self { points, tets, file_from_tet, arrays, counts, ..Self::empty() }
    }
}

impl CellMesh {
    /// A mesh without points and cells.
    pub fn empty() -> Self {
        let [file_from_tet, file_from_hexahedron, file_from_polyhedron] = [(); 3].map(|()| Vec::new().into());
        Self {
            points: Points::F32(Vec::new()),
            tets: Vec::new().into(),
            file_from_tet,
            hexahedra: Vec::new().into(),
            file_from_hexahedron,
            polyhedra: FaceLists::default(),
            file_from_polyhedron,
            arrays: Vec::new(),
            counts: CellCounts::default(),
        }
    }
}

impl Dataset {
    /// Checks `mesh` and brings it into the order in which it is drawn.
    ///
    /// # Errors
    /// Those of [`Dataset::from_cells`].
    pub fn from_tets(mesh: TetMesh) -> Result<Self> {
        Self::from_cells(mesh.into())
    }

    /// Checks `mesh` and brings it into the order in which it is drawn.
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`], [`Error::NonFinitePosition`], [`Error::LengthMismatch`], [`Error::TooLarge`],
    /// [`Error::OpenCell`], and [`Error::NoCells`] where no cell has a volume.
    pub fn from_cells(mesh: CellMesh) -> Result<Self> {
        check(&mesh)?;
        let CellMesh { points, tets, file_from_tet, hexahedra, file_from_hexahedron, arrays, mut counts, .. } = mesh;
        let (low, high) = tets
            .par_iter()
            .flatten()
            .chain(hexahedra.par_iter().flatten())
            .chain(mesh.polyhedra.points())
            .map(|&v| points.get(v as usize))
            .fold(|| (DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
            .reduce(|| (DVec3::INFINITY, DVec3::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        let placement = Placement::new(&points, low, high);
        let position = |v: u32| placement.position(points.get(v as usize));

        // Orientation and volume of what is drawn: of the narrowed positions, by an exact predicate.
        let orientation: Vec<i8> = tets.par_iter().map(|&tet| orientation_of(tet.map(position))).collect();
        let has_names = !hexahedra.is_empty() || !mesh.polyhedra.is_empty();
        let canonical = if has_names { canonical_from_point(&points) } else { Vec::new() };
        let shape = |hex: &[u32; 8]| HexShape::new(hex.map(position), hex.map(|point| canonical[point as usize]));
        let shapes: Vec<HexShape> = hexahedra.par_iter().map(shape).collect();
        let polyhedra = Built::new(&mesh.polyhedra, &mesh.file_from_polyhedron, &canonical, position, &placement)?;
        let canonical = if polyhedra.len() == 0 { Vec::new() } else { canonical };
        counts.inverted = orientation.par_iter().filter(|&&sign| sign < 0).count() as u64
            + shapes.par_iter().filter(|shape| shape.is_mirrored()).count() as u64
            + polyhedra.mirrored;
        let (tets, file_from_tet, flat_tets) = with_volume(tets, file_from_tet, |tet| orientation[tet] != 0);
        let (hexahedra, file_from_hexahedron, flat_hexahedra) =
            with_volume(hexahedra, file_from_hexahedron, |hex| !shapes[hex].is_absent());
        let shapes: Vec<HexShape> = shapes.into_iter().filter(|shape| !shape.is_absent()).collect();
        counts.degenerate = flat_tets + flat_hexahedra + polyhedra.flat;
        if tets.is_empty() && hexahedra.is_empty() && polyhedra.len() == 0 {
            return Err(Error::NoCells { found: describe(&counts) });
        }

        let tet_from_cell = spatial_order::file_from_cell(&tets, |tet| placement.key(tet.map(position)));
        let hex_from_cell = spatial_order::file_from_cell(&hexahedra, |hex| placement.key(hex.map(position)));
        let mut numbering = Numbering::new(points.len());
        numbering.number(&tets, &tet_from_cell);
        numbering.number(&hexahedra, &hex_from_cell);
        numbering.number_points(polyhedra.points());
        let (vertex_from_file, file_from_vertex) = numbering.finish();

        let positions: Vec<[f32; 3]> = file_from_vertex.par_iter().map(|&v| position(v).to_array()).collect();
        let is_too_far = |&v: &usize| !Vec3::from(positions[v]).is_finite();
        if let Some(vertex) = (0..positions.len()).into_par_iter().find_first(is_too_far) {
            let point = file_from_vertex[vertex];
            let position = points.get(point as usize).to_array();
            return Err(Error::NonFinitePosition { point: point.into(), position });
        }
        let vertex = |point: u32| {
            let vertex = vertex_from_file[point as usize];
            debug_assert!(vertex != UNUSED);
            vertex
        };
        let tets: Vec<[u32; 4]> = tet_from_cell
            .par_iter()
            .map(|&tet| {
                let mut cell = tets[tet as usize].map(vertex);
                cell.sort_unstable();
                cell
            })
            .collect();
        let hexahedra: Vec<[u32; 8]> =
            hex_from_cell.par_iter().map(|&hex| hexahedra[hex as usize].map(vertex)).collect();
        let shapes: Vec<HexShape> = hex_from_cell.par_iter().map(|&hex| shapes[hex as usize]).collect();
        let positive: Vec<bool> = tets
            .par_iter()
            .map(|cell| orientation_of(cell.map(|v| Vec3::from_array(positions[v as usize]))) > 0)
            .collect();
        let file_from_cell: Vec<u32> = tet_from_cell
            .par_iter()
            .map(|&tet| file_from_tet[tet as usize])
            .chain(hex_from_cell.par_iter().map(|&hex| file_from_hexahedron[hex as usize]))
            .chain(polyhedra.file_from_cell.par_iter().copied())
            .collect();

        let mut blocks = blocks_of(0, &tets, &positions);
        blocks.extend(blocks_of(tets.len(), &hexahedra, &positions));
        let polyhedra = polyhedra.finish(vertex, &canonical)?;
        blocks.extend(blocks_of_polyhedra(tets.len() + hexahedra.len(), &polyhedra, &positions));
        let bounds = blocks.iter().fold(Bounds::EMPTY, |all, block| all.union(block.bounds));

        Ok(Self {
            origin: placement.origin,
            positions: positions.into(),
            tets: tets.into(),
            hexahedra: Hexahedra::listed(hexahedra.into(), shapes.into()),
            polyhedra,
            positive: positive.into_iter().collect(),
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

/// The cells that have a volume, and how many have none.
fn with_volume<const N: usize>(
    cells: Column<[u32; N]>,
    file_from: Column<u32>,
    has_volume: impl Fn(usize) -> bool,
) -> (Column<[u32; N]>, Column<u32>, u64) {
    let kept = (0..cells.len()).filter(|&cell| has_volume(cell)).count();
    if kept == cells.len() {
        return (cells, file_from, 0);
    }
    let flat = (cells.len() - kept) as u64;
    let kept = || (0..cells.len()).filter(|&cell| has_volume(cell));
    (kept().map(|cell| cells[cell]).collect(), kept().map(|cell| file_from[cell]).collect(), flat)
}

/// Cells of one kind in blocks, the first of them cell `first`.
fn blocks_of<const N: usize>(first: usize, cells: &[[u32; N]], positions: &[[f32; 3]]) -> Vec<Block> {
    let block = |(i, run): (usize, &[[u32; N]])| {
        let start = first + i * Dataset::BLOCK_CELLS;
        let corners = run.iter().flatten();
        let bounds = corners.fold(Bounds::EMPTY, |b, &v| b.include(Vec3::from_array(positions[v as usize])));
        Block { cells: start..start + run.len(), bounds }
    };
    cells.chunks(Dataset::BLOCK_CELLS).enumerate().map(block).collect()
}

/// Polyhedra in blocks, the first of them cell `first`.
fn blocks_of_polyhedra(first: usize, polyhedra: &Polyhedra, positions: &[[f32; 3]]) -> Vec<Block> {
    let view = polyhedra.view();
    let block = |start: usize| {
        let run = start..(start + Dataset::BLOCK_CELLS).min(polyhedra.len());
        let corners = run.clone().flat_map(|cell| view.corners(cell));
        let bounds = corners.fold(Bounds::EMPTY, |b, &v| b.include(Vec3::from_array(positions[v as usize])));
        Block { cells: first + run.start..first + run.end, bounds }
    };
    (0..polyhedra.len()).step_by(Dataset::BLOCK_CELLS).map(block).collect()
}

fn check(mesh: &CellMesh) -> Result<()> {
    let limit = u64::from(u32::MAX) - 1;
    let CellMesh {
        points, tets, file_from_tet, hexahedra, file_from_hexahedron, polyhedra, file_from_polyhedron, ..
    } = mesh;
    let cells = tets.len().max(file_from_tet.len())
        + hexahedra.len().max(file_from_hexahedron.len())
        + polyhedra.cells().max(file_from_polyhedron.len());
    for (column, len) in [("points", points.len() as u64), ("cells", cells as u64)] {
        if len > limit {
            return Err(Error::TooLarge { column, len, limit });
        }
    }
    check_cells("file_from_tet", tets, file_from_tet, points)?;
    check_cells("file_from_hexahedron", hexahedra, file_from_hexahedron, points)?;
    check_polyhedra(polyhedra, file_from_polyhedron, points)?;
    check_arrays(points.len() as u64, &mesh.arrays, mesh.counts.in_file)
}

/// Every cell has a file's cell, every corner a point at a finite position.
fn check_cells<const N: usize>(column: &str, cells: &[[u32; N]], file_from: &[u32], points: &Points) -> Result<()> {
    if cells.len() != file_from.len() {
        let (len, expected) = (file_from.len() as u64, cells.len() as u64);
        return Err(Error::LengthMismatch { column: column.to_owned(), len, expected });
    }
    let len = points.len() as u64;
    let bad = cells.par_iter().position_first(|cell| cell.iter().any(|&v| u64::from(v) >= len));
    if let Some(cell) = bad {
        let index = cells[cell].iter().copied().max().map_or(0, i64::from);
        let cell = u64::from(file_from[cell]);
        return Err(Error::IndexOutOfRange { column: "connectivity", cell, index, len });
    }
    let bad = cells.par_iter().flatten().find_first(|&&v| !points.get(v as usize).is_finite());
    if let Some(&point) = bad {
        let position = points.get(point as usize).to_array();
        return Err(Error::NonFinitePosition { point: point.into(), position });
    }
    Ok(())
}

/// The same of polyhedra.
fn check_polyhedra(polyhedra: &FaceLists, file_from: &[u32], points: &Points) -> Result<()> {
    if polyhedra.cells() != file_from.len() {
        let (column, expected) = ("file_from_polyhedron".to_owned(), polyhedra.cells() as u64);
        return Err(Error::LengthMismatch { column, len: file_from.len() as u64, expected });
    }
    let len = points.len() as u64;
    for (cell, &file_cell) in file_from.iter().enumerate() {
        for &point in polyhedra.faces(cell).flatten() {
            if u64::from(point) >= len {
                let (cell, index) = (file_cell.into(), point.into());
                return Err(Error::IndexOutOfRange { column: "faces", cell, index, len });
            }
            let position = points.get(point as usize);
            if !position.is_finite() {
                return Err(Error::NonFinitePosition { point: point.into(), position: position.to_array() });
            }
        }
    }
    Ok(())
}

/// Every array has a tuple for each point, or for each cell of the file.
pub(in crate::columns) fn check_arrays(points: u64, arrays: &[Array], cells_in_file: u64) -> Result<()> {
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
