//! `stage/sort/topological`: which cells share a face, and the order of the visibility graph.

use std::hint::black_box;

use cellfan::Camera;
use cellfan::columns::{Dataset, Neighbours};
use cellfan::generate::Kind;
use cellfan::stages::View;
use cellfan::stages::project::scene_vertices;
use cellfan::stages::sort::adjacency::Adjacency;
use cellfan::stages::sort::check::check_order;
use cellfan::stages::sort::radix::{Pair, pair};
use cellfan::stages::sort::topological::{Layers, Topological};
use criterion::Criterion;

use crate::boxes::{Boxes, block_of_boxes, listed_boxes};
use crate::seen::{SIDE_PX, Seen, throughput};

pub(crate) fn bench_topological(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Delaunay);
    let dataset = &seen.mesh.dataset;
    let mut group = criterion.benchmark_group("stage/sort/topological");
    group.sample_size(20);
    throughput(&mut group, seen.cells(), 16 + 16);
    group.bench_function("adjacency", |b| b.iter(|| Adjacency::new(black_box(dataset))));
    let adjacency = Adjacency::new(dataset);
    // All faces have two sides but for those of the hull, which are few.
    let sides = adjacency.neighbours_from_tet().iter().flatten().filter(|&&other| other != Adjacency::NONE).count();
    assert!(sides % 2 == 0 && sides + adjacency.exterior().len() == 4 * dataset.tets.len());
    assert!(adjacency.exterior().len() < sides / 10);
    // As from a container: compared with the cells, not made.
    let stored = Dataset { adjacency: Some(Neighbours::new(dataset)), ..dataset.clone() };
    group.bench_function("adjacency/stored", |b| b.iter(|| Adjacency::new(black_box(&stored))));
    assert!(Adjacency::new(&stored).is_stored() && !adjacency.is_stored());

    throughput(&mut group, seen.cells(), 64);
    let mut topological = Topological::default();
    let mut stage = || topological.order(dataset, &adjacency, &seen.vertices, &seen.view);
    let Layers { cycles, layers, .. } = stage();
    group.bench_function("order", |b| b.iter(&mut stage));
    let order = topological.layer_from_cell().iter().zip(0..).map(|(&layer, cell)| pair(layer, cell));
    let mut order: Vec<Pair> = order.collect();
    order.sort_unstable();
    let check = check_order(dataset, &seen.vertices, &seen.view, &order);
    assert_eq!((cycles, check.misordered, order.len() as u64), (0, 0, seen.cells()));
    assert!(layers > 100 && check.pairs > seen.cells());
}

pub(crate) fn bench_topological_hexahedra(criterion: &mut Criterion) {
    let block = block_of_boxes();
    let listed = Dataset::from_cells(listed_boxes(&block)).expect("the boxes are valid");
    let structured = Dataset::from_structured(block).expect("the boxes are valid");
    let mut group = criterion.benchmark_group("stage/sort/topological/hexahedra");
    group.sample_size(20);
    for (name, dataset) in [("listed", &listed), ("block", &structured)] {
        let camera = Camera::framing(&dataset.corners_world(), 30.0, 20.0, SIDE_PX, SIDE_PX);
        let view = View::new(&camera, dataset).expect("the camera is valid");
        let vertices = scene_vertices(dataset, &dataset.homogeneous_field());
        let (cells, stored) = (dataset.cells() as u64, if name == "listed" { 24 } else { 0 });
        throughput(&mut group, cells, 32 + stored);
        group.bench_function(format!("{name}/adjacency"), |b| b.iter(|| Adjacency::new(black_box(dataset))));
        let adjacency = Adjacency::new(dataset);
        assert_eq!(adjacency.exterior().len() as u32, 6 * Boxes::SIDE.pow(2));

        throughput(&mut group, cells, 32 + stored + 16);
        let mut topological = Topological::default();
        let mut stage = || topological.order(dataset, &adjacency, &vertices, &view);
        let Layers { cycles, layers, .. } = stage();
        group.bench_function(format!("{name}/order"), |b| b.iter(&mut stage));
        let order = topological.layer_from_cell().iter().zip(0..).map(|(&layer, cell)| pair(layer, cell));
        let mut order: Vec<Pair> = order.collect();
        order.sort_unstable();
        let check = check_order(dataset, &vertices, &view, &order);
        assert_eq!((cycles, check.misordered), (0, 0));
        assert!(layers > 100 && check.pairs > 2 * cells);
    }
}
