//! Layers and relations against slow twins: longest ways found by relaxing all relations, and all cells along the rays of all pixels.

mod whole;

use std::collections::{BTreeSet, HashSet};

use glam::DVec3;
use rayon::prelude::*;

use super::*;
use crate::columns::{CellCounts, Points, TetMesh};
use crate::generate::{Settings, delaunay, tets};
use crate::stages::project::scene_vertices;
use crate::stages::sort::check::check_order;
use crate::stages::sort::neighbours::neighbours;
use crate::stages::sort::radix::pair;
use crate::stages::sort::side::side_of_eye;
use crate::stages::testing::{Random, corners, depths_in_cell, random_cells, ray, views};

/// The cells of `mesh` whose centroid in the cube from −1 to 1 is one that `is_kept`.
fn part(mesh: &TetMesh, is_kept: impl Fn(DVec3) -> bool) -> Dataset {
    let centroid = |tet: &[u32; 4]| tet.map(|v| mesh.points.get(v as usize)).into_iter().sum::<DVec3>() * 0.25;
    let kept: Vec<[u32; 4]> = mesh.tets.iter().filter(|tet| is_kept(centroid(tet) * 2.0 - 1.0)).copied().collect();
    let points = (0..mesh.points.len()).map(|i| (mesh.points.get(i) * 2.0 - 1.0).to_array()).collect();
    let file_from_tet = kept.iter().map(|_| 0).collect();
    Dataset::from_tets(TetMesh {
        points: Points::F64(points),
        tets: kept.into(),
        file_from_tet,
        arrays: Vec::new(),
        counts: CellCounts::default(),
    })
    .unwrap()
}

fn random_mesh(cells: u64) -> TetMesh {
    delaunay(&Settings { cells, seed: 3, ..Settings::default() }).unwrap()
}

/// Parts of Delaunay meshes, which have an order from everywhere, and grids.
fn meshes() -> Vec<(&'static str, Dataset)> {
    let jittered = tets(&Settings { cells: 3000, jitter: 0.2, ..Settings::default() }).unwrap();
    let mut random = Random::new(9);
    let mut holes = Random::new(4);
    let holes: Vec<(DVec3, f64)> = (0..20).map(|_| (holes.point(), 0.15 + 0.15 * holes.unit())).collect();
    vec![
        ("convex", part(&random_mesh(3000), |_| true)),
        ("cavity", part(&random_mesh(3000), |p| p.length() > 0.6)),
        ("two parts", part(&random_mesh(3000), |p| (p.x + 0.4 * p.y).abs() > 0.3)),
        ("holes", part(&random_mesh(6000), |p| holes.iter().all(|&(center, radius)| p.distance(center) > radius))),
        ("one cell", random_cells(1, 0.5, &mut random)),
        ("jittered grid", part(&jittered, |p| p.length() > 0.5)),
    ]
}

struct Ordered {
    topological: Topological,
    layers: Layers,
    vertices: Vec<SceneVertex>,
    adjacency: Adjacency,
}

fn order(dataset: &Dataset, view: &View) -> Ordered {
    let vertices = scene_vertices(dataset, &dataset.homogeneous_field());
    let (adjacency, mut topological) = (Adjacency::new(dataset), Topological::default());
    let layers = topological.order(dataset, &adjacency, &vertices, view);
    Ordered { topological, layers, vertices, adjacency }
}

/// Cell before cell, across faces and the open.
fn before_and_after(dataset: &Dataset, ordered: &Ordered, view: &View) -> Vec<(u32, u32)> {
    let mut related: Vec<(u32, u32)> =
        ordered.topological.relations.iter().map(|&r| (graph::nearer(r), graph::farther(r))).collect();
    for pair in neighbours(dataset, (0..dataset.cells() as u32).into_par_iter()) {
        let corner = |v: u32| Vec3::from_array(ordered.vertices[v as usize].position).as_dvec3();
        let sides = || pair.triangles.iter().map(|triangle| side_of_eye(triangle.map(corner), Toward::new(view)));
        match (sides().any(|side| side > 0.0), sides().any(|side| side < 0.0)) {
            (true, false) => related.push((pair.ahead, pair.behind)),
            (false, true) => related.push((pair.behind, pair.ahead)),
            _ => {}
        }
    }
    related
}

