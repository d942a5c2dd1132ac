//! [`Graph`]: which cell comes right before and right after which, for one view.
//!
//! Nodes are cells. Two cells at a face are related where the eye lies on one side of it. What rays meet relates those whose faces have
//! nothing across (`exterior`), and those at a face that is seen from both sides (`folds`).

use crate::stages::sort::adjacency::{Across, Adjacency};

/// Where what lies across each face of a cell stands, a bit for each of up to eight faces. Neither, where the face is edge-on; both,
/// where its two triangles are seen from different sides.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Zeroable)]
pub(super) struct Sides {
    /// Across this face lies what comes before the cell: rays enter here.
    pub(super) before: u8,
    /// Across this face lies what comes after the cell: rays leave here.
    pub(super) after: u8,
}

impl Sides {
    /// The faces that are seen from both sides, and relate nothing by themselves.
    #[inline]
    pub(super) fn both(self) -> u8 {
        self.before & self.after
    }

    #[inline]
    pub(super) fn only_before(self) -> u8 {
        self.before & !self.after
    }

    #[inline]
    fn only_after(self) -> u8 {
        self.after & !self.before
    }
}

/// A relation that rays found, `nearer << 32 | farther`; lists of them ascend, each once.
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

/// The visibility graph.
pub(super) struct Graph<'a, A> {
    /// The cell across each face.
    pub(super) neighbours: A,
    pub(super) sides_from_cell: &'a mut [Sides],
    pub(super) relations: &'a mut Vec<Relation>,
}

impl<A: Across> Graph<'_, A> {
    /// How many cells there are.
    pub(super) fn len(&self) -> usize {
        self.neighbours.len()
    }

    /// The cells across the faces of `cell` that `faces` has a bit for.
    #[inline]
    fn across(&self, cell: u32, faces: u8) -> impl Iterator<Item = u32> {
        self.neighbours.across(cell, faces).map(|(_, other)| other).filter(|&other| other != Adjacency::NONE)
    }

    /// The neighbours that come right before `cell`.
    #[inline]
    pub(super) fn neighbours_before(&self, cell: u32) -> impl Iterator<Item = u32> {
        self.across(cell, self.sides_from_cell[cell as usize].only_before())
    }

    /// The neighbours that come right after `cell`.
    #[inline]
    pub(super) fn neighbours_after(&self, cell: u32) -> impl Iterator<Item = u32> {
        self.across(cell, self.sides_from_cell[cell as usize].only_after())
    }

    /// Whether rays leave `cell` into the open, or through a face that is seen from both sides.
    #[inline]
    fn may_have_relations(&self, cell: u32) -> bool {
        let sides = self.sides_from_cell[cell as usize];
        sides.both() != 0 || self.neighbours.across(cell, sides.after).any(|(_, other)| other == Adjacency::NONE)
    }

    /// What rays found to come after `cell`.
    #[inline]
    pub(super) fn relations_after(&self, cell: u32) -> &[Relation] {
        // Most cells are inside: they are told from the others without a search.
        if self.relations.is_empty() || !self.may_have_relations(cell) {
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

    /// Forgets that neighbour `nearer` comes before `cell`.
    pub(super) fn forget_neighbour(&mut self, nearer: u32, cell: u32) {
        let faces_of = |cell: u32, faces: u8, neighbour: u32| {
            let faces = self.neighbours.across(cell, faces).filter(move |&(_, other)| other == neighbour);
            faces.fold(0_u8, |bits, (k, _)| bits | 1 << k)
        };
        let before = faces_of(cell, self.sides_from_cell[cell as usize].only_before(), nearer);
        let after = faces_of(nearer, self.sides_from_cell[nearer as usize].only_after(), cell);
        self.sides_from_cell[cell as usize].before &= !before;
        self.sides_from_cell[nearer as usize].after &= !after;
    }
}
