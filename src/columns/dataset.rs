//! `Dataset`: the validated mesh, in blocks of cells that lie together in space.

use std::ops::Range;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use arrayvec::ArrayVec;

use super::{
    Array, Backing, BitColumn, BlockTets, Column, Hexahedra, HexahedraView, Neighbours, Polyhedra, PolyhedraView, Tets,
};

/// A box in space; empty when a minimum exceeds its maximum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The smallest coordinates, relative to [`Dataset::origin`].
    pub min: Vec3,
    /// The largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around `self` and `p`.
    #[must_use]
    pub fn include(self, p: Vec3) -> Self {
        Self { min: self.min.min(p), max: self.max.max(p) }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The length of the diagonal.
    pub fn diagonal_world(self) -> f64 {
        (self.max.as_dvec3() - self.min.as_dvec3()).length()
    }

    /// The centre.
    pub fn center(self) -> DVec3 {
        (self.max.as_dvec3() + self.min.as_dvec3()) * 0.5
    }

    /// The eight corners.
    pub fn corners(self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            Vec3::new(pick(0, self.min.x, self.max.x), pick(1, self.min.y, self.max.y), pick(2, self.min.z, self.max.z))
        })
    }
}

/// The vertices of a cell.
#[derive(Clone, Debug)]
pub enum CellCorners<'a> {
    /// Of a tetrahedron or hexahedron.
    Few(ArrayVec<u32, 8>),
    /// Of a polyhedron.
    Many(&'a [u32]),
}

impl std::ops::Deref for CellCorners<'_> {
    type Target = [u32];

    #[inline]
    fn deref(&self) -> &[u32] {
        match self {
            Self::Few(corners) => corners,
            Self::Many(corners) => corners,
        }
    }
}

/// What became of the cells of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct CellCounts {
    /// Cells in the file, of any kind.
    pub in_file: u64,
    /// Cells left out because they have no volume by their kind (points, lines, faces).
    pub lower_dimensional: u64,
    /// Cells left out because `vtkGhostType` hides them or says that another piece owns them.
    pub ghost: u64,
    /// Cells of kinds that this version does not draw.
    pub unsupported: u64,
    /// Cells with four to eight corners that were split into tetrahedra.
    pub split: u64,
    /// Quadratic cells that are drawn by their corners alone.
    pub quadratic: u64,
    /// Tetrahedra that were turned because their vertices ran the other way.
    pub inverted: u64,
    /// Tetrahedra without volume; they are left out, no ray has a length in them.
    pub degenerate: u64,
}

impl CellCounts {
    /// All counts, in the order of the members.
    pub(crate) fn all(&self) -> [u64; 8] {
        let Self { in_file, lower_dimensional, ghost, unsupported, split, quadratic, inverted, degenerate } = *self;
        [in_file, lower_dimensional, ghost, unsupported, split, quadratic, inverted, degenerate]
    }
}

/// The values of one array over the cells of a mesh.
#[derive(Clone, Debug)]
pub struct ArrayRanges {
    /// Of the value or magnitude, then, where there are several, of each component.
    pub by_component: Vec<ValueRanges>,
}

/// The values of one scalar over the cells of a mesh.
#[derive(Clone, Debug)]
pub struct ValueRanges {
    /// Smallest and largest finite value; empty (min > max) where there is none.
    pub range: (f64, f64),
    /// Cells with a value that is not finite.
    pub invalid: u64,
    /// Smallest and largest value of the other cells of each block; empty (min > max) where there are none.
    pub blocks: Column<[f64; 2]>,
}

/// A run of cells that lie together in space.
#[derive(Clone, Debug)]
pub struct Block {
    /// Its cells.
    pub cells: Range<usize>,
    /// The box around their vertices.
    pub bounds: Bounds,
}

