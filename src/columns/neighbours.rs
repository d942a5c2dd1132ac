//! [`Neighbours`]: which cell lies across each face of listed cells.
//!
//! Most faces are shared within a block of cells, which lie together in space, and are found there, block by block; the sides that are
//! left over are sorted, and two that follow each other are those of one face. Here in memory; a container sorts what is left over in a
//! budget. Where more than two cells meet at a face, those on either side of it are paired as brackets are, in the order of the cells,
//! those of one block first; what is left over has no neighbour.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::canonical::place;
use super::faces::{FaceName, FaceSide, Faces, HEX_FACES, TET_FACES};
use super::{Column, Dataset};
use crate::control::Control;

/// The cells across the faces of tetrahedra and of listed hexahedra; those of structured blocks follow from i, j and k.
///
/// Cells meet where they share vertices, listed hexahedra and what adjoins them where their vertices stand in one place; the triangles of
/// the face are the same for both, and they lie on either side of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Neighbours {
    /// Across the face opposite to each vertex; [`Neighbours::NONE`] where there is none.
    pub from_tet: Column<[u32; TET_FACES]>,
    /// Across each face, in the order of [`HEXAHEDRON`](crate::cells::HEXAHEDRON); [`Neighbours::NONE`] also where a cell has no such face.
    pub from_hexahedron: Column<[u32; HEX_FACES]>,
}

impl Neighbours {
    /// No cell lies across the face.
    pub const NONE: u32 = u32::MAX;

    /// Finds the neighbours of the cells of `dataset`, in parallel.
    ///
    /// O(cells), with 24 bytes for each face that is not shared within its block, some tenth of all.
    pub fn new(dataset: &Dataset) -> Self {
        Self::new_while(&Control::default(), dataset)
    }

    /// The same until the end is asked for; then neighbours are missing.
    pub(crate) fn new_while(control: &Control, dataset: &Dataset) -> Self {
        let faces = Faces::new(dataset.into());
        let [tets, hexahedra] = faces.listed();
        let (mut from_tet, mut from_hexahedron) = (rows_of_none(control, tets), rows_of_none(control, hexahedra));
        let of_tets = within_blocks(control, &faces, 0, &mut from_tet);
        let of_hexahedra = within_blocks(control, &faces, tets, &mut from_hexahedron);
        let open_from_block: Vec<Vec<Side>> = of_tets.chain(of_hexahedra).collect();
        let open = sorted_while(control, &open_from_block, dataset.positions.len());
        drop(open_from_block);
        let mut joiner = Joiner::default();
        for sides in open.chunks(LOOK).take_while(|_| !control.is_cancelled()) {
            for [one, other] in sides.iter().filter_map(|&side| joiner.join(side)) {
                for (side, across) in [(one, other), (other, one)] {
                    match side.cell().checked_sub(tets) {
                        None => from_tet[side.cell()][side.face()] = across.cell() as u32,
                        Some(hexahedron) => from_hexahedron[hexahedron][side.face()] = across.cell() as u32,
                    }
                }
            }
        }
        Self { from_tet: from_tet.into(), from_hexahedron: from_hexahedron.into() }
    }

    /// The first cell that does not fit `dataset`: of a neighbour it says that lies across one of its faces, and this has no such face, or
    /// does not say the same of it. The first cell of all where the columns are of another length.
    ///
    /// What says that there is no neighbour is believed.
    pub fn first_wrong(&self, dataset: &Dataset) -> Option<usize> {
        let faces = Faces::by_vertices(dataset.into());
        let [tets, hexahedra] = faces.listed();
        if [self.from_tet.len(), self.from_hexahedron.len()] != [tets, hexahedra] {
            return Some(0);
        }
        let check = Check { neighbours: self, faces, positions: &dataset.positions };
        let blocks: Vec<Range<usize>> = Dataset::runs([tets, hexahedra, 0]).collect();
        blocks.into_par_iter().find_map_first(|cells| check.first_wrong(cells))
    }

    /// Bytes of memory that they take; columns that are used in place count nothing.
    pub fn owned_bytes(&self) -> u64 {
        self.from_tet.owned_bytes() + self.from_hexahedron.owned_bytes()
    }

    /// Across the faces of `cell`, if there is such a cell.
    #[inline]
    fn row(&self, cell: usize) -> Option<&[u32]> {
        match cell.checked_sub(self.from_tet.len()) {
            None => Some(&self.from_tet[cell]),
            Some(hexahedron) => self.from_hexahedron.get(hexahedron).map(|row| &row[..]),
        }
    }
}

