//! `Positions`: point coordinates as another program holds them.

use glam::{DVec3, Vec3};

use super::Points;
use crate::error::{Error, Result};

/// Borrowed point coordinates: x, y, z of a point together, or a slice an axis; in single or double precision.
///
/// ```
/// # use cellfan::columns::Positions;
/// let interleaved = Positions::interleaved_f32(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0])?;
/// let (x, y, z) = ([0.0, 3.0], [1.0, 4.0], [2.0, 5.0]);
/// let axes = Positions::AxesF64([&x, &y, &z]);
/// assert_eq!((interleaved.len(), interleaved.get(1)), (2, axes.get(1)));
/// assert!(Positions::interleaved_f32(&[0.0; 4]).is_err());
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub enum Positions<'a> {
    /// Points in single precision: the one layout that is drawn in place.
    F32(&'a [[f32; 3]]),
    /// Points in double precision; re-centred before they are narrowed.
    F64(&'a [[f64; 3]]),
    /// Each axis by itself, in single precision.
    AxesF32([&'a [f32]; 3]),
    /// Each axis by itself, in double precision.
    AxesF64([&'a [f64]; 3]),
}

impl<'a> Positions<'a> {
    /// Coordinates x, y, z of one point after the other.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] where they are not three a point.
    pub fn interleaved_f32(coordinates: &'a [f32]) -> Result<Self> {
        whole_points(coordinates).map(Self::F32)
    }

    /// The same in double precision.
    ///
    /// # Errors
    /// Those of [`Positions::interleaved_f32`].
    pub fn interleaved_f64(coordinates: &'a [f64]) -> Result<Self> {
        whole_points(coordinates).map(Self::F64)
    }

    /// How many points there are; of axes, as many as the shortest has.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(points) => points.len(),
            Self::F64(points) => points.len(),
            Self::AxesF32(axes) => axes.iter().map(|axis| axis.len()).min().unwrap_or(0),
            Self::AxesF64(axes) => axes.iter().map(|axis| axis.len()).min().unwrap_or(0),
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
            Self::AxesF32(axes) => DVec3::from_array(axes.map(|axis| f64::from(axis[i]))),
            Self::AxesF64(axes) => DVec3::from_array(axes.map(|axis| axis[i])),
        }
    }

    /// Whether they are in single precision.
    pub(crate) fn is_single(&self) -> bool {
        matches!(self, Self::F32(_) | Self::AxesF32(_))
    }

    /// Every axis has as many coordinates as the first.
    pub(crate) fn check(&self) -> Result<()> {
        let lens = match self {
            Self::F32(_) | Self::F64(_) => return Ok(()),
            Self::AxesF32(axes) => axes.map(<[f32]>::len),
            Self::AxesF64(axes) => axes.map(<[f64]>::len),
        };
        match lens.iter().zip(["x", "y", "z"]).find(|(len, _)| **len != lens[0]) {
            Some((&len, axis)) => {
                let column = format!("{axis} coordinates");
                Err(Error::LengthMismatch { column, len: len as u64, expected: lens[0] as u64 })
            }
            None => Ok(()),
        }
    }

    /// A copy.
    pub(crate) fn to_points(self) -> Points {
        let all = 0..self.len();
        match self {
            Self::F32(points) => Points::F32(points.to_vec()),
            Self::F64(points) => Points::F64(points.to_vec()),
            Self::AxesF32(axes) => Points::F32(all.map(|i| axes.map(|axis| axis[i])).collect()),
            Self::AxesF64(axes) => Points::F64(all.map(|i| axes.map(|axis| axis[i])).collect()),
        }
    }
}

impl<'a> From<&'a Points> for Positions<'a> {
    fn from(points: &'a Points) -> Self {
        match points {
            Points::F32(points) => Self::F32(points),
            Points::F64(points) => Self::F64(points),
        }
    }
}

fn whole_points<T>(coordinates: &[T]) -> Result<&[[T; 3]]> {
    let (points, rest) = coordinates.as_chunks();
    if rest.is_empty() {
        return Ok(points);
    }
    let (len, expected) = (coordinates.len() as u64, points.len() as u64 * 3 + 3);
    Err(Error::LengthMismatch { column: "coordinates".to_owned(), len, expected })
}
