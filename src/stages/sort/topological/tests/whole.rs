//! Hexahedra, wedges, pyramids and tetrahedra in one graph, against all cells along the rays of all pixels.

use super::*;
use crate::stages::testing::whole::{Cells, blocks, parts_in_cell};

const WIDTH: u32 = 48;
const HEIGHT: u32 = 40;

/// Listed, mixed and in blocks, with holes, turned round, and with faces folded by up to `jitter` of a cell.
fn meshes(jitter: f64, seed: u64) -> Vec<(&'static str, Dataset)> {
    let mut random = Random::new(seed);
    let cells = Cells::jittered(6, jitter, &mut random);
    let mixed = Cells::jittered(4, jitter, &mut random).mixed(&mut random);
    let twisted = |_: usize, p: DVec3| {
        let (angle, radius) = (1.5 * p.x + jitter * p.z, 0.7 + 0.25 * p.y);
        DVec3::new(radius * angle.cos(), radius * angle.sin(), p.z)
    };
    // The second is the first in a mirror: its cells run the other way round.
    let halves = |block: usize, p: DVec3| {
        let x = 0.5 + 0.5 * p.x;
        DVec3::new(if block == 0 { -x } else { x }, p.y + jitter * p.x * p.z, p.z)
    };
    vec![
        ("hexahedra", cells.clone().dataset()),
        ("cavity", cells.clone().part(|p| p.length() > 0.6).dataset()),
        ("two parts", cells.part(|p| (p.x + 0.4 * p.y).abs() > 0.3).dataset()),
        ("mixed", mixed.dataset()),
        ("shell", blocks(&[[13, 4, 7]], twisted, |cell| cell % 29 == 3)),
        ("two blocks", blocks(&[[4, 6, 6], [4, 6, 6]], halves, |_| false)),
    ]
}

/// Entry, exit and cell of all parts of cells on the ray of a pixel, nearest first.
fn along_ray(dataset: &Dataset, vertices: &[SceneVertex], view: &View, [x, y]: [u32; 2]) -> Vec<(f64, f64, u32)> {
    let ray = ray(view, f64::from(x), f64::from(y));
    let parts = |cell: usize| {
        let parts = parts_in_cell(dataset, vertices, view, ray, cell);
        parts.into_iter().map(move |(enter, leave)| (enter, leave, cell as u32))
    };
    let mut met: Vec<_> = (0..dataset.cells()).flat_map(parts).collect();
    met.sort_by(|a, b| a.0.total_cmp(&b.0));
    met
}

/// The cells that follow each other on some ray, leaving out what is met for less than `rounding`.
fn following(dataset: &Dataset, vertices: &[SceneVertex], view: &View, rounding: f64) -> BTreeSet<(u32, u32)> {
    let pixels = (0..WIDTH * HEIGHT).into_par_iter().map(|i| [i % WIDTH, i / WIDTH]);
    let of_pixel = |pixel| {
        let met = along_ray(dataset, vertices, view, pixel);
        let is_met = |(enter, leave, _): &(f64, f64, u32)| leave - enter > rounding;
        let pairs = met.windows(2).filter(|two| two.iter().all(is_met) && two[0].2 != two[1].2);
        pairs.map(|two| (two[0].2, two[1].2)).collect::<Vec<_>>()
    };
    pixels.flat_map_iter(of_pixel).collect()
}

