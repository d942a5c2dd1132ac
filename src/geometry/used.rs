//! Vertices under one number where they stand in one place, so that what cells share is drawn once.

use crate::columns::{Dataset, canonical_from_vertex};

/// The lowest vertex at the place of each; as in the faces of cells, only where vertices may coincide: listed hexahedra, and blocks.
pub(super) struct Canonical(Vec<u32>);

impl Canonical {
    /// 4 bytes a vertex, 20 until it is known; nothing for tetrahedra.
    pub(super) fn new(dataset: &Dataset) -> Self {
        let may_coincide = dataset.tets.len() < dataset.cells();
        Self(if may_coincide { canonical_from_vertex(&dataset.positions) } else { Vec::new() })
    }

    #[inline]
    pub(super) fn of(&self, vertex: u32) -> u32 {
        self.0.get(vertex as usize).copied().unwrap_or(vertex)
    }
}
