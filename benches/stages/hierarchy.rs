//! `stage/hierarchy`: the octree of 256³ bytes, on all threads, and selections from it, on one. Nodes a second are those looked at.

use cellfan::FieldSelection;
use cellfan::columns::GridEye;
use cellfan::generate::{SampleType, Signal, volume};
use cellfan::hierarchy::{Hierarchy, Selection, Shows, WithinError};
use cellfan::optics::{ControlPoint, CullTable, Model, TransferFunction};
use criterion::{Criterion, Throughput};

const SIDE: usize = 256;

pub(crate) fn bench_hierarchy(criterion: &mut Criterion) {
    let volume = volume([SIDE; 3], Signal::Buckyball, SampleType::U8).expect("256³ bytes fit");
    let field = volume.field(&FieldSelection::parse("value", &volume.arrays)).expect("it has values");
    let hierarchy = Hierarchy::new(&field).expect("256 samples a side");
    assert!(hierarchy.levels().len() == 8 && hierarchy.nodes() == (8_u64.pow(9) - 1) / 7);
    let mut group = criterion.benchmark_group("stage/hierarchy");
    group.sample_size(10);
    group.throughput(Throughput::ElementsAndBytes { elements: hierarchy.nodes(), bytes: (SIDE as u64).pow(3) });
    group.bench_function("build", |b| b.iter(|| Hierarchy::new(&field)));

    let point = |value, extinction| ControlPoint { value, color: [1.0; 3], extinction };
    let transfer = TransferFunction::new(vec![point(0.0, 0.0), point(25.0, 0.0), point(255.0, 1.0)]);
    let pieces = transfer.expect("values ascend").pieces(hierarchy.offset());
    let table = CullTable::new(&pieces, Model::EmissionAbsorption);
    let shows = Shows { intervals: &pieces, table: &table };
    let eye = GridEye::At([700.0, 500.0, 300.0].into());
    let mut selection = Selection::default();
    for share in [0.0, 0.18, 0.48] {
        let rule = WithinError(share * 255.0);
        selection.select((&hierarchy, &field), &rule, shows, eye, false);
        let covered: u64 = selection.cubes.iter().map(|cube| 8_u64.pow(cube.level.into())).sum();
        assert_eq!(covered + selection.transparent, (SIDE as u64).pow(3));
        group.throughput(Throughput::ElementsAndBytes { elements: selection.visited, bytes: selection.visited * 12 });
        group.bench_function(format!("select/{share}"), |b| {
            b.iter(|| selection.select((&hierarchy, &field), &rule, shows, eye, false));
        });
    }
}
