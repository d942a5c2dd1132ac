//! `edges`: the edges of all cells, each once; not the diagonals along which faces are cut.
//!
//! In: the cells. Out: pairs of vertices, by vertex. Cells of a block lie together and share most edges: these are found block by block,
//! and those of all blocks sorted. 8 bytes for each edge of each block, some 1.5 times the edges.

use rayon::prelude::*;

use super::surface::in_scene;
use super::used::Canonical;
use super::{List, Primitive};
use crate::cells::HEXAHEDRON;
use crate::columns::{BlockCells, Dataset};
use crate::stages::scene_per_world;

/// Edges of a tetrahedron.
const OF_TETRAHEDRON: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
/// Edges of a hexahedron; where corners coincide, some are points.
const OF_HEXAHEDRON: [[usize; 2]; 12] = hexahedron_edges();

/// Around its bottom and its top, and from one to the other.
const fn hexahedron_edges() -> [[usize; 2]; 12] {
    let mut edges = [[0; 2]; 12];
    let mut i = 0;
    while i < 4 {
        edges[i] = [i, (i + 1) % 4];
        edges[i + 4] = [i + 4, (i + 1) % 4 + 4];
        edges[i + 8] = [i, i + 4];
        i += 1;
    }
    edges
}

const _: () = assert!(HEXAHEDRON.corners == 8);

/// The edges of the cells of `dataset`.
///
/// ```
/// use cellfan::{Dataset, generate, geometry};
/// // A cube of six tetrahedra: 12 edges, a diagonal on each side, one through the middle.
/// let mesh = generate::tets(&generate::Settings { cells: 6, ..Default::default() })?;
/// assert_eq!(geometry::edges(&Dataset::from_tets(mesh)?).len(), 12 + 6 + 1);
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn edges(dataset: &Dataset) -> List {
    let canonical = Canonical::new(dataset);
    let name = |a: u32, b: u32| {
        let (a, b) = (canonical.of(a), canonical.of(b));
        u64::from(a.min(b)) << 32 | u64::from(a.max(b))
    };
    let of_block = |block: usize| -> Vec<u64> {
        let mut edges = Vec::new();
        match dataset.block(block).cells {
            BlockCells::Tets(tets) => {
                for cell in 0..tets.len() {
                    let corners = tets.get(cell);
                    edges.extend(OF_TETRAHEDRON.map(|[i, k]| name(corners[i], corners[k])));
                }
            }
            BlockCells::Hexahedra(hexahedra) => {
                for cell in (0..hexahedra.len()).filter(|&cell| !hexahedra.shape(cell).is_absent()) {
                    let corners = hexahedra.get(cell);
                    edges.extend(OF_HEXAHEDRON.map(|[i, k]| name(corners[i], corners[k])));
                }
            }
            BlockCells::Polyhedra(polyhedra) => {
                for face in (0..polyhedra.len()).flat_map(|cell| polyhedra.faces(cell)) {
                    let around = face.around;
                    edges.extend((0..around.len()).map(|i| name(around[i], around[(i + 1) % around.len()])));
                }
            }
        }
        edges.sort_unstable();
        edges.dedup();
        edges.retain(|&edge| edge >> 32 != edge & u64::from(u32::MAX));
        edges
    };
    let mut all: Vec<u64> = (0..dataset.blocks.len()).into_par_iter().flat_map_iter(of_block).collect();
    all.par_sort_unstable();
    all.dedup();
    let scale = scene_per_world(dataset);
    let ends = all.par_iter().flat_map_iter(|&edge| [(edge >> 32) as u32, edge as u32]);
    List::new(Primitive::Lines, ends.map(|vertex| in_scene(dataset, vertex, scale)).collect())
}
