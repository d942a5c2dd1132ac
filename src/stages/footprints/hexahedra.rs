//! The faces of one hexahedron relative to a tile: up to twelve triangles, one a lane.
//!
//! A face of four corners is two triangles. On the picture their diagonal parts it: on either side of the line through the
//! diagonal's ends its depth is that of one triangle's plane. The line is D(x, y) = m·d(x, y), m = (p−e)×(q−p) for the ends
//! p, q by ascending number (parallel rays: m·(o(x, y)−p), m = f×(q−p)): affine, and the same bits for both cells at the face.
//!
//! Where every corner lies inside all faces ([`HexShape::is_convex`]) a ray enters through the farthest front face and leaves
//! through the nearest back face, as in a tetrahedron. A face whose triangles face both ways bounds the cell by each where it
//! folds outwards; where it folds inwards a ray may meet the cell twice, and the cell is [`Outline::Crossed`].
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use arrayvec::ArrayVec;
use glam::Vec3;

use super::planes::{FaceScalar, TileRays, cross, dot, plane};
use crate::columns::HexShape;
use crate::optics::lanes::{LANES, Lanes, Mask, mask};
use crate::stages::SceneVertex;

/// Triangles of a cell: two a face.
pub const TRIANGLES: usize = 12;

/// The triangles of a cell with their corners by ascending vertex number: their planes are the same bits in both cells that share them.
#[derive(Clone, Copy, Debug)]
pub struct Triangles {
    /// Corners of each by ascending number of their vertices; unused lanes repeat the first.
    pub corners: [[u8; 3]; LANES],
    /// Set where those run clockwise seen from outside.
    pub is_turned: Mask,
    /// Set where the triangle's own corner lies to the other side of the diagonal than (b−a)×(c−a) of its corners says.
    is_own_between: Mask,
    /// Ends of each face's diagonal, ascending.
    pub diagonals: [[u8; 2]; 6],
}

impl Triangles {
    /// Of the cell with vertices `vertex` and `shape`.
    #[inline(always)]
    pub fn new(vertex: [u32; 8], shape: HexShape) -> Self {
        let mut triangles = Self {
            corners: [[0; 3]; LANES],
            is_turned: [0; LANES],
            is_own_between: [0; LANES],
            diagonals: [[0; 2]; 6],
        };
        let number = |corner: u8| vertex[usize::from(corner & 7)];
        for face in 0..6 {
            let both = shape.triangles(face);
            let [mut p, mut q, _] = both[0];
            let is_falling = number(q) < number(p);
            if is_falling {
                (p, q) = (q, p);
            }
            triangles.diagonals[face] = [p, q];
            for side in 0..2 {
                let own = both[side][2];
                let (below, above) = (number(own) < number(p), number(own) > number(q));
                let sorted = if below {
                    [own, p, q]
                } else if above {
                    [p, q, own]
                } else {
                    [p, own, q]
                };
                // p q own is counterclockwise for the first triangle unless the ends were exchanged, for the second if they were.
                let is_between = !(below || above);
                let is_clockwise = is_falling ^ (side == 1);
                let lane = 2 * face + side;
                triangles.corners[lane] = sorted;
                triangles.is_turned[lane] = mask(is_clockwise ^ is_between);
                triangles.is_own_between[lane] = mask(is_between);
            }
        }
        triangles
    }
}

/// A face, or one of its triangles, on one side of a cell.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The triangle where `side` is negative, and the one where it is not; the same for a triangle by itself.
    pub triangles: [u8; 2],
    /// Which side of the diagonal a position is on: at the tile's first pixel, per column, per row.
    pub side: [f32; 3],
}

/// How a cell is bounded on the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outline {
    /// A ray meets it once at most: by its surfaces.
    Simple,
    /// A ray may meet it more than once, or the near or far plane cuts it: by the triangles that it meets.
    Crossed,
}

/// The footprint of one hexahedron relative to a tile.
#[derive(Clone, Debug)]
pub struct HexFootprint {
    /// Inverse depth of each triangle's plane at the tile's first pixel, per column, per row.
    pub planes: [Lanes; 3],
    /// The scalar on each triangle.
    pub scalars: [FaceScalar; TRIANGLES],
    /// Surfaces through which rays enter.
    pub fronts: ArrayVec<Surface, TRIANGLES>,
    /// Surfaces through which rays leave.
    pub backs: ArrayVec<Surface, TRIANGLES>,
    /// How it is bounded.
    pub outline: Outline,
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
}

