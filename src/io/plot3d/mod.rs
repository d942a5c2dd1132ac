//! PLOT3D: a grid file of one or several blocks, and the solution beside it.
//!
//! In: the bytes of a grid. Out: [`StructuredMesh`], with the solution's arrays under VTK's names. Neither file says how it is
//! written: `layout.rs` finds the one way that makes the file's length; `numbers.rs` reads accordingly, `words.rs` text.
//! (P. G. Buning et al., "PLOT3D User's Manual", NASA TM 101067, 1990; whole files, not planes.)

mod layout;
mod numbers;
mod words;

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "values are read bit for bit")]
mod tests;

use std::fs::File;
use std::path::{Path, PathBuf};

use self::layout::Layout;
use self::numbers::{Number, Numbers};
use super::StructuredMesh;
use super::assemble::HIDDEN_CELL;
use super::numbers::NumberType;
use super::scratch::Scratch;
use super::source::Source;
use crate::atomic::io_at;
use crate::columns::{Array, Association, Column, NumericColumn, Points};
use crate::error::Result;

/// Values a point in a solution: density, momentum, stagnation energy.
const SOLUTION_VALUES: usize = 5;
/// Values of a block in a solution before those of its points: Mach number, angle of attack, Reynolds number, time.
const CONDITIONS: usize = 4;

/// Reads a PLOT3D grid that is in memory, and the solution beside it if there is one: for `NAMExyz.EXTENSION` that is
/// `NAMEq.EXTENSION`, for `NAME.xyz`, `NAME.x` and `NAME.p3d` it is `NAME.q`.
///
/// Arrays over points: `Density`, `Momentum` and `StagnationEnergy` of a solution, `IBlank` of a grid that has it; cells with
/// a corner of `IBlank` 0 are hidden by `vtkGhostType`.
///
/// # Errors
/// [`Error::Malformed`](crate::Error::Malformed) where the length fits no layout, or the solution is not of this grid;
/// [`Error::Unsupported`](crate::Error::Unsupported) for a two-dimensional grid and for a solution; [`Error::Io`](crate::Error::Io).
pub fn read_plot3d(bytes: &[u8], path: &Path) -> Result<StructuredMesh> {
    read_plot3d_in(bytes, path, &Scratch::memory())
}

/// As [`read_plot3d`], the columns where `scratch` says.
pub(super) fn read_plot3d_in(bytes: &[u8], path: &Path, scratch: &Scratch) -> Result<StructuredMesh> {
    let source = Source { path, scratch };
    let layout = layout::of_grid(bytes, source)?;
    let (points, iblank) = read_grid(bytes, &layout, source)?;
    let mut arrays = Vec::new();
    if let Some(path) = solution_of(path) {
        let file = File::open(&path).map_err(io_at(&path))?;
        let bytes = scratch.bytes_of(&path, file)?;
        arrays = read_solution((*bytes).as_ref(), &layout, Source { path: &path, scratch })?;
    }
    arrays.extend(iblank.clone().map(|values| point_array("IBlank", 1, values.into())));
    let mut mesh = StructuredMesh::new(&layout.dims, points, arrays).map_err(|error| error.in_file(path))?;
    if let Some(iblank) = iblank {
        let hidden = hidden_cells(&mesh, &iblank);
        mesh.mark(HIDDEN_CELL, &hidden);
    }
    Ok(mesh)
}

/// The file beside the grid `path` that its name makes its solution, if it is there.
fn solution_of(path: &Path) -> Option<PathBuf> {
    let (stem, extension) = (path.file_stem()?.to_str()?, path.extension()?.to_str()?);
    let q_as = |like: &str| if like.starts_with(char::is_uppercase) { "Q" } else { "q" };
    let (name, ending) = stem.split_at_checked(stem.len().saturating_sub(3))?;
    let solution = match extension.to_ascii_lowercase().as_str() {
        _ if ending.eq_ignore_ascii_case("xyz") => path.with_file_name(format!("{name}{}.{extension}", q_as(ending))),
        "xyz" | "x" | "p3d" => path.with_extension(q_as(extension)),
        _ => return None,
    };
    solution.is_file().then_some(solution)
}

