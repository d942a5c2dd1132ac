//! `topological`: Williams' meshed-polyhedra visibility order, with what Cook et al. add for meshes that are not convex.
//!
//! In: cells, their [`Adjacency`], vertices, the view. Out: a layer for each cell, the key; how many cycles were broken. `sides`
//! → `exterior`, `folds` → `layers`, and where cells wait for each other `cycles`.
//!
//! Two cells at a face are in order when the one on the eye's side comes first. A ray that leaves the mesh and enters it again
//! relates two cells without a common face, and one that meets a face which is seen from both sides the two cells at it; a picture
//! looks along the rays of its pixel centres and nowhere else, so the relations that these meet are enough. Cells that do not show
//! stay in the graph: the order of others runs through them.
//!
//! Cells without volume are not drawn and not in the graph. Faces that only one of them parts have nothing across: rays pass from one
//! into the next at one depth, which relates them (Williams 1992 and Max 2006, section 7, give such cells a place instead).
//!
//! Sources: Williams, Visibility ordering meshed polyhedra, 1992. Cook, Max, Silva, Williams, Image-space visibility ordering for
//! cell projection volume rendering of unstructured data, 2004. Max 2006, section 5.

mod cycles;
mod exterior;
mod folds;
mod graph;
mod layers;
mod outline;
mod sides;
#[cfg(test)]
mod tests;
mod triangle;

use glam::Vec3;

use self::exterior::Exterior;
use self::graph::{Graph, Relation, Sides};
use self::layers::Layering;
use self::outline::Seen;
use super::adjacency::{Across, Adjacency, Face};
use super::centroid::Centroid;
use super::{Toward, key_of_depth};
use crate::columns::Dataset;
use crate::control::Control;
use crate::stages::{SceneVertex, View};

/// What a topological order came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layers {
    /// Layers of cells that do not overlap.
    pub layers: u32,
    /// Cells that were let go before one that lies before them, since each waited for another, and faces through which rays pass both
    /// ways; with none the order is exact.
    pub cycles: u64,
    /// Pairs of cells that are related by what rays meet: without a common face, or at one that is seen from both sides.
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
        self.order_while(&Control::default(), dataset, adjacency, vertices, view)
    }

    /// The same until the end is asked for; then it is no order.
    pub(crate) fn order_while(
        &mut self,
        control: &Control,
        dataset: &Dataset,
        adjacency: &Adjacency,
        vertices: &[SceneVertex],
        view: &View,
    ) -> Layers {
        set_len(&mut self.sides_from_cell, dataset.cells());
        sides::sides(control, dataset, vertices, Toward::new(view), &mut self.sides_from_cell);
        let seen = Seen { dataset, sides_from_cell: &self.sides_from_cell, vertices, view };
        self.exterior.relations(control, seen, adjacency, &mut self.relations);
        let both_ways = folds::relations(control, seen, adjacency, &mut self.relations);
        if control.is_cancelled() {
            return Layers::default();
        }
        let relations = self.relations.len() as u64;

        let centroid = Centroid::new(view);
        let corner = |v: u32| Vec3::from_array(vertices[v as usize].position);
        let exterior = adjacency.exterior();
        let (layers, let_go) = if dataset.hexahedra.is_empty() {
            let depth = |cell: u32| centroid.depth(dataset.tets.get(cell as usize).map(corner));
            self.layers(control, adjacency.tet_rows(), exterior, depth)
        } else {
            let hexahedra = dataset.hexahedra.view();
            let depth = |cell: u32| match (cell as usize).checked_sub(dataset.tets.len()) {
                None => centroid.depth(dataset.tets.get(cell as usize).map(corner)),
                Some(cell) => centroid.depth(hexahedra.get(cell).map(corner)),
            };
            self.layers(control, adjacency.rows(dataset), exterior, depth)
        };
        Layers { layers, cycles: both_ways + let_go, relations }
    }

    /// Finds the layers of cells whose sides and relations are known; how many there are, and how many cells were let go. `depth` is a
    /// key that orders nearly.
    fn layers(
        &mut self,
        control: &Control,
        neighbours: impl Across,
        exterior: &[Face],
        depth: impl Fn(u32) -> f32,
    ) -> (u32, u64) {
        let Self { sides_from_cell, relations, layering, layer_from_cell, .. } = self;
        let mut graph = Graph { neighbours, sides_from_cell, relations };
        let (mut layers, are_all) = layering.place(control, &graph, exterior, layer_from_cell);
        let mut let_go = 0;
        if !are_all && !control.is_cancelled() {
            let_go = cycles::cut(control, &mut graph, layering.waiting(), |cell| key_of_depth(depth(cell)));
            (layers, _) = layering.place(control, &graph, exterior, layer_from_cell);
        }
        (layers, let_go)
    }

    /// The layer of each cell in the last order, 0 the nearest: cells of one layer hide nothing of each other.
    pub fn layer_from_cell(&self) -> &[u32] {
        &self.layer_from_cell
    }
}

/// Cells between two looks at the token where little is done for each.
const LOOK: usize = 1 << 16;

/// Makes `values` so long; memory that is asked for anew is cleared by the system when it is first written to.
fn set_len<T: Clone + bytemuck::Zeroable>(values: &mut Vec<T>, len: usize) {
    if values.capacity() < len {
        *values = Vec::new();
        *values = bytemuck::zeroed_vec(len);
    } else {
        values.resize(len, T::zeroed());
    }
}
