use super::{delaunay, random_points};
use crate::columns::Points;
use crate::error::Error;
use crate::generate::Settings;
use crate::generate::grid::volume_six_times;

fn volume(settings: &Settings) -> f64 {
    let mesh = delaunay(settings).unwrap();
    let Points::F32(points) = &mesh.points else { panic!("generated points are f32") };
    mesh.tets.iter().map(|tet| volume_six_times(tet.map(|v| points[v as usize]))).sum::<f64>() / 6.0
}

#[test]
fn mesh_fills_the_cube_or_the_hull_of_its_points() {
    for cells in [1, 20, 300, 20_000] {
        let filled = Settings { cells, seed: cells, ..Settings::default() };
        assert!((volume(&filled) - 1.0).abs() < 1e-9, "{cells}");
        let hull = volume(&Settings { fill_cube: false, ..filled });
        assert!(0.0 < hull && hull < 1.0, "{cells}: {hull}");
    }
}

#[test]
fn cells_come_near_what_was_asked_for() {
    for fill_cube in [true, false] {
        // The count of points on the boundary goes in steps: coarse for few cells.
        for (cells, tolerance) in [(2000, 0.1), (10_000, 0.03), (40_000, 0.03), (241_000, 0.03)] {
            let found = delaunay(&Settings { cells, fill_cube, ..Settings::default() }).unwrap().tets.len();
            let ratio = found as f64 / cells as f64;
            assert!((ratio - 1.0).abs() < tolerance, "{fill_cube} {cells}: {found}");
        }
    }
}

#[test]
fn points_lie_in_the_cube_with_its_corners_and_do_not_coincide() {
    let mut points = random_points(&Settings { cells: 50_000, ..Settings::default() });
    assert!(points.iter().flatten().all(|x| (0.0..=1.0).contains(x)));
    let boundary = |p: &[f32; 3]| p.iter().filter(|&&x| x <= 0.0 || x >= 1.0).count();
    assert_eq!(points.iter().filter(|p| boundary(p) == 3).count(), 8);
    let count = points.len();
    points.sort_unstable_by_key(|p| p.map(f32::to_bits));
    points.dedup();
    assert_eq!(points.len(), count);
}

#[test]
fn more_cells_than_32_bits_can_number_are_refused() {
    let settings = Settings { cells: u64::MAX, ..Settings::default() };
    assert!(matches!(delaunay(&settings), Err(Error::TooLarge { column: "cells", .. })));
}
