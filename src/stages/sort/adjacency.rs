//! `adjacency`: which cell lies across each face, and which faces have none: the exterior ones. Once a mesh.
//!
//! In: the cells, and what a container says of them. Out: [`Adjacency`]: the [`Neighbours`] of tetrahedra and of listed hexahedra, from
//! the container or made in parallel; nothing for structured blocks, where they follow from i, j and k; and the exterior faces.

#[cfg(test)]
mod tests;

use rayon::prelude::*;

use crate::columns::{Dataset, HEX_FACES, HexahedraView, Neighbours, StructuredBlock, TET_FACES};
use crate::control::Control;

/// A face of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// The cell.
    pub cell: u32,
    /// Which of its faces: of a tetrahedron the one opposite to this vertex, of a hexahedron in the order of its kind.
    pub index: u32,
}

/// The cells across all faces of a mesh.
#[derive(Clone, Debug)]
pub struct Adjacency {
    neighbours: Neighbours,
    is_stored: bool,
    exterior: Vec<Face>,
}

impl Adjacency {
    /// No cell lies across the face.
    pub const NONE: u32 = Neighbours::NONE;

    /// That of the tetrahedra and hexahedra of `dataset`: its own where it is right, which is looked at face by face, and otherwise made from the cells.
    pub fn new(dataset: &Dataset) -> Self {
        Self::new_while(&Control::default(), dataset)
    }

    /// The same until the end is asked for; then something is missing.
    pub(crate) fn new_while(control: &Control, dataset: &Dataset) -> Self {
        let stored = dataset.adjacency.as_ref().filter(|stored| stored.first_wrong(dataset).is_none());
        let neighbours = stored.cloned().unwrap_or_else(|| Neighbours::new_while(control, dataset));
        if control.is_cancelled() {
            return Self { neighbours, is_stored: false, exterior: Vec::new() };
        }
        let mut adjacency = Self { neighbours, is_stored: stored.is_some(), exterior: Vec::new() };
        let rows = adjacency.rows(dataset);
        let is_absent = |cell: usize| {
            cell.checked_sub(dataset.tets.len()).is_some_and(|cell| dataset.hexahedra.view().shape(cell).is_absent())
        };
        let exterior_of = |cell: usize| {
            let faces = if is_absent(cell) { 0 } else { rows.all_faces(cell) };
            let none = rows.across(cell as u32, faces).filter(|&(_, other)| other == Self::NONE);
            none.map(move |(k, _)| Face { cell: cell as u32, index: k as u32 })
        };
        let cells = dataset.first_polyhedron();
        let of_block = |block: usize| {
            let start = block * Dataset::BLOCK_CELLS;
            let end = if control.is_cancelled() { start } else { (start + Dataset::BLOCK_CELLS).min(cells) };
            (start..end).flat_map(exterior_of)
        };
        let blocks = (0..cells.div_ceil(Dataset::BLOCK_CELLS)).into_par_iter();
        adjacency.exterior = blocks.flat_map_iter(of_block).collect();
        adjacency
    }

    /// The cell across the face opposite to each vertex of each tetrahedron; [`Adjacency::NONE`] where there is none.
    pub fn neighbours_from_tet(&self) -> &[[u32; 4]] {
        &self.neighbours.from_tet
    }

    /// Whether it is the dataset's own, from a container, and was not made.
    pub fn is_stored(&self) -> bool {
        self.is_stored
    }

    /// The cells across the faces of `cell`, a cell of the `dataset` that this is of: four of a tetrahedron, six of a hexahedron;
    /// [`Adjacency::NONE`] where there is none, and where there is no such face.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn neighbours(&self, dataset: &Dataset, cell: u32) -> [u32; 6] {
        self.rows(dataset).row(cell)
    }

    /// The faces without a cell across, by cell.
    pub fn exterior(&self) -> &[Face] {
        &self.exterior
    }

    /// Bytes of memory that it takes; a column that is used in place counts nothing.
    pub fn owned_bytes(&self) -> u64 {
        self.neighbours.owned_bytes() + size_of_val(&self.exterior[..]) as u64
    }

    /// All cells of a mesh of tetrahedra.
    pub(super) fn tet_rows(&self) -> TetRows<'_> {
        TetRows(&self.neighbours.from_tet)
    }

    /// All cells of any mesh.
    pub(super) fn rows<'a>(&'a self, dataset: &'a Dataset) -> CellRows<'a> {
        CellRows {
            tets: &self.neighbours.from_tet,
            listed: &self.neighbours.from_hexahedron,
            hexahedra: dataset.hexahedra.view(),
            blocks: dataset.hexahedra.structured_blocks(),
        }
    }
}

