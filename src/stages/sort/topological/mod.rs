//! `topological`: Williams' meshed-polyhedra visibility order, with what Cook et al. add for meshes that are not convex.
//!
//! In: cells, their [`Adjacency`], vertices, the view. Out: a layer for each cell, the key; how many cycles were broken. `sides`
//! → `exterior` → `layers`, and where cells wait for each other `cycles`.
//!
//! Two cells at a face are in order when the one on the eye's side comes first. A ray that leaves the mesh and enters it again
//! relates two cells without a common face; a picture looks along the rays of its pixel centres and nowhere else, so the relations
//! that these meet are enough. Cells that do not show stay in the graph: the order of others runs through them.
//!
//! Sources: Williams, Visibility ordering meshed polyhedra, 1992. Cook, Max, Silva, Williams, Image-space visibility ordering for
//! cell projection volume rendering of unstructured data, 2004. Max 2006, section 5.

mod cycles;
mod exterior;
mod graph;
mod layers;
mod sides;
#[cfg(test)]
mod tests;
mod triangle;

use glam::Vec3;
use rayon::prelude::*;

use self::exterior::Exterior;
use self::graph::{Graph, Relation, Sides};
use self::layers::Layering;
use super::adjacency::Adjacency;
use super::centroid::Centroid;
use super::{Toward, key_of_depth};
use crate::columns::Dataset;
use crate::stages::{SceneVertex, View};

/// What a topological order came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layers {
    /// Layers of cells that do not overlap.
    pub layers: u32,
    /// Cells that were let go before one that lies before them, since each waited for another; with none the order is exact.
    pub cycles: u64,
    /// Pairs of cells without a common face that a ray meets one after the other.
    pub relations: u64,
}

/// Finds topological orders; keeps its memory, and the last order, between frames.
#[derive(Default)]
pub struct Topological {
    sides_from_cell: Vec<Sides>,
    exterior: Exterior,
    relations: Vec<Relation>,
    layering: Layering,
    layer_from_cell: Vec<u32>,
}

impl Topological {
    /// Finds the order of all cells of `dataset` in `view`; the same for any number of threads.
    pub fn order(&mut self, dataset: &Dataset, adjacency: &Adjacency, vertices: &[SceneVertex], view: &View) -> Layers {
        self.sides_from_cell.resize(dataset.tets.len(), Sides::default());
        sides::sides(dataset, vertices, Toward::new(view), &mut self.sides_from_cell);
        self.exterior.relations(dataset, adjacency, &self.sides_from_cell, vertices, view, &mut self.relations);
        let relations = self.relations.len() as u64;

        let neighbours_from_cell = adjacency.neighbours_from_cell();
        let (sides_from_cell, relations_found) = (&mut self.sides_from_cell[..], &mut self.relations);
        let mut graph = Graph { neighbours_from_cell, sides_from_cell, relations: relations_found };
        let layering = &mut self.layering;
        layering.begin(&graph);
        let all = || (0..dataset.tets.len() as u32).into_par_iter();
        let placed = layering.place(&graph, &layering.waiting(all(), false));
        let mut cycles = 0;
        if placed < dataset.tets.len() as u64 {
            let waiting = layering.waiting(all(), true);
            let centroid = Centroid::new(view);
            let corner = |v: u32| Vec3::from_array(vertices[v as usize].position);
            let depth = |cell: u32| key_of_depth(centroid.depth(dataset.tets.get(cell as usize).map(corner)));
            cycles = cycles::cut(&mut graph, layering, waiting.clone(), depth);
            layering.place(&graph, &layering.waiting(waiting.into_par_iter(), false));
        }
        Layers { layers: layering.finish(&mut self.layer_from_cell), cycles, relations }
    }

    /// The layer of each cell in the last order, 0 the nearest: cells of one layer hide nothing of each other.
    pub fn layer_from_cell(&self) -> &[u32] {
        &self.layer_from_cell
    }
}
