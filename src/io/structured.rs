//! `StructuredMesh`: blocks of points in rows, columns and layers. The corners of a cell follow from its number.

use super::assemble::{GHOST_TYPE, check_lengths};
use super::concat;
use super::scratch::Scratch;
use crate::columns::{Array, Association, Points};
use crate::error::{Error, Result};

/// Structured grids: the points of all blocks one after the other, in each i fastest, then j, then k. No connectivity is stored.
///
/// ```
/// # use cellfan::{columns::Points, io::StructuredMesh};
/// let points: Vec<[f32; 3]> = (0..12).map(|i| [i % 3, i / 3 % 2, i / 6].map(|c| c as f32)).collect();
/// let mesh = StructuredMesh::new(&[[3, 2, 2]], Points::F32(points), Vec::new())?;
/// assert_eq!(mesh.blocks()[0].corners(1), [1, 2, 5, 4, 7, 8, 11, 10]);
/// assert_eq!(mesh.into_tets()?.tets.len(), 12);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct StructuredMesh {
    blocks: Vec<StructuredBlock>,
    points: Points,
    arrays: Vec<Array>,
}

impl StructuredMesh {
    /// Blocks of `dims` points each, with arrays over all their points and cells.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] where points or arrays are not as many as the blocks have; [`Error::TooLarge`].
    pub fn new(dims: &[[usize; 3]], points: Points, arrays: Vec<Array>) -> Result<Self> {
        let (mut blocks, mut first_point, mut first_cell) = (Vec::with_capacity(dims.len()), 0, 0);
        for &dims in dims {
            let limit = u64::from(u32::MAX) - 1;
            let too_large = |len| Error::TooLarge { column: "points", len, limit };
            let block_points = points_of(dims).ok_or_else(|| too_large(u64::MAX))?;
            let block = StructuredBlock { dims, first_point, first_cell };
            // A block has at least as many points as cells.
            first_point = first_point.saturating_add(block_points);
            first_cell += block.cells();
            blocks.push(block);
            if first_point as u64 > limit {
                return Err(too_large(first_point as u64));
            }
        }
        if points.len() != first_point {
            let (len, expected) = (points.len() as u64, first_point as u64);
            return Err(Error::LengthMismatch { column: "points".to_owned(), len, expected });
        }
        check_lengths(&arrays, first_point as u64, first_cell as u64)?;
        Ok(Self { blocks, points, arrays })
    }

    /// The blocks, in the order of their points and cells.
    pub fn blocks(&self) -> &[StructuredBlock] {
        &self.blocks
    }

    /// All points.
    pub fn points(&self) -> &Points {
        &self.points
    }

    /// Arrays over the points and cells of all blocks.
    pub fn arrays(&self) -> &[Array] {
        &self.arrays
    }

    /// How many cells there are, of any dimension.
    pub fn cells(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.first_cell + block.cells())
    }

    /// Sets `bits` of `vtkGhostType` for some cells; the array is added where there is none.
    pub(super) fn mark(&mut self, bits: u8, cells: &[usize]) {
        let is_types =
            |array: &Array| array.name == GHOST_TYPE && array.association == Association::Cell && array.components == 1;
        let at = self.arrays.iter().position(is_types);
        let found = at.map(|at| self.arrays.remove(at).values);
        let mut types: Vec<u8> =
            found.map_or(vec![0; self.cells()], |found| (0..found.len()).map(|i| found.get(i) as u8).collect());
        for &cell in cells {
            types[cell] |= bits;
        }
        let (name, association) = (GHOST_TYPE.to_owned(), Association::Cell);
        self.arrays.push(Array { name, association, components: 1, values: types.into() });
    }

    /// Points and arrays.
    pub(super) fn into_columns(self) -> (Points, Vec<Array>) {
        (self.points, self.arrays)
    }

    /// The blocks of all pieces, in order; arrays that not all pieces have are left out, pieces without points too.
    ///
    /// # Errors
    /// [`Error::TooLarge`], and those of the scratch.
    pub(super) fn concat(mut pieces: Vec<Self>, scratch: &Scratch) -> Result<Self> {
        pieces.retain(|piece| !piece.points.is_empty());
        if pieces.len() == 1 {
            return Ok(pieces.swap_remove(0));
        }
        let arrays = concat::arrays(&pieces.iter().map(|piece| &piece.arrays[..]).collect::<Vec<_>>(), scratch)?;
        Self::concat_with(&pieces, arrays)
    }

    /// The blocks of all pieces, in order, with `arrays` over all their points and cells.
    ///
    /// # Errors
    /// Those of [`StructuredMesh::new`].
    pub(super) fn concat_with(pieces: &[Self], arrays: Vec<Array>) -> Result<Self> {
        let dims: Vec<[usize; 3]> = pieces.iter().flat_map(|piece| &piece.blocks).map(|block| block.dims).collect();
        let points = concat::points(&pieces.iter().map(|piece| &piece.points).collect::<Vec<_>>());
        Self::new(&dims, points, arrays)
    }
}

/// One block: its size, and where its points and cells stand among those of its mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StructuredBlock {
    dims: [usize; 3],
    first_point: usize,
    first_cell: usize,
}

impl StructuredBlock {
    /// Points along i, j and k.
    pub fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// The mesh's number of the block's first point.
    pub fn first_point(&self) -> usize {
        self.first_point
    }

    /// The mesh's number of the block's first cell.
    pub fn first_cell(&self) -> usize {
        self.first_cell
    }

    /// How many points the block has.
    pub fn points(&self) -> usize {
        self.dims.iter().product()
    }

    /// How many cells the block has: hexahedra, or what is left of them where it is one point thick.
    pub fn cells(&self) -> usize {
        cells_of(self.dims)
    }

    /// VTK's code of the block's cells: hexahedra (12), quadrilaterals (9), lines (3) or a vertex (1).
    pub fn code(&self) -> u8 {
        [1, 3, 9, 12][self.dims.iter().filter(|&&points| points > 1).count()]
    }

    /// Whether the block's cells are hexahedra.
    pub fn has_volume(&self) -> bool {
        self.dims.iter().all(|&points| points > 1)
    }

    /// The mesh's points at the corners of the block's hexahedron `cell`, in VTK's order.
    ///
    /// # Panics
    /// May panic if the block has no volume or no such cell.
    #[inline]
    pub fn corners(&self, cell: usize) -> [u32; 8] {
        let [ni, nj, _] = self.dims;
        let (row, i) = (cell / (ni - 1), cell % (ni - 1));
        let (k, j) = (row / (nj - 1), row % (nj - 1));
        let (row_step, layer_step) = (ni as u32, (ni * nj) as u32);
        let corner = (self.first_point + i + ni * (j + nj * k)) as u32;
        let around = [corner, corner + 1, corner + 1 + row_step, corner + row_step];
        let [a, b, c, d] = around;
        let [e, f, g, h] = around.map(|point| point + layer_step);
        [a, b, c, d, e, f, g, h]
    }
}

/// How many points `dims` make, where the number exists.
pub(super) fn points_of(dims: [usize; 3]) -> Option<usize> {
    if dims.contains(&0) { Some(0) } else { dims.iter().try_fold(1_usize, |points, &along| points.checked_mul(along)) }
}

/// How many cells `dims` points make; an axis of one point does not count.
///
/// The number of points must exist.
pub(super) fn cells_of(dims: [usize; 3]) -> usize {
    if dims.contains(&0) { 0 } else { dims.iter().map(|&points| (points - 1).max(1)).product() }
}