/// The points of all blocks, and whether each is visible (not 0), where the grid says so.
fn read_grid(bytes: &[u8], layout: &Layout, source: Source<'_>) -> Result<(Points, Option<Column<i32>>)> {
    match layout.real {
        NumberType::F64 => read_grid_of(bytes, layout, source, Points::F64),
        _ => read_grid_of(bytes, layout, source, Points::F32),
    }
}

fn read_grid_of<T: Number>(
    bytes: &[u8],
    layout: &Layout,
    source: Source<'_>,
    points_from: impl FnOnce(Vec<[T; 3]>) -> Points,
) -> Result<(Points, Option<Column<i32>>)> {
    let mut numbers = Numbers::after_header(bytes, layout, source);
    let mut points = Vec::with_capacity(layout.points().sum());
    let mut iblank = source.scratch.column();
    for n in layout.points() {
        numbers.mark(layout.block_bytes(n))?;
        let xyz = numbers.take::<T>(3 * n)?;
        points.extend((0..n).map(|i| [xyz[i], xyz[n + i], xyz[2 * n + i]]));
        if layout.has_iblank {
            iblank.extend(numbers.take::<i32>(n)?.iter().copied())?;
        }
        numbers.mark(layout.block_bytes(n))?;
    }
    let iblank = if layout.has_iblank { Some(iblank.finish()?) } else { None };
    Ok((points_from(points), iblank))
}

/// The arrays of the solution of `grid`.
fn read_solution(bytes: &[u8], grid: &Layout, source: Source<'_>) -> Result<Vec<Array>> {
    let layout = layout::of_solution(bytes, grid, source)?;
    if layout.dims != grid.dims {
        let problem = format!(
            "is of {}, its grid of {}: it belongs to another grid; move it away to open the grid alone",
            layout::describe(&layout.dims),
            layout::describe(&grid.dims)
        );
        return Err(source.malformed("the solution", problem));
    }
    match layout.real {
        NumberType::F64 => read_solution_of::<f64>(bytes, &layout, source),
        _ => read_solution_of::<f32>(bytes, &layout, source),
    }
}

fn read_solution_of<T: Number>(bytes: &[u8], layout: &Layout, source: Source<'_>) -> Result<Vec<Array>>
where
    NumericColumn: From<Column<T>>,
{
    let mut numbers = Numbers::after_header(bytes, layout, source);
    let scratch = source.scratch;
    let (mut density, mut momentum, mut energy) = (scratch.column(), scratch.column(), scratch.column());
    for n in layout.points() {
        let conditions = CONDITIONS * layout.real.size();
        numbers.mark(conditions)?;
        numbers.take::<T>(CONDITIONS)?;
        numbers.mark(conditions)?;
        numbers.mark(layout.block_bytes(n))?;
        let values = numbers.take::<T>(SOLUTION_VALUES * n)?;
        numbers.mark(layout.block_bytes(n))?;
        density.extend(values[..n].iter().copied())?;
        momentum.extend((0..n).flat_map(|i| [1, 2, 3].map(|plane| values[plane * n + i])))?;
        energy.extend(values[4 * n..].iter().copied())?;
    }
    Ok(vec![
        point_array("Density", 1, density.finish()?.into()),
        point_array("Momentum", 3, momentum.finish()?.into()),
        point_array("StagnationEnergy", 1, energy.finish()?.into()),
    ])
}

fn point_array(name: &str, components: usize, values: NumericColumn) -> Array {
    Array { name: name.to_owned(), association: Association::Point, components, values }
}

/// The hexahedra with a corner that is not visible.
fn hidden_cells(mesh: &StructuredMesh, iblank: &[i32]) -> Vec<usize> {
    let mut hidden = Vec::new();
    for block in mesh.blocks().iter().filter(|block| block.has_volume()) {
        let is_hidden = |cell: &usize| block.corners(*cell).iter().any(|&point| iblank[point as usize] == 0);
        hidden.extend((0..block.cells()).filter(is_hidden).map(|cell| block.first_cell() + cell));
    }
    hidden
}
