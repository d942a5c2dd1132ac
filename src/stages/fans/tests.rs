use glam::{Vec2, Vec3};

use super::*;
use crate::stages::project::{project, scene_vertices};
use crate::stages::testing::{Random, corners, depths_in_cell, random_cells, ray, views};

const STYLE: FanStyle = FanStyle { planes_for: PlanesFor::NoCells, faces: Faces::Exact };

/// All fans of `dataset`, each with the cell it belongs to.
fn all_fans(dataset: &Dataset, vertices: &[SceneVertex], view: &View) -> Vec<(usize, Fan)> {
    let mut screen = Vec::new();
    project(view, vertices, &mut screen);
    let input = FanInput::new(view, dataset, vertices, &screen, None, STYLE);
    let mut all = Vec::new();
    for cell in 0..dataset.tets.len() as u32 {
        let mut fans = vec![Fan::default(); count(&input, &[cell])];
        let mut slot = &mut fans[..];
        let by_class = write(&input, &[cell], &mut slot);
        assert!(slot.is_empty(), "the count is exact");
        assert_eq!(by_class.cells(), fans.len() as u64);
        all.extend(fans.into_iter().map(|fan| (cell as usize, fan)));
    }
    all
}

/// The sum of the areas of a fan's triangles.
fn area_of_fan(fan: &Fan) -> f64 {
    Fan::TRIANGLES.map(|triangle| area(triangle.map(|i| Vec2::from_array(fan.vertex(i).0)))).iter().sum()
}

fn area([a, b, c]: [Vec2; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(Vec2::as_dvec2);
    0.5 * (b - a).perp_dot(c - a).abs()
}

#[test]
fn a_fan_covers_half_the_area_of_its_cells_projected_faces() {
    let dataset = random_cells(10_000, 0.3, &mut Random::new(2));
    let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
    let [outside, _, parallel] = views(&dataset, 512, 512);
    for view in [outside, parallel] {
        let fans = all_fans(&dataset, &vertices, &view);
        assert!(
            fans.iter().filter(|(_, fan)| *fan == Fan::default()).count() < 10,
            "only cells seen edge-on cover nothing"
        );
        for (cell, fan) in fans {
            let of_fan = area_of_fan(&fan);
            let p = dataset
                .tets
                .get(cell)
                .map(|v| view.projection().project(Vec3::from_array(vertices[v as usize].position)).truncate());
            let faces: f64 = crate::stages::classify::FACES.iter().map(|face| area(face.map(|i| p[i]))).sum();
            let extent = p.iter().flat_map(|a| p.iter().map(move |b| a.distance(*b))).fold(0.0, f32::max);
            // A coordinate is off by some 1e-4 px; that times the extent.
            let allowed = 3e-4 * f64::from(extent) + 1e-6;
            assert!((of_fan - 0.5 * faces).abs() < allowed, "cell {cell}: {of_fan} px², {faces} of its faces");
        }
    }
}

#[test]
fn the_thick_vertex_is_as_thick_as_the_cell_there() {
    let dataset = random_cells(10_000, 0.3, &mut Random::new(3));
    let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
    let [outside, _, parallel] = views(&dataset, 512, 512);
    for view in [outside, parallel] {
        let (mut checked, mut worst) = (0, 0.0_f64);
        for (cell, fan) in all_fans(&dataset, &vertices, &view) {
            let size = area_of_fan(&fan);
            let p = corners(&dataset, &vertices, cell);
            let volume = (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]).abs();
            // Slivers have no sharp thickness: a coordinate's last bit changes it.
            if size < 10.0 || volume < 1e-5 {
                continue;
            }
            let [x, y] = fan.thick_px.map(f64::from);
            let exact = depths_in_cell(&view, ray(&view, x, y), p);
            let depth = |v: f32| f64::from(if view.is_perspective { 1.0 / v } else { -v });
            let (front, back) = (depth(fan.front[0]), depth(fan.back[0]));
            worst = worst.max(((back - front) - (exact.1 - exact.0)).abs());
            checked += 1;
        }
        println!("{checked} thick vertices, largest error {worst:.2e} scene units");
        assert!(checked > 3000, "{checked}");
        // A picture position is rounded to 3e-5 px; where the face is steep that moves its depth by more.
        assert!(worst < 1e-3, "{worst}");
    }
}

#[test]
fn fans_cut_at_the_near_plane_lie_behind_it() {
    let dataset = random_cells(2000, 0.3, &mut Random::new(4));
    let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
    let mut view = views(&dataset, 64, 64)[1];
    view.near = 0.05;
    let fans = all_fans(&dataset, &vertices, &view);
    let cut = fans.windows(2).filter(|two| two[0].0 == two[1].0).count();
    assert!(cut > 20, "{cut} cells were cut into several");
    for (_, fan) in fans.iter().filter(|(_, fan)| *fan != Fan::default()) {
        for (_, front, back) in (0..5).map(|i| fan.vertex(i)) {
            let nearest = front[0].max(back[0]);
            assert!(nearest > 0.0 && nearest < 1.001 / view.near, "{fan:?}");
        }
    }
}
