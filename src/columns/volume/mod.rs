//! `Volume`: a regular grid, whose points follow from three numbers and a matrix.
//!
//! Nothing of the geometry is stored, and arrays may be those of a mapped file, in place and of any numeric type.

mod cubes;
mod field;
mod lattice;

use std::array;
use std::sync::Arc;

use glam::DVec3;

pub use cubes::{Cube, CubeCorners, CubeGrid, CubeSlopes, GridEye};
pub use field::{SampleVisitor, Samples, VolumeField};
pub use lattice::Lattice;

use super::build::check_arrays;
use super::{Array, Backing};
use crate::error::{Error, Result};

/// Samples on a regular grid: arrays over its points (i fastest, then j, then k) and over the cells between them.
///
/// ```
/// use cellfan::columns::{Array, Association, Lattice, Volume};
/// let values: Vec<u8> = (0..12).collect();
/// let array = Array { name: "density".into(), association: Association::Point, components: 1, values: values.into() };
/// let volume = Volume::new([3, 2, 2], Lattice::default(), vec![array])?;
/// assert_eq!((volume.points(), volume.cells()), (12, 2));
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Volume {
    /// Points along i, j and k; all at least 1.
    pub dims: [usize; 3],
    /// Where the points are.
    pub lattice: Lattice,
    /// Arrays over points and cells.
    pub arrays: Vec<Array>,
    /// The file whose bytes are used in place, if there is one.
    pub backing: Option<Arc<Backing>>,
}

impl Volume {
    /// A grid of `dims` points with arrays over all its points and cells.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] where an array is not as long as the grid has points or cells, or a side has no point;
    /// [`Error::TooLarge`] where memory cannot number the points.
    pub fn new(dims: [usize; 3], lattice: Lattice, arrays: Vec<Array>) -> Result<Self> {
        let too_large = || Error::TooLarge { column: "points", len: u64::MAX, limit: isize::MAX as u64 };
        let points = dims.iter().try_fold(1_usize, |product, &along| product.checked_mul(along));
        let points = points.filter(|&points| isize::try_from(points).is_ok()).ok_or_else(too_large)?;
        if points == 0 {
            return Err(Error::LengthMismatch { column: "points along a side".to_owned(), len: 0, expected: 1 });
        }
        let volume = Self { dims, lattice, arrays: Vec::new(), backing: None };
        check_arrays(points as u64, &arrays, volume.cells() as u64)?;
        Ok(Self { arrays, ..volume })
    }

    /// How many points there are.
    pub fn points(&self) -> usize {
        self.dims.iter().product()
    }

    /// How many cells there are: cubes, or what is left of them where a side is one point thick.
    pub fn cells(&self) -> usize {
        self.cell_dims().iter().product()
    }

    /// Cells along i, j and k; an axis of one point does not count.
    pub fn cell_dims(&self) -> [usize; 3] {
        self.dims.map(|points| (points - 1).max(1))
    }

    /// VTK's code of the cells: voxels (11), pixels (8), lines (3) or a vertex (1).
    pub fn code(&self) -> u8 {
        [1, 3, 8, 11][self.dims.iter().filter(|&&points| points > 1).count()]
    }

    /// The eight corners of the box around all points.
    pub fn corners_world(&self) -> [DVec3; 8] {
        let last = self.dims.map(|points| (points - 1) as f64);
        let along = |corner: usize, axis: usize| if corner >> axis & 1 == 1 { last[axis] } else { 0.0 };
        array::from_fn(|corner| self.lattice.world(DVec3::from([0, 1, 2].map(|axis| along(corner, axis)))))
    }

    /// Whether the cells have a volume.
    pub fn has_volume(&self) -> bool {
        self.dims.iter().all(|&points| points > 1) && self.lattice.volume_of_cell() > 0.0
    }

    /// Bytes of memory that the arrays take; none where they are used in place.
    pub fn owned_bytes(&self) -> u64 {
        self.arrays.iter().map(|array| array.values.owned_bytes()).sum()
    }
}
