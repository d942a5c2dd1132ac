use std::collections::HashMap;

use glam::DVec3;

use super::*;
use crate::columns::{CellCounts, CellMesh, Dataset, Points, StructuredCells};
use crate::generate::{Settings, tets};
use crate::stages::scene_per_world;
use crate::stages::sort::adjacency::Adjacency;

fn surface_of(dataset: &Dataset) -> List {
    surface(dataset, Adjacency::new(dataset).exterior())
}

/// Edges along which more triangles run one way than the other: none of a closed surface.
fn open_edges(list: &List) -> usize {
    let key = |p: [f32; 3]| p.map(f32::to_bits);
    let mut edges: HashMap<_, i32> = HashMap::new();
    for corners in list.corners().chunks(3) {
        for i in 0..3 {
            let (a, b) = (key(corners[i]), key(corners[(i + 1) % 3]));
            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
    }
    edges.values().filter(|&&sum| sum != 0).count()
}

/// The volume within a surface that is seen from outside, in world units.
fn volume_world(list: &List, dataset: &Dataset) -> f64 {
    let at = |p: [f32; 3]| DVec3::from_array(p.map(f64::from)) / scene_per_world(dataset);
    let of = |corners: &[[f32; 3]]| at(corners[0]).dot(at(corners[1]).cross(at(corners[2]))) / 6.0;
    list.corners().chunks(3).map(of).sum()
}

fn assert_encloses_all_cells(what: &str, dataset: &Dataset) {
    let list = surface_of(dataset);
    assert_eq!(open_edges(&list), 0, "{what}: the surface is open");
    let cells: f64 = (0..dataset.cells()).map(|cell| dataset.volume_world(cell)).sum();
    let within = volume_world(&list, dataset);
    assert!((within - cells).abs() < 1e-5 * cells, "{what}: {within}, not {cells}");
}

/// Points of a grid of n cells each way, and the corners of its cells.
fn grid(n: u32, place: impl Fn(DVec3) -> DVec3) -> (Vec<[f64; 3]>, Vec<[u32; 8]>) {
    let side = n + 1;
    let index = |i: u32, j: u32, k: u32| i + side * (j + side * k);
    let all = |n: u32| (0..n).flat_map(move |k| (0..n).flat_map(move |j| (0..n).map(move |i| [i, j, k])));
    let points = all(side).map(|ijk| place(DVec3::from_array(ijk.map(f64::from)) / f64::from(n)).to_array()).collect();
    let around = |i, j, k| [index(i, j, k), index(i + 1, j, k), index(i + 1, j + 1, k), index(i, j + 1, k)];
    let cells = all(n).map(|[i, j, k]| {
        let ([a, b, c, d], [e, f, g, h]) = (around(i, j, k), around(i, j, k + 1));
        [a, b, c, d, e, f, g, h]
    });
    (points, cells.collect())
}

fn listed(points: Vec<[f64; 3]>, tets: Vec<[u32; 4]>, hexahedra: Vec<[u32; 8]>) -> Dataset {
    let (of_tets, all) = (tets.len() as u32, (tets.len() + hexahedra.len()) as u32);
    Dataset::from_cells(CellMesh {
        points: Points::F64(points),
        tets: tets.into(),
        file_from_tet: (0..of_tets).collect(),
        hexahedra: hexahedra.into(),
        file_from_hexahedron: (of_tets..all).collect(),
        arrays: Vec::new(),
        counts: CellCounts::default(),
        ..CellMesh::empty()
    })
    .unwrap()
}

#[test]
fn the_surface_of_tetrahedra_encloses_them_and_has_no_inner_face() {
    for cells in [1, 6, 48, 3000] {
        let mesh = tets(&Settings { cells, jitter: 0.2, seed: 3, ..Settings::default() }).unwrap();
        let dataset = Dataset::from_tets(mesh).unwrap();
        assert_encloses_all_cells(&format!("{cells} tetrahedra"), &dataset);
    }
}

#[test]
fn the_surface_of_hexahedra_is_cut_along_their_diagonals() {
    // Faces are warped: another diagonal would enclose another volume.
    let warped = |p: DVec3| p + DVec3::new(p.y * p.z, p.z * p.x * p.x, p.x * p.y) * 0.2;
    let (points, cells) = grid(3, warped);
    let dataset = listed(points, Vec::new(), cells);
    assert_encloses_all_cells("hexahedra", &dataset);
    assert_eq!(surface_of(&dataset).len(), 6 * 9 * 2);
}

#[test]
fn edges_and_points_of_hexahedra_leave_out_diagonals_and_count_a_place_once() {
    let (points, cells) = grid(3, |p| p);
    let count = |list: List| list.len();
    let dataset = listed(points.clone(), Vec::new(), cells.clone());
    // Three directions of 3 · 4 · 4 edges.
    assert_eq!((count(edges(&dataset)), count(super::points(&dataset))), (3 * 3 * 16, 64));
    // Each cell with points of its own, and one point that no cell uses.
    let own: Vec<[f64; 3]> = cells.iter().flatten().map(|&v| points[v as usize]).chain([[9.0; 3]]).collect();
    let own_cells = (0..cells.len() as u32).map(|cell| [0, 1, 2, 3, 4, 5, 6, 7].map(|i| 8 * cell + i)).collect();
    let dataset = listed(own, Vec::new(), own_cells);
    assert_eq!((count(edges(&dataset)), count(super::points(&dataset))), (3 * 3 * 16, 64));
    assert_eq!(count(surface_of(&dataset)), 6 * 9 * 2);
}

#[test]
fn wedges_and_pyramids_have_their_own_edges_and_sides() {
    // A wedge: 9 edges, two triangles and three faces of four corners. On it a tetrahedron that shares its top.
    let points = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [0.2, 0.2, 1.7],
    ];
    let wedge = [0, 1, 2, 2, 3, 4, 5, 5];
    let alone = listed(points.clone(), Vec::new(), vec![wedge]);
    assert_eq!((edges(&alone).len(), surface_of(&alone).len(), super::points(&alone).len()), (9, 2 + 3 * 2, 6));
    let both = listed(points, vec![[3, 4, 5, 6]], vec![wedge]);
    assert_eq!((edges(&both).len(), surface_of(&both).len(), super::points(&both).len()), (12, 1 + 3 * 2 + 3, 7));
    assert_encloses_all_cells("a wedge and a tetrahedron", &both);
}

