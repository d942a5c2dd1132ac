//! What every cell meets on any backend: project, cull, boxes, planes, classes, fans.

use std::hint::black_box;

use cellfan::Model;
use cellfan::optics::{CullTable, Intervals, LANES};
use cellfan::stages::classify::classify;
use cellfan::stages::cull::cull;
use cellfan::stages::fans::{self, Faces, Fan, FanInput, FanStyle, PlanesFor};
use cellfan::stages::footprints::planes::{Batch, Corners, TileRays};
use cellfan::stages::footprints::{PixelBox, PixelBoxes};
use cellfan::stages::project::project;
use cellfan::stages::{SceneVertex, ScreenVertex};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::seen::Seen;
use super::{Bench, Stage};
use crate::cli::bench::{Outcome, ensure};

pub(super) fn run(bench: &mut Bench, seen: &Seen) -> Outcome {
    vertices(bench, seen)?;
    culled(bench, seen)?;
    boxes(bench, seen)?;
    planes(bench, seen)?;
    classes(bench, seen)?;
    fans_of(bench, seen, "fans", PlanesFor::NearCells)?;
    fans_of(bench, seen, "fans/planes", PlanesFor::AllCells)
}

/// Nothing to ready.
fn as_it_is<T>(_: &mut T) {}

/// Four vertices' numbers and records.
const CELL_BYTES: usize = 16 + 4 * size_of::<SceneVertex>();

fn vertices(bench: &mut Bench, seen: &Seen) -> Outcome {
    let bytes = seen.vertices.len() as u64 * (size_of::<SceneVertex>() + size_of::<ScreenVertex>()) as u64;
    let stage = Stage { name: "project", unit: "vertices", units: seen.vertices.len() as u64, bytes };
    let frame = seen.camera.frame()?;
    let tolerance_px = 1e-5 * f64::from(seen.view.size_px[0]);
    let check = |screen: &Vec<ScreenVertex>| {
        screen.iter().zip(seen.dataset.positions.iter()).step_by(997).try_for_each(|(at, &position)| {
            let exact = frame.pixel(Vec3::from_array(position).as_dvec3() + seen.dataset.origin);
            let is_near = (at.xy().as_dvec2() - exact).length() < tolerance_px;
            ensure(is_near, || format!("project: {at:?} is not {exact}"))
        })
    };
    bench.stage(stage, Vec::new(), as_it_is, |screen| project(&seen.view, black_box(&seen.vertices), screen), check)
}

fn culled(bench: &mut Bench, seen: &Seen) -> Outcome {
    let pieces = seen.transfer.pieces(seen.field.offset);
    let intervals: &Intervals = &pieces;
    let table = CullTable::new(&pieces, Model::EmissionAbsorption);
    let work = |visible: &mut Vec<Vec<u32>>| {
        visible.par_iter_mut().enumerate().for_each(|(block, visible)| {
            visible.clear();
            let block = seen.block(block);
            black_box(cull(&block, &seen.field, &seen.screen, (intervals, &table), visible));
        });
    };
    // The slow twin: no value between the smallest and the largest shows.
    let shows = |tet: &[u32; 4]| {
        let values = tet.map(|v| seen.field.values[v as usize]);
        let (low, high) = values.iter().fold((f32::MAX, f32::MIN), |(low, high), &s| (low.min(s), high.max(s)));
        let of = |s: f32| seen.transfer.eval(seen.field.offset + f64::from(s)).extinction > 0.0;
        let between =
            |value: f64| f64::from(low) < value - seen.field.offset && value - seen.field.offset < f64::from(high);
        of(low) || of(high) || seen.transfer.points().iter().any(|point| between(point.value) && point.extinction > 0.0)
    };
    let expected = seen.dataset.tets.iter().filter(shows).count() as f64;
    let check = |visible: &Vec<Vec<u32>>| {
        let found = visible.iter().map(Vec::len).sum::<usize>() as f64;
        // A value at the end of a piece may be rounded into the next.
        let is_right = (found - expected).abs() <= 2e-5 * seen.cells() as f64 + 2.0;
        ensure(is_right && visible.iter().all(|cells| cells.is_sorted()), || {
            format!("cull: {found} cells show, not {expected}")
        })
    };
    bench.stage(Stage::of_cells("cull", seen.cells(), 32), seen.for_each_block(), as_it_is, work, check)
}

