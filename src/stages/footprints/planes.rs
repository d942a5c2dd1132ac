//! Face planes and scalar gradients of some cells at a time, sixteen unless one wants one, relative to a tile.
//!
//! Symbols: e the eye, d(x, y) = d₀ + x·dx + y·dy the direction of the ray of picture position (x, y) with view depth 1, n the
//! normal (b−a)×(c−a) of a face with ascending vertices a, b, c. A point e + w·d lies on the face's plane where
//! w·n·d = n·(a−e), so v = 1/w = n·d(x, y) / n·(a−e): affine in x and y. Along parallel rays o(x, y) + w·f it is
//! v = −w = n·(o(x, y)−a) / n·f. Both neighbours of a face compute it from the same vertices in the same order: the same
//! bits, so that their segments meet without gap or overlap.
//!
//! A face seen edge-on has no such plane. It becomes a wall, all but infinitely steep, some ulp aside: it keeps the cell's
//! outline, and a ray that runs exactly along a face or an edge of the mesh is given to one cell around it, the one that lies
//! to that side.
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use glam::{DVec3, Vec3};

use crate::optics::lanes::{LANES, mask, max, min, select};
use crate::stages::classify::{FACES, OUTWARD_IF_POSITIVE};
use crate::stages::{SceneVertex, View};

/// One number per cell of a batch.
pub type PerCell<const N: usize = LANES> = [f32; N];

/// An affine function of the position (x, y) in a tile, per cell.
#[derive(Clone, Copy, Debug)]
pub struct Affine<const N: usize = LANES> {
    /// At the tile's first pixel.
    pub c: PerCell<N>,
    /// Change per column.
    pub x: PerCell<N>,
    /// Change per row.
    pub y: PerCell<N>,
}

/// The footprints of `N` cells relative to a tile.
#[derive(Clone, Copy, Debug)]
pub struct Batch<const N: usize = LANES> {
    /// The inverse depth of each face's plane; face k is opposite to vertex k.
    pub planes: [Affine<N>; 4],
    /// Bit k of entry i: face k of cell i is back-facing.
    pub back_faces: [u32; N],
    /// Smallest and largest inverse depth of each cell within the view's range.
    pub v_min: PerCell<N>,
    /// See `v_min`.
    pub v_max: PerCell<N>,
    /// The scalar along the ray is `base(x, y) + slope(x, y)·w`.
    pub base: Affine<N>,
    /// See `base`.
    pub slope: Affine<N>,
    /// Whether a cell's gradient is so steep that the rounding of a depth shows: its faces' own gradients are to be used.
    pub is_steep: [u32; N],
    /// Smallest and largest stored value of each cell.
    pub s_min: PerCell<N>,
    /// See `s_min`.
    pub s_max: PerCell<N>,
    /// The pixels of the tile that each cell may cover, whole numbers: first column, column after the last, and the same for rows.
    pub boxes: [PerCell<N>; 4],
}

/// The rays of one tile, in f32.
#[derive(Clone, Copy, Debug)]
pub struct TileRays {
    is_perspective: bool,
    eye: Vec3,
    forward: Vec3,
    /// d₀ (perspective) or o₀ (orthographic) at the tile's first pixel.
    first: Vec3,
    step_x: Vec3,
    step_y: Vec3,
    /// Maps a position relative to the eye to columns and rows of the tile.
    to_x: Vec3,
    to_y: Vec3,
    center: [f32; 2],
    v_range: (f32, f32),
    near: f32,
    side_px: f32,
    pad_px: f32,
    /// |dx|: a pixel is as wide as it is high.
    pixel: f32,
}

/// A face is a wall if the sine of its angle to the rays is below this, some ulp of the products it is computed from, and below
/// this many pixels (as an angle, or in scene units): far away, or from a needle's tip, small angles are seen.
const EDGE_ON: f32 = 4e-6;
const EDGE_ON_PX: f32 = 3e-2;

/// The denominator of a wall: scene units, where normals of drawable faces are above 1e-14.
const WALL: f32 = 1e-30;

/// A cell is steep if its gradient, over its distance from the eye, is this many times its range of values: then some ulp of
/// depth are a hundredth of that range. A sliver is; a compact cell is not, unless 10^4 of them fit between it and the eye.
const STEEP: f32 = 5e4;

