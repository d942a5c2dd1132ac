#![expect(clippy::float_cmp, reason = "extremes are those of samples, bit for bit")]

use glam::DVec3;

use super::*;
use crate::FieldSelection;
use crate::columns::{
    Array, Association, Cube, CubeCorners, CubeGrid, CubeSlopes, GridEye, Lattice, NumericColumn, Volume, VolumeField,
};
use crate::optics::{ControlPoint, CullTable, Model, Pieces, TransferFunction};

fn field(dims: [usize; 3], values: impl Into<NumericColumn>) -> (Volume, VolumeField) {
    let array = Array { name: "v".into(), association: Association::Point, components: 1, values: values.into() };
    let volume = Volume::new(dims, Lattice::default(), vec![array]).unwrap();
    let field = volume.field(&FieldSelection::parse("v", &[])).unwrap();
    (volume, field)
}

/// Uniform in [0, 1), the same for the same seed.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24)
    }
}

/// Something smooth with noise, from 0 to about 200.
fn bytes([nx, ny, nz]: [usize; 3], seed: u64) -> Vec<u8> {
    let mut noise = random(seed);
    let at = |i: usize, n: usize| i as f64 / n as f64 * 6.0;
    (0..nx * ny * nz)
        .map(|i| {
            let (x, y, z) = (at(i % nx, nx), at(i / nx % ny, ny), at(i / (nx * ny), nz));
            (100.0 + 40.0 * x.sin() * y.cos() + 30.0 * z.sin() + 20.0 * noise()) as u8
        })
        .collect()
}

fn transfer(points: &[(f64, f64)]) -> (Pieces, CullTable) {
    let point = |&(value, extinction): &(f64, f64)| ControlPoint { value, color: [1.0; 3], extinction };
    let pieces = TransferFunction::new(points.iter().map(point).collect()).unwrap().pieces(0.0);
    let table = CullTable::new(&pieces, Model::EmissionAbsorption);
    (pieces, table)
}

/// The samples of a node, by their coordinates.
fn samples_of(cube: Cube, dims: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let [first, end] = cube.samples(dims.map(|side| side as u32)).map(|corner| corner.map(|side| side as usize));
    (first[2]..end[2])
        .flat_map(move |k| (first[1]..end[1]).flat_map(move |j| (first[0]..end[0]).map(move |i| [i, j, k])))
}

#[test]
fn nodes_are_what_their_samples_say() {
    for dims in [[1, 1, 1], [2, 2, 2], [5, 3, 7], [1, 9, 2], [16, 8, 4], [13, 17, 5]] {
        let values = bytes(dims, 3);
        let (_, field) = field(dims, values.clone());
        let hierarchy = Hierarchy::new(&field).unwrap();
        assert!(hierarchy.levels().last().is_none_or(|root| root.dims == [1; 3]));
        for (number, level) in hierarchy.levels().iter().enumerate() {
            let mut covered = 0;
            for i in 0..level.len() {
                let [nx, ny, _] = level.dims.map(|side| side as usize);
                let node = [i % nx, i / nx % ny, i / (nx * ny)].map(|side| side as u16);
                let cube = Cube { node, level: number as u16 + 1, value: 0.0 };
                let samples: Vec<f64> = samples_of(cube, dims).map(|at| f64::from(values[field.index(at)])).collect();
                let mean = samples.iter().sum::<f64>() / samples.len() as f64;
                let error = samples.iter().map(|value| (value - mean).abs()).fold(0.0, f64::max);
                let found = level.node(i);
                assert!((f64::from(found.mean) - mean).abs() < 1e-4 && (f64::from(found.error()) - error).abs() < 1e-4);
                assert_eq!(f64::from(found.min), samples.iter().copied().fold(f64::INFINITY, f64::min));
                assert_eq!(f64::from(found.max), samples.iter().copied().fold(0.0, f64::max));
                covered += samples.len();
            }
            assert_eq!(covered, values.len());
        }
    }
}

