//! The triangles of one polyhedron relative to a tile, and how rays cross them.
//!
//! For the triangle a, b, c, counterclockwise seen from outside, and a ray from the eye e along d(x, y), let
//! `D_a = ((b−e)×(c−b))·d`, and `D_b`, `D_c` likewise (parallel rays o(x, y) along f: `D_a = (f×(c−b))·(o−b)`): affine in x and y, one number for
//! each edge, of opposite sign for the two triangles at it. The line of the ray crosses the triangle where the three have one sign:
//! all positive where it leaves the cell, all negative where it enters. The crossing is at `(D_a a + D_b b + D_c c) / (D_a + D_b + D_c)`: its
//! depth and its scalar are means of the corners' with these weights, never outside of what they are between, however steep the
//! triangle stands; no plane is needed.
//!
//! Whether and which way a ray crosses is decided by the signs alone. Each edge is computed from its ends in the order of their
//! coordinates, so that both triangles at it, of one cell or of two, get the same bits: a ray leaves a closed cell as often as it
//! enters it. Depths count from the cell's middle, so that the difference of two keeps its digits however far away the cell is; it is
//! what Roettger and Ertl (2003, section 3) normalise their lengths for, whose eight bits need it more.

use glam::{DVec3, Vec3};

use super::planes::TileRays;
use crate::columns::PolyhedraView;
use crate::stages::{SceneVertex, View};

/// The rays of a tile in f64.
#[derive(Clone, Copy, Debug)]
pub struct ExactRays {
    is_perspective: bool,
    eye: DVec3,
    forward: DVec3,
    /// Direction (perspective) or origin of the ray of the tile's first pixel.
    first: DVec3,
    step_x: DVec3,
    step_y: DVec3,
}

impl ExactRays {
    /// The rays of the tile that begins at pixel (x, y).
    pub fn new(view: &View, x: u32, y: u32) -> Self {
        let View { is_perspective, eye, forward, step_x, step_y, corner, .. } = view.beside();
        let aside = corner + step_x * f64::from(x) + step_y * f64::from(y);
        let first = if is_perspective { forward + aside } else { eye + aside };
        Self { is_perspective, eye, forward, first, step_x, step_y }
    }

    /// Which side of the edge from p to q a position is on: at the tile's first pixel, per column, per row.
    fn side_of(&self, p: DVec3, q: DVec3) -> [f32; 3] {
        let (m, first) = if self.is_perspective {
            ((p - self.eye).cross(q - p), self.first)
        } else {
            (self.forward.cross(q - p), self.first - p)
        };
        [m.dot(first) as f32, m.dot(self.step_x) as f32, m.dot(self.step_y) as f32]
    }

    fn depth(&self, p: DVec3) -> f64 {
        (p - self.eye).dot(self.forward)
    }
}

/// A triangle by the edges opposite to its corners.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Which edges they are.
    pub edges: [u32; 3],
    /// Whether each runs clockwise around the triangle, seen from outside: all bits or none.
    pub is_turned: [u32; 3],
    /// Depths of the corners, from [`PolyFootprint::w_middle`].
    pub w: [f32; 3],
    /// Stored values at the corners.
    pub s: [f32; 3],
}

/// The footprint of one polyhedron relative to a tile.
#[derive(Clone, Debug, Default)]
pub struct PolyFootprint {
    /// Which side of each edge a position is on: at the tile's first pixel, per column, per row.
    pub edges: Vec<[f32; 3]>,
    /// The triangles of all faces.
    pub triangles: Vec<Triangle>,
    /// The depth from which others count.
    pub w_middle: f32,
    /// Shorter segments, in depth, are rounding: where a face that is not convex is a fan whose triangles overlap, a ray beside it
    /// crosses two of them at one depth.
    pub w_least: f32,
    /// Smallest and largest inverse depth of its corners within the view's range.
    pub v_min: f32,
    /// See `v_min`.
    pub v_max: f32,
    /// Smallest and largest stored value.
    pub s_min: f32,
    /// See `s_min`.
    pub s_max: f32,
    /// The pixels of the tile that it may cover: first column, column after the last, and the same for rows.
    pub sides: [usize; 4],
    positions: Vec<Vec3>,
}

/// Of a cell's depth, what is no length: some ulp of it.
pub(in crate::stages) const LEAST: f32 = 1e-6;

/// A corner: where it is, its depth and its value.
#[derive(Clone, Copy)]
struct Corner {
    position: [f32; 3],
    exact: DVec3,
    w: f32,
    s: f32,
}

impl PolyFootprint {
    /// Computes the footprint of cell `cell` of `polyhedra`; `constant` is its value where it has one.
    pub fn set_up(
        &mut self,
        (rays, exact): (&TileRays, &ExactRays),
        (polyhedra, cell): (&PolyhedraView<'_>, usize),
        vertices: &[SceneVertex],
        constant: Option<f32>,
    ) {
        self.edges.clear();
        self.triangles.clear();
        self.positions.clear();
        let (mut w_min, mut w_max) = (f64::INFINITY, f64::NEG_INFINITY);
        (self.s_min, self.s_max) = constant.map_or((f32::INFINITY, f32::NEG_INFINITY), |value| (value, value));
        for &v in polyhedra.corners(cell) {
            let SceneVertex { position, scalar } = vertices[v as usize];
            self.positions.push(Vec3::from_array(position));
            let w = exact.depth(Vec3::from_array(position).as_dvec3());
            (w_min, w_max) = (w_min.min(w), w_max.max(w));
            if constant.is_none() {
                (self.s_min, self.s_max) = (self.s_min.min(scalar), self.s_max.max(scalar));
            }
        }
        let extent = rays.extent(&self.positions);
        (self.v_min, self.v_max, self.sides) = (extent.v_min, extent.v_max, extent.sides);
        self.w_least = LEAST * (w_max - w_min) as f32;
        self.w_middle = (0.5 * (w_min + w_max)) as f32;

        let w_middle = f64::from(self.w_middle);
        let corner = |v: u32| {
            let SceneVertex { position, scalar } = vertices[v as usize];
            let p = Vec3::from_array(position).as_dvec3();
            Corner { position, exact: p, w: (exact.depth(p) - w_middle) as f32, s: constant.unwrap_or(scalar) }
        };
        for face in polyhedra.faces(cell) {
            let first = corner(face.around[0]);
            let mut before = corner(face.around[1]);
            let mut to_before = self.edge(exact, first, before);
            for &v in &face.around[2..] {
                let next = corner(v);
                let (outer, to_next) = (self.edge(exact, before, next), self.edge(exact, first, next));
                // Opposite to `first`, `before`, `next`; the second runs from `next` to `first`.
                let turned = [outer.1, !to_next.1, to_before.1].map(|is_turned| is_turned != face.is_reversed);
                self.triangles.push(Triangle {
                    edges: [outer.0, to_next.0, to_before.0],
                    is_turned: turned.map(|is_turned| u32::from(is_turned).wrapping_neg()),
                    w: [first.w, before.w, next.w],
                    s: [first.s, before.s, next.s],
                });
                (before, to_before) = (next, to_next);
            }
        }
    }

    /// Adds the edge between two corners: its number, and whether it runs from q to p.
    fn edge(&mut self, rays: &ExactRays, p: Corner, q: Corner) -> (u32, bool) {
        let is_turned = p.position > q.position;
        let [low, high] = if is_turned { [q, p] } else { [p, q] };
        self.edges.push(rays.side_of(low.exact, high.exact));
        (self.edges.len() as u32 - 1, is_turned)
    }
}
