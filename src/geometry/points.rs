//! `points`: the vertices that cells use, each once.
//!
//! In: the cells. Out: their vertices in the order of the dataset; vertices in one place are one. O(cells), a bit a vertex.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::surface::in_scene;
use super::used::Canonical;
use super::{List, Primitive};
use crate::columns::{BlockCells, Dataset};
use crate::stages::scene_per_world;

/// The points that the cells of `dataset` use.
///
/// ```
/// use cellfan::{Dataset, generate, geometry};
/// let mesh = generate::tets(&generate::Settings { cells: 48, ..Default::default() })?;
/// assert_eq!(geometry::points(&Dataset::from_tets(mesh)?).len(), 3 * 3 * 3);
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn points(dataset: &Dataset) -> List {
    let canonical = Canonical::new(dataset);
    let vertices = dataset.positions.len();
    let is_used: Vec<AtomicU64> = (0..vertices.div_ceil(64)).map(|_| AtomicU64::new(0)).collect();
    let note = |vertex: u32| {
        let vertex = canonical.of(vertex);
        let (word, bit) = (&is_used[vertex as usize / 64], 1 << (vertex % 64));
        // Most are known already: reading is cheaper than writing what is there.
        if word.load(Ordering::Relaxed) & bit == 0 {
            word.fetch_or(bit, Ordering::Relaxed);
        }
    };
    (0..dataset.blocks.len()).into_par_iter().for_each(|block| match dataset.block(block).cells {
        BlockCells::Tets(tets) => (0..tets.len()).for_each(|cell| tets.get(cell).into_iter().for_each(note)),
        BlockCells::Hexahedra(hexahedra) => {
            let drawn = (0..hexahedra.len()).filter(|&cell| !hexahedra.shape(cell).is_absent());
            drawn.for_each(|cell| hexahedra.get(cell).into_iter().for_each(note));
        }
        BlockCells::Polyhedra(polyhedra) => {
            (0..polyhedra.len()).for_each(|cell| polyhedra.corners(cell).iter().copied().for_each(note));
        }
    });
    let scale = scene_per_world(dataset);
    let used = (0..vertices as u32).into_par_iter().filter(|&vertex| {
        let word = is_used[vertex as usize / 64].load(Ordering::Relaxed);
        word >> (vertex % 64) & 1 == 1
    });
    List::new(Primitive::Points, used.map(|vertex| in_scene(dataset, vertex, scale)).collect())
}