#[test]
fn any_number_type_gives_the_same_tree_and_small_ranges_keep_their_digits() {
    let dims = [9, 6, 5];
    let values = bytes(dims, 5);
    let tree = |values: NumericColumn| Hierarchy::new(&field(dims, values).1).unwrap();
    let of_bytes = tree(values.clone().into());
    let of_doubles = tree(values.iter().map(|&value| f64::from(value)).collect::<Vec<_>>().into());
    let of_shorts = tree(values.iter().map(|&value| i16::from(value)).collect::<Vec<_>>().into());
    let far_off = tree(values.iter().map(|&value| 1e9 + f64::from(value)).collect::<Vec<_>>().into());
    for (number, level) in of_bytes.levels().iter().enumerate() {
        for i in 0..level.len() {
            assert_eq!(level.node(i), of_doubles.levels()[number].node(i));
            assert_eq!(level.node(i), of_shorts.levels()[number].node(i));
            let (near, far) = (level.node(i), far_off.levels()[number].node(i));
            assert!((near.error() - far.error()).abs() < 1e-3);
            let mean = f64::from(far.mean) + far_off.offset() - 1e9;
            assert!((f64::from(near.mean) - mean).abs() < 1e-3);
        }
    }
}

/// All samples that show are in one cube each, within the tolerance, and no cube comes before one that it hides.
#[test]
fn a_selection_covers_what_shows_once_and_farther_cubes_come_first() {
    let (pieces, table) = transfer(&[(70.0, 0.0), (90.0, 0.0), (91.0, 1.0)]);
    let shows = Shows { intervals: &pieces, table: &table };
    let at = |x, y, z| GridEye::At(DVec3::new(x, y, z));
    let eyes = [
        at(-20.0, 30.0, 7.0),
        at(5.5, 4.2, 40.0),
        at(6.5, 3.5, 4.5),
        GridEye::Along(DVec3::new(1.0, -0.3, 0.0)),
        GridEye::Along(DVec3::new(-0.2, -0.3, 0.9)),
    ];
    for dims in [[13, 9, 11], [16, 16, 16], [1, 20, 3]] {
        let mut values: Vec<f32> = bytes(dims, 7).into_iter().map(f32::from).collect();
        for i in (0..values.len()).step_by(97) {
            values[i] = if i % 2 == 0 { f32::NAN } else { f32::INFINITY };
        }
        let invalid = values.iter().filter(|value| !value.is_finite()).count() as u64;
        let (_, field) = field(dims, values.clone());
        let hierarchy = Hierarchy::new(&field).unwrap();
        for (eye, tolerance) in eyes.into_iter().flat_map(|eye| [0.0, 20.0, 60.0].map(|tolerance| (eye, tolerance))) {
            let mut selection = Selection::default();
            selection.select((&hierarchy, &field), &WithinError(tolerance), shows, eye, false);
            let mut in_parallel = Selection::default();
            in_parallel.select((&hierarchy, &field), &WithinError(tolerance), shows, eye, true);
            assert_eq!(selection.cubes, in_parallel.cubes);
            assert_eq!(selection.visited, in_parallel.visited);
            assert_eq!((selection.invalid, in_parallel.invalid), (invalid, invalid));
            assert_eq!(selection.transparent, in_parallel.transparent);

            let mut cubes_over = vec![0; values.len()];
            for &cube in &selection.cubes {
                for sample in samples_of(cube, dims).map(|at| field.index(at)) {
                    cubes_over[sample] += 1;
                    assert!((values[sample] - cube.value).abs() <= tolerance + 1e-3);
                }
            }
            for (&value, over) in values.iter().zip(cubes_over) {
                let is_seen = value.is_finite() && value > 90.0;
                assert!(over == 1 || (over == 0 && !is_seen), "{over} cubes over {value}");
            }
            assert_rays_meet_later_cubes_first(eye, &selection.cubes, dims);
        }
    }
}

/// Along any ray through the eye, the cubes that it meets come in the order of their depths, the farthest first.
fn assert_rays_meet_later_cubes_first(eye: GridEye, cubes: &[Cube], dims: [usize; 3]) {
    let side = DVec3::from_array(dims.map(|side| side as f64));
    let boxes: Vec<[DVec3; 2]> = cubes
        .iter()
        .map(|cube| cube.samples(dims.map(|side| side as u32)))
        .map(|ends| ends.map(|end| DVec3::from_array(end.map(f64::from))))
        .collect();
    let mut unit = random(17);
    let mut met = 0;
    for _ in 0..60 {
        let inside = DVec3::new(unit(), unit(), unit()) * side;
        let (origin, direction) = match eye {
            GridEye::At(eye) => (eye, inside - eye),
            GridEye::Along(to_eye) => (inside + to_eye * 100.0, -to_eye),
        };
        let mut last = f64::INFINITY;
        for ends in &boxes {
            let [a, b] = ends.map(|end| (end - origin) / direction);
            let (enter, leave) = (a.min(b).max_element().max(0.0), a.max(b).min_element());
            if enter + 1e-9 < leave {
                assert!(leave <= last + 1e-9, "{ends:?} comes too late from {eye:?}");
                last = enter;
                met += 1;
            }
        }
    }
    assert!(met > 30, "{met}");
}

