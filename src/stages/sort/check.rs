//! `check`: how many neighbouring cells an order puts the wrong way round (`--check-order`).
//!
//! In: the drawn cells' keys, nearest first. Out: [`OrderCheck`]. Two cells that share a face are in order when the one on the
//! eye's side of the face comes first; the side is decided exactly (Shewchuk's predicate). A face seen edge-on constrains
//! nothing, and neither does one whose two triangles are seen from different sides: either order is wrong for some rays.

use glam::Vec3;
use rayon::prelude::*;

use super::Toward;
use super::neighbours::neighbours;
use super::radix::{Pair, index_of};
use super::side::side_of_eye;
use crate::columns::Dataset;
use crate::stages::{SceneVertex, View};

/// What an order does to the pairs of cells that share a face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OrderCheck {
    /// Pairs whose order matters: both cells drawn, the face seen, and from one side.
    pub pairs: u64,
    /// Pairs the wrong way round.
    pub misordered: u64,
}

/// Checks `order`, pairs of key and cell with the nearest first.
pub fn check_order(dataset: &Dataset, vertices: &[SceneVertex], view: &View, order: &[Pair]) -> OrderCheck {
    const NOT_DRAWN: u32 = u32::MAX;
    let mut rank_from_cell = vec![NOT_DRAWN; dataset.cells()];
    for (rank, &pair) in order.iter().enumerate() {
        rank_from_cell[index_of(pair) as usize] = rank as u32;
    }
    let toward = Toward::new(view);
    let drawn = |&cell: &u32| rank_from_cell[cell as usize] != NOT_DRAWN;
    neighbours(dataset, (0..dataset.cells() as u32).into_par_iter().filter(drawn))
        .par_iter()
        .map(|pair| {
            let corner = |v: u32| Vec3::from_array(vertices[v as usize].position).as_dvec3();
            let side = |triangle: &[u32; 3]| side_of_eye(triangle.map(corner), toward);
            let is_seen = |sign: f64| pair.triangles.iter().any(|triangle| side(triangle) * sign > 0.0);
            let (nearer, farther) = match (is_seen(1.0), is_seen(-1.0)) {
                (true, false) => (pair.ahead, pair.behind),
                (false, true) => (pair.behind, pair.ahead),
                _ => return OrderCheck::default(),
            };
            let misordered = rank_from_cell[nearer as usize] > rank_from_cell[farther as usize];
            OrderCheck { pairs: 1, misordered: misordered.into() }
        })
        .reduce(OrderCheck::default, |a, b| OrderCheck {
            pairs: a.pairs + b.pairs,
            misordered: a.misordered + b.misordered,
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Dataset;
    use crate::generate::{Settings, delaunay, tets};
    use crate::stages::project::scene_vertices;
    use crate::stages::sort::power::Power;
    use crate::stages::sort::radix::pair;
    use crate::stages::sort::{KeyMaker, SortKey};
    use crate::stages::testing::views;

    fn checked(dataset: &Dataset, vertices: &[SceneVertex], key: SortKey, view: &View) -> OrderCheck {
        let keys = KeyMaker::new(key, view, &[]);
        let mut order = Vec::new();
        for block in (0..dataset.blocks.len()).map(|block| dataset.block(block)) {
            let cells: Vec<u32> = (0..block.len() as u32).collect();
            let mut key_from_cell = Vec::new();
            keys.keys(&block, vertices, &cells, &mut key_from_cell);
            order.extend(cells.iter().zip(key_from_cell).map(|(&cell, key)| pair(key, block.base as u32 + cell)));
        }
        order.sort_unstable();
        check_order(dataset, vertices, view, &order)
    }

    /// The order by power distances that were not narrowed to 32 bits.
    fn checked_in_f64(dataset: &Dataset, vertices: &[SceneVertex], view: &View) -> OrderCheck {
        let power = Power::new(view);
        let corners =
            |cell: u32| dataset.tets.get(cell as usize).map(|v| Vec3::from_array(vertices[v as usize].position));
        let mut cells: Vec<(f64, u32)> =
            (0..dataset.tets.len() as u32).map(|cell| (power.depth(corners(cell)), cell)).collect();
        cells.sort_by(|a, b| a.0.total_cmp(&b.0));
        let order: Vec<Pair> = cells.iter().enumerate().map(|(rank, &(_, cell))| pair(rank as u32, cell)).collect();
        check_order(dataset, vertices, view, &order)
    }

    #[test]
    fn power_orders_a_delaunay_mesh_and_centroids_do_not() {
        for seed in [1, 2] {
            let settings = Settings { cells: 20_000, seed, ..Settings::default() };
            let mesh = Dataset::from_tets(delaunay(&settings).unwrap()).unwrap();
            let vertices = scene_vertices(&mesh, &mesh.homogeneous_field());
            for (i, view) in views(&mesh, 64, 64).iter().enumerate() {
                let exact = checked_in_f64(&mesh, &vertices, view);
                assert!(exact.pairs > 30_000, "two faces a cell or so are shared");
                assert_eq!(exact.misordered, 0, "seed {seed}, view {i}");
                // Keys of 32 bits tie, or change places, where two distances agree to 24 bits.
                let power = checked(&mesh, &vertices, SortKey::Power, view);
                println!("seed {seed}, view {i}: {power:?}");
                assert!(power.misordered <= 4, "seed {seed}, view {i}: {power:?}");
                // The control: the same check finds what an approximate order gets wrong.
                let centroid = checked(&mesh, &vertices, SortKey::Centroid, view);
                assert_eq!(centroid.pairs, exact.pairs);
                assert!(centroid.misordered > 100, "seed {seed}, view {i}: {centroid:?}");
            }
        }
    }

    #[test]
    fn a_reversed_order_has_every_pair_the_wrong_way_round() {
        let mesh =
            Dataset::from_tets(tets(&Settings { cells: 3000, jitter: 0.0, ..Settings::default() }).unwrap()).unwrap();
        let vertices = scene_vertices(&mesh, &mesh.homogeneous_field());
        let view = views(&mesh, 64, 64)[0];
        let order = |keys: &dyn Fn(u32) -> u32| {
            let mut order: Vec<Pair> = (0..mesh.tets.len() as u32).map(|cell| pair(keys(cell), cell)).collect();
            order.sort_unstable();
            check_order(&mesh, &vertices, &view, &order)
        };
        let (forward, backward) = (order(&|cell| cell), order(&|cell| u32::MAX - cell));
        assert!(forward.pairs > 5000 && forward.pairs == backward.pairs);
        assert_eq!(forward.misordered + backward.misordered, forward.pairs);
    }
}
