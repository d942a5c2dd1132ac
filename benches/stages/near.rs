//! `stage/near`: cells cut at the near plane.

use std::hint::black_box;

use cellfan::generate::Kind;
use cellfan::stages::near::{Corner, cut};
use criterion::Criterion;
use glam::Vec3;

use crate::seen::{Seen, throughput};

pub(crate) fn bench_near(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Delaunay);
    // A plane through the middle of the mesh, and the cells that lie across it.
    let near = seen.screen.iter().map(|vertex| vertex.depth).sum::<f32>() / seen.screen.len() as f32;
    let corner = |v: u32| {
        let (vertex, depth) = (seen.vertices[v as usize], seen.screen[v as usize].depth);
        Corner { position: Vec3::from_array(vertex.position), scalar: vertex.scalar, depth }
    };
    let is_across = |corners: &[Corner; 4]| {
        corners.iter().any(|corner| corner.depth < near) && corners.iter().any(|corner| corner.depth >= near)
    };
    let cells: Vec<[Corner; 4]> = seen.mesh.dataset.tets.iter().map(|tet| tet.map(corner)).filter(is_across).collect();
    assert!(cells.len() > 1000, "{} cells lie across the plane", cells.len());

    let mut group = criterion.benchmark_group("stage/near");
    throughput(&mut group, cells.len() as u64, 4 * size_of::<[Corner; 4]>());
    let empty = Corner { position: Vec3::ZERO, scalar: 0.0, depth: 0.0 };
    let mut parts = [[empty; 4]; 3];
    group.bench_function("cut", |b| {
        b.iter(|| cells.iter().map(|cell| cut(black_box(*cell), near, &mut parts)).sum::<usize>());
    });
    // What is left lies behind the plane and is less than the cell.
    let volume = |[a, b, c, d]: [Vec3; 4]| {
        let [a, b, c, d] = [a, b, c, d].map(Vec3::as_dvec3);
        (b - a).cross(c - a).dot(d - a).abs()
    };
    for cell in &cells {
        let count = cut(*cell, near, &mut parts);
        let kept: f64 = parts[..count].iter().map(|part| volume(part.map(|corner| corner.position))).sum();
        assert!(parts[..count].iter().flatten().all(|corner| corner.depth >= near));
        assert!(count >= 1 && kept <= volume(cell.map(|corner| corner.position)) * 1.001 + 1e-12);
    }
}