fn boxes(bench: &mut Bench, seen: &Seen) -> Outcome {
    let boxes = PixelBoxes::new(&seen.view);
    let every = Seen::cells_of_block();
    let work = |memory: &mut Vec<(Vec<u32>, Vec<PixelBox>)>| {
        memory.par_iter_mut().enumerate().for_each(|(block, (drawn, areas))| {
            drawn.clear();
            areas.clear();
            let block = seen.block(block);
            boxes.of_cells(&block, &seen.vertices, &seen.screen, &every[..block.len()], drawn, areas);
        });
    };
    // Every box that is there holds the cell's projected corners, but for the half pixel at which centres lie.
    let check = |memory: &Vec<(Vec<u32>, Vec<PixelBox>)>| {
        let tets = &seen.dataset.tets;
        memory.iter().zip(&seen.dataset.blocks).try_for_each(|((drawn, areas), block)| {
            drawn.iter().zip(areas).step_by(89).try_for_each(|(&cell, area)| {
                let low = Vec2::new(f32::from(area.x0), f32::from(area.y0)) - 1.01;
                let high = Vec2::new(f32::from(area.x1), f32::from(area.y1)) + 0.01;
                let corners = tets.get(block.cells.start + cell as usize).map(|v| seen.screen[v as usize].xy());
                let is_inside = corners.iter().all(|xy| xy.cmpge(low).all() && xy.cmple(high).all());
                ensure(is_inside, || format!("footprints: {area:?} does not hold {corners:?}"))
            })
        })?;
        let drawn: usize = memory.iter().map(|(drawn, _)| drawn.len()).sum();
        ensure(drawn > 0, || "footprints: no cell has a box".to_owned())
    };
    let bytes = CELL_BYTES + size_of::<u32>() + size_of::<PixelBox>();
    bench.stage(Stage::of_cells("footprints/boxes", seen.cells(), bytes), seen.for_each_block(), as_it_is, work, check)
}

fn planes(bench: &mut Bench, seen: &Seen) -> Outcome {
    let [width, height] = seen.view.size_px;
    let rays = TileRays::new(&seen.view, width / 2, height / 2, 32);
    let work = |sums: &mut Vec<f64>| {
        sums.par_iter_mut().enumerate().for_each(|(block, sum)| {
            let cells = seen.dataset.blocks[block].cells.clone();
            let (mut corners, mut batch) = (Corners::<LANES>::default(), Batch::default());
            *sum = 0.0;
            for first in cells.clone().step_by(LANES) {
                let lanes = (cells.end - first).min(LANES);
                for lane in 0..lanes {
                    let cell = first + lane;
                    let tet = seen.dataset.tets.get(cell);
                    corners.set(lane, tet, &seen.vertices, seen.dataset.positive.get(cell));
                }
                black_box(&mut batch).set_up(&rays, &corners);
                *sum += batch.v_max[..lanes].iter().map(|&v| f64::from(v)).sum::<f64>();
            }
        });
    };
    let nearest = |tet: [u32; 4]| tet.iter().fold(f32::INFINITY, |w, &v| w.min(seen.screen[v as usize].depth));
    let expected: f64 = seen.dataset.tets.iter().map(|tet| 1.0 / f64::from(nearest(tet))).sum();
    let check = |sums: &Vec<f64>| {
        let sum: f64 = sums.iter().sum();
        ensure((sum / expected - 1.0).abs() < 1e-5, || format!("footprints/planes: {sum} is not {expected}"))
    };
    let bytes = CELL_BYTES + size_of::<Batch>() / LANES;
    bench.stage(Stage::of_cells("footprints/planes", seen.cells(), bytes), seen.for_each_block(), as_it_is, work, check)
}

