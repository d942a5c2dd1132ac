//! A grid of the unit cube in tetrahedra, its vertices jittered without ever turning a cell over.
//!
//! In: cells wanted, scheme, jitter, seed. Out: f32 points, x fastest, and positive tetrahedra that fill the cube
//! exactly: a vertex of the boundary stays on its face or edge, a corner stays. O(cells); the same bytes for any number
//! of threads.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::random;
use super::settings::{Scheme, Settings, check_len};
use crate::error::Result;

/// No cell keeps less than this part of its volume in the regular grid.
///
/// Moving each coordinate of four vertices by at most j spacings leaves a cell at least 1 − 6j of its volume (the
/// determinant is linear in each coordinate, so its minimum lies at one of 2^12 corners; a test visits them all). A
/// cell that a larger jitter squeezes below this part has the moves of its vertices halved; after two halvings j ≤
/// 0.0875.
const MIN_VOLUME_KEPT: f64 = 0.05;

/// The points and tetrahedra of a grid.
pub(super) struct Grid {
    /// Positions in the unit cube.
    pub(super) points: Vec<[f32; 3]>,
    /// Four points each, (b−a)×(c−a)·(d−a) > 0.
    pub(super) tets: Vec<[u32; 4]>,
}

/// The smallest grid that has at least `settings.cells` cells.
pub(super) fn grid(settings: &Settings) -> Result<Grid> {
    let lattice = Lattice::new(settings)?;
    let tets = (0..lattice.len()).into_par_iter().map(|i| lattice.tet(i)).collect();
    Ok(Grid { points: lattice.points(), tets })
}

/// The smallest n with n³ boxes of at least `cells` cells.
fn boxes_along_an_edge(cells: u64, scheme: Scheme) -> u128 {
    let enough = |n: u128| n.pow(3) * u128::from(scheme.tets_per_box()) >= u128::from(cells);
    // Rounding may put the estimate one off, in either direction.
    let mut n = ((cells as f64 / scheme.tets_per_box() as f64).cbrt() as u128).saturating_sub(2).max(1);
    while !enough(n) {
        n += 1;
    }
    n
}

/// The rule that makes a grid, tetrahedron by tetrahedron.
pub(super) struct Lattice {
    /// Boxes along an edge.
    boxes: usize,
    settings: Settings,
    /// The tetrahedra of an even and of an odd box.
    tets_of_box: [([[u8; 4]; 6], usize); 2],
}

impl Lattice {
    /// The smallest that gives at least `settings.cells` cells.
    pub(super) fn new(settings: &Settings) -> Result<Self> {
        settings.check()?;
        let boxes = boxes_along_an_edge(settings.cells, settings.scheme);
        check_len("cells", boxes.pow(3) * u128::from(settings.scheme.tets_per_box()))?;
        check_len("points", (boxes + 1).pow(3))?;
        let tets_of_box = [false, true].map(|odd| tets_of_box(settings.scheme, odd));
        Ok(Self { boxes: boxes as usize, settings: *settings, tets_of_box })
    }

    /// How many tetrahedra there are.
    pub(super) fn len(&self) -> usize {
        self.boxes.pow(3) * self.settings.scheme.tets_per_box() as usize
    }

    /// Tetrahedron `i`; those of a box follow each other.
    pub(super) fn tet(&self, i: usize) -> [u32; 4] {
        let (n, side, per_box) = (self.boxes, self.boxes + 1, self.settings.scheme.tets_per_box() as usize);
        let b = i / per_box;
        let [x, y, z] = [b % n, b / n % n, b / (n * n)];
        let (tets, _) = self.tets_of_box[(x + y + z) % 2];
        tets[i % per_box].map(|c| {
            ((x + usize::from(c & 1)) + side * ((y + usize::from(c >> 1 & 1)) + side * (z + usize::from(c >> 2))))
                as u32
        })
    }

