//! Incremental Delaunay triangulation (Bowyer 1981, Watson 1981) with exact predicates (Shewchuk 1997).
//!
//! A new point p is in conflict with every cell whose circumsphere holds it. These cells form a cavity that p sees
//! whole: they are removed, and each face of the cavity makes a new cell with p. The outside of the hull is cells too:
//! each face of the hull has one with the ghost vertex, in conflict with what lies beyond the face, so that a point
//! outside is inserted like any other. A point in the plane of a hull face is in conflict with its ghost cell if it
//! lies in the face's circumcircle, which is where the sphere of the cell behind the face meets the plane. With that
//! rule a face and p in one plane are in conflict on both sides or on neither, so that no new cell is flat.

use crate::error::Result;
use crate::generate::random;
use crate::generate::settings::check_len;

/// The vertex at infinity.
const GHOST: u32 = u32::MAX;

/// Stream of the random numbers that choose where a walk tries first.
const WALK: u64 = 0x3a1c;

/// A mesh of a growing prefix of the points, ghost cells included.
pub(super) struct Triangulation<'a> {
    points: &'a [[f64; 3]],
    /// Vertices; [`orient`] is positive with any point beyond the hull face in place of the ghost. All ghosts: not in
    /// use.
    tets: Vec<[u32; 4]>,
    /// The cell across the face that lacks vertex i.
    neighbors: Vec<[u32; 4]>,
    /// Twice the point whose insertion tested the cell last, plus one where they were in conflict.
    tested: Vec<u64>,
    /// A cell made by the last insertion.
    last: u32,
    unused: Vec<u32>,
    // Kept between insertions for their memory alone.
    cavity: Vec<u32>,
    faces: Vec<CavityFace>,
    sides: Vec<(u64, u32, u32)>,
}

/// A face between a cell of the cavity and one outside of it.
struct CavityFace {
    /// The new cell: the cavity's, with p in place of the vertex that the face lacks.
    tet: [u32; 4],
    /// Where p is in it.
    apex: usize,
    outside: u32,
}

impl<'a> Triangulation<'a> {
    /// The mesh of the first four points, for which [`orient`] is positive.
    pub(super) fn new(points: &'a [[f64; 3]]) -> Self {
        // Cell 0, and the ghost cell 1 + i across its face i: the ghost in place of vertex i, two others exchanged,
        // since what lies beyond the face sees it from the other side.
        let mut tets = vec![[0, 1, 2, 3]];
        let mut neighbors = vec![[1, 2, 3, 4]];
        for i in 0..4_u32 {
            let mut ghost = [0, 1, 2, 3];
            let mut across = [1, 2, 3, 4];
            ghost[i as usize] = GHOST;
            across[i as usize] = 0;
            let [j, k] = [(i as usize + 1) % 4, (i as usize + 2) % 4];
            ghost.swap(j, k);
            across.swap(j, k);
            tets.push(ghost);
            neighbors.push(across);
        }
        Self {
            points,
            tested: vec![0; tets.len()],
            tets,
            neighbors,
            last: 0,
            unused: Vec::new(),
            cavity: Vec::new(),
            faces: Vec::new(),
            sides: Vec::new(),
        }
    }

    /// Adds point `v`, unless it coincides with one that is there.
    pub(super) fn insert(&mut self, v: u32) -> Result<()> {
        let Some(start) = self.locate(v) else { return Ok(()) };
        self.carve(v, start);
        self.fill(v)
    }

    /// The cells without a ghost.
    pub(super) fn finish(self) -> impl Iterator<Item = [u32; 4]> {
        self.tets.into_iter().filter(|tet| !tet.contains(&GHOST))
    }

    /// A cell in conflict with `v`, or none where `v` coincides with a vertex.
    ///
    /// Walks from the last new cell across a face that has `v` strictly beyond it. Which face is tried first is random,
    /// for a walk among cells of one sphere may go in circles otherwise.
    fn locate(&self, v: u32) -> Option<u32> {
        let p = self.points[v as usize];
        let mut cell = self.last;
        if let Some(ghost) = ghost_of(self.tets[cell as usize]) {
            cell = self.neighbors[cell as usize][ghost];
        }
        let mut before = GHOST;
        for step in 0..self.tets.len() as u64 {
            let (tet, neighbors) = (self.tets[cell as usize], self.neighbors[cell as usize]);
            let first = random::bits(u64::from(v), WALK, step) as usize;
            let exit = (0..4)
                .map(|i| (first.wrapping_add(i)) % 4)
                .find(|&i| neighbors[i] != before && orient(self.positions_with(tet, i, p)) < 0.0);
            let Some(exit) = exit else {
                return if tet.iter().any(|&u| coincide(self.points[u as usize], p)) { None } else { Some(cell) };
            };
            (before, cell) = (cell, neighbors[exit]);
            if ghost_of(self.tets[cell as usize]).is_some() {
                return Some(cell);
            }
        }
        // As improbable as a coin that always falls on the same side.
        (0..self.tets.len() as u32).find(|&cell| self.tets[cell as usize] != [GHOST; 4] && self.in_conflict(cell, p))
    }