#[test]
fn an_order_is_found_where_there_is_one_and_every_ray_meets_it() {
    let (mut exact, mut broken) = (0, 0);
    for (jitter, seed) in [(0.0, 1), (0.15, 2), (0.4, 3)] {
        for (name, mesh) in meshes(jitter, seed) {
            for (i, view) in views(&mesh, WIDTH, HEIGHT).iter().enumerate() {
                let what = format!("{name} by {jitter}, view {i}");
                let ordered = order(&mesh, view);
                let layer_from_cell = ordered.topological.layer_from_cell();
                let following = following(&mesh, &ordered.vertices, view, 1e-9);
                assert!(following.len() > 20, "{what}: {}", following.len());
                let Layers { cycles, layers, .. } = ordered.layers;
                assert!(layer_from_cell.iter().all(|&layer| layer < layers));
                let related = before_and_after(&mesh, &ordered, view);
                // What must be kept: what lies across each face that is seen from one side, and what rays meet.
                let asked: Vec<(u32, u32)> = related.iter().chain(&following).copied().collect();
                let slow = slow_layers(mesh.cells(), &asked);
                println!("{what}: {:?}, {} of {} cells follow", ordered.layers, following.len(), mesh.cells());
                assert_eq!(cycles == 0, slow.is_some(), "{what}: {:?}", ordered.layers);
                if cycles > 0 {
                    broken += 1;
                    continue;
                }
                exact += 1;
                assert!(slow_layers(mesh.cells(), &related).unwrap() == layer_from_cell, "{what}");
                for &(nearer, farther) in &following {
                    let [nearer, farther] = [nearer, farther].map(|cell| layer_from_cell[cell as usize]);
                    assert!(nearer < farther, "{what}");
                }
                let mut pairs: Vec<_> =
                    layer_from_cell.iter().zip(0..).map(|(&layer, cell)| pair(layer, cell)).collect();
                pairs.sort_unstable();
                let check = check_order(&mesh, &ordered.vertices, view, &pairs);
                assert!(check.misordered == 0 && check.pairs > 100, "{what}: {check:?}");
            }
        }
    }
    println!("{exact} with an order, {broken} without");
    assert!(exact > 20 && broken > 5);
}

#[test]
fn any_number_of_threads_finds_the_same_order() {
    for (name, mesh) in meshes(0.4, 6) {
        let mut kept = Topological::default();
        for (i, view) in views(&mesh, 100, 80).iter().enumerate() {
            let expected = order(&mesh, view);
            for threads in [1, 2, 5] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let layers = pool.install(|| kept.order(&mesh, &expected.adjacency, &expected.vertices, view));
                assert_eq!(layers, expected.layers, "{name}, view {i}, {threads} threads");
                assert!(kept.layer_from_cell() == expected.topological.layer_from_cell());
            }
        }
    }
}

/// Two cells at a face whose fold is the outline of one of them: rays near it pass through the other, it, and the other again.
#[test]
fn a_face_that_rays_pass_both_ways_is_a_cycle_where_a_pixel_sees_it() {
    let fold = |height: f64| {
        Cells::grid([1, 1, 2], |p| if p.z.abs() < 0.1 && (p.x - p.y).abs() < 0.1 { p + DVec3::Z * height } else { p })
            .dataset()
    };
    // Points 4 and 7 of the layer between are moved up: along x = y the face is a ridge, and is cut there.
    let camera = |toward: DVec3| {
        let camera = crate::camera::Camera {
            projection: crate::camera::Projection::Orthographic { height_world: 4.0 },
            ..crate::camera::Camera::looking_at(-toward * 4.0, DVec3::ZERO, 90, 90)
        };
        move |mesh: &Dataset| View::new(&camera, mesh).unwrap()
    };
    let across = DVec3::new(1.0, -1.0, 0.0).normalize();
    let below = DVec3::new(1.0, -1.0, -3.0).normalize();
    for (height, toward, is_cycle) in
        [(0.0, across, false), (0.4, across, true), (0.4, below, false), (1e-4, across, false)]
    {
        let mesh = fold(height);
        let view = camera(toward)(&mesh);
        let ordered = order(&mesh, &view);
        println!("height {height}, {toward}: {:?}", ordered.layers);
        assert_eq!(ordered.layers.cycles > 0, is_cycle, "height {height}, {toward}");
        if is_cycle {
            assert_eq!((ordered.layers.cycles, ordered.layers.relations, ordered.layers.layers), (1, 1, 2));
        }
    }
}
