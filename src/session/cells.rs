//! From the cells of a [`MeshView`] to columns: in place where they are of one kind and numbered in 32 bits, copied where not.
#![expect(unsafe_code, reason = "columns are lent by whoever calls")]

use super::loan::lend;
use super::view::{Cells, Indices, MeshView};
use crate::cells::{CellKind, HEXAHEDRON, TETRAHEDRON, hexahedron_of};
use crate::columns::{CellCounts, CellMesh, CellsInPlace, Column, FaceLists, HexCorners, Positions, StructuredBlock};
use crate::error::{Error, Result};
use crate::io::UnstructuredMesh;

/// The cells of `mesh`, checked.
///
/// # Errors
/// [`Error::LengthMismatch`], [`Error::IndexOutOfRange`], [`Error::TooLarge`].
///
/// # Safety
/// As for [`lend`].
pub(super) unsafe fn cells_of(mesh: &MeshView<'_, '_>) -> Result<CellsInPlace> {
    mesh.positions.check()?;
    let points = mesh.positions.len();
    let cells = match mesh.cells {
        Cells::Structured { dims } => structured(dims, points)?,
        // SAFETY: the caller's obligation.
        Cells::OfKind { kind, points: indices } => unsafe { of_kind(kind, indices, points) }?,
        Cells::Mixed { types, offsets, points: indices } => match only_kind(types, offsets, indices) {
            // SAFETY: the caller's obligation.
            Some(kind) => unsafe { of_kind(kind, indices, points) }?,
            // SAFETY: the caller's obligation.
            None => unsafe { mixed((types, offsets, indices), mesh.positions) }?,
        },
    };
    cells.check(points)?;
    Ok(cells)
}

/// Cells of which those that are not given are none.
fn none(in_file: usize) -> CellsInPlace {
    CellsInPlace {
        tets: Vec::new().into(),
        file_from_tet: None,
        hexahedra: HexCorners::Listed(Vec::new().into()),
        file_from_hexahedron: None,
        counts: CellCounts { in_file: in_file as u64, ..CellCounts::default() },
    }
}

fn structured(dims: [usize; 3], points: usize) -> Result<CellsInPlace> {
    // The products are checked below.
    let cells = dims.iter().map(|&along| along.saturating_sub(1)).fold(1_usize, usize::saturating_mul);
    let blocks = StructuredBlock::sequence([dims], points, cells)?;
    Ok(CellsInPlace { hexahedra: HexCorners::Structured(blocks), ..none(cells) })
}

/// # Safety
/// As for [`lend`].
unsafe fn of_kind(kind: &'static CellKind, indices: Indices<'_>, points: usize) -> Result<CellsInPlace> {
    let cells = indices.len() / kind.corners;
    if !indices.len().is_multiple_of(kind.corners) {
        let column = format!("connectivity of {} points a cell", kind.corners);
        let (len, expected) = (indices.len() as u64, (cells as u64 + 1) * kind.corners as u64);
        return Err(Error::LengthMismatch { column, len, expected });
    }
    if kind == &TETRAHEDRON {
        // SAFETY: the caller's obligation.
        return Ok(CellsInPlace { tets: unsafe { rows(indices, points) }?, ..none(cells) });
    }
    let corners = if kind == &HEXAHEDRON {
        // SAFETY: the caller's obligation.
        unsafe { rows(indices, points) }?
    } else {
        let Some(corner_of) = hexahedron_of(kind) else { return Ok(none(cells)) };
        let all = indices.narrowed(points, |i| i / kind.corners)?;
        all.chunks_exact(kind.corners).map(|of_cell| corner_of.map(|corner| of_cell[corner])).collect()
    };
    Ok(CellsInPlace { hexahedra: HexCorners::Listed(corners), ..none(cells) })
}

/// Rows of `N` numbers, in place where that can be.
///
/// # Safety
/// As for [`lend`].
unsafe fn rows<const N: usize>(indices: Indices<'_>, points: usize) -> Result<Column<[u32; N]>> {
    match indices.in_place() {
        // SAFETY: the caller's obligation.
        Some(in_place) => Ok(unsafe { lend(in_place.as_chunks().0) }),
        None => indices.narrowed_rows(points),
    }
}

/// The kind of all cells, if all are tetrahedra or all hexahedra and one follows the other.
fn only_kind(types: &[u8], offsets: Indices<'_>, indices: Indices<'_>) -> Option<&'static CellKind> {
    let kind = [&TETRAHEDRON, &HEXAHEDRON].into_iter().find(|kind| types.first() == Some(&kind.code))?;
    let is_alike = offsets.len() == types.len() + 1
        && indices.len() == types.len() * kind.corners
        && types.iter().all(|&code| code == kind.code)
        && (0..offsets.len()).all(|cell| offsets.get(cell) == Some((cell * kind.corners) as u64));
    is_alike.then_some(kind)
}

/// Cells of several kinds; what cannot be drawn is left out and counted.
///
/// # Safety
/// As for [`lend`]; what is lent is gone when this returns.
unsafe fn mixed(
    (types, offsets, indices): (&[u8], Indices<'_>, Indices<'_>),
    positions: Positions<'_>,
) -> Result<CellsInPlace> {
    let offset = |i: usize| offsets.get(i).unwrap_or(u64::MAX);
    let connectivity = if let Some(in_place) = indices.in_place() {
        // SAFETY: the caller's obligation.
        unsafe { lend(in_place) }
    } else {
        let cell_of = |i: usize| (0..types.len()).find(|&cell| offset(cell + 1) > i as u64).unwrap_or(0);
        indices.narrowed(positions.len(), cell_of)?.into()
    };
    let mesh = UnstructuredMesh {
        points: positions.to_points(),
        // SAFETY: the caller's obligation.
        types: unsafe { lend(types) },
        offsets: (0..offsets.len()).map(offset).collect(),
        connectivity,
        faces: FaceLists::default(),
        arrays: Vec::new(),
    };
    let CellMesh { tets, file_from_tet, hexahedra, file_from_hexahedron, polyhedra, mut counts, .. } =
        mesh.into_cells()?;
    // Prisms of five and six sides: a session does not draw them.
    counts.unsupported += polyhedra.cells() as u64;
    Ok(CellsInPlace {
        tets,
        file_from_tet: Some(file_from_tet),
        hexahedra: HexCorners::Listed(hexahedra),
        file_from_hexahedron: Some(file_from_hexahedron),
        counts,
    })
}
