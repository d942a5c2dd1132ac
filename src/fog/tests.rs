use std::collections::HashMap;

use glam::DVec3;

use super::*;
use crate::columns::{Dataset, FieldSelection};

fn terrain(points: usize) -> Terrain {
    let settings = MapSettings { points, ..MapSettings::default() };
    let ground = ground_map(&settings).unwrap();
    let fog = fog_map(&ground, &settings).unwrap();
    Terrain::new(&ground, &fog, 10.0, [1.5, 0.3]).unwrap()
}

fn seen_from(eye: DVec3, tolerance_px: f64) -> Detail {
    Detail::Tolerance { eye, px_per_unit: 400.0, tolerance_px }
}

/// Every edge belongs to two triangles, or lies at the border; together they cover the square once.
fn check_conforming(landscape: &Landscape, side_world: f64) {
    let mut uses: HashMap<[u32; 2], i32> = HashMap::new();
    let mut area = 0.0;
    for &[a, b, c] in &landscape.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            // Once each way.
            *uses.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { 1 << 16 };
        }
        let [a, b, c] = [a, b, c].map(|v| landscape.points[v as usize]);
        let twice = (f64::from(b[0]) - f64::from(a[0])) * (f64::from(c[1]) - f64::from(a[1]))
            - (f64::from(b[1]) - f64::from(a[1])) * (f64::from(c[0]) - f64::from(a[0]));
        assert!(twice > 0.0, "counterclockwise from above");
        area += twice / 2.0;
    }
    assert!((area / side_world.powi(2) - 1.0).abs() < 1e-6, "{area}");
    for ([from, to], count) in uses {
        let [p, q] = [from, to].map(|v| landscape.points[v as usize].map(f64::from));
        let at_border =
            (0..2).any(|k| [0.0, side_world].iter().any(|side| (p[k] - side).abs() + (q[k] - side).abs() < 1e-5));
        assert!(count == (1 | 1 << 16) || (at_border && (count == 1 || count == 1 << 16)), "{p:?} {q:?}: {count:x}");
    }
}

#[test]
fn a_landscape_has_no_cracks_from_any_eye_and_covers_its_square_once() {
    let terrain = terrain(129);
    let flight = Flight::new(&terrain, 0.3);
    for i in 0..12 {
        let landscape = terrain.landscape(&seen_from(flight.place(f64::from(i) / 12.0), 2.0), Profile::Emission);
        check_conforming(&landscape, 10.0);
        assert!(
            landscape.triangles.len() > 500 && landscape.triangles.len() < 2 * 128 * 128,
            "{}",
            landscape.triangles.len()
        );
    }
    let full = terrain.landscape(&Detail::Full, Profile::Emission);
    assert_eq!(full.triangles.len(), 2 * 128 * 128);
    check_conforming(&full, 10.0);
}

#[test]
fn what_is_left_out_is_within_the_tolerance_of_the_full_terrain() {
    let terrain = terrain(129);
    let eye = Flight::new(&terrain, 0.3).place(0.2);
    for tolerance_px in [1.0, 4.0] {
        let landscape = terrain.landscape(&seen_from(eye, tolerance_px), Profile::Emission);
        let mut most: f64 = 0.0;
        for &[a, b, c] in &landscape.triangles {
            let [a, b, c] = [a, b, c].map(|v| DVec3::from_array(landscape.points[v as usize].map(f64::from)));
            let middle = (a + b + c) / 3.0;
            let [ground, _] = terrain.heights_at(middle.x, middle.y);
            most = most.max((ground - middle.z).abs() * 400.0 / eye.distance(middle));
        }
        // A point that is left out may be off by the tolerance, and so may be the points above it that have not risen: a level each.
        assert!(most < 8.0 * tolerance_px, "{most} px at {tolerance_px}");
    }
}

