//! `stage/sort`: what looks at an order or chooses one: `check`, `delaunay`, `overlaps`. All threads.

use std::hint::black_box;

use cellfan::Dataset;
use cellfan::generate::Kind;
use cellfan::stages::sort::adjacency::Adjacency;
use cellfan::stages::sort::check::check_order;
use cellfan::stages::sort::delaunay::delaunay_share;
use cellfan::stages::sort::overlaps::overlapping_faces;
use cellfan::stages::sort::radix::{Pair, pair};
use cellfan::stages::sort::{KeyMaker, SortKey};
use criterion::Criterion;

use crate::boxes::{block_of_boxes, listed_boxes};
use crate::seen::{Seen, all_cells, throughput};

pub(crate) fn bench_order(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Delaunay);
    let dataset = &seen.mesh.dataset;
    let mut group = criterion.benchmark_group("stage/sort");
    group.sample_size(10);

    let order_by = |key: SortKey| {
        let (maker, mut keys) = (KeyMaker::new(key, &seen.view, &[]), Vec::new());
        seen.each_block(&all_cells(), |block, cells| maker.keys(block, &seen.vertices, cells, &mut keys));
        let mut order: Vec<Pair> = keys.into_iter().zip(0..).map(|(key, cell)| pair(key, cell)).collect();
        order.sort_unstable();
        order
    };
    let order = order_by(SortKey::Power);
    // A face's name and side, four a cell, sorted.
    throughput(&mut group, seen.cells(), 16 + 4 * 24);
    let check = |order: &[Pair]| check_order(dataset, &seen.vertices, &seen.view, order);
    group.bench_function("check", |b| b.iter(|| check(black_box(&order))));
    let (power, centroid) = (check(&order), check(&order_by(SortKey::Centroid)));
    assert!(power.pairs > seen.cells() && power.misordered * 1000 < power.pairs, "{power:?}");
    assert!(centroid.misordered * 20 > centroid.pairs, "{centroid:?}");

    group.bench_function("delaunay", |b| b.iter(|| delaunay_share(black_box(dataset))));
    assert!(delaunay_share(dataset) > 0.999_999);

    let boxes = Dataset::from_cells(listed_boxes(&block_of_boxes())).expect("the boxes are valid");
    let adjacency = Adjacency::new(&boxes);
    // Exterior faces alone: two triangles each.
    throughput(&mut group, adjacency.exterior().len() as u64, 2 * 36);
    group.bench_function("overlaps", |b| b.iter(|| overlapping_faces(black_box(&boxes), &adjacency)));
    assert_eq!(overlapping_faces(&boxes, &adjacency), 0);
}
