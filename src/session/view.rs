//! `MeshView`: a simulation's own slices, as a mesh.

use crate::cells::CellKind;
use crate::columns::{Association, Column, Positions};
use crate::error::{Error, Result};

/// A mesh in the slices of another program; nothing is copied by making one, and nothing checked. A session may borrow points and cells for
/// `'a`, and scalars, for `'s`, only while it is made.
///
/// | layout | what [`Session::new`](super::Session::new) copies, for as long as the session lives |
/// | --- | --- |
/// | positions in `f32`, x, y, z together, not far from the origin | nothing |
/// | positions an axis a slice, in `f64`, or farther from the origin than four times their extent | 12 bytes a point |
/// | all cells tetrahedra or all hexahedra, numbers of points in `u32` or `i32` | nothing |
/// | the same in `u64` or `i64` | 16 or 32 bytes a cell |
/// | cells of several kinds (offsets and VTK's codes) | 20 bytes a tetrahedron, 36 any other cell, positions |
/// | structured: nothing says which points a cell has | nothing |
/// | scalars of any type | 4 bytes a value |
///
/// ```
/// use cellfan::session::{Cells, Indices, MeshView, Scalars};
/// use cellfan::{Positions, columns::Association, cells::TETRAHEDRON};
/// let (xyz, corners, pressure) = ([0.0_f32; 12], [0_u32, 1, 2, 3], [1.5_f64]);
/// let cells = Cells::OfKind { kind: &TETRAHEDRON, points: Indices::U32(&corners) };
/// let mesh = MeshView::new(Positions::interleaved_f32(&xyz)?, cells).with_scalars(Association::Cell, Scalars::F64(&pressure));
/// assert_eq!(mesh.cells.len(), 1);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct MeshView<'a, 's> {
    /// Where the points are.
    pub positions: Positions<'a>,
    /// Which of them are the corners of each cell.
    pub cells: Cells<'a>,
    /// What is drawn; nothing draws the mesh homogeneous.
    pub scalars: Option<(Association, Scalars<'s>)>,
}

impl<'a> MeshView<'a, '_> {
    /// Cells between points.
    pub fn new(positions: Positions<'a>, cells: Cells<'a>) -> Self {
        Self { positions, cells, scalars: None }
    }

    /// With a scalar for each point or each cell.
    #[must_use]
    pub fn with_scalars<'s>(self, association: Association, scalars: Scalars<'s>) -> MeshView<'a, 's> {
        MeshView { positions: self.positions, cells: self.cells, scalars: Some((association, scalars)) }
    }
}

/// The cells of a mesh.
#[derive(Clone, Copy, Debug)]
pub enum Cells<'a> {
    /// All of one kind, of [`KINDS`](crate::cells::KINDS).
    OfKind {
        /// The kind.
        kind: &'static CellKind,
        /// The points of one cell after the other, in VTK's order, from 0.
        points: Indices<'a>,
    },
    /// Of several kinds, as in VTK's unstructured grids.
    Mixed {
        /// VTK's code of each cell.
        types: &'a [u8],
        /// Where in `points` each cell begins, and the end: one entry more than there are cells.
        offsets: Indices<'a>,
        /// The points of one cell after the other, from 0.
        points: Indices<'a>,
    },
    /// Between points in rows, columns and layers, as many along i, j and k: i fastest.
    Structured {
        /// Points along i, j and k, two at least.
        dims: [usize; 3],
    },
}

impl Cells<'_> {
    /// How many cells there are.
    pub fn len(&self) -> usize {
        match self {
            Self::OfKind { kind, points } => points.len() / kind.corners,
            Self::Mixed { types, .. } => types.len(),
            Self::Structured { dims } => dims.iter().map(|points| points.saturating_sub(1)).product(),
        }
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

macro_rules! slices {
    ($(#[$doc:meta])* $name:ident, $($variant:ident $type:ty),*) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub enum $name<'a> {
            $(#[doc = concat!("`", stringify!($type), "` values.")] $variant(&'a [$type])),*
        }

        impl $name<'_> {
            /// How many values there are.
            pub fn len(&self) -> usize {
                match self { $(Self::$variant(values) => values.len()),* }
            }

            /// Whether there is none.
            pub fn is_empty(&self) -> bool {
                self.len() == 0
            }
        }

        $(impl<'a> From<&'a [$type]> for $name<'a> {
            fn from(values: &'a [$type]) -> Self {
                Self::$variant(values)
            }
        })*
    };
}

slices!(
    /// Numbers of points or places, of any type that solvers use.
    Indices, U32 u32, I32 i32, U64 u64, I64 i64
);
slices!(
    /// Scalars of any numeric type.
    Scalars, I8 i8, U8 u8, I16 i16, U16 u16, I32 i32, U32 u32, I64 i64, U64 u64, F32 f32, F64 f64
);

impl<'a> Indices<'a> {
    /// The numbers in place, where they are 32 bits wide: a negative one is larger than any point.
    pub(super) fn in_place(self) -> Option<&'a [u32]> {
        match self {
            Self::U32(values) => Some(values),
            Self::I32(values) => Some(bytemuck::cast_slice(values)),
            Self::U64(_) | Self::I64(_) => None,
        }
    }

    /// Number `i`; `None` where it is negative.
    pub(super) fn get(self, i: usize) -> Option<u64> {
        match self {
            Self::U32(values) => Some(values[i].into()),
            Self::I32(values) => values[i].try_into().ok(),
            Self::U64(values) => Some(values[i]),
            Self::I64(values) => values[i].try_into().ok(),
        }
    }

    /// Number `i` as a person would read it.
    fn shown(self, i: usize) -> i64 {
        match self {
            Self::U32(values) => values[i].into(),
            Self::I32(values) => values[i].into(),
            Self::U64(values) => values[i].try_into().unwrap_or(i64::MAX),
            Self::I64(values) => values[i],
        }
    }

    /// Entry `i` in 32 bits, which has to be below `points`, the number of points.
    fn narrow(self, i: usize, points: usize, cell_of: impl Fn(usize) -> usize) -> Result<u32> {
        let index = self.get(i).filter(|&index| index < points as u64);
        index.map(|index| index as u32).ok_or_else(|| Error::IndexOutOfRange {
            column: "connectivity",
            cell: cell_of(i) as u64,
            index: self.shown(i),
            len: points as u64,
        })
    }

    /// A copy in 32 bits.
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`] with the cell that `cell_of` says the entry belongs to.
    pub(super) fn narrowed(self, points: usize, cell_of: impl Fn(usize) -> usize) -> Result<Vec<u32>> {
        (0..self.len()).map(|i| self.narrow(i, points, &cell_of)).collect()
    }

    /// The same of cells of `N` points each.
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`].
    pub(super) fn narrowed_rows<const N: usize>(self, points: usize) -> Result<Column<[u32; N]>> {
        let mut rows = vec![[0; N]; self.len() / N];
        for (i, corner) in rows.as_flattened_mut().iter_mut().enumerate() {
            *corner = self.narrow(i, points, |i| i / N)?;
        }
        Ok(rows.into())
    }
}
