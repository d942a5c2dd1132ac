//! `honeycomb`: truncated octahedra, which fill space (the bitruncated cubic honeycomb), with the signal of Marschner and Lobb.
//!
//! They are the Voronoi cells of a cubic lattice with a point in the middle of each cube. In quarters of the lattice's spacing the corners
//! of a cell are its centre plus the permutations of (0, ±1, ±2): whole numbers, which name them.

use std::collections::HashMap;

use glam::DVec3;

use super::field::sample_polyhedra;
use super::marschner_lobb;
use super::random::uniform;
use super::settings::{Settings, check_len, check_polyhedra};
use crate::columns::{CellMesh, FaceLists};
use crate::error::Result;

/// Truncated octahedra in the unit cube, eight hexagons and six squares each, with the [`marschner_lobb`] signal; corners are moved by
/// `jitter` quarters of the lattice's spacing, which bends the faces.
///
/// ```
/// # use cellfan::{Dataset, generate::{Settings, honeycomb}};
/// let mesh = Dataset::from_cells(honeycomb(&Settings { cells: 9, jitter: 0.0, ..Settings::default() })?)?;
/// assert_eq!((mesh.polyhedra.len(), mesh.polyhedra.faces()), (9, 9 * 14 - 8 - 12)); // shared: hexagons, squares
/// assert!((mesh.volume_world(4) - 0.5 / 8.0).abs() < 1e-7); // two cells a cube of the lattice
/// # Ok::<(), cellfan::Error>(())
/// ```
///
/// # Errors
/// As [`super::generate`].
pub fn honeycomb(settings: &Settings) -> Result<CellMesh> {
    settings.check()?;
    check_polyhedra(settings.cells)?;
    let count = |n: u128| n.pow(3) + (n - 1).pow(3);
    let n = (1..=1 << 11).find(|&n| count(n) >= u128::from(settings.cells)).unwrap_or(1);
    check_len("cells", count(n))?;
    let n = n as i32;

    let (mut points, mut lists, mut centers) = (Vec::new(), FaceLists::default(), Vec::new());
    let mut point_from_place: HashMap<[i32; 3], u32> = HashMap::new();
    let place = |q: [i32; 3], point: u64| {
        let moved = |axis: usize| settings.jitter * (2.0 * uniform(settings.seed, 1 + axis as u64, point) - 1.0);
        DVec3::from_array([0, 1, 2].map(|axis| (f64::from(q[axis]) + moved(axis)) / f64::from(4 * n)))
    };
    let mut faces = Vec::new();
    for [first, sites] in [[2, n], [4, n - 1]] {
        for k in 0..sites {
            for j in 0..sites {
                for i in 0..sites {
                    let center = [i, j, k].map(|i| 4 * i + first);
                    cell_around(center, &mut faces);
                    for face in &faces {
                        let around: Vec<u32> = face
                            .iter()
                            .map(|&corner| {
                                *point_from_place.entry(corner).or_insert_with(|| {
                                    let point = points.len();
                                    points.push(place(corner, point as u64).as_vec3().to_array());
                                    point as u32
                                })
                            })
                            .collect();
                        lists.push_face(&around);
                    }
                    lists.end_cell();
                    centers.push(DVec3::from_array(center.map(f64::from)) / f64::from(4 * n));
                }
            }
        }
    }
    Ok(sample_polyhedra(points, lists, &centers, marschner_lobb))
}

/// The corners around each face of the cell around `center`, counterclockwise seen from outside.
fn cell_around(center: [i32; 3], faces: &mut Vec<Vec<[i32; 3]>>) {
    faces.clear();
    let at = |q: [i32; 3]| [0, 1, 2].map(|axis| center[axis] + q[axis]);
    for axis in 0..3 {
        for sign in [1, -1] {
            let ring = [[1, 0], [0, 1], [-1, 0], [0, -1]];
            let mut square: Vec<[i32; 3]> = ring
                .iter()
                .map(|&[u, v]| {
                    let mut q = [0; 3];
                    (q[axis], q[(axis + 1) % 3], q[(axis + 2) % 3]) = (2 * sign, u, v);
                    at(q)
                })
                .collect();
            if sign < 0 {
                square.reverse();
            }
            faces.push(square);
        }
    }
    for octant in 0..8 {
        let signs = [0, 1, 2].map(|axis| if octant >> axis & 1 == 0 { 1 } else { -1 });
        let ring = [[0, 1, 2], [1, 0, 2], [2, 0, 1], [2, 1, 0], [1, 2, 0], [0, 2, 1]];
        let mut hexagon: Vec<[i32; 3]> = ring.iter().map(|q| at([0, 1, 2].map(|axis| signs[axis] * q[axis]))).collect();
        if signs.iter().product::<i32>() < 0 {
            hexagon.reverse();
        }
        faces.push(hexagon);
    }
}