/// Whether rows are those of the cells.
struct Check<'a> {
    neighbours: &'a Neighbours,
    faces: Faces<'a>,
    positions: &'a [[f32; 3]],
}

impl Check<'_> {
    /// Of the cells of a block.
    fn first_wrong(&self, mut cells: Range<usize>) -> Option<usize> {
        // Most neighbours lie in the block: its faces are named once.
        let first = cells.start;
        let mut sides = vec![[None; HEX_FACES]; cells.len()];
        for (cell, sides) in cells.clone().zip(&mut sides) {
            self.faces.for_each(cell, |k, side| sides[k] = Some(side));
        }
        let side = |cell: usize, k: usize| match cell.checked_sub(first).and_then(|cell| sides.get(cell)) {
            Some(sides) => sides[k],
            None => self.faces.get(cell, k, |vertex| vertex),
        };
        let is_shared = |(cell, k): (usize, usize), (other, j): (usize, usize)| {
            // As a rule they have the same vertices.
            side(cell, k).zip(side(other, j)).is_some_and(|(a, b)| a.is_across(b))
                || self.is_shared_by_place((cell, k), (other, j))
        };
        let is_neighbour = |(cell, k): (usize, usize), other: usize| {
            let names_it =
                |row: &[u32]| (0..row.len()).any(|j| row[j] as usize == cell && is_shared((cell, k), (other, j)));
            other != cell && self.neighbours.row(other).is_some_and(names_it)
        };
        let is_right = |cell: usize| {
            let mut row = self.neighbours.row(cell).unwrap_or_default().iter().enumerate();
            row.all(|(k, &other)| other == Neighbours::NONE || is_neighbour((cell, k), other as usize))
        };
        cells.find(|&cell| !is_right(cell))
    }

    /// Whether two faces, each of a cell, are one, seen from both sides; beside hexahedra, vertices at one place count as one.
    fn is_shared_by_place(&self, (cell, k): (usize, usize), (other, j): (usize, usize)) -> bool {
        if self.faces.listed()[1] == 0 {
            return false;
        }
        let corners = self.faces.corners(cell);
        let at = |vertex: u32| place(self.positions[vertex as usize]);
        let canonical = |vertex: u32| corners.iter().copied().find(|&v| at(v) == at(vertex)).unwrap_or(vertex);
        let sides = self.faces.get(cell, k, canonical).zip(self.faces.get(other, j, canonical));
        sides.is_some_and(|(a, b)| a.is_across(b))
    }
}

/// A face of a cell, as words that sort by the face, then by cell.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
pub(crate) struct Side([u32; Side::WORDS]);

impl Side {
    /// The name of the face, the cell, and which of its faces it is and how it runs.
    pub(crate) const WORDS: usize = 6;

    fn new(cell: usize, k: usize, FaceSide { name: FaceName([a, b, c, d]), ascends }: FaceSide) -> Self {
        Self([a, b, c, d, cell as u32, (k as u32) << 1 | u32::from(ascends)])
    }

    /// The number of the cell.
    pub(crate) fn cell(self) -> usize {
        self.0[4] as usize
    }

    /// Which face of the cell it is.
    pub(crate) fn face(self) -> usize {
        (self.0[5] >> 1) as usize
    }

    fn of_face(self) -> FaceSide {
        let [a, b, c, d, _, way] = self.0;
        FaceSide { name: FaceName([a, b, c, d]), ascends: way & 1 == 1 }
    }

    /// A number that the sides of a face have in common, and few others: the halves of its name multiplied, the product folded.
    fn hash(self) -> u32 {
        let [a, b, c, d, ..] = self.0;
        let two = |high: u32, low: u32, salt: u64| u128::from((u64::from(high) << 32 | u64::from(low)) ^ salt);
        // Digits of π, so that no factor is small.
        let product = two(a, b, 0x243f_6a88_85a3_08d3) * two(c, d, 0x1319_8a2e_0370_7344);
        ((product >> 64) as u64 ^ product as u64) as u32
    }
}

/// Finds the two sides of faces among sides that come in order, as brackets are paired.
#[derive(Default)]
pub(crate) struct Joiner {
    /// Sides of one face that have no other yet: one, as a rule.
    waiting: Vec<Side>,
}