/// The layers by Bellman and Ford's longest ways; none where there is a cycle.
fn slow_layers(cells: usize, related: &[(u32, u32)]) -> Option<Vec<u32>> {
    let mut layers = vec![0; cells];
    for _ in 0..=cells {
        let mut has_changed = false;
        for &(nearer, farther) in related {
            if layers[farther as usize] <= layers[nearer as usize] {
                layers[farther as usize] = layers[nearer as usize] + 1;
                has_changed = true;
            }
        }
        if !has_changed {
            return Some(layers);
        }
    }
    None
}

/// Entry, exit and cell of all cells on the ray of a pixel, nearest first.
fn along_ray(dataset: &Dataset, vertices: &[SceneVertex], view: &View, [x, y]: [u32; 2]) -> Vec<(f64, f64, u32)> {
    let ray = ray(view, f64::from(x), f64::from(y));
    let mut met: Vec<(f64, f64, u32)> = (0..dataset.tets.len())
        .map(|cell| (depths_in_cell(view, ray, corners(dataset, vertices, cell)), cell as u32))
        .map(|((enter, leave), cell)| (enter, leave, cell))
        .filter(|(enter, leave, _)| enter < leave)
        .collect();
    met.sort_by(|a, b| a.0.total_cmp(&b.0));
    met
}

#[test]
fn layers_are_longest_ways_and_every_ray_meets_them_in_order() {
    for (name, mesh) in meshes() {
        for (i, view) in views(&mesh, 48, 40).iter().enumerate() {
            let ordered = order(&mesh, view);
            let layer_from_cell = ordered.topological.layer_from_cell();
            println!("{name}, view {i}: {:?} of {} cells", ordered.layers, mesh.tets.len());
            assert_eq!(ordered.layers.cycles, 0, "{name}, view {i}");
            assert_eq!(ordered.layers.relations > 0, !["convex", "one cell"].contains(&name), "{name}, view {i}");
            let related = before_and_after(&mesh, &ordered, view);
            assert!(slow_layers(mesh.tets.len(), &related).unwrap() == layer_from_cell, "{name}, view {i}");

            let mut pairs: Vec<_> = layer_from_cell.iter().zip(0..).map(|(&layer, cell)| pair(layer, cell)).collect();
            pairs.sort_unstable();
            let check = check_order(&mesh, &ordered.vertices, view, &pairs);
            assert!(check.misordered == 0 && (check.pairs > 1000 || name == "one cell"), "{name}, view {i}: {check:?}");

            let mut met = 0;
            for pixel in (0..48 * 40).map(|i| [i % 48, i / 48]) {
                let cells = along_ray(&mesh, &ordered.vertices, view, pixel);
                met += cells.len();
                for two in cells.windows(2) {
                    // What a ray meets for less than rounding has no place in it.
                    if two.iter().all(|(enter, leave, _)| leave - enter > 1e-9) {
                        let [near, far] = [two[0], two[1]].map(|(.., cell)| layer_from_cell[cell as usize]);
                        assert!(near < far, "{name}, view {i}, {pixel:?}: {two:?} in layers {near}, {far}");
                    }
                }
            }
            assert!(met > 20, "{name}, view {i}: {met}");
        }
    }
}

#[test]
fn relations_are_those_of_cells_that_follow_each_other_across_the_open() {
    for (name, mesh) in meshes() {
        for (i, view) in views(&mesh, 70, 50).iter().enumerate() {
            let ordered = order(&mesh, view);
            let found: BTreeSet<(u32, u32)> =
                ordered.topological.relations.iter().map(|&r| (graph::nearer(r), graph::farther(r))).collect();
            let (mut sure, mut possible) = (BTreeSet::new(), BTreeSet::new());
            for pixel in (0..70 * 50).map(|i| [i % 70, i / 70]) {
                let cells = along_ray(&mesh, &ordered.vertices, view, pixel);
                for two in cells.windows(2) {
                    let related = (two[0].2, two[1].2);
                    let is_neighbour = ordered.adjacency.neighbours_from_tet()[related.0 as usize].contains(&related.1);
                    let gap = two[1].0 - two[0].1;
                    possible.insert(related);
                    if !is_neighbour && gap > 1e-4 {
                        sure.insert(related);
                    }
                }
            }
            assert!(sure.is_subset(&found), "{name}, view {i}: {:?}", sure.difference(&found));
            assert!(found.is_subset(&possible), "{name}, view {i}: {:?}", found.difference(&possible));
        }
    }
}