impl Default for HexFootprint {
    fn default() -> Self {
        Self {
            planes: [[0.0; LANES]; 3],
            scalars: [FaceScalar::default(); TRIANGLES],
            fronts: ArrayVec::new(),
            backs: ArrayVec::new(),
            outline: Outline::Crossed,
            v_min: 0.0,
            v_max: 0.0,
            s_min: 0.0,
            s_max: 0.0,
            sides: [0; 4],
        }
    }
}

impl HexFootprint {
    /// Computes the footprint of the cell with vertices `vertex`; `constant` is its value where it has one.
    #[inline(always)]
    pub fn set_up(
        &mut self,
        rays: &TileRays,
        (vertex, shape): ([u32; 8], HexShape),
        vertices: &[SceneVertex],
        constant: Option<f32>,
    ) {
        let corners = vertex.map(|v| vertices[v as usize]);
        let p = corners.map(|corner| Vec3::from_array(corner.position));
        let triangles = Triangles::new(vertex, shape);
        let extent = rays.extent(&p);
        (self.v_min, self.v_max, self.sides) = (extent.v_min, extent.v_max, extent.sides);

        let (mut is_along, mut is_flat) = ([0; LANES], [0; LANES]);
        let mut of = [[[0.0_f32; LANES]; 3]; 3];
        for lane in 0..LANES {
            for k in 0..3 {
                let corner = p[usize::from(triangles.corners[lane][k] & 7)];
                (of[k][0][lane], of[k][1][lane], of[k][2][lane]) = (corner.x, corner.y, corner.z);
            }
        }
        for lane in 0..LANES {
            let corner = |k: usize| Vec3::new(of[k][0][lane], of[k][1][lane], of[k][2][lane]);
            let (a, b, c) = (corner(0), corner(1), corner(2));
            let ([at_first, per_column, per_row], along) = plane(rays, [a, b, c]);
            (self.planes[0][lane], self.planes[1][lane], self.planes[2][lane]) = (at_first, per_column, per_row);
            is_along[lane] = along;
            let n = cross(b - a, c - a);
            is_flat[lane] = mask(dot(n, n) == 0.0);
        }
        match constant {
            Some(value) => (self.s_min, self.s_max) = (value, value),
            None => {
                let s = corners.map(|corner| corner.scalar);
                self.s_min = s.iter().copied().fold(f32::INFINITY, f32::min);
                self.s_max = s.iter().copied().fold(f32::NEG_INFINITY, f32::max);
                for (scalar, corners) in self.scalars.iter_mut().zip(triangles.corners) {
                    let corners = corners.map(|i| usize::from(i & 7));
                    *scalar = FaceScalar::of_face(rays, corners.map(|i| p[i]), corners.map(|i| s[i]));
                }
            }
        }
        let is_whole = shape.is_convex() && extent.is_within;
        self.outline = if is_whole { Outline::Simple } else { Outline::Crossed };
        self.fronts.clear();
        self.backs.clear();
        for face in 0..6 {
            let [first, second] = [2 * face, 2 * face + 1];
            // The ray leaves through a triangle whose outward normal runs along with it.
            let is_back = |lane: usize| (is_along[lane] ^ triangles.is_turned[lane]) & 1 == 1;
            let mut add = |is_back: bool, surface| {
                if is_back { self.backs.push(surface) } else { self.fronts.push(surface) }
            };
            let alone = |lane: usize| Surface { triangles: [lane as u8; 2], side: [0.0; 3] };
            match (is_flat[first] == 0, is_flat[second] == 0) {
                (false, false) => {}
                (true, false) => add(is_back(first), alone(first)),
                (false, true) => add(is_back(second), alone(second)),
                (true, true) if is_back(first) == is_back(second) => {
                    let ends = triangles.diagonals[face].map(|i| p[usize::from(i)]);
                    // The own corner of a triangle lies on the diagonal's positive side where det(p, q, own) is positive.
                    let is_first_positive = (is_along[first] ^ triangles.is_own_between[first]) & 1 == 1;
                    let both = if is_first_positive { [second, first] } else { [first, second] };
                    add(is_back(first), Surface { triangles: both.map(|lane| lane as u8), side: rays.side_of(ends) });
                }
                (true, true) => {
                    if shape.is_concave(face) {
                        self.outline = Outline::Crossed;
                    }
                    add(is_back(first), alone(first));
                    add(is_back(second), alone(second));
                }
            }
        }
    }
}