fn classes(bench: &mut Bench, seen: &Seen) -> Outcome {
    let (tets, positive) = (&seen.dataset.tets, &seen.dataset.positive);
    let work = |counts: &mut Vec<[u64; 5]>| {
        counts.par_iter_mut().enumerate().for_each(|(block, counts)| {
            *counts = [0; 5];
            for cell in seen.dataset.blocks[block].cells.clone() {
                let xy = tets.get(cell).map(|v| seen.screen[v as usize].xy());
                counts[classify(xy, positive.get(cell)).class as usize] += 1;
            }
        });
    };
    let check = |counts: &Vec<[u64; 5]>| {
        let of = |class: usize| counts.iter().map(|counts| counts[class]).sum::<u64>();
        let (all, general) = ((0..5).map(of).sum::<u64>(), of(1) + of(2));
        // Random cells have one inner vertex or a quadrilateral; the others are exceptions.
        ensure(all == seen.cells() && general > all - all / 100, || format!("classify: {general} of {all} cells"))
    };
    bench.stage(Stage::of_cells("classify", seen.cells(), CELL_BYTES), seen.for_each_block(), as_it_is, work, check)
}

/// Cells that a thread writes the fans of at a time.
const RUN: usize = 1 << 14;

fn fans_of(bench: &mut Bench, seen: &Seen, name: &'static str, planes_for: PlanesFor) -> Outcome {
    let style = FanStyle { planes_for, faces: Faces::Exact };
    let input = FanInput::new(&seen.view, &seen.dataset, &seen.vertices, &seen.screen, None, style);
    let cells: Vec<u32> = (0..seen.cells() as u32).collect();
    let runs: Vec<Vec<u32>> = cells.chunks(RUN).map(<[u32]>::to_vec).collect();
    let counts: Vec<usize> = runs.iter().map(|run| fans::count(&input, run)).collect();
    let memory = vec![Fan::default(); counts.iter().sum()];
    let work = |memory: &mut Vec<Fan>| {
        black_box(fans::write_runs(&input, &runs, &counts, &mut memory[..]));
    };
    let area = |[a, b, c]: [Vec2; 3]| 0.5 * f64::from((b - a).perp_dot(c - a).abs());
    let of_faces = |tet: [u32; 4]| {
        let [a, b, c, d] = tet.map(|v| seen.screen[v as usize].xy());
        [[b, c, d], [a, c, d], [a, b, d], [a, b, c]].map(area).iter().sum::<f64>()
    };
    let expected = 0.5 * seen.dataset.tets.iter().map(of_faces).sum::<f64>();
    let is_planes = |fan: &&Fan| fan.s_range[0] > fan.s_range[1];
    let check = |memory: &Vec<Fan>| {
        if planes_for == PlanesFor::AllCells {
            // Their values are told from those of fans by a range that runs down; slivers have fans.
            let share = memory.iter().filter(is_planes).count() as f64 / memory.len() as f64;
            return ensure(share > 0.9, || format!("fans/planes: {share} of the cells are planes"));
        }
        // Each ray that enters leaves once: fans cover half the area of the projected faces.
        let xy = |fan: &Fan, i: u16| Vec2::from_array(fan.vertex(i).0);
        let of_fan = |fan: &Fan| Fan::TRIANGLES.map(|triangle| area(triangle.map(|i| xy(fan, i)))).iter().sum::<f64>();
        let covered: f64 = memory.iter().map(of_fan).sum();
        ensure((covered / expected - 1.0).abs() < 1e-4, || format!("fans cover {covered} px², not {expected}"))
    };
    let bytes = CELL_BYTES + size_of::<Fan>();
    bench.stage(Stage::of_cells(name, seen.cells(), bytes), memory, as_it_is, work, check)
}
