//! The two sides of a cell on the picture: the *lid*, faces turned one way, and the *bowl*, faces turned the other way.
//! Which of them is the front is left open.

use super::Faces;

/// An edge and its two faces: the first runs from `ends[0]` to `ends[1]`, the second back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub ends: [u8; 2],
    pub faces: [u8; 2],
}

/// Which faces form the lid (bit f of `lid` for face f); the others form the bowl.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides {
    pub faces: Faces,
    pub lid: u8,
}

impl Sides {
    /// Whether a face belongs to the lid.
    pub(super) fn is_lid(self, face: u8) -> bool {
        self.lid >> face & 1 == 1
    }

    /// How many corners the cell has.
    pub(super) fn corners(self) -> u8 {
        self.faces.iter().flat_map(|face| face.iter()).max().map_or(0, |last| last + 1)
    }

    /// The faces of the lid, or of the bowl.
    pub(super) fn faces_of(self, lid: bool) -> impl Iterator<Item = u8> {
        (0..self.faces.len() as u8).filter(move |&face| self.is_lid(face) == lid)
    }

    /// The faces of the lid, or of the bowl, that have this corner.
    pub(super) fn faces_at(self, corner: u8, lid: bool) -> impl Iterator<Item = u8> {
        self.faces_of(lid).filter(move |&face| self.faces[usize::from(face)].contains(&corner))
    }

    /// Whether all faces at a corner belong to the lid (`Some(true)`) or to the bowl; `None` on the outline.
    pub(super) fn inner(self, corner: u8) -> Option<bool> {
        match [true, false].map(|lid| self.faces_at(corner, lid).next().is_some()) {
            [true, true] => None,
            [lid, _] => Some(lid),
        }
    }

    /// All edges, each once.
    pub(super) fn edges(self) -> Vec<Edge> {
        let mut edges: Vec<Edge> = Vec::new();
        for (face, corners) in (0..).zip(self.faces) {
            for (i, &a) in corners.iter().enumerate() {
                let b = corners[(i + 1) % corners.len()];
                match edges.iter_mut().find(|edge| edge.ends == [b, a]) {
                    Some(edge) => edge.faces[1] = face,
                    None => edges.push(Edge { ends: [a, b], faces: [face, face] }),
                }
            }
        }
        edges
    }

    /// The edges between two faces of the lid, or of the bowl.
    pub(super) fn inner_edges(self, lid: bool) -> Vec<Edge> {
        let inner = |edge: &Edge| edge.faces.iter().all(|&face| self.is_lid(face) == lid);
        self.edges().into_iter().filter(inner).collect()
    }

    /// The edges between lid and bowl, running as the lid's face does; that face comes first.
    pub(super) fn outline(self) -> Vec<Edge> {
        let turned = |Edge { ends: [a, b], faces: [f, g] }| match [f, g].map(|face| self.is_lid(face)) {
            [true, false] => Some(Edge { ends: [a, b], faces: [f, g] }),
            [false, true] => Some(Edge { ends: [b, a], faces: [g, f] }),
            _ => None,
        };
        self.edges().into_iter().filter_map(turned).collect()
    }

    /// Whether lid and bowl meet in one loop that touches itself nowhere, so that each is a disc.
    pub(super) fn share_one_outline(self) -> bool {
        let outline = self.outline();
        let Some(first) = outline.first() else { return false };
        let mut at = first.ends[1];
        for walked in 1..=outline.len() {
            if at == first.ends[0] {
                return walked == outline.len();
            }
            let mut onward = outline.iter().filter(|edge| edge.ends[0] == at);
            match (onward.next(), onward.next()) {
                (Some(edge), None) => at = edge.ends[1],
                _ => return false,
            }
        }
        false
    }
}
