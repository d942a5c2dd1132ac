//! `Hexahedra`: cells with up to six faces of four corners, listed, or implied by structured blocks.
//!
//! Wedges and pyramids are hexahedra some of whose corners coincide. What no view changes is found once, in [`HexShape`].

mod shape;

pub use shape::HexShape;

use super::Column;

/// Eight corners a cell, in VTK's order, positively oriented.
#[derive(Clone, Debug)]
pub struct Hexahedra {
    corners: HexCorners,
    shapes: Column<HexShape>,
    absent: usize,
}

/// Where the corners of hexahedra stand.
#[derive(Clone, Debug)]
pub(super) enum HexCorners {
    /// Cell by cell.
    Listed(Column<[u32; 8]>),
    /// In the order of the points of structured blocks, without a number stored.
    Structured(Vec<StructuredBlock>),
}

/// A block of `dims` points, i fastest, and of one cell less each way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    fn corners(&self, cell: u32) -> [u32; 8] {
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
}

impl Hexahedra {
    /// Cells whose corners are listed.
    pub(super) fn listed(corners: Column<[u32; 8]>, shapes: Column<HexShape>) -> Self {
        Self::new(HexCorners::Listed(corners), shapes)
    }

    /// The cells of structured blocks.
    pub(super) fn structured(blocks: Vec<StructuredBlock>, shapes: Column<HexShape>) -> Self {
        Self::new(HexCorners::Structured(blocks), shapes)
    }

    fn new(corners: HexCorners, shapes: Column<HexShape>) -> Self {
        let absent = shapes.iter().filter(|shape| shape.is_absent()).count();
        Self { corners, shapes, absent }
    }

    /// No cell.
    pub fn none() -> Self {
        Self::listed(Vec::new().into(), Vec::new().into())
    }

    /// How many cells there are, those included that are not drawn.
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// How many of them are not drawn.
    pub fn absent(&self) -> usize {
        self.absent
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// The structured blocks that imply the cells, by their first cells; none where cells are listed.
    pub fn blocks(&self) -> &[StructuredBlock] {
        match &self.corners {
            HexCorners::Listed(_) => &[],
            HexCorners::Structured(blocks) => blocks,
        }
    }

    /// All cells as slices, for repeated access.
    pub fn view(&self) -> HexahedraView<'_> {
        let listed: &[_] = match &self.corners {
            HexCorners::Listed(corners) => corners,
            HexCorners::Structured(_) => &[],
        };
        HexahedraView { listed, blocks: self.blocks(), shapes: &self.shapes, first: 0 }
    }

    /// Bytes of memory that the cells take; none where they are used in place.
    pub fn owned_bytes(&self) -> u64 {
        let corners = match &self.corners {
            HexCorners::Listed(corners) => corners.owned_bytes(),
            HexCorners::Structured(blocks) => size_of_val(&blocks[..]) as u64,
        };
        corners + self.shapes.owned_bytes()
    }
}

/// [`Hexahedra`], or a run of them, as slices.
#[derive(Clone, Copy, Debug)]
pub struct HexahedraView<'a> {
    /// All cells' corners, where they are listed.
    listed: &'a [[u32; 8]],
    blocks: &'a [StructuredBlock],
    /// Of the cells of the run.
    shapes: &'a [HexShape],
    /// The run's first cell.
    first: usize,
}

impl HexahedraView<'_> {
    /// The run of cells `cells`.
    pub(super) fn run(self, cells: std::ops::Range<usize>) -> Self {
        Self { first: self.first + cells.start, shapes: &self.shapes[cells], ..self }
    }

    /// How many cells there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// The shape of cell `cell`.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub fn shape(&self, cell: usize) -> HexShape {
        self.shapes[cell]
    }

    /// The corners of cell `cell`.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub fn get(&self, cell: usize) -> [u32; 8] {
        let is_mirrored = self.shapes[cell].is_mirrored();
        let cell = self.first + cell;
        let corners = if self.blocks.is_empty() {
            self.listed[cell]
        } else {
            let block = self.blocks.partition_point(|block| block.first_cell as usize <= cell) - 1;
            let block = &self.blocks[block];
            block.corners(cell as u32 - block.first_cell)
        };
        if is_mirrored { HexShape::mirrored(corners) } else { corners }
    }
}
