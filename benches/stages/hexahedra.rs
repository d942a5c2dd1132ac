//! Hexahedra: `stage/classify/hexahedra`, `stage/fans/hexahedra`, `stage/footprints/hexahedra`.

use std::hint::black_box;

use cellfan::Dataset;
use cellfan::cells::HEXAHEDRON;
use cellfan::stages::classify::polyhedra::{Placed, Projection, Projections};
use cellfan::stages::fans::polyhedra::{CellFans, ProjectedCorner};
use cellfan::stages::fans::{self, Faces, Fan, FanInput, FanStyle, HexFan, PlanesFor};
use cellfan::stages::footprints::hexahedra::HexFootprint;
use cellfan::stages::footprints::planes::TileRays;
use cellfan::stages::project::{project, scene_vertices};
use cellfan::stages::{SceneVertex, ScreenVertex, View};
use criterion::Criterion;
use glam::Vec2;

use crate::boxes::{Boxes, block_of_boxes};
use crate::seen::{SIDE_PX, throughput};
use crate::support::framing;

pub(crate) fn bench_hexahedra(criterion: &mut Criterion) {
    let boxes = Boxes::new();
    let cells = boxes.xy.len() as u64;
    let table = Projections::of(&HEXAHEDRON).expect("hexahedra have a table");
    let classify = || boxes.xy.iter().map(|xy| table.classify(black_box(xy), true));
    let whole: Vec<(usize, Placed)> = (0..)
        .zip(classify())
        .filter_map(|(cell, projection)| match projection {
            Projection::Whole(placed) => Some((cell, placed)),
            Projection::EdgeOn | Projection::Split => None,
        })
        .collect();
    assert!(whole.len() as u64 > cells / 4, "{} of {cells} boxes are whole", whole.len());
    let mut by_case = vec![0_u64; table.cases().len()];
    for (_, placed) in &whole {
        by_case[placed.case.index] += 1;
    }
    assert!(by_case.iter().filter(|&&cells| cells > 0).count() >= 3, "{by_case:?}");

    let mut group = criterion.benchmark_group("stage/classify");
    throughput(&mut group, cells, 8 * size_of::<Vec2>());
    group.bench_function("hexahedra", |b| {
        b.iter(|| classify().filter(|projection| matches!(projection, Projection::Whole(_))).count());
    });
    group.finish();

    let mut group = criterion.benchmark_group("stage/fans");
    throughput(&mut group, whole.len() as u64, 8 * size_of::<ProjectedCorner>() + size_of::<CellFans>());
    let fans = || whole.iter().map(|(cell, placed)| CellFans::new(black_box(placed), &boxes.corners[*cell], 0));
    group.bench_function("hexahedra", |b| b.iter(|| fans().for_each(|fans| drop(black_box(fans)))));
    group.finish();

    // Each ray that enters leaves once: the triangles of a cell cover half the area of its projected faces.
    let area = |polygon: &[Vec2]| {
        let from = |p: Vec2| (p - polygon[0]).as_dvec2();
        0.5 * polygon[1..].windows(2).map(|side| from(side[0]).perp_dot(from(side[1]))).sum::<f64>().abs()
    };
    for ((cell, _), fans) in whole.iter().zip(fans()) {
        let at = |vertex: u8| Vec2::from_array(fans.vertices[usize::from(vertex)].position_px);
        let of_fans: f64 = fans.triangles.iter().map(|triangle| area(&triangle.map(at))).sum();
        let corner = |corner: &u8| boxes.xy[*cell][usize::from(*corner)];
        let faces = HEXAHEDRON.faces.iter().map(|face| area(&face.iter().map(corner).collect::<Vec<_>>()));
        let faces: f64 = faces.sum();
        assert!((2.0 * of_fans / faces - 1.0).abs() < 1e-4, "cell {cell}: {of_fans} px², its faces {faces}");
    }
}

/// The boxes in one view.
struct SeenBoxes {
    dataset: Dataset,
    view: View,
    vertices: Vec<SceneVertex>,
    screen: Vec<ScreenVertex>,
}

impl SeenBoxes {
    fn new() -> Self {
        let dataset = Dataset::from_structured(block_of_boxes()).expect("the boxes are valid");
        let camera = framing(&dataset, 0.0, SIDE_PX);
        let view = View::new(&camera, &dataset).expect("the camera is valid");
        let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
        let mut screen = Vec::new();
        project(&view, &vertices, &mut screen);
        Self { dataset, view, vertices, screen }
    }
}

/// Faces as planes, for the tile compositor.
pub(crate) fn bench_footprints(criterion: &mut Criterion) {
    let SeenBoxes { dataset, view, vertices, screen } = SeenBoxes::new();
    let rays = TileRays::new(&view, SIDE_PX / 2, SIDE_PX / 2, 32);
    let cells = dataset.hexahedra.view();
    let mut group = criterion.benchmark_group("stage/footprints");
    throughput(&mut group, cells.len() as u64, 8 * size_of::<SceneVertex>() + size_of::<HexFootprint>());
    let mut footprint = HexFootprint::default();
    let mut stage = || {
        let mut sum = 0.0;
        for cell in 0..cells.len() {
            black_box(&mut footprint).set_up(&rays, (cells.get(cell), cells.shape(cell)), &vertices, None);
            sum += f64::from(footprint.v_max);
        }
        sum
    };
    let sum = stage();
    group.bench_function("hexahedra", |b| b.iter(&mut stage));
    let nearest = |cell| cells.get(cell).map(|v| screen[v as usize].depth).into_iter().fold(f32::INFINITY, f32::min);
    let expected: f64 = (0..cells.len()).map(|cell| 1.0 / f64::from(nearest(cell))).sum();
    assert!((sum / expected - 1.0).abs() < 1e-5, "{sum} is not {expected}");
}

/// Whole cells in the room of fans: by their planes, and by the triangles of their cases.
pub(crate) fn bench_whole_fans(criterion: &mut Criterion) {
    let SeenBoxes { dataset, view, vertices, screen } = SeenBoxes::new();
    let cells: Vec<u32> = (0..dataset.cells() as u32).collect();
    let values = dataset.homogeneous_field();
    let mut group = criterion.benchmark_group("stage/fans");
    for (name, faces) in [("whole/exact", Faces::Exact), ("whole/fan", Faces::Fan)] {
        let style = FanStyle { planes_for: PlanesFor::NoCells, faces };
        let input = FanInput::new(&view, &dataset, &vertices, &screen, Some(&values.values[..]), style);
        let mut memory = vec![Fan::default(); fans::count(&input, &cells)];
        let bytes = 8 * size_of::<ScreenVertex>() + input.contents().fans_per_record() * size_of::<Fan>();
        throughput(&mut group, cells.len() as u64, bytes);
        let mut stage = || fans::write(&input, &cells, &mut &mut memory[..]);
        let by_class = stage();
        group.bench_function(name, |b| b.iter(&mut stage));
        if faces == Faces::Fan {
            // Nearly all boxes have a case.
            assert!(by_class.triangles() > 4 * cells.len() as u64, "{by_class:?}");
        } else {
            assert_eq!(memory.len(), cells.len() * HexFan::FANS);
            assert!(memory.chunks(HexFan::FANS).all(|record| HexFan::of_record(record).is_some()));
        }
    }
}