    /// All points, jittered.
    pub(super) fn points(&self) -> Vec<[f32; 3]> {
        let side = self.boxes + 1;
        let mut points: Vec<[f32; 3]> = (0..side.pow(3)).into_par_iter().map(|v| self.point(v, 1.0)).collect();
        let mut halvings: Vec<u8> = Vec::new();
        while let squeezed = self.squeezed(&points)
            && !squeezed.is_empty()
        {
            halvings.resize(points.len(), 0);
            for v in squeezed {
                halvings[v] += 1;
                points[v] = self.point(v, 0.5_f64.powi(i32::from(halvings[v])));
            }
        }
        points
    }

    /// Point `v` with its jitter times `scale`; a coordinate on the boundary stays.
    fn point(&self, v: usize, scale: f64) -> [f32; 3] {
        let (n, side) = (self.boxes, self.boxes + 1);
        let lattice = [v % side, v / side % side, v / (side * side)];
        std::array::from_fn(|axis| {
            let i = lattice[axis];
            let jitter = if i == 0 || i == n || self.settings.jitter == 0.0 {
                0.0
            } else {
                let random = random::uniform(self.settings.seed, axis as u64, v as u64);
                scale * self.settings.jitter * (2.0 * random - 1.0)
            };
            ((i as f64 + jitter) / n as f64) as f32
        })
    }

    /// The vertices of all cells that keep too little of their volume, ascending, each once.
    fn squeezed(&self, points: &[[f32; 3]]) -> Vec<usize> {
        if 1.0 - 6.0 * self.settings.jitter > MIN_VOLUME_KEPT {
            return Vec::new(); // it cannot happen
        }
        let spacing = 1.0 / self.boxes as f64;
        let per_box = self.settings.scheme.tets_per_box() as usize;
        let mut squeezed: Vec<usize> = (0..self.len())
            .into_par_iter()
            .map(|i| (i, self.tet(i)))
            .filter(|&(i, tet)| {
                // Six times the regular volume, in boxes: 1, but 2 for the middle of five, which comes first.
                let regular = if per_box == 5 && i % per_box == 0 { 2.0 } else { 1.0 };
                volume_six_times(tet.map(|v| points[v as usize])) < MIN_VOLUME_KEPT * regular * spacing.powi(3)
            })
            .flat_map_iter(|(_, tet)| tet.map(|v| v as usize))
            .collect();
        squeezed.par_sort_unstable();
        squeezed.dedup();
        squeezed
    }
}

/// (b−a)×(c−a)·(d−a), in double precision.
pub(super) fn volume_six_times(tet: [[f32; 3]; 4]) -> f64 {
    let [a, b, c, d] = tet.map(|p| Vec3::from_array(p).as_dvec3());
    (b - a).cross(c - a).dot(d - a)
}

/// The tetrahedra of a box and how many they are; corner c has x = bit 0, y = bit 1, z = bit 2 of c.
fn tets_of_box(scheme: Scheme, odd: bool) -> ([[u8; 4]; 6], usize) {
    let mut tets = [[0; 4]; 6];
    match scheme {
        Scheme::Six => {
            // One for each order of the axes: from corner 0 along them, one after the other, to corner 7.
            let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
            tets = orders.map(|[a, b, _]| [0, 1 << a, 1 << a | 1 << b, 7]);
        }
        Scheme::Five => {
            // The diagonals of all faces join lattice points with an even sum of coordinates.
            let mirror = u8::from(odd);
            tets[0] = [0, 3, 5, 6].map(|c| c ^ mirror);
            for (tet, corner) in tets[1..].iter_mut().zip([1, 2, 4, 7]) {
                *tet = [corner, corner ^ 1, corner ^ 2, corner ^ 4].map(|c| c ^ mirror);
            }
        }
    }
    (tets.map(positive), scheme.tets_per_box() as usize)
}

/// Exchanges two corners where the tetrahedron is negative.
fn positive(tet: [u8; 4]) -> [u8; 4] {
    let [a, b, c, d] = tet.map(|c| DVec3::new(f64::from(c & 1), f64::from(c >> 1 & 1), f64::from(c >> 2)));
    if (b - a).cross(c - a).dot(d - a) < 0.0 { [tet[0], tet[1], tet[3], tet[2]] } else { tet }
}

#[cfg(test)]
mod tests;
