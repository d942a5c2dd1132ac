//! `voronoi`: the Voronoi cells of random points in the unit cube, with the signal of Marschner and Lobb.
//!
//! A cell is the cube, cut by the planes half-way to the points around (Rycroft's Voro++, 2009, works so), nearest first, until what is
//! left is nearer to its own point than any other could cut. A corner is where the planes of three cut: with the cell's own point it is as
//! far from four points, whose numbers name it in all four cells.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::field::sample_polyhedra;
use super::marschner_lobb;
use super::random::uniform;
use super::settings::{Settings, check_len, check_polyhedra};
use crate::columns::{CellMesh, FaceLists};
use crate::error::Result;

/// The Voronoi cells of as many random points as cells are wanted: polyhedra with 15 faces on average, which fill the unit cube; with
/// the [`marschner_lobb`] signal.
///
/// ```
/// # use cellfan::{Dataset, generate::{Settings, voronoi}};
/// let mesh = Dataset::from_cells(voronoi(&Settings { cells: 50, ..Settings::default() })?)?;
/// assert_eq!(mesh.polyhedra.len(), 50);
/// let volume: f64 = (0..50).map(|cell| mesh.volume_world(cell)).sum();
/// assert!((volume - 1.0).abs() < 1e-6);
/// # Ok::<(), cellfan::Error>(())
/// ```
///
/// # Errors
/// As [`super::generate`].
pub fn voronoi(settings: &Settings) -> Result<CellMesh> {
    settings.check()?;
    check_polyhedra(settings.cells)?;
    check_len("cells", settings.cells.into())?;
    let coordinate = |site: u64, axis: u64| uniform(settings.seed, 1 + axis, site);
    let sites: Vec<DVec3> = (0..settings.cells)
        .into_par_iter()
        .map(|site| DVec3::new(coordinate(site, 0), coordinate(site, 1), coordinate(site, 2)))
        .collect();
    let buckets = Buckets::new(&sites);
    let cells: Vec<Vec<Facet>> = (0..sites.len()).into_par_iter().map(|site| buckets.cell(&sites, site)).collect();

    let (mut points, mut lists) = (Vec::new(), FaceLists::default());
    let mut point_from_name: HashMap<[u32; 4], u32> = HashMap::new();
    for (facets, site) in cells.iter().zip(0..) {
        for facet in facets {
            let point_of = |corner: &Corner| {
                let [a, b, c] = corner.planes;
                let mut name = [a, b, c, site];
                name.sort_unstable();
                *point_from_name.entry(name).or_insert_with(|| {
                    points.push(corner.position.as_vec3().to_array());
                    points.len() as u32 - 1
                })
            };
            let around: Vec<u32> = facet.corners.iter().map(point_of).collect();
            lists.push_face(&around);
        }
        lists.end_cell();
    }
    Ok(sample_polyhedra(points, lists, &sites, marschner_lobb))
}

/// The walls of the cube have the last numbers.
const FIRST_WALL: u32 = u32::MAX - 5;

/// Where three planes meet.
#[derive(Clone, Copy, Debug)]
struct Corner {
    position: DVec3,
    /// The point on the other side of each, or the wall; ascending.
    planes: [u32; 3],
}

/// A face, its corners counterclockwise seen from outside.
#[derive(Clone, Debug)]
struct Facet {
    corners: Vec<Corner>,
}

/// The unit cube.
fn cube() -> Vec<Facet> {
    let wall = |axis: usize, is_upper: bool| FIRST_WALL + 2 * axis as u32 + u32::from(is_upper);
    let corner = |bits: [bool; 3]| Corner {
        position: DVec3::from_array(bits.map(|bit| f64::from(u8::from(bit)))),
        planes: [0, 1, 2].map(|axis| wall(axis, bits[axis])),
    };
    let facet = |axis: usize, is_upper: bool| {
        let around = [[false, false], [true, false], [true, true], [false, true]];
        let mut corners: Vec<Corner> = around
            .iter()
            .map(|&[u, v]| {
                let mut bits = [is_upper; 3];
                (bits[(axis + 1) % 3], bits[(axis + 2) % 3]) = (u, v);
                corner(bits)
            })
            .collect();
        if !is_upper {
            corners.reverse();
        }
        Facet { corners }
    };
    (0..3).flat_map(|axis| [facet(axis, false), facet(axis, true)]).collect()
}

