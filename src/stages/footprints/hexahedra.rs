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
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use arrayvec::ArrayVec;
use glam::Vec3;

use super::planes::{FaceScalar, TileRays, cross, dot, plane};
use crate::columns::HexShape;
use crate::optics::lanes::{LANES, Lanes, Mask, mask, max, min, select};
use crate::stages::SceneVertex;

/// Triangles of a cell: two a face.
pub const TRIANGLES: usize = 12;

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
    /// What varies on the picture of the scalar on each triangle, the same three (see [`FaceScalar`]): the slope in perspective,
    /// else the base.
    pub varying: [Lanes; 3],
    /// The other of base and slope.
    pub constant: Lanes,
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
            varying: [[0.0; LANES]; 3],
            constant: [0.0; LANES],
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

/// One corner of each triangle: its vertex; its position and scalar.
#[derive(Clone, Copy)]
struct CornerLanes {
    vertex: Mask,
    xyzs: [Lanes; 4],
}

impl CornerLanes {
    const NONE: Self = Self { vertex: [0; LANES], xyzs: [[0.0; LANES]; 4] };

    #[inline(always)]
    fn set(&mut self, lane: usize, vertex: u32, SceneVertex { position: [x, y, z], scalar }: SceneVertex) {
        self.vertex[lane] = vertex;
        for (of, value) in self.xyzs.iter_mut().zip([x, y, z, scalar]) {
            of[lane] = value;
        }
    }

    #[inline(always)]
    fn position(&self, lane: usize) -> Vec3 {
        Vec3::new(self.xyzs[0][lane], self.xyzs[1][lane], self.xyzs[2][lane])
    }

    #[inline(always)]
    fn scalar(&self, lane: usize) -> f32 {
        self.xyzs[3][lane]
    }

    /// Exchanges the two corners of a lane where the first has the greater number; a mask of whether they were.
    #[inline(always)]
    fn order(first: &mut Self, second: &mut Self, lane: usize) -> u32 {
        let (a, b) = (first.vertex[lane], second.vertex[lane]);
        let is_exchanged = mask(a > b);
        (first.vertex[lane], second.vertex[lane]) = (a.min(b), a.max(b));
        for of in 0..4 {
            let (a, b) = (first.xyzs[of][lane], second.xyzs[of][lane]);
            first.xyzs[of][lane] = select(is_exchanged, b, a);
            second.xyzs[of][lane] = select(is_exchanged, a, b);
        }
        is_exchanged
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
        // Written out: closures over arrays are not inlined into kernels.
        let mut corners = [SceneVertex { position: [0.0; 3], scalar: 0.0 }; 8];
        let mut positions = [Vec3::ZERO; 8];
        for (i, &v) in vertex.iter().enumerate() {
            corners[i] = vertices[v as usize];
            positions[i] = Vec3::from_array(corners[i].position);
        }
        let extent = rays.extent(&positions);
        (self.v_min, self.v_max, self.sides) = (extent.v_min, extent.v_max, extent.sides);
        self.outline = if shape.is_convex() && extent.is_within { Outline::Simple } else { Outline::Crossed };

        // The ends of each triangle's diagonal, then its own corner; face by face counterclockwise seen from outside.
        let (mut p, mut q, mut own) = (CornerLanes::NONE, CornerLanes::NONE, CornerLanes::NONE);
        for face in 0..6 {
            for (side, triangle) in shape.triangles(face).into_iter().enumerate() {
                let lane = 2 * face + side;
                let (i, k, j) = (triangle[0] as usize & 7, triangle[1] as usize & 7, triangle[2] as usize & 7);
                p.set(lane, vertex[i], corners[i]);
                q.set(lane, vertex[k], corners[k]);
                own.set(lane, vertex[j], corners[j]);
            }
        }
        let mut is_turned = [0; LANES];
        let mut sides = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            is_turned[lane] = CornerLanes::order(&mut p, &mut q, lane);
            let [at_first, per_column, per_row] = rays.side_of([p.position(lane), q.position(lane)]);
            (sides[0][lane], sides[1][lane], sides[2][lane]) = (at_first, per_column, per_row);
        }
        // Corners by ascending number: planes are the same bits in both cells that share them.
        let mut is_own_between = [0; LANES];
        for lane in 0..LANES {
            let is_below_q = CornerLanes::order(&mut q, &mut own, lane);
            let is_below_p = CornerLanes::order(&mut p, &mut q, lane);
            is_own_between[lane] = is_below_q ^ is_below_p;
            is_turned[lane] ^= is_own_between[lane];
        }
        let (mut is_along, mut is_flat) = ([0; LANES], [0; LANES]);
        for lane in 0..LANES {
            let (a, b, c) = (p.position(lane), q.position(lane), own.position(lane));
            let ([at_first, per_column, per_row], along) = plane(rays, [a, b, c]);
            (self.planes[0][lane], self.planes[1][lane], self.planes[2][lane]) = (at_first, per_column, per_row);
            is_along[lane] = along;
            let n = cross(b - a, c - a);
            is_flat[lane] = mask(dot(n, n) == 0.0);
        }
        if let Some(value) = constant {
            (self.s_min, self.s_max) = (value, value);
        } else {
            (self.s_min, self.s_max) = (corners[0].scalar, corners[0].scalar);
            for corner in &corners[1..] {
                self.s_min = min(corner.scalar, self.s_min);
                self.s_max = max(corner.scalar, self.s_max);
            }
            for lane in 0..LANES {
                let corners = [p.position(lane), q.position(lane), own.position(lane)];
                let FaceScalar { base, slope } =
                    FaceScalar::of_face(rays, corners, [p.scalar(lane), q.scalar(lane), own.scalar(lane)]);
                let (varying, constant) = if rays.is_perspective() { (slope, base[0]) } else { (base, slope[0]) };
                let [at_first, per_column, per_row] = varying;
                (self.varying[0][lane], self.varying[1][lane], self.varying[2][lane]) = (at_first, per_column, per_row);
                self.constant[lane] = constant;
            }
        }
        self.find_surfaces(
            shape,
            |lane| (is_along[lane] ^ is_turned[lane]) & 1 == 1,
            &is_flat,
            |lane| {
                // A triangle lies on the diagonal's positive side where det(p, q, own), relative to the eye, is positive.
                ((is_along[lane] ^ is_own_between[lane]) & 1 == 1, [sides[0][lane], sides[1][lane], sides[2][lane]])
            },
        );
    }

    /// Puts faces, or triangles, to the side that they bound.
    #[inline(always)]
    fn find_surfaces(
        &mut self,
        shape: HexShape,
        is_back: impl Fn(usize) -> bool,
        is_flat: &Mask,
        side_of: impl Fn(usize) -> (bool, [f32; 3]),
    ) {
        self.fronts.clear();
        self.backs.clear();
        for face in 0..6 {
            let [first, second] = [2 * face, 2 * face + 1];
            let mut add = |is_back: bool, surface| {
                if is_back { self.backs.push(surface) } else { self.fronts.push(surface) }
            };
            let alone = |lane: usize| Surface { triangles: [lane as u8; 2], side: [0.0; 3] };
            match (is_flat[first] == 0, is_flat[second] == 0) {
                (false, false) => {}
                (true, false) => add(is_back(first), alone(first)),
                (false, true) => add(is_back(second), alone(second)),
                (true, true) if is_back(first) == is_back(second) => {
                    let (is_first_positive, side) = side_of(first);
                    let both = if is_first_positive { [second, first] } else { [first, second] };
                    add(is_back(first), Surface { triangles: [both[0] as u8, both[1] as u8], side });
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
