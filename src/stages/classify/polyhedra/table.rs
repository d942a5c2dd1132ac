//! The table of a kind: from the facing of its faces, and where its inner corners lie, to a case and a renumbering.
//!
//! Made once, from the cases and the renumberings of their standard numberings onto the kind's.

use std::sync::LazyLock;

use arrayvec::ArrayVec;

use super::cases::{Case, definitions};
use super::renumber::{Renumbering, renumberings};
use super::sides::Sides;
use crate::cells::{CellKind, HEXAHEDRON, PYRAMID, VOXEL, WEDGE};

/// All projections of one kind of cell.
pub struct Projections {
    pub(super) kind: &'static CellKind,
    cases: Vec<Case>,
    /// For each set of faces that run counterclockwise on the picture (bit f for face f).
    by_counterclockwise: Vec<Option<Pattern>>,
}

/// The cells with certain faces counterclockwise on the picture.
pub(super) struct Pattern {
    /// Inner corners that may lie in more than one face.
    pub seekers: ArrayVec<Seeker, 2>,
    /// For the place of the first seeker among its faces, then that of the second.
    entries: [[Option<Entry>; 3]; 3],
}

/// An inner corner, and the faces of the other side one of which contains it.
pub(super) struct Seeker {
    pub corner: u8,
    pub candidates: ArrayVec<Candidate, 3>,
}

/// A face, and its edges to other faces of its side, directed so that its inside is where orientations are positive.
pub(super) struct Candidate {
    face: u8,
    pub edges: ArrayVec<[u8; 2], 2>,
}

/// A case, how to renumber the cell for it, and whether its lid is what runs counterclockwise.
#[derive(Clone, Copy)]
pub(super) struct Entry {
    pub case: usize,
    pub renumbering: Renumbering,
    pub lid_is_counterclockwise: bool,
}

static TABLES: [LazyLock<Option<Projections>>; 4] = [
    LazyLock::new(|| Projections::new(&VOXEL)),
    LazyLock::new(|| Projections::new(&HEXAHEDRON)),
    LazyLock::new(|| Projections::new(&WEDGE)),
    LazyLock::new(|| Projections::new(&PYRAMID)),
];

impl Projections {
    /// The projections of a kind; `None` for tetrahedra, whose are in [`classify`](super::super).
    pub fn of(kind: &CellKind) -> Option<&'static Self> {
        let table =
            [VOXEL.code, HEXAHEDRON.code, WEDGE.code, PYRAMID.code].iter().position(|&code| code == kind.code)?;
        TABLES[table].as_ref()
    }

    /// The kind's cases.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// The pattern of cells whose faces with set bits run counterclockwise; `None` if there is no such projection.
    #[inline]
    pub(super) fn pattern(&self, counterclockwise: u8) -> Option<&Pattern> {
        self.by_counterclockwise.get(usize::from(counterclockwise))?.as_ref()
    }

    fn new(kind: &'static CellKind) -> Option<Self> {
        let definitions = definitions(kind);
        let cases: Option<Vec<Case>> = (0..).zip(definitions).map(|(index, of)| of.case(index)).collect();
        let all = 1_u8 << kind.faces.len();
        let pattern = |lid| Pattern::new(Sides { faces: kind.faces, lid });
        let mut by_counterclockwise: Vec<Option<Pattern>> = (0..all).map(pattern).collect();
        for (case, definition) in definitions.iter().enumerate() {
            for renumbering in renumberings(definition.faces, kind.faces) {
                let (lid, inside) = definition.renumbered(&renumbering);
                for (counterclockwise, lid_is_counterclockwise) in [(lid, true), (all - 1 - lid, false)] {
                    let pattern = by_counterclockwise[usize::from(counterclockwise)].as_mut()?;
                    let [first, second] = pattern.places(&inside)?;
                    // Rotations that map the case to itself do equally well; the first is taken.
                    pattern.entries[first][second].get_or_insert(Entry { case, renumbering, lid_is_counterclockwise });
                }
            }
        }
        Some(Self { kind, cases: cases?, by_counterclockwise })
    }
}

impl Pattern {
    fn new(sides: Sides) -> Option<Self> {
        if !sides.share_one_outline() {
            return None;
        }
        let mut seekers = ArrayVec::new();
        for corner in 0..sides.corners() {
            let Some(of_lid) = sides.inner(corner) else { continue };
            let candidates: ArrayVec<Candidate, 5> =
                sides.faces_of(!of_lid).map(|face| Candidate::new(sides, face)).collect();
            if candidates.len() > 1 {
                // More than two would be a kind that this table is too small for.
                seekers.try_push(Seeker { corner, candidates: candidates.into_iter().collect() }).ok()?;
            }
        }
        Some(Self { seekers, entries: [[None; 3]; 3] })
    }

    /// Where among their candidates the seekers are that lie in these (corner, face).
    fn places(&self, inside: &[(u8, u8)]) -> Option<[usize; 2]> {
        let mut places = [0; 2];
        for (place, seeker) in places.iter_mut().zip(&self.seekers) {
            let (_, face) = inside.iter().find(|(corner, _)| *corner == seeker.corner)?;
            *place = seeker.candidates.iter().position(|candidate| candidate.face == *face)?;
        }
        Some(places)
    }

    /// The entry for the seekers' places among their candidates.
    #[inline]
    pub(super) fn entry(&self, [first, second]: [usize; 2]) -> Option<&Entry> {
        self.entries.get(first)?.get(second)?.as_ref()
    }
}

impl Candidate {
    fn new(sides: Sides, face: u8) -> Self {
        let is_counterclockwise = sides.is_lid(face);
        let inner = sides.inner_edges(is_counterclockwise);
        let directed = inner.into_iter().filter(|edge| edge.faces.contains(&face)).map(|edge| {
            // As this face runs, and turned round where that is counterclockwise on the picture, whose rows run down.
            let [a, b] = edge.ends;
            if (edge.faces[0] == face) == is_counterclockwise { [b, a] } else { [a, b] }
        });
        Self { face, edges: directed.collect() }
    }
}