/// Cuts off what lies at n·p > d.
fn cut(facets: &mut Vec<Facet>, n: DVec3, d: f64, plane: u32) {
    let outside = |corner: &Corner| n.dot(corner.position) - d;
    if facets.iter().flat_map(|facet| &facet.corners).all(|corner| outside(corner) <= 0.0) {
        return;
    }
    // Where the cut enters each facet that it crosses, and where it leaves it.
    let mut next: Vec<(Corner, Corner)> = Vec::new();
    for facet in facets.iter_mut() {
        let mut kept = Vec::with_capacity(facet.corners.len() + 1);
        let (mut first, mut last) = (None, None);
        for (i, a) in facet.corners.iter().enumerate() {
            let b = &facet.corners[(i + 1) % facet.corners.len()];
            let (s_a, s_b) = (outside(a), outside(b));
            if s_a <= 0.0 {
                kept.push(*a);
            }
            if (s_a <= 0.0) != (s_b <= 0.0) {
                // From the end that stays, so that both facets at the edge find the same bits.
                let ([p, q], [s_p, s_q]) = if s_a <= 0.0 { ([a, b], [s_a, s_b]) } else { ([b, a], [s_b, s_a]) };
                let position = p.position + (q.position - p.position) * (s_p / (s_p - s_q));
                let mut shared = a.planes.into_iter().filter(|plane| b.planes.contains(plane));
                let mut planes = [shared.next().unwrap_or(plane), shared.next().unwrap_or(plane), plane];
                planes.sort_unstable();
                let corner = Corner { position, planes };
                kept.push(corner);
                *(if s_a <= 0.0 { &mut first } else { &mut last }) = Some(corner);
            }
        }
        // Around the new face the edge runs the other way.
        next.extend(last.zip(first));
        facet.corners = kept;
    }
    facets.retain(|facet| facet.corners.len() > 2);
    let Some(&(start, _)) = next.first() else { return };
    let mut corners = vec![start];
    let mut planes = start.planes;
    while let Some(&(_, to)) = next.iter().find(|(from, _)| from.planes == planes) {
        if to.planes == start.planes || corners.len() > next.len() {
            break;
        }
        corners.push(to);
        planes = to.planes;
    }
    facets.push(Facet { corners });
}

/// The points by where they are: boxes of about one point each.
struct Buckets {
    side: i64,
    sites: Vec<Vec<u32>>,
}

impl Buckets {
    fn new(all: &[DVec3]) -> Self {
        let side = (all.len() as f64).cbrt().floor().max(1.0) as i64;
        let mut buckets = Self { side, sites: vec![Vec::new(); side.pow(3) as usize] };
        for (site, number) in all.iter().zip(0..) {
            let place = buckets.place(buckets.of(*site));
            buckets.sites[place].push(number);
        }
        buckets
    }

    fn of(&self, p: DVec3) -> [i64; 3] {
        p.to_array().map(|x| ((x * self.side as f64) as i64).min(self.side - 1))
    }

    fn place(&self, [i, j, k]: [i64; 3]) -> usize {
        ((k * self.side + j) * self.side + i) as usize
    }

    /// The cell of point `site`.
    fn cell(&self, sites: &[DVec3], site: usize) -> Vec<Facet> {
        let (own, center) = (sites[site], self.of(sites[site]));
        let mut facets = cube();
        let mut around = Vec::new();
        for shell in 0..self.side {
            // A point in this shell or beyond is so far away at least, and cuts half-way.
            let reach = facets.iter().flat_map(|facet| &facet.corners).map(|corner| corner.position.distance(own));
            if (shell - 1) as f64 / self.side as f64 > 2.0 * reach.fold(0.0, f64::max) {
                break;
            }
            around.clear();
            let range = |axis: usize| (center[axis] - shell).max(0)..=(center[axis] + shell).min(self.side - 1);
            for k in range(2) {
                for j in range(1) {
                    for i in range(0) {
                        let away = [i - center[0], j - center[1], k - center[2]].map(i64::abs);
                        if away.into_iter().max() == Some(shell) {
                            around.extend_from_slice(&self.sites[self.place([i, j, k])]);
                        }
                    }
                }
            }
            around.retain(|&other| other as usize != site);
            let distance = |&other: &u32| sites[other as usize].distance_squared(own);
            around.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
            for &other in &around {
                let other_site = sites[other as usize];
                let n = other_site - own;
                cut(&mut facets, n, n.dot((own + other_site) * 0.5), other);
            }
        }
        facets
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Dataset;

    #[test]
    fn cells_fill_the_cube_and_share_all_inner_faces() {
        for (cells, seed) in [(1, 1), (2, 1), (7, 3), (400, 2)] {
            let settings = Settings { cells, seed, ..Settings::default() };
            let mesh = voronoi(&settings).unwrap();
            let sides: usize = (0..mesh.polyhedra.cells()).map(|cell| mesh.polyhedra.faces(cell).len()).sum();
            let dataset = Dataset::from_cells(mesh).unwrap();
            assert_eq!((dataset.polyhedra.len() as u64, dataset.counts.inverted), (cells, 0));
            let volume: f64 = (0..dataset.cells()).map(|cell| dataset.volume_world(cell)).sum();
            assert!((volume - 1.0).abs() < 1e-6, "{cells}: {volume}");
            // Outer faces are those on the walls.
            let exterior: Vec<_> = dataset.polyhedra.exterior().collect();
            assert_eq!(sides + exterior.len(), 2 * dataset.polyhedra.faces());
            for face in exterior {
                let position = |v: u32| dataset.positions[v as usize];
                let is_on =
                    |axis: usize, wall: f32| face.around.iter().all(|&v| position(v)[axis].to_bits() == wall.to_bits());
                assert!((0..3).any(|axis| is_on(axis, 0.0) || is_on(axis, 1.0)), "{face:?}");
            }
        }
    }
}
