//! Hexahedra: classified, as triangles, and as footprints.

use std::hint::black_box;

use cellfan::columns::BlockCells;
use cellfan::stages::classify::polyhedra::{Placed, Projection};
use cellfan::stages::fans::polyhedra::{CellFans, ProjectedCorner};
use cellfan::stages::footprints::hexahedra::HexFootprint;
use cellfan::stages::footprints::planes::TileRays;
use cellfan::stages::project::{project, scene_vertices};
use cellfan::stages::{SceneVertex, View};
use glam::Vec2;
use rayon::prelude::*;

use super::{Bench, Stage};
use crate::cli::bench::curvilinear::half_ball;
use crate::cli::bench::frames::camera;
use crate::cli::bench::hexahedra::Classified;
use crate::cli::bench::{Outcome, ensure};

/// Cells that a thread takes at a time.
const CHUNK: usize = 1 << 12;

pub(super) fn run(bench: &mut Bench, cells: u64, side: u32) -> Outcome {
    let dataset = half_ball(cells)?.into_whole_dataset()?;
    let view = View::new(&camera(&dataset, [side; 2], 0.0), &dataset)?;
    let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
    let mut screen = Vec::new();
    project(&view, &vertices, &mut screen);
    let Some(classified) = Classified::new(&dataset, &view, &screen) else { return Ok(()) };
    let corners = &classified.corners;
    let expected = classified.whole().count();
    let ratio = classified.covered_ratio();
    ensure((ratio - 1.0).abs() < 1e-4, || format!("fans/hexahedra cover {ratio} times half the area of the faces"))?;

    let whole_of = |corners: &[[ProjectedCorner; 8]]| {
        let is_whole = |corners: &&_| matches!(classified.classify(corners), Projection::Whole(_));
        black_box(corners).iter().filter(is_whole).count()
    };
    let classify = |whole: &mut usize| *whole = corners.par_chunks(CHUNK).map(whole_of).sum();
    let check = |whole: &usize| ensure(*whole == expected, || format!("{whole} whole hexahedra, not {expected}"));
    let bytes = 8 * size_of::<Vec2>();
    bench.stage(Stage::of_cells("classify/hexahedra", corners.len() as u64, bytes), 0, |_| {}, classify, check)?;

    let placed: Vec<_> = classified.whole().collect();
    let fans = |triangles: &mut usize| {
        let of = |(corners, placed): &(&[ProjectedCorner; 8], Placed)| {
            black_box(CellFans::new(placed, *corners, 0)).triangles.len()
        };
        *triangles = placed.par_iter().with_min_len(CHUNK).map(of).sum();
    };
    let triangles: usize = placed.iter().map(|(_, placed)| placed.case.triangles.len()).sum();
    let check = |found: &usize| ensure(*found == triangles, || format!("{found} triangles, not {triangles}"));
    let bytes = 8 * size_of::<ProjectedCorner>() + size_of::<CellFans>();
    bench.stage(Stage::of_cells("fans/hexahedra", placed.len() as u64, bytes), 0, |_| {}, fans, check)?;

    let rays = TileRays::new(&view, side / 2, side / 2, 32);
    let footprints = |sums: &mut Vec<f64>| {
        sums.par_iter_mut().enumerate().for_each(|(block, sum)| {
            *sum = 0.0;
            let BlockCells::Hexahedra(cells) = dataset.block(block).cells else { return };
            let mut footprint = HexFootprint::default();
            for cell in (0..cells.len()).filter(|&cell| !cells.shape(cell).is_absent()) {
                black_box(&mut footprint).set_up(&rays, (cells.get(cell), cells.shape(cell)), &vertices, None);
                *sum += f64::from(footprint.v_max);
            }
        });
    };
    let hexahedra = dataset.hexahedra.view();
    let nearest = |cell: usize| {
        let depths = hexahedra.get(cell).map(|v| f64::from(screen[v as usize].depth));
        1.0 / depths.into_iter().fold(f64::INFINITY, f64::min)
    };
    let present = (0..hexahedra.len()).filter(|&cell| !hexahedra.shape(cell).is_absent());
    let expected: f64 = present.map(nearest).sum();
    let check = |sums: &Vec<f64>| {
        let sum: f64 = sums.iter().sum();
        ensure((sum / expected - 1.0).abs() < 1e-5, || format!("footprints/hexahedra: {sum} is not {expected}"))
    };
    let bytes = 8 * size_of::<SceneVertex>() + size_of::<HexFootprint>();
    let memory = vec![0.0; dataset.blocks.len()];
    bench.stage(Stage::of_cells("footprints/hexahedra", corners.len() as u64, bytes), memory, |_| {}, footprints, check)
}