#[test]
fn points_rise_without_a_jump() {
    let terrain = terrain(129);
    let flight = Flight::new(&terrain, 0.3);
    // Heights of the surface at some places, frame by frame, a hundredth of a percent of the path apart.
    let heights_at = |share: f64| -> HashMap<[u32; 2], f32> {
        let landscape = terrain.landscape(&seen_from(flight.place(share), 2.0), Profile::Emission);
        landscape.points.iter().map(|&[x, y, z]| ([x.to_bits(), y.to_bits()], z)).collect()
    };
    let mut before = heights_at(0.4);
    for i in 1..20 {
        let share = 0.4 + f64::from(i) * 1e-4;
        let (eye, now) = (flight.place(share), heights_at(share));
        for (at, z) in &now {
            let Some(old) = before.get(at) else { continue };
            let place = DVec3::new(f32::from_bits(at[0]).into(), f32::from_bits(at[1]).into(), (*z).into());
            let jump_px = f64::from((z - old).abs()) * 400.0 / eye.distance(place);
            assert!(jump_px < 0.5, "{jump_px} px");
        }
        before = now;
    }
}

#[test]
fn prisms_fill_the_fog_and_end_where_it_does() {
    let ground = HeightMap::sample(17, |at| 0.3 * at.y).unwrap();
    // A wedge of fog over half of the square: thickness from 1 at x = 0 to 0 at x = 0.5.
    let fog = HeightMap::sample(17, |at| (1.0 - 2.0 * at.x).max(0.0)).unwrap();
    let terrain = Terrain::new(&ground, &fog, 2.0, [1.0, 0.5]).unwrap();
    for detail in [Detail::Full, seen_from(DVec3::new(1.0, 1.0, 4.0), 0.5)] {
        let landscape = terrain.landscape(&detail, Profile::Emission);
        let dataset = Dataset::from_cells(landscape.fog).unwrap();
        assert_eq!(dataset.counts.inverted + dataset.counts.degenerate, 0);
        let volume: f64 = (0..dataset.cells()).map(|cell| dataset.volume_world(cell)).sum();
        // ∫ 0.5·(1 − x) dx over 0…1, 2 deep.
        assert!((volume - 0.5).abs() < 1e-4, "{volume}");
        let field = dataset.field(&FieldSelection::parse("density", &dataset.arrays)).unwrap();
        assert_eq!((field.range.0, field.range.1), (0.0, 1.0));
    }
}

#[test]
fn a_view_without_fog_has_one_cell_that_shows_nothing() {
    let flat = HeightMap::sample(9, |_| 0.0).unwrap();
    // One point of fog, which a distant view leaves out.
    let fog = HeightMap::sample(9, |at| f64::from(at.distance(glam::DVec2::new(0.375, 0.375)) < 0.01)).unwrap();
    let terrain = Terrain::new(&flat, &fog, 1.0, [1.0, 0.1]).unwrap();
    let landscape = terrain.landscape(&seen_from(DVec3::new(0.5, 0.5, 1e6), 1.0), Profile::Emission);
    assert_eq!((landscape.triangles.len(), landscape.fog.hexahedra.len()), (2, 1));
    assert!((0..landscape.fog.points.len()).all(|i| landscape.fog.arrays[0].values.get(i) == 0.0));
    assert!(Dataset::from_cells(landscape.fog).is_ok());
}

#[test]
fn maps_are_read_from_16_bit_pictures_and_bad_ones_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.png");
    let ramp =
        image::ImageBuffer::<image::Luma<u16>, Vec<u16>>::from_fn(5, 5, |x, y| image::Luma([(x * 1000 + y) as u16]));
    ramp.save(&path).unwrap();
    let map = HeightMap::read(&path).unwrap();
    assert_eq!(map.side(), 5);
    // The last row of the picture is y = 0.
    assert!((f64::from(map.heights()[3]) - 3004.0 / 65535.0).abs() < 1e-7);
    assert!((map.height(glam::DVec2::new(0.125, 1.0)) - 500.0 / 65535.0).abs() < 1e-7);
    std::fs::write(&path, b"no picture").unwrap();
    assert!(HeightMap::read(&path).unwrap_err().to_string().contains("map.png"));
    assert!(HeightMap::read(&folder.path().join("none.png")).is_err());
    let ground = HeightMap::sample(9, |_| 0.5).unwrap();
    let none = HeightMap::sample(9, |_| 0.0).unwrap();
    assert!(Terrain::new(&ground, &none, 1.0, [1.0, 0.1]).unwrap_err().to_string().contains("--fog-map"));
}
