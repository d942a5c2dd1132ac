//! `.vti`: VTK XML images, and `.pvti`, in several files.
//!
//! Pieces of one image are put together row by row; what two pieces have is taken from the later one.

use std::path::Path;

use glam::{DMat3, DVec3};

use super::assemble::check_lengths;
use super::concat;
use super::mapping::Mapped;
use super::scratch::Scratch;
use super::source::{Source, quote};
use super::structured::{cells_of, points_of};
use super::vtk_xml::{self, Element, Extent};
use super::{numbers, volume};
use crate::columns::{Array, Association, Lattice, Volume};
use crate::error::Result;

/// Reads a `.vti` file that is in memory; `path` is its name in messages.
///
/// # Errors
/// [`Error::Malformed`](crate::Error::Malformed) and [`Error::Unsupported`](crate::Error::Unsupported).
pub fn read_vti(bytes: &[u8], path: &Path) -> Result<Volume> {
    read_vti_in(bytes, None, path, &Scratch::memory())
}

/// Reads a `.pvti` file that is in memory, and the pieces it names relative to the folder of `path`.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) where a piece cannot be read, and those of [`read_vti`].
pub fn read_pvti(bytes: &[u8], path: &Path) -> Result<Volume> {
    read_pvti_in(bytes, path, &Scratch::memory())
}

/// As [`read_vti`], the columns where `scratch` says.
/// and arrays in place of `mapped`, whose bytes these are.
pub(super) fn read_vti_in(bytes: &[u8], mapped: Option<&Mapped>, path: &Path, scratch: &Scratch) -> Result<Volume> {
    Ok(volume::watched(join(read_pieces(bytes, mapped, path, scratch)?, Source { path, scratch })?, mapped))
}

/// As [`read_pvti`], the columns where `scratch` says.
pub(super) fn read_pvti_in(bytes: &[u8], path: &Path, scratch: &Scratch) -> Result<Volume> {
    let source = Source { path, scratch };
    let files = vtk_xml::read_pieces(bytes, "PImageData", source, |bytes, path, scratch| {
        read_pieces(bytes, None, path, scratch)
    })?;
    join(files.into_iter().flatten().collect(), source)
}

/// Which points of the whole grid a piece holds, and its arrays.
struct Piece {
    extent: Extent,
    /// Where the points are, counted as the extents count them.
    lattice: Lattice,
    arrays: Vec<Array>,
}

/// The pieces that have points.
fn read_pieces(bytes: &[u8], mapped: Option<&Mapped>, path: &Path, scratch: &Scratch) -> Result<Vec<Piece>> {
    let source = Source { path, scratch };
    vtk_xml::read_mapped(bytes, mapped, "ImageData", source, |grid, encoding| {
        let whole = Extent::of(grid, "WholeExtent", source)?;
        let lattice = lattice(grid, source)?;
        let mut pieces = Vec::new();
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
            let points = points_of(dims).ok_or_else(too_many)?;
            let arrays = vtk_xml::arrays(piece, points, cells_of(dims), encoding, source)?;
            volume::check_bare(points, &arrays, &encoding.expansion)
                .map_err(|problem| source.malformed(piece.place(), problem))?;
            check_lengths(&arrays, points as u64, cells_of(dims) as u64).map_err(|error| error.in_file(path))?;
            pieces.push(Piece { extent, lattice, arrays });
        }
        Ok(pieces)
    })
}

/// Origin, spacing and direction: point i, j, k is at origin + direction · (spacing · ijk).
fn lattice(grid: &Element<'_>, source: Source<'_>) -> Result<Lattice> {
    let origin = numbers_of(grid, "Origin", [0.0; 3], source)?;
    let spacing = numbers_of(grid, "Spacing", [1.0; 3], source)?;
    let by_row = numbers_of(grid, "Direction", DMat3::IDENTITY.to_cols_array(), source)?;
    let direction = DMat3::from_cols_array(&by_row).transpose();
    Ok(Lattice::sheared(origin.into(), direction * DMat3::from_diagonal(spacing.into())))
}

fn numbers_of<const N: usize>(
    element: &Element<'_>,
    name: &str,
    default: [f64; N],
    source: Source<'_>,
) -> Result<[f64; N]> {
    let Some(text) = element.attribute(name) else { return Ok(default) };
    let numbers: Option<Vec<f64>> = text.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
        source.malformed(element.place(), format!("{name}={} are not {N} numbers", quote(text.as_bytes())))
    })
}