impl Joiner {
    /// Takes the next side, and gives the last that waited and this where they are the sides of one face.
    pub(crate) fn join(&mut self, side: Side) -> Option<[Side; 2]> {
        let face = side.of_face();
        match self.waiting.last() {
            // A cell that is folded upon itself is not its own neighbour.
            Some(last) if last.of_face().is_across(face) && last.cell() != side.cell() => {
                return self.waiting.pop().map(|last| [last, side]);
            }
            Some(last) if last.of_face().name != face.name => self.waiting.clear(),
            _ => {}
        }
        self.waiting.push(side);
        None
    }
}

/// Fills the rows of a block, whose first cell is `first`, with what lies across within the block; the sides whose other is elsewhere.
fn within_block<const N: usize>(faces: &Faces, first: usize, rows: &mut [[u32; N]]) -> Vec<Side> {
    let mut sides = Vec::with_capacity(N * rows.len());
    for cell in first..first + rows.len() {
        faces.for_each(cell, |k, face| sides.push(Side::new(cell, k, face)));
    }
    // Numbers are sorted faster than sides; of those that share one, two are the rule.
    let mut side_by_hash: Vec<u64> =
        (0..).zip(&sides).map(|(i, side): (u64, &Side)| u64::from(side.hash()) << 32 | i).collect();
    side_by_hash.sort_unstable();
    let (mut joiner, mut open, mut alike) = (Joiner::default(), Vec::new(), Vec::new());
    for run in side_by_hash.chunk_by(|a, b| a >> 32 == b >> 32) {
        alike.clear();
        alike.extend(run.iter().map(|&number| sides[number as u32 as usize]));
        alike.sort_unstable();
        for &side in &alike {
            let Some([one, other]) = joiner.join(side) else {
                open.push(side);
                continue;
            };
            // It was the last to be left open.
            open.pop();
            rows[one.cell() - first][one.face()] = other.cell() as u32;
            rows[other.cell() - first][other.face()] = one.cell() as u32;
        }
    }
    open
}

/// Rows, or sides, between two looks at the token: less than a millisecond.
const LOOK: usize = 1 << 15;

/// Rows without a neighbour.
fn rows_of_none<const N: usize>(control: &Control, len: usize) -> Vec<[u32; N]> {
    let mut rows = Vec::new();
    rows.reserve_exact(len);
    while rows.len() < len && !control.is_cancelled() {
        rows.resize((rows.len() + LOOK).min(len), [Neighbours::NONE; N]);
    }
    rows
}

/// All sides in order: those of faces whose first of so many vertices are near each other are put together, and sorted in cache.
fn sorted_while(control: &Control, sides_from_block: &[Vec<Side>], vertices: usize) -> Vec<Side> {
    let len: usize = sides_from_block.iter().map(Vec::len).sum();
    let buckets = len / LOOK + 1;
    let bucket_of = |side: &Side| (u64::from(side.0[0]) * buckets as u64 / vertices.max(1) as u64) as usize;
    let sides_while = || sides_from_block.iter().take_while(|_| !control.is_cancelled()).flatten();
    // Count, scan, write.
    let mut places = vec![0; buckets];
    sides_while().for_each(|side| places[bucket_of(side)] += 1);
    let mut sorted = vec![Side::zeroed(); len];
    let (mut rest, mut slices, mut start) = (&mut sorted[..], Vec::with_capacity(buckets), 0);
    let lens = places.clone();
    for place in &mut places {
        start += std::mem::replace(place, start);
    }
    for side in sides_while() {
        let place = &mut places[bucket_of(side)];
        rest[*place] = *side;
        *place += 1;
    }
    for len in lens {
        let (slice, after) = rest.split_at_mut(len);
        slices.push(slice);
        rest = after;
    }
    slices.into_par_iter().filter(|_| !control.is_cancelled()).for_each(<[Side]>::sort_unstable);
    sorted
}

/// The same for all blocks of the cells from `first` on, which are of one kind.
pub(crate) fn within_blocks<'a, const N: usize>(
    control: &'a Control,
    faces: &'a Faces,
    first: usize,
    rows: &'a mut [[u32; N]],
) -> impl ParallelIterator<Item = Vec<Side>> + 'a {
    let blocks = rows.par_chunks_mut(Dataset::BLOCK_CELLS).enumerate();
    blocks.map(move |(block, rows)| {
        if control.is_cancelled() {
            return Vec::new();
        }
        within_block(faces, first + block * Dataset::BLOCK_CELLS, rows)
    })
}