#[test]
fn blocks_that_touch_and_grids_that_close_have_no_wall_inside() {
    // A ring of eight cells around, two along, one out, closed upon itself: seen as 9 points around.
    let around = |i: usize| std::f64::consts::TAU * (i % 8) as f64 / 8.0;
    let ring = |first_k: usize| {
        let at = move |i: usize, j: usize, k: usize| {
            let radius = 1.0 + j as f64;
            [radius * around(i).cos(), radius * around(i).sin(), (first_k + k) as f64]
        };
        (0..2).flat_map(move |k| (0..2).flat_map(move |j| (0..9).map(move |i| at(i, j, k))))
    };
    let points: Vec<[f64; 3]> = ring(0).chain(ring(1)).collect();
    let dataset = Dataset::from_structured(StructuredCells {
        points: Points::F64(points),
        dims: vec![[9, 2, 2]; 2],
        hidden: (0..2 * 8).map(|_| false).collect(),
        arrays: Vec::new(),
        counts: CellCounts::default(),
    })
    .unwrap();
    let list = surface_of(&dataset);
    // Inside and outside 8 · 2 faces each, top and bottom 8 each.
    assert_eq!(list.len(), 2 * (2 * 16 + 2 * 8));
    assert_encloses_all_cells("rings", &dataset);
    // Around 8, three layers, two radii; along 8 · 2 · 2; out 8 · 3.
    assert_eq!((edges(&dataset).len(), super::points(&dataset).len()), (8 * 3 * 2 + 32 + 24, 8 * 2 * 3));
}