#[test]
fn counts_are_those_of_selections() {
    let (pieces, table) = transfer(&[(70.0, 0.0), (90.0, 0.0), (91.0, 1.0)]);
    let shows = Shows { intervals: &pieces, table: &table };
    let dims = [21, 16, 13];
    let (_, field) = field(dims, bytes(dims, 11));
    let hierarchy = Hierarchy::new(&field).unwrap();
    let counts = CubeCounts::new((&hierarchy, &field), shows);
    let select = |rule| {
        let mut selection = Selection::default();
        selection.select((&hierarchy, &field), &rule, shows, GridEye::At(DVec3::splat(-9.0)), false);
        selection.cubes.len() as u64
    };
    assert_eq!(select(WithinError(0.0)), counts.finest());
    assert!(counts.finest() > 1000);
    for wanted in [1_000_000, counts.finest() - 1, 1000, 200, 50, 1] {
        let (rule, found) = (counts.within(wanted), select(counts.within(wanted)));
        assert!(found <= wanted, "{found} instead of {wanted}");
        let finer = WithinError(rule.0 - 0.1);
        assert!(rule.0 == 0.0 || select(finer) > wanted, "{finer:?} would do for {wanted}");
    }
}

#[test]
fn the_longest_way_through_a_volume_is_no_shorter_than_that_of_any_ray() {
    let grid = CubeGrid { dims: [4, 5, 6], lattice: Lattice::new(DVec3::splat(1.0), DVec3::new(1.0, 0.5, 2.0)) };
    let corners = grid.corners_world();
    let diagonal = corners[0].distance(corners[7]);
    let mut shortest = f64::INFINITY;
    for (azimuth, elevation) in [(0.0, 0.0), (35.0, 20.0), (90.0, 1.0), (10.0, 89.0)] {
        let frame = crate::Camera::framing(&corners, azimuth, elevation, 40, 30).frame().unwrap();
        let longest = longest_chord_world(&grid, &frame);
        assert!(longest <= diagonal);
        shortest = shortest.min(longest);
        for (x, y) in (0..30).flat_map(|y| (0..40).map(move |x| (f64::from(x), f64::from(y)))) {
            let ray = frame.ray(x, y);
            let to_grid = grid.lattice.grid_from_world();
            let (o, d) = (to_grid.transform_point3(ray.origin), to_grid.transform_vector3(ray.direction));
            let ends = [DVec3::ZERO, DVec3::from_array(grid.dims.map(f64::from))].map(|corner| (corner - o) / d);
            let (enter, leave) = (ends[0].min(ends[1]).max_element(), ends[0].max(ends[1]).min_element());
            assert!((leave - enter) * ray.direction.length() <= longest * (1.0 + 1e-9));
        }
    }
    assert!(shortest < 0.9 * diagonal, "{shortest} of {diagonal}");
}