#[test]
fn any_number_of_threads_finds_the_same_order_and_the_memory_of_the_last_view_does_not_show() {
    for (name, mesh) in meshes() {
        let mut kept = Topological::default();
        for (i, view) in views(&mesh, 100, 80).iter().enumerate() {
            let expected = order(&mesh, view);
            for threads in [1, 2, 5] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let layers = pool.install(|| kept.order(&mesh, &expected.adjacency, &expected.vertices, view));
                assert_eq!(layers, expected.layers, "{name}, view {i}, {threads} threads");
                assert!(kept.layer_from_cell() == expected.topological.layer_from_cell());
            }
        }
    }
}

#[test]
fn what_waits_for_itself_is_let_go_once_a_cycle_and_the_rest_stays_in_order() {
    // Random cells overlap and hide each other in every way.
    for cells in [30, 200, 800] {
        let mesh = random_cells(cells, 0.3, &mut Random::new(u64::from(cells)));
        for (i, view) in views(&mesh, 64, 64).iter().enumerate() {
            let ordered = order(&mesh, view);
            let Layers { cycles, relations, .. } = ordered.layers;
            println!("{cells} cells, view {i}: {:?}", ordered.layers);
            let layer_from_cell = ordered.topological.layer_from_cell();
            assert!(layer_from_cell.iter().all(|&layer| layer < ordered.layers.layers));
            // Relations are those that were kept: they have an order, and it is this one.
            let kept = before_and_after(&mesh, &ordered, view);
            assert!(slow_layers(mesh.tets.len(), &kept).unwrap() == layer_from_cell);
            assert!((kept.len() as u64) <= relations && (kept.len() as u64 == relations) == (cycles == 0));
            let heads: HashSet<u32> = kept.iter().map(|&(_, farther)| farther).collect();
            assert!(cycles <= mesh.tets.len() as u64 && !heads.is_empty());
            assert!(cells < 200 || cycles > 0, "cells that overlap at random have cycles");
        }
    }
}

#[test]
fn events_as_near_as_rounding_stand_as_cells_follow_each_other() {
    let mut ray = exterior::Ray::default();
    let mut related = |events: &[(f64, u32, bool)]| {
        let mut events: Vec<exterior::Event> =
            events.iter().map(|&(v, cell, is_exit)| exterior::Event { v, pixel: 0, cell, is_exit }).collect();
        ray.relate(&mut events, true);
        ray.relations.iter().map(|&r| (graph::nearer(r), graph::farther(r))).collect::<Vec<_>>()
    };
    // Two cells that touch, the second entered a rounding error before the first is left; a third across the open.
    let touching =
        [(2.0, 0, false), (1.0, 0, true), (1.0 + 1e-9, 1, false), (0.5, 1, true), (0.4, 2, false), (0.3, 2, true)];
    assert_eq!(related(&touching), [(0, 1), (1, 2)]);
    // From inside the first.
    assert_eq!(related(&touching[1..]), [(0, 1), (1, 2)]);
    assert_eq!(related(&[(1.0, 0, true), (1.0 + 1e-9, 1, false), (0.5, 1, true)]), [(0, 1)]);
    // At an outline the exit is rounded before the entry: nothing follows.
    assert_eq!(related(&[(1.0 + 1e-9, 0, true), (1.0, 1, false)]), []);
    // Cells that overlap: both come after what was left before.
    let overlapping =
        [(3.0, 0, false), (2.5, 0, true), (2.0, 1, false), (1.5, 2, false), (1.0, 1, true), (0.5, 2, true)];
    assert_eq!(related(&overlapping), [(0, 1), (0, 2)]);
}
