//! The order of a frame: what it is asked for, which sort gives it, and how far it can be trusted.

use std::sync::Arc;
use std::time::Instant;

use super::{Renderer, Scene, Stillness};
use crate::backends::{Counts, Frame};
use crate::profile::{Exactness, OrderStats, Profile};
use crate::stages::View;
use crate::stages::sort::check::check_order;
use crate::stages::sort::radix::{Pair, pair, sort};
use crate::stages::sort::topological::{Layers, Topological};
use crate::stages::sort::{SortKey, SortMethod};

/// How the cells of one frame are put in order.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameOrder {
    /// What cells are sorted by.
    pub(super) key: SortKey,
    /// Whether fragments found out of order are put right; otherwise they are only counted.
    pub(super) is_exact: bool,
    /// What the topological order came to, where that is the key.
    layers: Option<Layers>,
    /// Whether the neighbours that it follows are those of a container, where that is the key.
    has_stored_adjacency: Option<bool>,
    /// Faces at which cells were found to overlap.
    overlapping_faces: u64,
}

/// The order of a frame, and what it is of.
pub(super) struct LastOrder {
    shape: Arc<()>,
    view: View,
    sort: SortMethod,
    draws_fans: bool,
    order: FrameOrder,
}

impl Renderer {
    /// The order of a frame: the last frame's, where that was by the graph of the mesh and nothing has moved since.
    pub(super) fn order_kept(
        &mut self,
        scene: &Scene,
        view: &View,
        topological: &mut Topological,
        profile: &mut Profile,
    ) -> FrameOrder {
        let (sort, draws_fans) = (self.options.sort, self.draws_fans());
        let is_same = |last: &LastOrder| {
            let is_asked_for =
                last.sort == sort && last.draws_fans == draws_fans && !self.options.model.is_order_free();
            is_asked_for && Arc::ptr_eq(&last.shape, &scene.shape) && last.view == *view
        };
        if let Some(LastOrder { order, .. }) = self.last_order.as_ref().filter(|last| is_same(last)) {
            return *order;
        }
        self.last_order = None;
        let order = self.order_frame(scene, view, topological, profile);
        if self.still != Stillness::Moving && order.layers.is_some() {
            let shape = Arc::clone(&scene.shape);
            self.last_order = Some(LastOrder { shape, view: *view, sort, draws_fans, order });
        }
        order
    }

    /// Chooses the order of a frame and makes what its keys are read from.
    ///
    /// `auto` takes what is exact: on the processor fragments are checked and put right, which costs less than a graph of the mesh
    /// and needs no conditions. Fans take the topological order; where that has to break cycles, or cells overlap, a GPU checks the
    /// order and the processor draws the tiles again in which it was wrong; so it is with polyhedra, which the graph does not know.
    pub(super) fn order_frame(
        &self,
        scene: &Scene,
        view: &View,
        topological: &mut Topological,
        profile: &mut Profile,
    ) -> FrameOrder {
        let by =
            |key| FrameOrder { key, is_exact: false, layers: None, has_stored_adjacency: None, overlapping_faces: 0 };
        match self.options.sort {
            _ if self.options.model.is_order_free() => by(SortKey::None),
            SortMethod::None => by(SortKey::None),
            SortMethod::Centroid => by(SortKey::Centroid),
            SortMethod::Power => by(SortKey::Power),
            SortMethod::Auto | SortMethod::Exact if !self.draws_fans() || !scene.dataset.polyhedra.is_empty() => {
                FrameOrder { is_exact: true, ..by(scene.best_key(&self.control).unwrap_or(SortKey::None)) }
            }
            SortMethod::Auto | SortMethod::Exact | SortMethod::Topological => {
                // Where the end is asked for, no order is looked at.
                let Some(adjacency) = scene.adjacency(&self.control, profile) else { return by(SortKey::None) };
                let start = Instant::now();
                let _span = tracing::trace_span!("topological").entered();
                let layers = topological.order_while(&self.control, &scene.dataset, adjacency, &scene.vertices, view);
                profile.add("topological", start.elapsed(), scene.dataset.cells() as u64 * 64);
                let overlapping_faces = scene.overlapping_faces(adjacency, profile);
                let is_exact = self.checks_order()
                    && match self.options.sort {
                        SortMethod::Exact => true,
                        SortMethod::Auto => layers.cycles > 0 || overlapping_faces > 0,
                        _ => false,
                    };
                let has_stored_adjacency = Some(adjacency.is_stored());
                FrameOrder {
                    layers: Some(layers),
                    is_exact,
                    has_stored_adjacency,
                    overlapping_faces,
                    ..by(SortKey::Topological)
                }
            }
        }
    }

    /// What is said of the order of a frame that was drawn.
    pub(super) fn order_stats(&self, order: FrameOrder, counts: &Counts, misordered_pairs: Option<u64>) -> OrderStats {
        let is_ordered = !self.options.model.is_order_free();
        let is_counted = is_ordered && (!self.draws_fans() || order.is_exact);
        let violations = is_counted.then_some(counts.violations);
        let exactness = match order.layers {
            Some(_) if order.overlapping_faces > 0 && !order.is_exact => {
                Exactness::CellsOverlap(order.overlapping_faces)
            }
            Some(Layers { cycles, .. }) if cycles > 0 && !order.is_exact => Exactness::CyclesBroken(cycles),
            // Built from the graph of what lies before what.
            Some(_) => Exactness::Exact,
            // Every fragment was compared with what its pixel had drawn, and put right. Counting alone proves nothing: a
            // ray that ended early does not see what comes too late.
            None if order.is_exact || !is_ordered => Exactness::Exact,
            None => Exactness::Unverified,
        };
        OrderStats {
            kind: if order.is_exact { SortMethod::Exact.name() } else { order.key.name() },
            exactness,
            misordered_pairs,
            cycles: order.layers.map(|layers| layers.cycles),
            layers: order.layers.map(|layers| layers.layers),
            adjacency: order.has_stored_adjacency.map(|is_stored| if is_stored { "stored" } else { "built" }),
            violations,
            tiles_redone: counts.tiles_redone,
        }
    }
}

/// Puts all cells in the order of the sort and counts the neighbours that stand the wrong way round.
pub(super) fn misordered_pairs(frame: &Frame) -> u64 {
    let mut order: Vec<Pair> = Vec::new();
    let mut key_from_cell = Vec::new();
    for block in 0..frame.dataset.blocks.len() {
        let block = frame.dataset.block(block);
        let cells: Vec<u32> = (0..block.len() as u32).collect();
        key_from_cell.clear();
        frame.keys.keys(&block, frame.vertices, &cells, &mut key_from_cell);
        order.extend(key_from_cell.iter().zip(&cells).map(|(&key, &cell)| pair(key, block.base as u32 + cell)));
    }
    sort(&mut order, &mut Vec::new());
    check_order(frame.dataset, frame.vertices, frame.view, &order).misordered
}