/// Every point of two boxes' common border has one value, whatever their sizes; in the twin, whose corners are samples, it has two.
#[test]
fn values_between_points_agree_where_boxes_of_different_size_meet() {
    let (pieces, table) = transfer(&[(0.0, 1.0), (255.0, 1.0)]);
    let shows = Shows { intervals: &pieces, table: &table };
    for (dims, seed) in [([14, 10, 12], 5), ([17, 17, 17], 9), ([9, 26, 6], 2)] {
        let (_, field) = field(dims, bytes(dims, seed));
        let tree = Hierarchy::with(&field, Interpolation::Trilinear).unwrap();
        let mut selection = Selection::default();
        let tolerance = 40.0;
        selection.select((&tree, &field), &WithinError(tolerance), shows, GridEye::Along(DVec3::ONE), false);
        let cubes = &selection.cubes;
        let levels: std::collections::HashSet<u16> = cubes.iter().map(|cube| cube.level).collect();
        assert!(levels.len() > 1, "{levels:?}");
        let of_selection = SelectedCorners::new((&tree, &field), cubes);
        let sample = |at: [u32; 3]| field.values.get(field.index(at.map(|along| along as usize))) as f32;
        let boxes: Vec<[[u32; 3]; 2]> = cubes.iter().map(|cube| cube.samples(tree.dims())).collect();
        let of_samples = |ends: [[u32; 3]; 2]| -> [f32; 8] {
            std::array::from_fn(|corner| sample([0, 1, 2].map(|axis| ends[corner >> axis & 1][axis])))
        };
        let value = |corners: &[f32; 8], [first, end]: [[u32; 3]; 2], at: [f32; 3]| {
            let share = |axis: usize| (at[axis] - first[axis] as f32) / (end[axis] - first[axis]) as f32;
            super::linear::between(corners, [share(0), share(1), share(2)])
        };
        let mut unit = random(3);
        let (mut compared, mut largest, mut of_twin) = (0, 0.0_f32, 0.0_f32);
        for (a, &[low, high]) in boxes.iter().enumerate() {
            for (b, &[other_low, other_high]) in boxes.iter().enumerate().skip(a + 1) {
                let from: [u32; 3] = std::array::from_fn(|axis| low[axis].max(other_low[axis]));
                let to: [u32; 3] = std::array::from_fn(|axis| high[axis].min(other_high[axis]));
                if (0..3).any(|axis| from[axis] > to[axis]) {
                    continue;
                }
                let at: [f32; 3] =
                    std::array::from_fn(|axis| from[axis] as f32 + unit() as f32 * (to[axis] - from[axis]) as f32);
                let both = [(a, [low, high]), (b, [other_low, other_high])];
                let [p, q] = both.map(|(i, ends)| value(&of_selection.of(&cubes[i]), ends, at));
                largest = largest.max((p - q).abs());
                let [p, q] = both.map(|(_, ends)| value(&of_samples(ends), ends, at));
                of_twin = of_twin.max((p - q).abs());
                compared += 1;
            }
        }
        assert!(compared > 200 && largest < 1e-3 && of_twin > 5.0, "{compared}: {largest}, {of_twin}");
        // The error says how far samples are off in boxes whose corners are samples.
        for (cube, &ends) in cubes.iter().zip(&boxes) {
            let corners = of_samples(ends);
            let [first, end] = ends;
            for i in 0..27_u32 {
                let at: [u32; 3] = std::array::from_fn(|axis| {
                    first[axis] + (i / 3_u32.pow(axis as u32) % 3) * (end[axis] - first[axis]) / 2
                });
                let off = (value(&corners, ends, at.map(|along| along as f32)) - sample(at)).abs();
                assert!(off <= tolerance + 1e-3, "{cube:?}: {off}");
            }
        }
    }
}

#[test]
fn slopes_of_a_ramp_are_its_own() {
    let dims = [9, 8, 7];
    let values: Vec<f32> = (0..dims.iter().product())
        .map(|i: usize| (i % 9) as f32 + 3.0 * (i / 9 % 8) as f32 - (i / 72) as f32)
        .collect();
    let (_, field) = field(dims, values);
    for interpolation in [Interpolation::Constant, Interpolation::Trilinear] {
        let tree = Hierarchy::with(&field, interpolation).unwrap();
        let slopes = Slopes::new((&tree, &field));
        for (node, level) in [([0, 0, 0], 0), ([4, 3, 2], 0), ([1, 1, 1], 1), ([0, 1, 0], 2)] {
            let slope = slopes.of(&Cube { node, level, value: 0.0 });
            let is_near = slope.iter().zip([1.0, 3.0, -1.0]).all(|(found, expected)| (found - expected).abs() < 1e-6);
            assert!(is_near, "{interpolation:?} {node:?} {level}: {slope:?}");
        }
    }
    // Beside a hole: the other side alone.
    let (_, field) = super::tests::field([4, 1, 1], vec![1.0, f32::NAN, 5.0, 9.0]);
    let tree = Hierarchy::new(&field).unwrap();
    assert_eq!(Slopes::new((&tree, &field)).of(&Cube { node: [2, 0, 0], level: 0, value: 5.0 }), [4.0, 0.0, 0.0]);
}