/// How far walls stand aside along columns, relative to what they are computed from: just above its rounding; and at most this
/// many pixels. Along rows they stand aside by another, incommensurable share.
const ASIDE: f32 = 5e-7;
const ASIDE_PX: f32 = 4e-3;
const ASIDE_ROWS: f32 = 0.37;

impl TileRays {
    /// The rays of the tile of `side_px` pixels that begins at pixel (x, y).
    pub fn new(view: &View, x: u32, y: u32, side_px: u32) -> Self {
        let aside = view.corner + view.step_x * f64::from(x) + view.step_y * f64::from(y);
        let first = if view.is_perspective { view.forward + aside } else { view.eye + aside };
        let scale = |step: DVec3| step / step.length_squared();
        let (to_x, to_y) = (scale(view.step_x), scale(view.step_y));
        Self {
            is_perspective: view.is_perspective,
            eye: view.eye.as_vec3(),
            forward: view.forward.as_vec3(),
            first: first.as_vec3(),
            step_x: view.step_x.as_vec3(),
            step_y: view.step_y.as_vec3(),
            to_x: to_x.as_vec3(),
            to_y: to_y.as_vec3(),
            center: [-aside.dot(to_x) as f32, -aside.dot(to_y) as f32],
            v_range: view.inverse_depth_range(),
            near: view.near,
            side_px: side_px as f32,
            pixel: view.step_x.length() as f32,
            pad_px: view.pad_px(),
        }
    }
}

/// What a tile sees of a cell's corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Smallest and largest inverse depth within the view's range.
    pub(super) v_min: f32,
    pub(super) v_max: f32,
    /// Whether all corners lie within the view's range.
    pub(super) is_within: bool,
    /// First column, column after the last, and the same for rows.
    pub(super) sides: [usize; 4],
}

impl TileRays {
    /// Whether rays leave the eye.
    #[inline(always)]
    pub fn is_perspective(&self) -> bool {
        self.is_perspective
    }

    /// Of a cell with corners at `p`.
    #[inline(always)]
    pub(super) fn extent(&self, p: &[Vec3]) -> Extent {
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        let (mut w_min, mut w_max) = (f32::INFINITY, f32::NEG_INFINITY);
        for &corner in p {
            let from_eye = corner - self.eye;
            let w = dot(from_eye, self.forward);
            let scale = if self.is_perspective { 1.0 / w } else { 1.0 };
            let at =
                [dot(from_eye, self.to_x) * scale + self.center[0], dot(from_eye, self.to_y) * scale + self.center[1]];
            for axis in 0..2 {
                low[axis] = min(low[axis], at[axis]);
                high[axis] = max(high[axis], at[axis]);
            }
            w_min = min(w_min, w);
            w_max = max(w_max, w);
        }
        let (far, near) = self.v_range;
        let v_of = |w: f32| if self.is_perspective { 1.0 / w } else { -w };
        let crosses_near = w_min < self.near;
        let is_within = !crosses_near && v_of(w_max) >= far;
        let v_max = if crosses_near { near } else { min(v_of(w_min), near) };
        let v_min = if w_max < self.near { near } else { max(v_of(w_max), far) };
        let side = self.side_px;
        let first = |low: f32| min(max((low - self.pad_px).ceil(), 0.0), side) as usize;
        let end = |high: f32| min(max((high + self.pad_px).floor() + 1.0, 0.0), side) as usize;
        // A cell across the near plane has corners without a picture position.
        let whole = [0, side as usize];
        let side_of = |axis: usize| if crosses_near { whole } else { [first(low[axis]), end(high[axis])] };
        let [columns, rows] = [side_of(0), side_of(1)];
        Extent { v_min, v_max, is_within, sides: [columns[0], columns[1], rows[0], rows[1]] }
    }

    /// Which side of the line through p and q a position is on: at the tile's first pixel, per column, per row.
    #[inline(always)]
    pub(super) fn side_of(&self, [p, q]: [Vec3; 2]) -> [f32; 3] {
        let (m, first) = if self.is_perspective {
            (cross(p - self.eye, q - p), self.first)
        } else {
            (cross(self.forward, q - p), self.first - p)
        };
        [dot(m, first), dot(m, self.step_x), dot(m, self.step_y)]
    }
}

