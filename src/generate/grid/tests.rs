use std::collections::HashMap;

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::{Grid, MIN_VOLUME_KEPT, boxes_along_an_edge, grid, tets_of_box, volume_six_times};
use crate::error::Error;
use crate::generate::{MAX_JITTER, Scheme, Settings};

const SCHEMES: [Scheme; 2] = [Scheme::Five, Scheme::Six];

/// The faces of a mesh with how often each occurs and its area.
fn faces(grid: &Grid) -> HashMap<[u32; 3], (usize, f64)> {
    let mut faces = HashMap::new();
    for tet in &grid.tets {
        for left_out in 0..4 {
            let mut face = [0, 1, 2].map(|i| tet[(left_out + 1 + i) % 4]);
            face.sort_unstable();
            let [a, b, c] = face.map(|v| Vec3::from_array(grid.points[v as usize]).as_dvec3());
            faces.entry(face).or_insert((0, 0.5 * (b - a).cross(c - a).length())).0 += 1;
        }
    }
    faces
}

#[test]
fn cell_keeps_one_minus_six_jitters_of_its_volume_at_worst() {
    // The determinant is linear in each of 12 coordinates: its extremes lie at the 2^12 corners.
    for jitter in [0.01, 0.0875, 0.15, 0.2] {
        let mut worst = f64::INFINITY;
        for (scheme, odd) in [(Scheme::Six, false), (Scheme::Five, false), (Scheme::Five, true)] {
            let (tets, count) = tets_of_box(scheme, odd);
            for tet in &tets[..count] {
                let regular = tet.map(|c| DVec3::new(f64::from(c & 1), f64::from(c >> 1 & 1), f64::from(c >> 2)));
                let volume = |[a, b, c, d]: [DVec3; 4]| (b - a).cross(c - a).dot(d - a);
                assert!(volume(regular) > 0.5);
                for signs in 0..1 << 12 {
                    let moved = |vertex: usize, axis: usize| {
                        if signs >> (3 * vertex + axis) & 1 == 0 { -jitter } else { jitter }
                    };
                    let corner =
                        std::array::from_fn(|v| regular[v] + DVec3::new(moved(v, 0), moved(v, 1), moved(v, 2)));
                    worst = f64::min(worst, volume(corner) / volume(regular));
                }
            }
        }
        assert!((worst - (1.0 - 6.0 * jitter)).abs() < 1e-12, "jitter {jitter}: {worst}");
    }
}

#[test]
fn grid_has_the_fewest_boxes_that_are_enough() {
    for (cells, scheme, boxes) in [
        (1, Scheme::Six, 1),
        (6, Scheme::Six, 1),
        (7, Scheme::Six, 2),
        (40, Scheme::Five, 2),
        (41, Scheme::Five, 3),
        (6_000_000, Scheme::Six, 100),
        (6_000_001, Scheme::Six, 101),
    ] {
        assert_eq!(boxes_along_an_edge(cells, scheme), boxes, "{cells} {scheme:?}");
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let refused = |settings| grid(&settings).err();
    assert!(matches!(
        refused(Settings { cells: 0, ..Settings::default() }),
        Some(Error::Option { option: "--cells", .. })
    ));
    for jitter in [-0.1, 0.36, f64::NAN, f64::INFINITY] {
        let settings = Settings { jitter, ..Settings::default() };
        assert!(matches!(refused(settings), Some(Error::Option { option: "--jitter", .. })), "{jitter}");
    }
    for cells in [u64::from(u32::MAX), u64::MAX] {
        assert!(matches!(refused(Settings { cells, ..Settings::default() }), Some(Error::TooLarge { .. })), "{cells}");
    }
}

#[test]
fn regular_grid_has_equal_cells_at_lattice_points() {
    let grid = grid(&Settings { cells: 6 * 64, jitter: 0.0, ..Settings::default() }).unwrap();
    assert_eq!(grid.points[1].map(f32::to_bits), [0.25_f32, 0.0, 0.0].map(f32::to_bits));
    for tet in &grid.tets {
        let volume = volume_six_times(tet.map(|v| grid.points[v as usize]));
        assert!((volume - 1.0 / 64.0).abs() < 1e-15);
    }
}

/// So many cases, the same ones every time.
fn seeded(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(seeded(40))]
    #[test]
    fn jittered_grid_fills_the_cube_and_no_cell_is_inverted(
        seed: u64, boxes in 1_u64..9, five: bool, jitter in prop_oneof![Just(MAX_JITTER), 0.0..MAX_JITTER],
    ) {
        let scheme = SCHEMES[usize::from(!five)];
        let cells = boxes.pow(3) * scheme.tets_per_box();
        let grid = grid(&Settings { cells, seed, jitter, scheme, ..Settings::default() }).unwrap();
        prop_assert_eq!(grid.tets.len() as u64, cells);

        let spacing = 1.0 / boxes as f64;
        let volume = |tet: &[u32; 4]| volume_six_times(tet.map(|v| grid.points[v as usize]));
        let volumes: Vec<f64> = grid.tets.iter().map(volume).collect();
        // At least, in boxes: six times the regular volume is 1 or 2.
        prop_assert!(volumes.iter().all(|&volume| volume >= MIN_VOLUME_KEPT * spacing.powi(3)));
        let total: f64 = volumes.iter().sum::<f64>() / 6.0;
        prop_assert!((total - 1.0).abs() < 1e-12, "volume {}", total);

        let faces = faces(&grid);
        prop_assert!(faces.values().all(|&(count, _)| count <= 2));
        let boundary: Vec<_> = faces.iter().filter(|(_, (count, _))| *count == 1).collect();
        prop_assert_eq!(boundary.len() as u64, 12 * boxes * boxes);
        let area: f64 = boundary.iter().map(|(_, (_, area))| area).sum();
        prop_assert!((area - 6.0).abs() < 1e-12, "area {}", area);
        for (face, _) in boundary {
            let coordinate = |v: u32, axis: usize| grid.points[v as usize][axis].to_bits();
            let on_cube = |axis: usize, side: f32| face.iter().all(|&v| coordinate(v, axis) == side.to_bits());
            prop_assert!((0..3).any(|axis| on_cube(axis, 0.0) || on_cube(axis, 1.0)));
        }
    }
}
