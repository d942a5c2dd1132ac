use glam::DVec3;

use super::planes::{Batch, Corners, TileRays};
use super::*;
use crate::columns::{CellCounts, Dataset, Points, TetMesh};
use crate::optics::LANES;
use crate::stages::project::{project, scene_vertices};
use crate::stages::testing::{Random, corners, depths_in_cell, random_cells, ray, views};

const SIDE_PX: u32 = 40;

#[test]
fn no_covered_pixel_centre_lies_outside_the_box() {
    for size in [0.02, 0.2, 0.8] {
        let dataset = random_cells(600, size, &mut Random::new(5));
        let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
        for (i, view) in views(&dataset, SIDE_PX, 30).iter().enumerate() {
            let mut screen = Vec::new();
            project(view, &vertices, &mut screen);
            let boxes = PixelBoxes::new(view);
            let (mut covered, mut tested) = (0, 0);
            for (cell, tet) in dataset.tets.iter().enumerate() {
                let found = boxes.of_cell(tet, &vertices, &screen);
                let p = corners(&dataset, &vertices, cell);
                for (x, y) in (0..30).flat_map(|y| (0..SIDE_PX).map(move |x| (x, y))) {
                    let (first, last) = depths_in_cell(view, ray(view, f64::from(x), f64::from(y)), p);
                    let is_inside = found.is_some_and(|area| {
                        (area.x0..area.x1).contains(&(x as u16)) && (area.y0..area.y1).contains(&(y as u16))
                    });
                    assert!(
                        is_inside || first >= last,
                        "size {size}, view {i}: ({x}, {y}) of {p:?} is not in {found:?}"
                    );
                    covered += u32::from(first < last);
                    tested += u32::from(is_inside);
                }
            }
            // The control: boxes are not simply the picture.
            assert!(
                covered > 20 && (size > 0.5 || tested < 600 * 40 * 30 / 2),
                "size {size}, view {i}: {covered} of {tested}"
            );
        }
    }
}

#[test]
fn a_block_that_is_missed_covers_no_pixel() {
    let mut random = Random::new(6);
    let dataset = random_cells(200, 0.3, &mut random);
    let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
    let mut missed = 0;
    for view in &mut views(&dataset, 8, 8) {
        view.far = 1.6;
        let boxes = PixelBoxes::new(view);
        for (cell, tet) in dataset.tets.iter().enumerate() {
            let position = |v: u32| Vec3::from_array(dataset.positions[v as usize]);
            let bounds = tet.iter().fold(Bounds::EMPTY, |bounds, &v| bounds.include(position(v)));
            if boxes.rows_of_bounds(bounds, view).is_none() {
                missed += 1;
                let p = corners(&dataset, &vertices, cell);
                for (x, y) in (0..8).flat_map(|y| (0..8).map(move |x| (f64::from(x), f64::from(y)))) {
                    let (first, last) = depths_in_cell(view, ray(view, x, y), p);
                    assert!(first >= last, "({x}, {y}) of {p:?}");
                }
            }
        }
    }
    assert!(missed > 50, "{missed} of 600");
}

#[test]
fn cells_touch_no_row_that_their_block_does_not() {
    let (mut narrow, mut whole) = (0, 0);
    for (size, near) in [(0.02, 0.0), (0.02, 0.9), (0.3, 0.7)] {
        let dataset = random_cells(900, size, &mut Random::new(9));
        let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
        for view in &mut views(&dataset, 400, 2000) {
            view.near = view.near.max(near);
            let mut screen = Vec::new();
            project(view, &vertices, &mut screen);
            let boxes = PixelBoxes::new(view);
            for run in dataset.tets.iter().collect::<Vec<_>>().chunks(3) {
                let position = |&v: &u32| Vec3::from_array(dataset.positions[v as usize]);
                let bounds = run.iter().flatten().map(position).fold(Bounds::EMPTY, Bounds::include);
                let rows = boxes.rows_of_bounds(bounds, view);
                for area in run.iter().filter_map(|&tet| boxes.of_cell(tet, &vertices, &screen)) {
                    let rows = rows.clone().unwrap_or(0..0);
                    assert!(rows.start <= area.y0 && area.y1 <= rows.end, "{area:?} in {rows:?}");
                }
                let height = rows.map_or(0, |rows| rows.end - rows.start);
                whole += usize::from(height == 2000);
                narrow += usize::from((1..1000).contains(&height));
            }
        }
    }
    assert!(narrow > 100 && whole > 10, "{narrow} {whole}");
}

