//! What changes of a scene while its mesh stays: scalars, positions; and what a renderer keeps then.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::Scene;
use super::opaque::Lists;
use crate::backends::Still;
use crate::columns::{Association, Dataset, Field};
use crate::stages::project::scene_vertices;

/// Whether views are thought to stay as they are while scalars change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Stillness {
    /// Every frame is another view.
    #[default]
    Moving,
    /// Frames may follow each other from one place: orders are kept.
    Still,
    /// The same, and scalars change.
    Live,
}

impl Stillness {
    /// What a frame of `scene` says of it.
    pub(super) fn of(self, scene: &Scene) -> Option<Still<'_>> {
        (self != Self::Moving).then_some(Still { shape: &scene.shape, is_live: self == Self::Live })
    }
}

impl Scene {
    /// Shows other values on the same cells. 20 bytes a vertex are written, or 4 a cell.
    pub(crate) fn set_field(&mut self, field: Field) {
        let is_of_points = |field: &Field| field.association == Association::Point;
        if is_of_points(&field) {
            let values = field.values.par_iter();
            self.vertices.par_iter_mut().zip(values).for_each(|(vertex, &scalar)| vertex.scalar = scalar);
        } else if is_of_points(&self.field) {
            self.vertices.par_iter_mut().for_each(|vertex| vertex.scalar = 0.0);
        }
        self.pieces = self.transfer.pieces(field.offset);
        self.field = field;
    }

    /// The same field on `dataset`, which has the same cells, or fewer, with their vertices at other places. Which cells adjoin is known
    /// still where all are tetrahedra and none came or went.
    pub(crate) fn set_shape(&mut self, dataset: Dataset, field: Field) {
        let is_alike = dataset.hexahedra.is_empty()
            && self.dataset.hexahedra.is_empty()
            && dataset.tets.len() == self.dataset.tets.len()
            && dataset.counts.degenerate == 0
            && self.dataset.counts.degenerate == 0;
        if !is_alike {
            self.adjacency = OnceLock::new();
        }
        self.overlapping_faces = OnceLock::new();
        self.best_key = OnceLock::new();
        self.lists = Lists::default();
        // The old records go before the new are asked for.
        self.vertices = Vec::new();
        self.vertices = scene_vertices(&dataset, &field);
        self.pieces = self.transfer.pieces(field.offset);
        (self.dataset, self.field) = (dataset, field);
        self.shape = Arc::new(());
    }
}