/// The pieces as one image.
fn join(mut pieces: Vec<Piece>, source: Source<'_>) -> Result<Volume> {
    const PLACE: &str = "the extents of its pieces";
    let Some(&Piece { extent, lattice, .. }) = pieces.first() else {
        return Err(source.malformed(PLACE, "hold no point"));
    };
    if pieces[1..].iter().any(|piece| piece.lattice != lattice) {
        return Err(source.malformed("its pieces", "have different origins, spacings or directions: damaged"));
    }
    let extent = pieces.iter().fold(extent, |all, piece| all.union(piece.extent));
    let arrays = if pieces.len() == 1 {
        pieces.swap_remove(0).arrays
    } else {
        assemble(&pieces, extent, source).map_err(|error| error.in_file(source.path))?
    };
    let first = DVec3::from([0, 1, 2].map(|axis| extent.first(axis) as f64));
    volume::of_file(extent.dims(), lattice.from_point(first), arrays, "<ImageData>", source)
}

/// The arrays that every piece has, over all points and cells.
fn assemble(pieces: &[Piece], whole: Extent, source: Source<'_>) -> Result<Vec<Array>> {
    let all = concat::arrays(&pieces.iter().map(|piece| &piece.arrays[..]).collect::<Vec<_>>(), source.scratch)?;
    let mut arrays = Vec::with_capacity(all.len());
    for association in [Association::Point, Association::Cell] {
        let of_kind: Vec<&Array> = all.iter().filter(|array| array.association == association).collect();
        if of_kind.is_empty() {
            continue;
        }
        let tuples = tuple_from_place(pieces, whole, association)
            .map_err(|problem| source.malformed("the extents of its pieces", problem))?;
        for array in of_kind {
            let values = numbers::gather(&array.values, array.components, &tuples);
            arrays.push(Array { values, ..array.clone() });
        }
    }
    Ok(arrays)
}

/// Which tuple, all pieces one after the other, stands at each point or cell of the whole image.
fn tuple_from_place(pieces: &[Piece], whole: Extent, association: Association) -> Result<Vec<u32>, String> {
    let sides = |extent: Extent| match association {
        Association::Point => extent.dims(),
        Association::Cell => extent.dims().map(|points| (points - 1).max(1)),
    };
    let [ni, nj, nk] = sides(whole);
    let places = points_of([ni, nj, nk]).unwrap_or(usize::MAX);
    let there: usize = pieces.iter().map(|piece| sides(piece.extent).iter().product::<usize>()).sum();
    // The arrays are as long as the pieces say, so the whole is no longer than what was read.
    if there < places {
        return Err(format!("leave out {} of {places} places of the image", places - there));
    }
    if u32::try_from(there).is_err() {
        return Err(format!("hold {there} tuples, which 32 bits cannot number: write one piece"));
    }
    let mut tuple_from_place = vec![u32::MAX; places];
    let mut first_tuple = 0;
    for piece in pieces {
        let along = sides(piece.extent);
        let [i, j, k] = [0, 1, 2].map(|axis| (piece.extent.first(axis) - whole.first(axis)) as usize);
        // One layer of points in a thicker image has no cells of its kind.
        let is_part = i + along[0] <= ni && j + along[1] <= nj && k + along[2] <= nk;
        let is_flat = (0..3).any(|axis| piece.extent.dims()[axis] == 1 && whole.dims()[axis] > 1);
        if is_part && !(is_flat && association == Association::Cell) {
            for row in 0..along[1] * along[2] {
                let place = i + ni * (j + row % along[1] + nj * (k + row / along[1]));
                let tuple = first_tuple + row * along[0];
                for (n, found) in tuple_from_place[place..][..along[0]].iter_mut().enumerate() {
                    *found = (tuple + n) as u32;
                }
            }
        }
        first_tuple += along.iter().product::<usize>();
    }
    match tuple_from_place.iter().filter(|&&tuple| tuple == u32::MAX).count() {
        0 => Ok(tuple_from_place),
        missing => Err(format!("leave out {missing} of {places} places of the image")),
    }
}
