//! `stage/fans`: tetrahedra as a rasteriser takes them.

use cellfan::generate::Kind;
use cellfan::stages::ScreenVertex;
use cellfan::stages::fans::{self, Faces, Fan, FanInput, FanStyle, PlanesFor};
use criterion::Criterion;

use crate::seen::{Seen, throughput};

/// Tetrahedra like this; there are no other cells.
fn style(planes_for: PlanesFor) -> FanStyle {
    FanStyle { planes_for, faces: Faces::Exact }
}

pub(crate) fn bench_fans(criterion: &mut Criterion) {
    let seen = Seen::new(Kind::Delaunay);
    let input =
        FanInput::new(&seen.view, &seen.mesh.dataset, &seen.vertices, &seen.screen, None, style(PlanesFor::NearCells));
    let cells: Vec<u32> = (0..seen.cells() as u32).collect();
    let mut group = criterion.benchmark_group("stage/fans");
    let mut memory = vec![Fan::default(); fans::count(&input, &cells)];
    throughput(&mut group, seen.cells(), 16 + 4 * size_of::<ScreenVertex>() + size_of::<Fan>());
    let mut stage = || fans::write(&input, &cells, &mut &mut memory[..]);
    stage();
    group.bench_function("write", |b| b.iter(&mut stage));
    let planes =
        FanInput::new(&seen.view, &seen.mesh.dataset, &seen.vertices, &seen.screen, None, style(PlanesFor::AllCells));
    let mut as_planes = memory.clone();
    let mut stage = || fans::write(&planes, &cells, &mut &mut as_planes[..]);
    stage();
    group.bench_function("planes", |b| b.iter(&mut stage));
    // Their values are told from those of fans by a range that runs down; slivers have fans.
    let is_planes = |fan: &&Fan| fan.s_range[0] > fan.s_range[1];
    let share = as_planes.iter().filter(is_planes).count() as f64 / cells.len() as f64;
    assert!(share > 0.9, "{share} of the cells are planes");

    // Each ray that enters leaves once: fans cover half the area of the projected faces.
    let area = |[a, b, c]: [glam::Vec2; 3]| 0.5 * f64::from((b - a).perp_dot(c - a).abs());
    let xy = |fan: &Fan, i: u16| glam::Vec2::from_array(fan.vertex(i).0);
    let of_fan = |fan: &Fan| Fan::TRIANGLES.map(|triangle| area(triangle.map(|i| xy(fan, i)))).iter().sum::<f64>();
    let of_fans: f64 = memory.iter().map(of_fan).sum();
    let faces: f64 = seen
        .mesh
        .dataset
        .tets
        .iter()
        .map(|tet| {
            let [a, b, c, d] = tet.map(|v| seen.screen[v as usize].xy());
            0.5 * [[b, c, d], [a, c, d], [a, b, d], [a, b, c]].map(area).iter().sum::<f64>()
        })
        .sum();
    assert!((of_fans / faces - 1.0).abs() < 1e-4, "fans cover {of_fans} px², half the faces {faces}");
}
