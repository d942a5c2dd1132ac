//! Regular grids: what readers check of them, and their way to meshes whose points are stored.

use std::sync::Arc;

use glam::DVec3;

use super::expansion::Expansion;
use super::mapping::Mapped;
use super::source::Source;
use super::structured::points_of;
use super::{Mesh, StructuredMesh};
use crate::columns::{Array, Lattice, Points, Volume};
use crate::error::{Error, Result};
use crate::memory;

/// Bytes a point that a volume takes while it becomes a [`Dataset`](crate::Dataset) of whole hexahedra, its points included: sorting
/// them takes the most (`columns::canonical_from_point`).
const WHOLE_BYTES: u64 = 80;
/// The same where six tetrahedra a cell are cut first.
const TETRAHEDRA_BYTES: u64 = WHOLE_BYTES + 6 * 40;

/// What becomes of the cells of a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// They stay whole.
    Whole,
    /// They are cut into tetrahedra.
    Tetrahedra,
}

impl StructuredMesh {
    /// A volume with its points stored, as a structured mesh of one block: in single precision where that changes none.
    ///
    /// # Errors
    /// [`Error::TooLarge`] where 32 bits cannot name the points; [`Error::OutOfMemory`] where they cannot be held.
    ///
    /// ```
    /// use cellfan::{columns::{Lattice, Volume}, io::StructuredMesh};
    /// let lattice = Lattice::new([1.0, 0.0, 0.0].into(), [0.5, 1.0, 2.0].into());
    /// let mesh = StructuredMesh::from_volume(Volume::new([3, 2, 2], lattice, Vec::new())?)?;
    /// assert_eq!(mesh.points().get(11).to_array(), [2.0, 1.0, 2.0]);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn from_volume(volume: Volume) -> Result<Self> {
        from_volume(volume, Use::Whole)
    }
}

pub(super) fn from_volume(volume: Volume, used: Use) -> Result<StructuredMesh> {
    let limit = u64::from(u32::MAX) - 1;
    let len = volume.points() as u64;
    if len > limit {
        return Err(Error::TooLarge { column: "points", len, limit });
    }
    let bytes = len * if used == Use::Whole { WHOLE_BYTES } else { TETRAHEDRA_BYTES };
    memory::check(|| format!("a volume of {len} points, drawn as cells with corners,"), Some(bytes))?;
    StructuredMesh::new(&[volume.dims], points(&volume), volume.arrays)
}

/// All points, i fastest.
fn points(volume: &Volume) -> Points {
    let Volume { dims: [ni, nj, nk], lattice, .. } = volume;
    let row = |row: usize| (row % nj, row / nj);
    let world = |i: usize, (j, k): (usize, usize)| lattice.world(DVec3::new(i as f64, j as f64, k as f64));
    let is_narrow = |point: DVec3| point.as_vec3().as_dvec3() == point;
    // The axes meet in point 0; where all of them fit and no axis is slanted, so does every sum.
    let axes = (0..*ni).map(|i| world(i, (0, 0)));
    let axes = axes.chain((0..*nj).map(|j| world(0, (j, 0)))).chain((0..*nk).map(|k| world(0, (0, k))));
    let steps = lattice.steps();
    let is_straight = [steps.x_axis, steps.y_axis, steps.z_axis]
        .iter()
        .all(|step| step.to_array().iter().filter(|&&along| along != 0.0).count() <= 1);
    let rows = 0..nj * nk;
    if is_straight && { axes }.all(is_narrow) {
        Points::F32(rows.flat_map(|r| (0..*ni).map(move |i| world(i, row(r)).as_vec3().to_array())).collect())
    } else {
        Points::F64(rows.flat_map(|r| (0..*ni).map(move |i| world(i, row(r)).to_array())).collect())
    }
}

/// A volume out of a file, at `place` in it: its lattice can be inverted, and every point has a position.
pub(super) fn of_file(
    dims: [usize; 3],
    lattice: Lattice,
    arrays: Vec<Array>,
    place: &str,
    source: Source<'_>,
) -> Result<Volume> {
    check(dims, &lattice).map_err(|problem| source.malformed(place, problem))?;
    Volume::new(dims, lattice, arrays).map_err(|error| error.in_file(source.path))
}

/// A volume without arrays has points that the file does not hold: they count as if it did, compressed. The error is a sentence about it.
pub(super) fn check_bare(points: usize, arrays: &[Array], expansion: &Expansion) -> Result<(), String> {
    let bytes = if arrays.is_empty() { (size_of::<[f32; 3]>() as u64).saturating_mul(points as u64) } else { 0 };
    expansion.take(bytes)
}