/// The corners of a batch of cells, one array per coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Corners<const N: usize = LANES> {
    x: [PerCell<N>; 4],
    y: [PerCell<N>; 4],
    z: [PerCell<N>; 4],
    s: [PerCell<N>; 4],
    positive: [u32; N],
}

impl<const N: usize> Affine<N> {
    /// 0 everywhere.
    pub const ZERO: Self = Self { c: [0.0; N], x: [0.0; N], y: [0.0; N] };
}

impl<const N: usize> Default for Batch<N> {
    fn default() -> Self {
        let zero = [0.0; N];
        Self {
            planes: [Affine::ZERO; 4],
            back_faces: [0; N],
            v_min: zero,
            v_max: zero,
            base: Affine::ZERO,
            slope: Affine::ZERO,
            is_steep: [0; N],
            s_min: zero,
            s_max: zero,
            boxes: [zero; 4],
        }
    }
}

impl<const N: usize> Default for Corners<N> {
    fn default() -> Self {
        let zero = [[0.0; N]; 4];
        Self { x: zero, y: zero, z: zero, s: zero, positive: [0; N] }
    }
}

impl<const N: usize> Corners<N> {
    /// The values at the corners of the cell in `lane`.
    #[inline(always)]
    pub fn scalars(&self, lane: usize) -> [f32; 4] {
        [self.s[0][lane], self.s[1][lane], self.s[2][lane], self.s[3][lane]]
    }

    /// Puts cell `tet` in lane `lane`.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, tet: [u32; 4], vertices: &[SceneVertex], is_positive: bool) {
        for (k, v) in tet.into_iter().enumerate() {
            let SceneVertex { position: [x, y, z], scalar } = vertices[v as usize];
            (self.x[k][lane], self.y[k][lane], self.z[k][lane], self.s[k][lane]) = (x, y, z, scalar);
        }
        self.positive[lane] = mask(is_positive);
    }

    /// Positions and scalars of the cell in lane `i`. Written out: a closure per corner keeps the loop over lanes scalar.
    #[inline(always)]
    fn get(&self, i: usize) -> ([Vec3; 4], [f32; 4]) {
        (self.positions(i), [self.s[0][i], self.s[1][i], self.s[2][i], self.s[3][i]])
    }

    /// The corners of the cell in lane `i`.
    #[inline(always)]
    pub fn positions(&self, i: usize) -> [Vec3; 4] {
        [self.position(0, i), self.position(1, i), self.position(2, i), self.position(3, i)]
    }

    /// Corner k of the cell in lane `i`.
    #[inline(always)]
    pub fn position(&self, k: usize, i: usize) -> Vec3 {
        Vec3::new(self.x[k][i], self.y[k][i], self.z[k][i])
    }

    /// Gives the cell in lane `lane` one value throughout.
    #[inline(always)]
    pub fn set_constant(&mut self, lane: usize, scalar: f32) {
        for s in &mut self.s {
            s[lane] = scalar;
        }
    }
}

/// The scalar along the rays where they meet a face: `base(x, y) + slope(x, y)·w`, steps per column and row.
#[derive(Clone, Copy, Debug, Default)]
pub struct FaceScalar {
    /// At the tile's first pixel, per column, per row.
    pub base: [f32; 3],
    /// The same.
    pub slope: [f32; 3],
}

impl FaceScalar {
    /// For each face of the cell in lane `i`, from the face's own three vertices: well conditioned where the cell is not.
    pub fn of_cell(rays: &TileRays, corners: &Corners, i: usize) -> [Self; 4] {
        let (p, s) = corners.get(i);
        FACES.map(|face| Self::of_face(rays, face.map(|corner| p[corner]), face.map(|corner| s[corner])))
    }

