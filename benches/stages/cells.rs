//! `stage/project`, `stage/cull`, `stage/classify`: what every cell meets.

use std::hint::black_box;

use cellfan::Model;
use cellfan::generate::Kind;
use cellfan::optics::{CullTable, Pieces};
use cellfan::stages::ScreenVertex;
use cellfan::stages::classify::classify;
use cellfan::stages::cull::{Culled, cull};
use cellfan::stages::project::project;
use criterion::Criterion;

use crate::seen::{SIDE_PX, Seen, rayon_of_one, throughput};
use crate::support::{TRANSPARENT_BELOW, transfer};

pub(crate) fn bench_project(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Tets);
    let pool = rayon_of_one();
    let mut group = criterion.benchmark_group("stage/project");
    throughput(&mut group, seen.vertices.len() as u64, 32);
    let mut screen = Vec::new();
    let mut stage = || pool.install(|| project(&seen.view, black_box(&seen.vertices), &mut screen));
    stage();
    group.bench_function("vertices", |b| b.iter(&mut stage));
    let frame = seen.mesh.camera(0.0, SIDE_PX).frame().expect("the camera is valid");
    for (at, position) in screen.iter().zip(seen.mesh.dataset.positions.iter()).step_by(997) {
        let exact = frame.pixel(glam::Vec3::from_array(*position).as_dvec3() + seen.mesh.dataset.origin);
        assert!((at.xy().as_dvec2() - exact).length() < 1e-3, "{at:?} is not {exact}");
    }
}

pub(crate) fn bench_cull(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Tets);
    let pieces: Pieces = transfer().pieces(seen.mesh.field.offset);
    let table = CullTable::new(&pieces, Model::EmissionAbsorption);
    let mut group = criterion.benchmark_group("stage/cull");
    throughput(&mut group, seen.cells(), 32);
    let mut visible = Vec::new();
    let mut stage = || {
        let (mut transparent, mut shown) = (0, 0);
        for block in seen.blocks() {
            visible.clear();
            let Culled { transparent: dropped, invalid: _ } =
                cull(&block, &seen.mesh.field, &seen.screen, (&pieces, &table), &mut visible);
            transparent += dropped;
            shown += visible.len() as u64;
        }
        (transparent, shown)
    };
    let (transparent, shown) = stage();
    group.bench_function("tets", |b| b.iter(&mut stage));
    let largest = |tet: &[u32; 4]| tet.map(|v| seen.vertices[v as usize].scalar).into_iter().fold(f32::MIN, f32::max);
    let low = seen.mesh.dataset.tets.iter().filter(|tet| f64::from(largest(tet)) < TRANSPARENT_BELOW).count() as u64;
    assert_eq!((transparent, transparent + shown), (low, seen.cells()));
    assert!(low > 0 && shown > 0, "a test of culling needs both kinds of cells");
}

pub(crate) fn bench_classify(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Delaunay);
    let (tets, positive) = (&seen.mesh.dataset.tets, &seen.mesh.dataset.positive);
    let mut group = criterion.benchmark_group("stage/classify");
    throughput(&mut group, seen.cells(), 16 + 4 * size_of::<ScreenVertex>());
    let stage = || {
        let mut by_class = [0_u64; 5];
        for (cell, tet) in tets.iter().enumerate() {
            let xy = tet.map(|v| seen.screen[v as usize].xy());
            by_class[classify(xy, positive.get(cell)).class as usize] += 1;
        }
        by_class
    };
    let by_class = stage();
    group.bench_function("delaunay", |b| b.iter(stage));
    assert_eq!(by_class.iter().sum::<u64>(), seen.cells());
    // Random cells have one inner vertex or a quadrilateral; the others are exceptions.
    assert!(by_class[1] > seen.cells() / 10 && by_class[2] > seen.cells() / 10, "{by_class:?}");
}