#[test]
fn boxes_within_a_region_are_the_parts_of_those_of_the_picture() {
    let mut random = Random::new(12);
    let (mut cut, mut missed) = (0, 0);
    for size in [0.02, 0.3] {
        let dataset = random_cells(900, size, &mut random);
        let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
        for view in views(&dataset, 32_768, 20_000) {
            let mut screen = Vec::new();
            project(&view, &vertices, &mut screen);
            let [x, y] = [32_000.0, 19_000.0].map(|side: f64| (random.unit() * side) as u32);
            let region = Region { x0: x, y0: y, x1: x + 768, y1: y + 1000 };
            let whole = PixelBoxes::new(&view);
            let part = whole.within(region);
            for tet in dataset.tets.iter() {
                let bounds = tet
                    .iter()
                    .fold(Bounds::EMPTY, |bounds, &v| bounds.include(Vec3::from_array(dataset.positions[v as usize])));
                let [x0, y0, x1, y1] = <[u32; 4]>::from(region).map(|px| px as u16);
                let of = whole.of_cell(tet, &vertices, &screen).map(|PixelBox { x0: l, x1: r, y0: t, y1: b }| {
                    PixelBox { x0: l.max(x0), x1: r.min(x1), y0: t.max(y0), y1: b.min(y1) }
                });
                let of = of.filter(|area| area.x0 < area.x1 && area.y0 < area.y1);
                assert_eq!(part.of_cell(tet, &vertices, &screen), of);
                let rows = part.rows_of_bounds(bounds, &view);
                missed += usize::from(rows.is_none());
                if let Some(area) = of {
                    cut += 1;
                    let rows = rows.unwrap_or(0..0);
                    assert!(rows.start <= area.y0 && area.y1 <= rows.end && rows.end <= y1, "{area:?} in {rows:?}");
                }
            }
        }
    }
    assert!(cut > 100 && missed > 1000, "{cut} {missed}");
}

/// The planes of a tile's cells, sixteen at a time.
fn batches(dataset: &Dataset, vertices: &[SceneVertex], rays: &TileRays) -> Vec<Batch> {
    let of_chunk = |(chunk, cells): (usize, &[[u32; 4]])| {
        let (mut corners, mut batch) = (Corners::default(), Batch::default());
        for (lane, &tet) in cells.iter().enumerate() {
            corners.set(lane, tet, vertices, dataset.positive.get(chunk * LANES + lane));
        }
        batch.set_up(rays, &corners);
        batch
    };
    dataset.tets.iter().collect::<Vec<_>>().chunks(LANES).enumerate().map(of_chunk).collect()
}

#[test]
fn planes_bound_the_rays_as_in_f64() {
    const TILE: u32 = 32;
    let dataset = random_cells(800, 0.4, &mut Random::new(7));
    let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
    for (i, view) in views(&dataset, 96, 96).iter().enumerate() {
        let (x0, y0) = (32, 32);
        let batches = batches(&dataset, &vertices, &TileRays::new(view, x0, y0, TILE));
        let (mut hits, mut behind, mut worst) = (0, 0, 0.0_f64);
        for cell in 0..dataset.tets.len() {
            let (batch, lane) = (&batches[cell / LANES], cell % LANES);
            let p = corners(&dataset, &vertices, cell);
            // Depths of the corners: behind the eye, or across its plane.
            let crosses = p.iter().any(|corner| (*corner - view.eye).dot(view.forward) < f64::from(view.near));
            for (x, y) in (0..TILE).step_by(3).flat_map(|y| (0..TILE).step_by(3).map(move |x| (x, y))) {
                let (mut enter, mut leave) = (batch.v_max[lane], batch.v_min[lane]);
                for (k, plane) in batch.planes.iter().enumerate() {
                    let v = plane.c[lane] + plane.x[lane] * x as f32 + plane.y[lane] * y as f32;
                    if batch.back_faces[lane] >> k & 1 == 1 { leave = leave.max(v) } else { enter = enter.min(v) }
                }
                let depth = |v: f32| f64::from(if view.is_perspective { 1.0 / v } else { -v });
                let length = if enter > leave { depth(leave) - depth(enter) } else { 0.0 };
                let at = (f64::from(x0 + x), f64::from(y0 + y));
                let (first, last) = depths_in_cell(view, ray(view, at.0, at.1), p);
                worst = worst.max((length - (last - first).max(0.0)).abs());
                hits += u32::from(enter > leave);
                behind += u32::from(crosses && enter > leave);
            }
        }
        println!("view {i}: {hits} hits ({behind} of cells across the eye's plane), largest error {worst:.2e}");
        assert!(hits > 1000, "view {i}: {hits}");
        assert!(i != 1 || behind > 100, "the eye inside must test cells behind it: {behind}");
        assert!(worst < 1e-3, "view {i}: {worst}");
    }
}