    /// For a face with corners a, b, c and their values.
    #[inline(always)]
    pub(super) fn of_face(rays: &TileRays, [a, b, c]: [Vec3; 3], [s_a, s_b, s_c]: [f32; 3]) -> Self {
        // The gradient in the plane: (b−a)·g = s_b − s_a, (c−a)·g = s_c − s_a, n·g = 0.
        let (u, v) = (b - a, c - a);
        let n = cross(u, v);
        let g = (cross(v, n) * (s_b - s_a) + cross(n, u) * (s_c - s_a)) / dot(n, n).max(f32::MIN_POSITIVE);
        let steps = [dot(g, rays.step_x), dot(g, rays.step_y)];
        if rays.is_perspective {
            let base = [s_a - dot(g, a - rays.eye), 0.0, 0.0];
            Self { base, slope: [dot(g, rays.first), steps[0], steps[1]] }
        } else {
            let base = [s_a + dot(g, rays.first - a), steps[0], steps[1]];
            Self { base, slope: [dot(g, rays.forward), 0.0, 0.0] }
        }
    }

    /// The value at column and row of the tile and view depth w.
    pub fn at(&self, x: f32, y: f32, w: f32) -> f32 {
        let affine = |[c, dx, dy]: [f32; 3]| c + dx * x + dy * y;
        affine(self.base) + affine(self.slope) * w
    }
}

impl<const N: usize> Batch<N> {
    /// Computes the footprints of all lanes of `corners`; unused lanes hold any finite cell.
    #[inline(always)]
    pub fn set_up(&mut self, rays: &TileRays, corners: &Corners<N>) {
        // A copy that nothing else can see: stores to the batch do not make the compiler read it again.
        let rays = &{ *rays };
        // One short loop per face and per concern: each becomes vector code, one long loop does not.
        self.back_faces = [0; N];
        for k in 0..4 {
            for i in 0..N {
                self.set_up_plane(rays, k, i, corners);
            }
        }
        for i in 0..N {
            let (p, s) = corners.get(i);
            self.set_up_scalar(rays, i, p, s);
        }
        for i in 0..N {
            self.set_up_extent(rays, i, corners.get(i).0);
        }
    }

    #[inline(always)]
    fn set_up_plane(&mut self, rays: &TileRays, k: usize, i: usize, corners: &Corners<N>) {
        let (a, b, c) =
            (corners.position(FACES[k][0], i), corners.position(FACES[k][1], i), corners.position(FACES[k][2], i));
        let ([at_first, per_column, per_row], is_positive) = plane(rays, [a, b, c]);
        self.planes[k].c[i] = at_first;
        self.planes[k].x[i] = per_column;
        self.planes[k].y[i] = per_row;
        // The ray leaves through a face whose outward normal runs along with it.
        let is_inward = corners.positive[i] ^ mask(OUTWARD_IF_POSITIVE[k]);
        self.back_faces[i] |= ((is_positive ^ is_inward) & 1) << k;
    }

    #[inline(always)]
    fn set_up_scalar(&mut self, rays: &TileRays, i: usize, p: [Vec3; 4], s: [f32; 4]) {
        // The gradient g of the linear field: g·(p_k − a) = s_k − s_a for the other three corners, by Cramer.
        let (q, r, t) = (p[1] - p[0], p[2] - p[0], p[3] - p[0]);
        let (rt, tq, qr) = (cross(r, t), cross(t, q), cross(q, r));
        let determinant = dot(q, rt);
        let safe = if determinant.abs() < f32::MIN_POSITIVE { 1.0 } else { determinant };
        let g = (rt * (s[1] - s[0]) + tq * (s[2] - s[0]) + qr * (s[3] - s[0])) * (1.0 / safe);
        let (step_x, step_y) = (dot(g, rays.step_x), dot(g, rays.step_y));
        // Perspective: s = s_a + g·(e − a) + w g·d(x, y). Parallel: s = s_a + g·(o(x, y) − a) + w g·f.
        if rays.is_perspective {
            self.base.c[i] = s[0] - dot(g, p[0] - rays.eye);
            (self.base.x[i], self.base.y[i]) = (0.0, 0.0);
            self.slope.c[i] = dot(g, rays.first);
            (self.slope.x[i], self.slope.y[i]) = (step_x, step_y);
        } else {
            self.base.c[i] = s[0] + dot(g, rays.first - p[0]);
            (self.base.x[i], self.base.y[i]) = (step_x, step_y);
            self.slope.c[i] = dot(g, rays.forward);
            (self.slope.x[i], self.slope.y[i]) = (0.0, 0.0);
        }
        self.s_min[i] = min(min(s[0], s[1]), min(s[2], s[3]));
        self.s_max[i] = max(max(s[0], s[1]), max(s[2], s[3]));
        let distance = norm_1(p[0] - if rays.is_perspective { rays.eye } else { rays.first });
        self.is_steep[i] = mask(norm_1(g) * distance > STEEP * (self.s_max[i] - self.s_min[i]));
    }