/// A validated mesh: every index in range, every position finite, every cell that is drawn with a volume.
///
/// Cells are numbered through: tetrahedra first, then hexahedra, then polyhedra. Cells and vertices stand in spatial (Morton) order; the arrays of a foreign file stay in its order and are reached
/// through [`Dataset::file_from_vertex`] and [`Dataset::file_from_cell`].
#[derive(Clone, Debug)]
pub struct Dataset {
    /// Added to a position, it gives the world position.
    pub origin: DVec3,
    /// Vertex positions relative to `origin`.
    pub positions: Column<[f32; 3]>,
    /// The four vertices of each tetrahedron, ascending: neighbours name a shared face alike.
    pub tets: Tets,
    /// Cells with faces of four corners, whose numbers follow those of the tetrahedra.
    pub hexahedra: Hexahedra,
    /// Cells with any faces, whose numbers follow those of the hexahedra.
    pub polyhedra: Polyhedra,
    /// Whether (b−a)×(c−a)·(d−a) > 0 for the ascending vertices a, b, c, d; decided exactly.
    pub positive: BitColumn,
    /// The file's point of each vertex; none where arrays stand in the order of the vertices.
    pub file_from_vertex: Option<Column<u32>>,
    /// The file's cell of each cell, several cells share one where a cell was split; none where arrays stand in the order of
    /// the cells.
    pub file_from_cell: Option<Column<u32>>,
    /// All arrays of the file.
    pub arrays: Vec<Array>,
    /// What is known of the values of each array, where a container says it; else empty.
    pub array_ranges: Vec<ArrayRanges>,
    /// Which cell lies across each face of listed cells; where a container has it.
    pub adjacency: Option<Neighbours>,
    /// The cells in runs of [`Dataset::BLOCK_CELLS`] of one kind, in order.
    pub blocks: Vec<Block>,
    /// The box around all cells.
    pub bounds: Bounds,
    /// What became of the file's cells.
    pub counts: CellCounts,
    /// Bytes of a file that is held in memory whole, whose columns are parts of it.
    pub read_bytes: u64,
    /// The file whose bytes are used in place, if there is one.
    pub backing: Option<Arc<Backing>>,
}

impl Dataset {
    /// Cells per block (the last has fewer).
    pub const BLOCK_CELLS: usize = 4096;

    /// How many cells there are, those included that are numbered and not drawn.
    pub fn cells(&self) -> usize {
        self.first_polyhedron() + self.polyhedra.len()
    }

    /// The number of the first polyhedron, or of the cell that would follow the last hexahedron.
    pub fn first_polyhedron(&self) -> usize {
        self.tets.len() + self.hexahedra.len()
    }

    /// The blocks of so many tetrahedra, hexahedra and polyhedra: runs of cells of one kind.
    pub(crate) fn runs([tets, hexahedra, polyhedra]: [usize; 3]) -> impl Iterator<Item = Range<usize>> {
        let of_kind = |all: Range<usize>| {
            all.clone().step_by(Self::BLOCK_CELLS).map(move |first| first..(first + Self::BLOCK_CELLS).min(all.end))
        };
        let first_polyhedron = tets + hexahedra;
        let whole = of_kind(tets..first_polyhedron).chain(of_kind(first_polyhedron..first_polyhedron + polyhedra));
        of_kind(0..tets).chain(whole)
    }

    /// How many cells of block `block` may be drawn: all but hidden ones and those without volume, which keep their numbers.
    ///
    /// # Panics
    /// If there is no such block.
    pub fn cells_drawn_in(&self, block: usize) -> u64 {
        let cells = &self.blocks[block].cells;
        let has_all = cells.start < self.tets.len() || cells.start >= self.first_polyhedron();
        if self.hexahedra.absent() == 0 || has_all {
            return cells.len() as u64;
        }
        let shapes = self.hexahedra.view();
        cells.clone().filter(|cell| !shapes.shape(cell - self.tets.len()).is_absent()).count() as u64
    }

