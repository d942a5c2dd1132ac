//! `.vts` and `.vtr`: VTK XML structured and rectilinear grids, and `.pvts` and `.pvtr`, in several files.
//!
//! Every piece is a block. Neighbours have the points between them twice, which makes no difference once cells are cut;
//! cells that two pieces have are drawn once (`overlap.rs`).

use std::path::Path;

use super::scratch::Scratch;
use super::source::Source;
use super::structured::{cells_of, points_of};
use super::vtk_xml::{self, Element, Encoding, Extent};
use super::{StructuredMesh, overlap, rectilinear};
use crate::columns::Points;
use crate::error::Result;

/// Reads a `.vts` file that is in memory; `path` is its name in messages.
///
/// # Errors
/// [`Error::Malformed`](crate::Error::Malformed), [`Error::Unsupported`](crate::Error::Unsupported), and
/// [`Error::TooLarge`](crate::Error::TooLarge) with the file's name.
pub fn read_vts(bytes: &[u8], path: &Path) -> Result<StructuredMesh> {
    read_file(bytes, path, &STRUCTURED, &Scratch::memory())
}

/// Reads a `.vtr` file that is in memory; `path` is its name in messages.
///
/// # Errors
/// Those of [`read_vts`].
pub fn read_vtr(bytes: &[u8], path: &Path) -> Result<StructuredMesh> {
    read_file(bytes, path, &RECTILINEAR, &Scratch::memory())
}

/// Reads a `.pvts` file that is in memory, and the pieces it names relative to the folder of `path`.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) where a piece cannot be read, and those of [`read_vts`].
pub fn read_pvts(bytes: &[u8], path: &Path) -> Result<StructuredMesh> {
    read_parallel(bytes, path, &STRUCTURED, &Scratch::memory())
}

/// Reads a `.pvtr` file that is in memory, and the pieces it names relative to the folder of `path`.
///
/// # Errors
/// Those of [`read_pvts`].
pub fn read_pvtr(bytes: &[u8], path: &Path) -> Result<StructuredMesh> {
    read_parallel(bytes, path, &RECTILINEAR, &Scratch::memory())
}

/// What differs between the two.
pub(super) struct Kind {
    element: &'static str,
    parallel_element: &'static str,
    /// The points of a piece with so many of them along i, j and k.
    points: fn(&Element<'_>, [usize; 3], &Encoding<'_>, Source<'_>) -> Result<Points>,
}

pub(super) const STRUCTURED: Kind = Kind {
    element: "StructuredGrid",
    parallel_element: "PStructuredGrid",
    points: |piece, dims, encoding, source| vtk_xml::points(piece, dims.iter().product(), encoding, source),
};

pub(super) const RECTILINEAR: Kind =
    Kind { element: "RectilinearGrid", parallel_element: "PRectilinearGrid", points: rectilinear_points };

/// As [`read_vts`] or [`read_vtr`], the columns where `scratch` says.
pub(super) fn read_file(bytes: &[u8], path: &Path, kind: &Kind, scratch: &Scratch) -> Result<StructuredMesh> {
    join(read_blocks(bytes, path, kind, scratch)?, path, scratch)
}

/// As [`read_pvts`] or [`read_pvtr`], the columns where `scratch` says.
pub(super) fn read_parallel(bytes: &[u8], path: &Path, kind: &Kind, scratch: &Scratch) -> Result<StructuredMesh> {
    let read = |bytes: &[u8], path: &Path, scratch: &Scratch| read_blocks(bytes, path, kind, scratch);
    let files = vtk_xml::read_pieces(bytes, kind.parallel_element, Source { path, scratch }, read)?;
    join(files.into_iter().flatten().collect(), path, scratch)
}

/// A piece, and which points of the whole grid it holds.
type Block = (Extent, StructuredMesh);

fn join(blocks: Vec<Block>, path: &Path, scratch: &Scratch) -> Result<StructuredMesh> {
    let (extents, pieces): (Vec<_>, Vec<_>) = blocks.into_iter().unzip();
    let mut mesh = StructuredMesh::concat(pieces, scratch).map_err(|error| error.in_file(path))?;
    let malformed = |problem| Source { path, scratch }.malformed("the extents of its pieces", problem);
    overlap::hide_shared_cells(&mut mesh, &extents).map_err(malformed)?;
    Ok(mesh)
}

/// The pieces that have points.
fn read_blocks(bytes: &[u8], path: &Path, kind: &Kind, scratch: &Scratch) -> Result<Vec<Block>> {
    let source = Source { path, scratch };
    vtk_xml::read_grid(bytes, kind.element, source, |grid, encoding| {
        let whole = Extent::of(grid, "WholeExtent", source)?;
        let mut blocks = Vec::new();
        for piece in grid.children_named("Piece") {
            let extent = Extent::of(piece, "Extent", source)?;
            let dims = extent.dims();
            if dims == [0; 3] {
                continue;
            }
            if !whole.contains(extent) {
                return Err(source.malformed(piece.place(), "its Extent lies outside the WholeExtent: damaged"));
            }
            let too_many = || source.malformed(piece.place(), format!("{dims:?} points cannot be"));
            let point_count = points_of(dims).ok_or_else(too_many)?;
            let points = (kind.points)(piece, dims, encoding, source)?;
            let arrays = vtk_xml::arrays(piece, point_count, cells_of(dims), encoding, source)?;
            blocks.push((extent, StructuredMesh::new(&[dims], points, arrays).map_err(|error| error.in_file(path))?));
        }
        Ok(blocks)
    })
}

fn rectilinear_points(
    piece: &Element<'_>,
    dims: [usize; 3],
    encoding: &Encoding<'_>,
    source: Source<'_>,
) -> Result<Points> {
    let coordinates = vtk_xml::child(piece, "Coordinates", source)?;
    let mut arrays = coordinates.children_named("DataArray");
    let mut axis = |axis: usize| {
        let missing = || source.malformed(coordinates.place(), "holds fewer than three <DataArray>");
        encoding.values(arrays.next().ok_or_else(missing)?, Some(dims[axis]))
    };
    let (x, y, z) = (axis(0)?, axis(1)?, axis(2)?);
    rectilinear::points([&x, &y, &z], &encoding.expansion)
        .map_err(|problem| source.malformed(coordinates.place(), problem))
}