    #[inline(always)]
    fn set_up_extent(&mut self, rays: &TileRays, i: usize, p: [Vec3; 4]) {
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        let (mut w_min, mut w_max) = (f32::INFINITY, f32::NEG_INFINITY);
        for corner in p {
            let from_eye = corner - rays.eye;
            let w = dot(from_eye, rays.forward);
            let scale = if rays.is_perspective { 1.0 / w } else { 1.0 };
            let at =
                [dot(from_eye, rays.to_x) * scale + rays.center[0], dot(from_eye, rays.to_y) * scale + rays.center[1]];
            for axis in 0..2 {
                low[axis] = min(low[axis], at[axis]);
                high[axis] = max(high[axis], at[axis]);
            }
            w_min = min(w_min, w);
            w_max = max(w_max, w);
        }
        let crosses_near = w_min < rays.near;
        let (far, near) = rays.v_range;
        let v_of = |w: f32| if rays.is_perspective { 1.0 / w } else { -w };
        self.v_max[i] = if crosses_near { near } else { min(v_of(w_min), near) };
        self.v_min[i] = if w_max < rays.near { near } else { max(v_of(w_max), far) };
        let side = rays.side_px;
        let first = |low: f32| min(max((low - rays.pad_px).ceil(), 0.0), side);
        let end = |high: f32| min(max((high + rays.pad_px).floor() + 1.0, 0.0), side);
        let pixel = |value: f32, whole_tile: f32| if crosses_near { whole_tile } else { value };
        // A cell across the near plane has corners without a picture position: the planes alone bound it.
        self.boxes[0][i] = pixel(first(low[0]), 0.0);
        self.boxes[1][i] = pixel(end(high[0]), side);
        self.boxes[2][i] = pixel(first(low[1]), 0.0);
        self.boxes[3][i] = pixel(end(high[1]), side);
    }
}

/// The inverse depth of the plane through a, b, c at the tile's first pixel, per column and per row, and a mask: whether rays run
/// along with (b−a)×(c−a).
#[inline(always)]
pub(super) fn plane(rays: &TileRays, [a, b, c]: [Vec3; 3]) -> ([f32; 3], u32) {
    let n = cross(b - a, c - a);
    let (at_first, across) = if rays.is_perspective {
        (dot(n, rays.first), dot(n, a - rays.eye))
    } else {
        (dot(n, rays.first - a), dot(n, rays.forward))
    };
    let (per_column, per_row) = (dot(n, rays.step_x), dot(n, rays.step_y));
    // What the sine of the face's angle, and the distance of a ray from it, are relative to.
    let (far, wide) = if rays.is_perspective { (norm_1(a - rays.eye), 1.0) } else { (1.0, norm_1(rays.first - a)) };
    let is_wall = mask(across.abs() <= min(EDGE_ON, EDGE_ON_PX * rays.pixel) * norm_1(n) * far);
    let aside_px = min(ASIDE * wide / rays.pixel, ASIDE_PX);
    let aside = (per_column + ASIDE_ROWS * per_row) * aside_px;
    let size = select(is_wall, WALL, across.abs());
    let is_positive = mask(across >= 0.0);
    let scale = 1.0 / select(is_positive, size, -size);
    ([(at_first + select(is_wall, aside, 0.0)) * scale, per_column * scale, per_row * scale], is_positive)
}

// Written out, without fused or reordered operations: the same bits in every lane, on every instruction set.

#[inline(always)]
pub(super) fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[inline(always)]
pub(super) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

#[inline(always)]
fn norm_1(a: Vec3) -> f32 {
    a.x.abs() + a.y.abs() + a.z.abs()
}