    /// Collects all cells in conflict with `v`, and the faces around them.
    fn carve(&mut self, v: u32, start: u32) {
        let p = self.points[v as usize];
        let (spared, removed) = (2 * u64::from(v), 2 * u64::from(v) + 1);
        self.cavity.clear();
        self.faces.clear();
        self.cavity.push(start);
        self.tested[start as usize] = removed;
        let mut next = 0;
        while let Some(&cell) = self.cavity.get(next) {
            next += 1;
            for (apex, outside) in self.neighbors[cell as usize].into_iter().enumerate() {
                let tested = self.tested[outside as usize];
                if tested == removed {
                    continue;
                }
                if tested != spared {
                    if self.in_conflict(outside, p) {
                        self.tested[outside as usize] = removed;
                        self.cavity.push(outside);
                        continue;
                    }
                    self.tested[outside as usize] = spared;
                }
                let mut tet = self.tets[cell as usize];
                tet[apex] = v;
                // The neighbour must forget the cell before its number is used again.
                self.faces.push(CavityFace { tet, apex, outside });
                let back = self.neighbors[outside as usize].iter_mut().find(|n| **n == cell);
                if let Some(back) = back {
                    *back = GHOST;
                }
            }
        }
    }

    /// Makes a cell of each face of the cavity and joins it to its neighbours.
    fn fill(&mut self, v: u32) -> Result<()> {
        check_len("cells", (self.tets.len() + self.faces.len()) as u128)?;
        for &cell in &self.cavity {
            self.tets[cell as usize] = [GHOST; 4];
        }
        self.unused.append(&mut self.cavity);
        self.sides.clear();
        for CavityFace { tet, apex, outside } in self.faces.drain(..) {
            let cell = self.unused.pop().unwrap_or_else(|| {
                self.tets.push(tet);
                self.neighbors.push([GHOST; 4]);
                self.tested.push(0);
                (self.tets.len() - 1) as u32
            });
            self.tets[cell as usize] = tet;
            self.neighbors[cell as usize][apex] = outside;
            // The neighbour's face is the one whose three vertices the new cell has.
            let (tets, neighbors) = (&self.tets, &mut self.neighbors[outside as usize]);
            let slot = (0..4).find(|&i| neighbors[i] == GHOST && !tet.contains(&tets[outside as usize][i]));
            debug_assert!(slot.is_some());
            if let Some(slot) = slot {
                neighbors[slot] = cell;
            }
            // The other faces: p and an edge, which two new cells have in common.
            for side in (0..4).filter(|&side| side != apex) {
                let [a, b] = edge_without(tet, apex, side);
                self.sides.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), cell, side as u32));
            }
            self.last = cell;
        }
        self.sides.sort_unstable();
        debug_assert!(self.sides.len().is_multiple_of(2), "point {v}: the cavity is not closed");
        for pair in self.sides.chunks_exact(2) {
            let [(edge_a, a, side_a), (edge_b, b, side_b)] = [pair[0], pair[1]];
            debug_assert_eq!(edge_a, edge_b, "point {v}: the cavity is not closed");
            self.neighbors[a as usize][side_a as usize] = b;
            self.neighbors[b as usize][side_b as usize] = a;
        }
        Ok(())
    }

    fn in_conflict(&self, cell: u32, p: [f64; 3]) -> bool {
        let tet = self.tets[cell as usize];
        let Some(ghost) = ghost_of(tet) else { return self.in_sphere(tet, p) };
        let beyond = orient(self.positions_with(tet, ghost, p));
        if beyond != 0.0 {
            return beyond > 0.0;
        }
        self.in_sphere(self.tets[self.neighbors[cell as usize][ghost] as usize], p)
    }

    fn in_sphere(&self, tet: [u32; 4], p: [f64; 3]) -> bool {
        let [a, b, c, d] = tet.map(|v| coord(self.points[v as usize]));
        robust::insphere(a, b, c, d, coord(p)) > 0.0
    }

    /// The vertices of `tet`, with `p` in place of vertex `i`, which may be the ghost.
    fn positions_with(&self, tet: [u32; 4], i: usize, p: [f64; 3]) -> [[f64; 3]; 4] {
        std::array::from_fn(|j| if j == i { p } else { self.points[tet[j] as usize] })
    }
}

/// Where the ghost is among the vertices, if it is.
fn ghost_of(tet: [u32; 4]) -> Option<usize> {
    tet.iter().position(|&v| v == GHOST)
}

/// The two vertices of `tet` at neither place.
fn edge_without(tet: [u32; 4], i: usize, j: usize) -> [u32; 2] {
    let first = (0..4).find(|&k| k != i && k != j).unwrap_or(0);
    [tet[first], tet[6 - i - j - first]]
}

fn coord([x, y, z]: [f64; 3]) -> robust::Coord3D<f64> {
    robust::Coord3D { x, y, z }
}

/// Whether two points are one; 0 and −0 are.
#[expect(clippy::float_cmp, reason = "the predicates are exact, so is this one")]
pub(super) fn coincide(a: [f64; 3], b: [f64; 3]) -> bool {
    a == b
}

/// Positive where d lies below the plane of a, b, c seen counterclockwise; the sign is exact.
pub(super) fn orient([a, b, c, d]: [[f64; 3]; 4]) -> f64 {
    robust::orient3d(coord(a), coord(b), coord(c), coord(d))
}
