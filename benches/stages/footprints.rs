//! `stage/footprints`: pixel boxes and face planes.

use std::hint::black_box;

use cellfan::generate::Kind;
use cellfan::optics::LANES;
use cellfan::stages::footprints::planes::{Batch, Corners, TileRays};
use cellfan::stages::footprints::{PixelBox, PixelBoxes};
use cellfan::stages::{SceneVertex, ScreenVertex};
use criterion::Criterion;

use crate::seen::{SIDE_PX, Seen, all_cells, throughput};

pub(crate) fn bench_footprints(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Tets);
    let every = all_cells();
    let mut group = criterion.benchmark_group("stage/footprints");
    throughput(&mut group, seen.cells(), 16 + 4 * size_of::<ScreenVertex>() + 12);
    let boxes = PixelBoxes::new(&seen.view);
    let (mut drawn, mut areas): (Vec<u32>, Vec<PixelBox>) = (Vec::new(), Vec::new());
    let mut stage = || {
        drawn.clear();
        areas.clear();
        seen.each_block(&every, |block, cells| {
            boxes.of_cells(block, &seen.vertices, &seen.screen, cells, &mut drawn, &mut areas);
        });
    };
    stage();
    group.bench_function("boxes", |b| b.iter(&mut stage));
    // The mesh is in view and its cells are some pixels wide: all but slivers between pixel centres have a box, and
    // the boxes cover what their cells do, a sixth of it or so.
    assert!(drawn.len() == areas.len() && drawn.len() as u64 > seen.cells() / 2);
    let pixels: f64 = areas.iter().map(|a| f64::from(a.x1 - a.x0) * f64::from(a.y1 - a.y0)).sum();
    let covered: f64 = seen
        .mesh
        .dataset
        .tets
        .iter()
        .map(|tet| {
            let [a, b, c, d] = tet.map(|v| seen.screen[v as usize].xy());
            let area = |a: glam::Vec2, b: glam::Vec2, c: glam::Vec2| f64::from((b - a).perp_dot(c - a).abs());
            0.25 * (area(a, b, c) + area(a, b, d) + area(a, c, d) + area(b, c, d))
        })
        .sum();
    assert!(pixels > covered && pixels < 10.0 * covered, "boxes of {pixels} px for cells of {covered} px");

    let rays = TileRays::new(&seen.view, SIDE_PX / 2, SIDE_PX / 2, 32);
    let dataset = &seen.mesh.dataset;
    let (mut corners, mut batch) = (Corners::<LANES>::default(), Batch::default());
    throughput(&mut group, seen.cells(), 16 + 4 * size_of::<SceneVertex>() + size_of::<Batch>() / LANES);
    let tets: Vec<[u32; 4]> = dataset.tets.iter().collect();
    let mut stage = || {
        let mut sum = 0.0_f64;
        for (chunk, cells) in tets.chunks(LANES).enumerate() {
            for (lane, &tet) in cells.iter().enumerate() {
                corners.set(lane, tet, &seen.vertices, dataset.positive.get(chunk * LANES + lane));
            }
            black_box(&mut batch).set_up(&rays, &corners);
            sum += batch.v_max[..cells.len()].iter().map(|&v| f64::from(v)).sum::<f64>();
        }
        sum
    };
    let sum = stage();
    group.bench_function("planes", |b| b.iter(&mut stage));
    let nearest = |tet: &[u32; 4]| tet.iter().fold(f32::INFINITY, |w, &v| w.min(seen.screen[v as usize].depth));
    let expected: f64 = dataset.tets.iter().map(|tet| 1.0 / f64::from(nearest(&tet))).sum();
    assert!((sum / expected - 1.0).abs() < 1e-5, "{sum} is not {expected}");
}
