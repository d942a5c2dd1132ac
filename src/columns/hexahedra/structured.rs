//! `StructuredBlock`: cells whose corners follow from their number.

use bytemuck::{Pod, Zeroable};

use crate::error::{Error, Result};

/// A block of `dims` points, i fastest, and of one cell less each way.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct StructuredBlock {
    /// Points along i, j and k, two at least.
    pub dims: [u32; 3],
    /// The vertex of its first point.
    pub first_vertex: u32,
    /// The number of its first cell among the hexahedra.
    pub first_cell: u32,
}

impl StructuredBlock {
    /// How many cells it has.
    pub fn cells(&self) -> u64 {
        self.dims.iter().map(|&points| u64::from(points) - 1).product()
    }

    /// The corners of its cell `cell`.
    #[inline]
    pub(crate) fn corners(&self, cell: u32) -> [u32; 8] {
        let [points_i, points_j, _] = self.dims;
        let (row, i) = (cell / (points_i - 1), cell % (points_i - 1));
        let (k, j) = (row / (points_j - 1), row % (points_j - 1));
        let layer = points_i * points_j;
        let first = self.first_vertex + i + points_i * j + layer * k;
        let [a, b] = [first, first + layer];
        [a, a + 1, a + 1 + points_i, a + points_i, b, b + 1, b + 1 + points_i, b + points_i]
    }

    /// The cells of the block across the faces of its cell `cell`, numbered like it, in the order of the faces of
    /// [`HEXAHEDRON`](crate::cells::HEXAHEDRON); none at a side of the block.
    #[inline]
    pub fn across(&self, cell: u32) -> [Option<u32>; 6] {
        let cells = self.dims.map(|points| points - 1);
        let (row, i) = (cell / cells[0], cell % cells[0]);
        let at = [i, row % cells[1], row / cells[1]];
        let step = [1, cells[0], cells[0] * cells[1]];
        std::array::from_fn(|face| {
            let axis = face / 2;
            if face % 2 == 0 {
                (at[axis] > 0).then(|| cell - step[axis])
            } else {
                (at[axis] + 1 < cells[axis]).then(|| cell + step[axis])
            }
        })
    }

    /// Blocks of `dims` points each, one after the other, that together have so many points and cells.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] where they have not, or a side has fewer than two points; [`Error::TooLarge`].
    pub(crate) fn sequence(
        dims: impl IntoIterator<Item = [usize; 3]>,
        points: usize,
        cells: usize,
    ) -> Result<Vec<Self>> {
        let limit = u64::from(u32::MAX) - 1;
        let (mut blocks, mut first_vertex, mut first_cell) = (Vec::new(), 0_u64, 0_u64);
        for dims in dims {
            let of_block = dims.iter().try_fold(1_u64, |product, &points| product.checked_mul(points as u64));
            let end = of_block.and_then(|points| first_vertex.checked_add(points)).filter(|&end| end <= limit);
            let Some(end) = end else { return Err(Error::TooLarge { column: "points", len: u64::MAX, limit }) };
            if let Some(flat) = dims.into_iter().find(|&points| points < 2) {
                let column = "points along a block's side".to_owned();
                return Err(Error::LengthMismatch { column, len: flat as u64, expected: 2 });
            }
            let dims = dims.map(|points| points as u32);
            let block = Self { dims, first_vertex: first_vertex as u32, first_cell: first_cell as u32 };
            first_cell += block.cells();
            first_vertex = end;
            blocks.push(block);
        }
        for (column, len, expected) in [("points", points, first_vertex), ("cells", cells, first_cell)] {
            if len as u64 != expected {
                return Err(Error::LengthMismatch { column: column.to_owned(), len: len as u64, expected });
            }
        }
        Ok(blocks)
    }
}
