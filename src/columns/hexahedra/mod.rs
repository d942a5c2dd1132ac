//! `Hexahedra`: cells with up to six faces of four corners, listed, or implied by structured blocks.
//!
//! Wedges and pyramids are hexahedra some of whose corners coincide. What no view changes is found once, in [`HexShape`].

mod shape;
mod structured;

pub use shape::HexShape;
pub use structured::StructuredBlock;

use super::Column;
use crate::error::{Error, Result};

/// Eight corners a cell, in VTK's order, positively oriented.
///
/// As in [`Tets`](super::Tets), a number from a container beyond the last vertex reads as the last, and a shape that is not the
/// cell's gives a wrong picture of it: neither is checked cell by cell.
#[derive(Clone, Debug)]
pub struct Hexahedra {
    corners: HexCorners,
    shapes: Column<HexShape>,
    absent: usize,
    last_vertex: u32,
}

/// Where the corners of hexahedra stand.
#[derive(Clone, Debug)]
pub(crate) enum HexCorners {
    /// Cell by cell.
    Listed(Column<[u32; 8]>),
    /// In the order of the points of structured blocks, without a number stored.
    Structured(Vec<StructuredBlock>),
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
        Self { corners, shapes, absent, last_vertex: u32::MAX }
    }

    /// Cells as a container holds them, of which `absent` are not drawn: what can be checked without reading through a column
    /// that may be larger than memory is checked.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] where the columns do not fit each other or the vertices; [`Error::TooLarge`].
    pub(crate) fn in_file(
        corners: HexCorners,
        shapes: Column<HexShape>,
        absent: usize,
        vertices: usize,
    ) -> Result<Self> {
        let cells = shapes.len();
        let mismatch = |column: &str, len: usize, expected: usize| {
            Err(Error::LengthMismatch { column: column.to_owned(), len: len as u64, expected: expected as u64 })
        };
        match &corners {
            HexCorners::Listed(corners) if corners.len() != cells => return mismatch("corners", corners.len(), cells),
            HexCorners::Listed(_) => {}
            HexCorners::Structured(blocks) => {
                let dims = blocks.iter().map(|block| block.dims.map(|points| points as usize));
                let sequence = StructuredBlock::sequence(dims, vertices, cells)?;
                let in_sequence = sequence.iter().zip(blocks).take_while(|(expected, block)| expected == block).count();
                if in_sequence < blocks.len() {
                    return mismatch("blocks that follow each other", in_sequence, blocks.len());
                }
            }
        }
        if absent > cells || vertices == 0 {
            return mismatch("cells", cells, absent);
        }
        Ok(Self { corners, shapes, absent, last_vertex: (vertices - 1) as u32 })
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

    /// All cells as slices, for repeated access.
    pub fn view(&self) -> HexahedraView<'_> {
        let (listed, blocks) = (self.listed_corners(), self.structured_blocks());
        HexahedraView { listed, blocks, shapes: &self.shapes, first: 0, last_vertex: self.last_vertex }
    }

    /// The corners of cells that are listed, as they stand in the column: not turned, not checked; none of structured blocks.
    pub(crate) fn listed_corners(&self) -> &[[u32; 8]] {
        match &self.corners {
            HexCorners::Listed(corners) => corners,
            HexCorners::Structured(_) => &[],
        }
    }

    /// The structured blocks that imply the cells, by their first cells; none where these are listed.
    pub fn structured_blocks(&self) -> &[StructuredBlock] {
        match &self.corners {
            HexCorners::Listed(_) => &[],
            HexCorners::Structured(blocks) => blocks,
        }
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
    last_vertex: u32,
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
            let mut corners = self.listed[cell];
            for vertex in &mut corners {
                *vertex = (*vertex).min(self.last_vertex);
            }
            corners
        } else {
            let block = match self.blocks {
                [block] => block,
                blocks => &blocks[blocks.partition_point(|block| block.first_cell as usize <= cell) - 1],
            };
            block.corners(cell as u32 - block.first_cell)
        };
        if is_mirrored { HexShape::mirrored(corners) } else { corners }
    }
}
