//! One stage at a time: `stage/<stage>`, and `optics/integral`; inputs are made outside the timer, where each
//! stage also runs once and its answer is checked.
//!
//! All but `sort` on large inputs, its `topological` and `check`, `composite`, and the building of `hierarchy`, run on one thread. Kernels are timed for the instruction set that the
//! benchmark is compiled for; the CPU backend, and so `composite`, chooses at run time. Bytes are those a stage reads and writes, once each.
//! `cellfan bench stages` measures the same stages on a mesh of any size against the memory's bandwidth.

mod boxes;
mod cells;
mod composite;
mod fans;
mod footprints;
mod hexahedra;
mod hierarchy;
mod integral;
mod near;
mod order;
mod seen;
mod sort;
#[path = "../support/mod.rs"]
mod support;
mod topological;

use criterion::{criterion_group, criterion_main};

criterion_group!(
    benches,
    cells::bench_project,
    cells::bench_cull,
    cells::bench_classify,
    near::bench_near,
    hexahedra::bench_hexahedra,
    hexahedra::bench_footprints,
    hexahedra::bench_whole_fans,
    hierarchy::bench_hierarchy,
    sort::bench_sort,
    order::bench_order,
    topological::bench_topological,
    topological::bench_topological_hexahedra,
    fans::bench_fans,
    footprints::bench_footprints,
    composite::bench_composite,
    integral::bench_integral
);
criterion_main!(benches);