    /// The vertices of cell `cell`: four, eight, or as many as a polyhedron has.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub fn corners(&self, cell: usize) -> CellCorners<'_> {
        if let Some(polyhedron) = cell.checked_sub(self.first_polyhedron()) {
            return CellCorners::Many(self.polyhedra.view().corners(polyhedron));
        }
        CellCorners::Few(match cell.checked_sub(self.tets.len()) {
            None => self.tets.get(cell).into_iter().collect(),
            Some(cell) => self.hexahedra.view().get(cell).into(),
        })
    }

    /// The volume of cell `cell`, in world units; 0 where it is not drawn.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn volume_world(&self, cell: usize) -> f64 {
        let position = |v: u32| Vec3::from_array(self.positions[v as usize]);
        if let Some(polyhedron) = cell.checked_sub(self.first_polyhedron()) {
            return self.polyhedra.view().volume(polyhedron, position);
        }
        if let Some(cell) = cell.checked_sub(self.tets.len()) {
            let hexahedra = self.hexahedra.view();
            return hexahedra.shape(cell).volume(hexahedra.get(cell).map(position));
        }
        let [a, b, c, d] = self.tets.get(cell).map(|v| position(v).as_dvec3());
        (b - a).cross(c - a).dot(d - a).abs() / 6.0
    }

    /// Length of the diagonal of the box around all cells, in world units.
    pub fn diagonal_world(&self) -> f64 {
        self.bounds.diagonal_world()
    }

    /// The centre of the box around all cells, in world coordinates.
    pub fn center_world(&self) -> DVec3 {
        self.origin + self.bounds.center()
    }

    /// The eight corners of the box around all cells, in world coordinates.
    pub fn corners_world(&self) -> [DVec3; 8] {
        self.bounds.corners().map(|corner| self.origin + corner.as_dvec3())
    }

    /// The tuple of point arrays that belongs to a vertex.
    #[inline]
    pub fn point_tuple(&self, vertex: usize) -> usize {
        self.file_from_vertex.as_ref().map_or(vertex, |file_from| file_from[vertex] as usize)
    }

    /// The tuple of cell arrays that belongs to a cell.
    #[inline]
    pub fn cell_tuple(&self, cell: usize) -> usize {
        self.file_from_cell.as_ref().map_or(cell, |file_from| file_from[cell] as usize)
    }

    /// Bytes of memory that the mesh takes; columns that are used in place, as those of a mapped file, count nothing.
    pub fn owned_bytes(&self) -> u64 {
        let columns = self.positions.owned_bytes()
            + self.tets.owned_bytes()
            + self.hexahedra.owned_bytes()
            + self.polyhedra.owned_bytes()
            + self.positive.owned_bytes()
            + [&self.file_from_vertex, &self.file_from_cell]
                .into_iter()
                .flatten()
                .map(Column::owned_bytes)
                .sum::<u64>();
        let arrays: u64 = self.arrays.iter().map(|array| array.values.owned_bytes()).sum();
        columns + arrays + size_of_val(&self.blocks[..]) as u64 + self.read_bytes
    }

    /// The cells of block `block`, as slices.
    ///
    /// # Panics
    /// If there is no such block.
    pub fn block(&self, block: usize) -> BlockView<'_> {
        let Block { cells, bounds } = &self.blocks[block];
        let (first_hexahedron, first_polyhedron) = (self.tets.len(), self.first_polyhedron());
        let of_block = if cells.start < first_hexahedron {
            BlockCells::Tets(BlockTets::new(&self.tets, block, cells.len()))
        } else if cells.start >= first_polyhedron {
            let run = cells.start - first_polyhedron..cells.end - first_polyhedron;
            BlockCells::Polyhedra(self.polyhedra.view().run(run))
        } else {
            let run = cells.start - first_hexahedron..cells.end - first_hexahedron;
            BlockCells::Hexahedra(self.hexahedra.view().run(run))
        };
        BlockView { base: cells.start, bounds: *bounds, cells: of_block, positions: &self.positions }
    }
}

/// One block as the stages see it: cells are named by their index in the block.
#[derive(Clone, Copy, Debug)]
pub struct BlockView<'a> {
    /// The dataset's index of the block's first cell.
    pub base: usize,
    /// The box around the block's vertices.
    pub bounds: Bounds,
    /// The block's cells.
    pub cells: BlockCells<'a>,
    /// All vertex positions.
    pub positions: &'a [[f32; 3]],
}

/// The cells of a block, all of one kind.
#[derive(Clone, Copy, Debug)]
pub enum BlockCells<'a> {
    /// Four corners each.
    Tets(BlockTets<'a>),
    /// Eight corners each, of which some may coincide; some are not drawn.
    Hexahedra(HexahedraView<'a>),
    /// Any number of corners and faces.
    Polyhedra(PolyhedraView<'a>),
}

impl BlockView<'_> {
    /// How many cells there are.
    #[inline]
    pub fn len(&self) -> usize {
        match &self.cells {
            BlockCells::Tets(tets) => tets.len(),
            BlockCells::Hexahedra(hexahedra) => hexahedra.len(),
            BlockCells::Polyhedra(polyhedra) => polyhedra.len(),
        }
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