/// What lies across the faces of cells; loops over cells are compiled for each way to know it.
pub(super) trait Across: Copy + Sync {
    /// How many cells there are.
    fn len(&self) -> usize;

    /// The faces of `cell` that `faces` has a bit for, and the cell across each or [`Adjacency::NONE`].
    fn across(&self, cell: u32, faces: u8) -> impl Iterator<Item = (usize, u32)>;
}

/// The faces that `faces` has a bit for, ascending. Branches once at the end, not at each bit: which are set is chance.
#[inline]
fn set_bits(mut faces: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lowest = faces.trailing_zeros() as usize;
        faces &= faces.checked_sub(1)?;
        Some(lowest)
    })
}

/// The rows of tetrahedra, which are all cells.
#[derive(Clone, Copy)]
pub(super) struct TetRows<'a>(&'a [[u32; TET_FACES]]);

impl Across for TetRows<'_> {
    fn len(&self) -> usize {
        self.0.len()
    }

    #[inline]
    fn across(&self, cell: u32, faces: u8) -> impl Iterator<Item = (usize, u32)> {
        let row = self.0[cell as usize];
        set_bits(faces).map(move |k| (k, row[k % TET_FACES]))
    }
}

/// The rows of tetrahedra, then of hexahedra, listed or implied by structured blocks.
#[derive(Clone, Copy)]
pub(super) struct CellRows<'a> {
    tets: &'a [[u32; TET_FACES]],
    listed: &'a [[u32; HEX_FACES]],
    hexahedra: HexahedraView<'a>,
    blocks: &'a [StructuredBlock],
}

impl CellRows<'_> {
    /// A bit for each face of `cell`.
    fn all_faces(&self, cell: usize) -> u8 {
        if cell < self.tets.len() { (1 << TET_FACES) - 1 } else { (1 << HEX_FACES) - 1 }
    }

    #[inline]
    fn row(&self, cell: u32) -> [u32; HEX_FACES] {
        let Some(hexahedron) = (cell as usize).checked_sub(self.tets.len()) else {
            let [a, b, c, d] = self.tets[cell as usize];
            return [a, b, c, d, Adjacency::NONE, Adjacency::NONE];
        };
        if self.blocks.is_empty() { self.listed[hexahedron] } else { self.implied(hexahedron as u32) }
    }

    /// The row of a hexahedron of a structured block. What lies across a face is no neighbour where it is not drawn, or runs the
    /// other way round and so lies on the same side of the face.
    #[inline]
    fn implied(&self, cell: u32) -> [u32; HEX_FACES] {
        let shape = self.hexahedra.shape(cell as usize);
        if shape.is_absent() {
            return [Adjacency::NONE; HEX_FACES];
        }
        let block = &self.blocks[self.blocks.partition_point(|block| block.first_cell <= cell) - 1];
        let neighbour = |other: u32| {
            let other = block.first_cell + other;
            let its = self.hexahedra.shape(other as usize);
            let is_neighbour = !its.is_absent() && its.is_mirrored() == shape.is_mirrored();
            if is_neighbour { self.tets.len() as u32 + other } else { Adjacency::NONE }
        };
        let mut row = block.across(cell - block.first_cell).map(|other| other.map_or(Adjacency::NONE, neighbour));
        if shape.is_mirrored() {
            // Its bottom and top have changed places.
            row.swap(4, 5);
        }
        row
    }
}

impl Across for CellRows<'_> {
    fn len(&self) -> usize {
        self.tets.len() + self.hexahedra.len()
    }

    #[inline]
    fn across(&self, cell: u32, faces: u8) -> impl Iterator<Item = (usize, u32)> {
        let row = if faces == 0 { [Adjacency::NONE; HEX_FACES] } else { self.row(cell) };
        set_bits(faces).map(move |k| (k, row[k]))
    }
}