#[test]
fn both_cells_at_a_face_compute_the_same_bits() {
    let mut random = Random::new(8);
    for _ in 0..200 {
        let [a, b, c] = [random.point(), random.point(), random.point()];
        let n = (b - a).cross(c - a);
        let middle = (a + b + c) / 3.0;
        let apex = |side: f64, random: &mut Random| {
            middle + n.normalize() * side * (0.2 + random.unit()) + random.point() * 0.1
        };
        let points = [a, b, c, apex(1.0, &mut random), apex(-1.0, &mut random)].map(|p| p.to_array());
        let mesh = TetMesh {
            points: Points::F64(points.to_vec()),
            tets: vec![[3, 2, 1, 0], [1, 4, 0, 2]].into(),
            file_from_tet: vec![0, 1].into(),
            arrays: Vec::new(),
            counts: CellCounts::default(),
        };
        let Ok(dataset) = Dataset::from_tets(mesh) else { continue };
        if dataset.tets.len() < 2 {
            continue;
        }
        let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
        for view in views(&dataset, 64, 64) {
            let batch = &batches(&dataset, &vertices, &TileRays::new(&view, 32, 0, 32))[0];
            let shared = |cell: usize| {
                let own = dataset.tets.get(cell).iter().position(|v| !dataset.tets.get(1 - cell).contains(v)).unwrap();
                let plane = &batch.planes[own];
                let bits = [plane.c[cell], plane.x[cell], plane.y[cell]].map(f32::to_bits);
                (bits, batch.back_faces[cell] >> own & 1)
            };
            let (first, second) = (shared(0), shared(1));
            assert_eq!(first.0, second.0);
            assert_ne!(first.1, second.1, "one enters where the other leaves");
        }
    }
}

#[test]
fn the_scalar_along_a_ray_is_that_of_the_field() {
    let dataset = random_cells(160, 0.5, &mut Random::new(9));
    let mut field = dataset.homogeneous_field();
    field.association = crate::columns::Association::Point;
    let linear = |p: DVec3| 0.3 * p.x - 0.7 * p.y + 0.2 * p.z + 1.0;
    field.values = dataset.positions.iter().map(|&p| linear(Vec3::from_array(p).as_dvec3()) as f32).collect();
    let vertices = scene_vertices(&dataset, &field);
    let mut checked = 0;
    for view in views(&dataset, 64, 64) {
        let batches = batches(&dataset, &vertices, &TileRays::new(&view, 32, 0, 32));
        for cell in 0..dataset.tets.len() {
            let (batch, lane) = (&batches[cell / LANES], cell % LANES);
            let p = corners(&dataset, &vertices, cell);
            if (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]).abs() < 1e-5 {
                continue;
            }
            let (x, y, w) = (7.0, 21.0, 1.5);
            let affine = |a: &planes::Affine| a.c[lane] + a.x[lane] * x + a.y[lane] * y;
            let s = affine(&batch.base) + affine(&batch.slope) * w;
            let (origin, direction) = ray(&view, 32.0 + f64::from(x), f64::from(y));
            let exact = linear((origin + direction * f64::from(w)) * view.world_per_scene);
            assert!((f64::from(s) - exact).abs() < 1e-3, "{s} is not {exact}");
            let values = dataset.tets.get(cell).map(|v| vertices[v as usize].scalar);
            let low = values.into_iter().fold(f32::INFINITY, f32::min);
            let high = values.into_iter().fold(f32::NEG_INFINITY, f32::max);
            assert_eq!([batch.s_min[lane], batch.s_max[lane]].map(f32::to_bits), [low, high].map(f32::to_bits));
            checked += 1;
        }
    }
    assert!(checked > 400, "{checked} of 480");
}
