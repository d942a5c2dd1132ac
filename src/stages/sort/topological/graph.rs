//! [`Graph`]: which cell comes right before and right after which, for one view.
//!
//! Nodes are cells, each with up to `F` faces. Two cells at a face are related where the eye lies on one side of it; cells whose
//! faces have nothing across are related by what rays meet (`exterior`).

use crate::stages::sort::adjacency::Adjacency;

/// Where what lies across each face of a cell stands, a bit for each of up to eight faces; neither, where the face is edge-on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sides {
    /// Across this face lies what comes before the cell: rays enter here.
    pub(super) before: u8,
    /// Across this face lies what comes after the cell: rays leave here.
    pub(super) after: u8,
}

/// Relations between cells without a common face, `nearer << 32 | farther`, ascending, each once.
pub(super) type Relation = u64;

pub(super) fn relation(nearer: u32, farther: u32) -> Relation {
    u64::from(nearer) << 32 | u64::from(farther)
}

pub(super) fn nearer(relation: Relation) -> u32 {
    (relation >> 32) as u32
}

pub(super) fn farther(relation: Relation) -> u32 {
    relation as u32
}

/// The visibility graph of cells with at most `F` faces; one with fewer has nothing across the others.
pub(super) struct Graph<'a, const F: usize> {
    /// The cell across each face, or [`Adjacency::NONE`].
    pub(super) neighbours_from_cell: &'a [[u32; F]],
    pub(super) sides_from_cell: &'a mut [Sides],
    pub(super) relations: &'a mut Vec<Relation>,
}

impl<const F: usize> Graph<'_, F> {
    const FACES_FIT: () = assert!(F <= 8, "sides have a bit for each of eight faces");

    /// How many cells there are.
    pub(super) fn len(&self) -> usize {
        let () = Self::FACES_FIT;
        self.neighbours_from_cell.len()
    }

    /// The cells across the faces of `cell` that `faces` has a bit for.
    #[inline]
    fn across(&self, cell: u32, faces: u8) -> impl Iterator<Item = u32> {
        let row = self.neighbours_from_cell[cell as usize];
        (0..F).filter(move |k| faces >> k & 1 == 1).map(move |k| row[k]).filter(|&other| other != Adjacency::NONE)
    }

    /// The neighbours that come right before `cell`.
    #[inline]
    pub(super) fn neighbours_before(&self, cell: u32) -> impl Iterator<Item = u32> {
        self.across(cell, self.sides_from_cell[cell as usize].before)
    }

    /// The neighbours that come right after `cell`.
    #[inline]
    pub(super) fn neighbours_after(&self, cell: u32) -> impl Iterator<Item = u32> {
        self.across(cell, self.sides_from_cell[cell as usize].after)
    }

    /// Whether rays leave `cell` into the open.
    #[inline]
    fn has_exit(&self, cell: u32) -> bool {
        let after = self.sides_from_cell[cell as usize].after;
        let row = &self.neighbours_from_cell[cell as usize];
        (0..F).any(|k| after >> k & 1 == 1 && row[k] == Adjacency::NONE)
    }

    /// The relations of `cell` to what comes after it without a common face.
    #[inline]
    pub(super) fn relations_after(&self, cell: u32) -> &[Relation] {
        // Most cells are inside: they are told from the others without a search.
        if self.relations.is_empty() || !self.has_exit(cell) {
            return &[];
        }
        let start = self.relations.partition_point(|&r| nearer(r) < cell);
        let rest = &self.relations[start..];
        let len = rest.iter().take_while(|&&r| nearer(r) == cell).count();
        &rest[..len]
    }

    /// All cells that come right after `cell`.
    pub(super) fn after(&self, cell: u32) -> impl Iterator<Item = u32> {
        self.neighbours_after(cell).chain(self.relations_after(cell).iter().map(|&r| farther(r)))
    }

    /// Forgets that neighbour `nearer` comes before `cell`; how many faces said so.
    pub(super) fn forget_neighbour(&mut self, nearer: u32, cell: u32) -> u32 {
        let mut forgotten = 0;
        for k in 0..F {
            let sides = &mut self.sides_from_cell[cell as usize];
            if sides.before >> k & 1 == 1 && self.neighbours_from_cell[cell as usize][k] == nearer {
                sides.before &= !(1 << k);
                forgotten += 1;
            }
            let sides = &mut self.sides_from_cell[nearer as usize];
            if sides.after >> k & 1 == 1 && self.neighbours_from_cell[nearer as usize][k] == cell {
                sides.after &= !(1 << k);
            }
        }
        forgotten
    }
}
