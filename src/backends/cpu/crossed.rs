//! Hexahedra that a ray may meet more than once, or that the near or far plane cuts: ray by ray, by the triangles it crosses.
//!
//! In: a cell. Out: all segments that rays have in it, as [`Parts`].
//! Whether a ray crosses a triangle is decided by its three edges, each by the sign of one affine function, the same for all
//! triangles at the edge: a ray through an edge crosses just one of two triangles that face the same way. In f64.

use arrayvec::ArrayVec;
use glam::DVec3;

use super::cell_kernels::Hexahedron;
use super::parts::{Part, Parts};
use super::tile::{BLOCKS, place_of};
use crate::columns::HexShape;
use crate::optics::{LANES, Lanes};
use crate::stages::View;
use crate::stages::footprints::hexahedra::{HexFootprint, TRIANGLES};

/// The parts of all rays in one cell; kept between cells and frames.
#[derive(Debug, Default)]
pub(super) struct Crossed {
    pub(super) parts: Parts,
}

/// Edges of the triangles of a hexahedron: twelve, and six diagonals.
const EDGES: usize = 18;

/// A triangle with its edges.
#[derive(Clone, Copy, Debug)]
struct Triangle {
    /// Outward normal: (a − e)·n and the affine n·d, whose ratio is the depth.
    height: f64,
    along: [f64; 3],
    /// Its three edges, a bit each, and those of them that run as its corners do.
    edges: u32,
    forward: u32,
}

/// Which side of an edge a ray is on, as an affine function of its position in the picture.
#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [u8; 2],
    side: [f64; 3],
}

fn at([c, dx, dy]: [f64; 3], [x, y]: [f64; 2]) -> f64 {
    c + dx * x + dy * y
}

/// The edges and triangles of a cell.
struct Skin {
    edges: ArrayVec<Edge, EDGES>,
    triangles: ArrayVec<Triangle, TRIANGLES>,
}

impl Skin {
    fn new(view: &View, first_px: [f64; 2], (vertex, shape): ([u32; 8], HexShape), p: [DVec3; 8]) -> Self {
        let aside = view.corner + view.step_x * first_px[0] + view.step_y * first_px[1];
        // n·d along rays from the eye; n·(o − a) along parallel ones, for a point a of the plane.
        let affine = |n: DVec3, a: DVec3| {
            let first = if view.is_perspective { view.forward + aside } else { view.eye + aside - a };
            [n.dot(first), n.dot(view.step_x), n.dot(view.step_y)]
        };
        let mut skin = Self { edges: ArrayVec::new(), triangles: ArrayVec::new() };
        for triangle in (0..6).flat_map(|face| shape.triangles(face)) {
            let corners = triangle.map(usize::from);
            let [a, b, c] = corners.map(|i| p[i]);
            let n = (b - a).cross(c - a);
            if n == DVec3::ZERO {
                continue;
            }
            let (mut edges, mut forward) = (0, 0);
            for (i, k) in [(0, 1), (1, 2), (2, 0)] {
                let (i, k) = (corners[i], corners[k]);
                let is_forward = vertex[i] < vertex[k];
                let ends = if is_forward { [i as u8, k as u8] } else { [k as u8, i as u8] };
                // Coincident corners are one point: edges are compared by where they are.
                let place = |ends: [u8; 2]| ends.map(|end| p[usize::from(end)]);
                let known = skin.edges.iter().position(|edge| place(edge.ends) == place(ends));
                let number = known.unwrap_or_else(|| {
                    let [q, r] = place(ends);
                    let m = if view.is_perspective { (q - view.eye).cross(r - q) } else { view.forward.cross(r - q) };
                    skin.edges.push(Edge { ends, side: affine(m, q) });
                    skin.edges.len() - 1
                });
                edges |= 1 << number;
                forward |= u32::from(is_forward) << number;
            }
            let height = if view.is_perspective { (a - view.eye).dot(n) } else { n.dot(view.forward) };
            skin.triangles.push(Triangle { height, along: affine(n, a), edges, forward });
        }
        skin
    }

    /// Number, depth and whether it leaves, of each triangle that the line of the ray at `position` crosses, nearest first.
    fn crossings(&self, view: &View, position: [f64; 2]) -> ArrayVec<(usize, f64, bool), TRIANGLES> {
        let mut left = 0_u32;
        for (number, edge) in self.edges.iter().enumerate() {
            left |= u32::from(at(edge.side, position) >= 0.0) << number;
        }
        let mut crossings = ArrayVec::new();
        for (number, triangle) in self.triangles.iter().enumerate() {
            // The ray is on the same side of all three, seen along the triangle.
            let sides = left & triangle.edges;
            if sides != triangle.forward && sides != triangle.edges ^ triangle.forward {
                continue;
            }
            let along = at(triangle.along, position);
            // Perspective: w = n·(a−e) / n·d. Parallel: w = −n·(o−a) / n·f. It leaves where the outward normal runs along.
            let (w, leaves) = if view.is_perspective {
                (triangle.height / along, along > 0.0)
            } else {
                (-along / triangle.height, triangle.height > 0.0)
            };
            if w.is_finite() {
                crossings.push((number, w, leaves));
            }
        }
        crossings.sort_by(|a: &(usize, f64, bool), b| a.1.total_cmp(&b.1));
        crossings
    }
}