/// The volume, which says when the file changes whose bytes its arrays use in place, if they do.
pub(super) fn watched(volume: Volume, mapped: Option<&Mapped>) -> Volume {
    let is_shared = volume.arrays.iter().any(|array| !array.values.is_empty() && array.values.owned_bytes() == 0);
    let backing = mapped.filter(|_| is_shared).map(|mapped| Arc::clone(mapped.backing()));
    Volume { backing, ..volume }
}

/// The error is a sentence about the grid.
fn check(dims: [usize; 3], lattice: &Lattice) -> Result<(), String> {
    if dims.contains(&0) {
        return Err(format!("{dims:?} points along the axes: the grid has none"));
    }
    if points_of(dims).is_none_or(|points| isize::try_from(points).is_err()) {
        return Err(format!("{dims:?} points cannot be: damaged"));
    }
    let last = DVec3::from(dims.map(|along| (along - 1) as f64));
    if !lattice.is_finite() || !lattice.world(last).is_finite() {
        return Err("origin, spacing or direction is not finite (NaN or infinite)".to_owned());
    }
    let steps = lattice.steps();
    let has_sides = dims.iter().all(|&along| along > 1);
    let lengths = steps.x_axis.length() * steps.y_axis.length() * steps.z_axis.length();
    // Rounding leaves steps in one plane a little volume.
    if has_sides && (lattice.volume_of_cell() <= 1e-12 * lengths || !lattice.grid_from_world().is_finite()) {
        return Err(format!(
            "the steps from point to point, {} {} {}, lie in one plane: the cells have no volume; \
             give spacing and directions that span space",
            steps.x_axis, steps.y_axis, steps.z_axis
        ));
    }
    Ok(())
}

impl From<Volume> for Mesh {
    fn from(volume: Volume) -> Self {
        Self::Volume(volume)
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "points are computed exactly or compared as they are stored")]
mod tests {
    use glam::DMat3;

    use super::*;

    #[test]
    fn points_are_single_where_nothing_is_lost() {
        let of = |lattice| StructuredMesh::from_volume(Volume::new([3, 2, 4], lattice, Vec::new()).unwrap()).unwrap();
        let straight = of(Lattice::new(DVec3::new(0.5, -1.0, 0.0), DVec3::new(0.25, 1.0, 3.0)));
        assert!(matches!(straight.points(), Points::F32(points) if points[23] == [1.0, 0.0, 9.0]));
        let fine = of(Lattice::new(DVec3::ZERO, DVec3::splat(0.1)));
        assert!(matches!(fine.points(), Points::F64(points) if points[1] == [0.1, 0.0, 0.0]));
        let sheared = Lattice::sheared(DVec3::X, DMat3::from_cols(DVec3::X, DVec3::new(0.5, 1.0, 0.0), DVec3::Z));
        assert_eq!(of(sheared).points().get(23), DVec3::new(3.5, 1.0, 3.0));
    }

    #[test]
    fn what_memory_or_numbers_cannot_hold_is_refused() {
        let volume = |along| Volume::new([along; 3], Lattice::default(), Vec::new()).unwrap();
        assert!(matches!(StructuredMesh::from_volume(volume(1 << 11)), Err(Error::TooLarge { .. })));
        assert!(matches!(StructuredMesh::from_volume(volume(1600)), Err(Error::OutOfMemory { .. })));
    }

    #[test]
    fn lattices_that_cannot_be_inverted_are_refused() {
        let spaced = |spacing: [f64; 3]| check([2, 2, 2], &Lattice::new(DVec3::ZERO, spacing.into()));
        assert!(spaced([1.0, 1.0, 1e-9]).is_ok() && spaced([-1.0, 1.0, 1e9]).is_ok());
        assert!(spaced([1.0, 0.0, 1.0]).unwrap_err().contains("one plane"));
        for bad in [f64::NAN, f64::INFINITY, 1.7e308] {
            assert!(check([3, 2, 2], &Lattice::new(DVec3::ZERO, DVec3::splat(bad))).unwrap_err().contains("finite"));
        }
        assert!(check([2, 1, 2], &Lattice::new(DVec3::ZERO, DVec3::new(1.0, 0.0, 1.0))).is_ok());
        assert!(check([0, 1, 2], &Lattice::default()).unwrap_err().contains("none"));
        assert!(check([usize::MAX, 2, 2], &Lattice::default()).unwrap_err().contains("cannot be"));
    }
}