impl Crossed {
    /// Finds the parts of all rays of the tile in the cell.
    #[inline(never)]
    pub(super) fn find(
        &mut self,
        (view, first_px, limits): (&View, [u32; 2], Option<&[Lanes; BLOCKS]>),
        hexahedron: &Hexahedron<'_>,
        cell: &HexFootprint,
    ) {
        let Hexahedron { vertex, shape, vertices, .. } = *hexahedron;
        let view = &view.beside();
        self.parts.clear();
        let corners = vertex.map(|v| vertices[v as usize]);
        let p = corners.map(|corner| DVec3::from_array(corner.position.map(f64::from)));
        // A damaged container may have a corner nowhere.
        if !p.iter().all(|corner| corner.is_finite()) {
            return;
        }
        let s = corners.map(|corner| f64::from(corner.scalar));
        let first_px = first_px.map(f64::from);
        let skin = Skin::new(view, first_px, (vertex, shape), p);
        let scalars = if cell.s_min < cell.s_max { scalars(&skin, shape, p, s) } else { ArrayVec::new() };
        let [x0, x1, y0, y1] = cell.sides;
        let (near, far) = (f64::from(view.near), f64::from(view.far));
        for y in y0..y1 {
            for x in x0..x1 {
                let position = [x as f64, y as f64];
                let [column, row] = [first_px[0] + position[0], first_px[1] + position[1]];
                let aside = view.corner + view.step_x * column + view.step_y * row;
                let point = |w: f64| {
                    if view.is_perspective {
                        view.eye + (view.forward + aside) * w
                    } else {
                        view.eye + aside + view.forward * w
                    }
                };
                let value = |(number, w, _): (usize, f64, bool)| {
                    scalars
                        .get(number)
                        .map_or(f64::from(cell.s_min), |&(gradient, constant)| gradient.dot(point(w)) + constant)
                };
                // Opaque geometry ends the ray.
                let place = place_of(x, y);
                let limit = limits.map_or(f64::INFINITY, |limits| depth_of(view, limits[place / LANES][place % LANES]));
                let far = far.min(limit);
                let (mut inside, mut nth) = (0_i32, 0);
                let crossings = skin.crossings(view, position);
                for two in crossings.windows(2) {
                    inside += if two[0].2 { -1 } else { 1 };
                    let (w0, w1) = (two[0].1.max(near), two[1].1.min(far));
                    if inside == 0 || w0 >= w1 {
                        continue;
                    }
                    let (s0, s1) = (value(two[0]), value(two[1]));
                    let along = |w: f64| s0 + (s1 - s0) * ((w - two[0].1) / (two[1].1 - two[0].1));
                    let stored = |w: f64| (along(w) as f32).clamp(cell.s_min, cell.s_max);
                    let v = [w0, w1].map(|w| if view.is_perspective { 1.0 / w } else { -w } as f32);
                    self.parts.push(Part { pixel: [x as u8, y as u8], nth, v, s: [stored(w0), stored(w1)] });
                    nth += 1;
                }
            }
        }
    }
}

/// Of each triangle, the gradient of the scalar in its plane and what is added to its product with a position.
fn scalars(skin: &Skin, shape: HexShape, p: [DVec3; 8], s: [f64; 8]) -> ArrayVec<(DVec3, f64), TRIANGLES> {
    let mut scalars = ArrayVec::new();
    for triangle in (0..6).flat_map(|face| shape.triangles(face)) {
        let [a, b, c] = triangle.map(usize::from);
        let (u, v) = (p[b] - p[a], p[c] - p[a]);
        let n = u.cross(v);
        if n == DVec3::ZERO {
            continue;
        }
        let gradient = (v.cross(n) * (s[b] - s[a]) + n.cross(u) * (s[c] - s[a])) / n.length_squared();
        scalars.push((gradient, s[a] - gradient.dot(p[a])));
    }
    debug_assert_eq!(scalars.len(), skin.triangles.len());
    scalars
}

/// The depth of an inverse depth; infinite where a ray goes on.
fn depth_of(view: &View, v: f32) -> f64 {
    match (v > f32::NEG_INFINITY, view.is_perspective) {
        (false, _) => f64::INFINITY,
        (true, true) => 1.0 / f64::from(v),
        (true, false) => -f64::from(v),
    }
}
