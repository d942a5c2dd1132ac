//! `footprints`: what a tile compositor needs of a cell, without triangles.
//!
//! In: visible cells of a block, projected vertices, the view. Out: [`PixelBox`]es (here), and, sixteen cells at a time, face
//! planes, scalar gradient and value interval relative to a tile ([`planes`]).
//!
//! At a pixel, a convex cell is entered through the farthest front-facing plane (the smallest v) and left through the nearest
//! back-facing one (the largest v); it is met where entry comes first. With v = 1/w each plane is affine in picture
//! coordinates, on both sides of the eye, so that nothing is cut at the near plane.

pub mod hexahedra;
pub mod planes;
pub mod polyhedra;

use std::ops::Range;

use glam::{Vec2, Vec3};

use self::planes::Corners;
use crate::camera::Region;
use crate::columns::{BlockCells, BlockView, Bounds};
use crate::optics::lanes::{LANES, Mask, mask, max, min};
use crate::stages::{PixelProjection, SceneVertex, ScreenVertex, View};

/// The pixels of a box: columns `x0..x1`, rows `y0..y1` (ends exclusive).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelBox {
    /// First column.
    pub x0: u16,
    /// Column after the last.
    pub x1: u16,
    /// First row.
    pub y0: u16,
    /// Row after the last.
    pub y1: u16,
}

/// The boxes of sixteen cells, one a lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct BoxLanes {
    columns: [u32; LANES],
    rows: [u32; LANES],
    /// Whether a cell comes before the near plane: its box is not known then.
    pub crosses_near: Mask,
    /// Whether it may cover a pixel centre.
    pub is_seen: Mask,
}

impl BoxLanes {
    /// The box in a lane.
    #[inline]
    pub fn get(&self, lane: usize) -> PixelBox {
        let [x0, x1] = [self.columns[lane] as u16, (self.columns[lane] >> 16) as u16];
        let [y0, y1] = [self.rows[lane] as u16, (self.rows[lane] >> 16) as u16];
        PixelBox { x0, x1, y0, y1 }
    }
}

/// What maps cells to pixel boxes for one view.
#[derive(Clone, Copy, Debug)]
pub struct PixelBoxes {
    projection: PixelProjection,
    near: f32,
    far: f32,
    /// Boxes are cut to these columns and rows: from `first_px` to before `end_px`.
    first_px: Vec2,
    end_px: Vec2,
    pad_px: f32,
}

impl PixelBoxes {
    /// For the whole picture of one view.
    pub fn new(view: &View) -> Self {
        let (projection, pad_px) = (view.projection(), view.pad_px());
        let whole =
            Self { projection, near: view.near, far: view.far, first_px: Vec2::ZERO, end_px: Vec2::ZERO, pad_px };
        whole.within(Region::whole(view.size_px))
    }

    /// The same boxes, as far as they lie in `region`.
    #[must_use]
    pub fn within(self, Region { x0, y0, x1, y1 }: Region) -> Self {
        let px = |x: u32, y: u32| Vec2::new(x as f32, y as f32);
        Self { first_px: px(x0, y0), end_px: px(x1, y1), ..self }
    }

    /// The pixels whose centres the cell may cover; `None` if there is none.
    #[inline]
    pub fn of_cell<const N: usize>(
        &self,
        cell: [u32; N],
        vertices: &[SceneVertex],
        screen: &[ScreenVertex],
    ) -> Option<PixelBox> {
        let corners = cell.map(|v| screen[v as usize]);
        let nearest = corners.iter().fold(f32::INFINITY, |near, corner| near.min(corner.depth));
        if nearest < self.near {
            return self.across_near(&cell.map(|v| vertices[v as usize].position), &corners.map(|c| c.depth));
        }
        if nearest > self.far {
            return None;
        }
        let low = corners.iter().fold(Vec2::INFINITY, |low, corner| low.min(corner.xy()));
        let high = corners.iter().fold(Vec2::NEG_INFINITY, |high, corner| high.max(corner.xy()));
        self.around(low, high)
    }

    /// The pixels whose centres a triangle may cover, and the range of its depths from the near plane on; `None` if there is none.
    pub fn of_triangle(&self, positions: [[f32; 3]; 3]) -> Option<(PixelBox, [f32; 2])> {
        let corners = positions.map(|p| self.projection.project(Vec3::from_array(p)));
        let [a, b, c] = corners;
        let (nearest, farthest) = (a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
        if farthest < self.near || nearest > self.far {
            return None;
        }
        let pixels = if nearest < self.near {
            self.across_near(&positions, &corners.map(|corner| corner.z))?
        } else {
            let [a, b, c] = corners.map(Vec3::truncate);
            self.around(a.min(b).min(c), a.max(b).max(c))?
        };
        Some((pixels, [nearest.max(self.near), farthest]))
    }

    /// The same for the sixteen tetrahedra of `corners`, which no compiler needs to be told how to do in lanes.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "part of kernels that are compiled for wider vectors")]
    pub fn of_lanes(&self, corners: &Corners, found: &mut BoxLanes) {
        let (first_px, end_px) = (self.first_px.to_array(), self.end_px.to_array());
        for i in 0..LANES {
            let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
            let mut nearest = f32::INFINITY;
            for k in 0..4 {
                let p = self.projection.project(corners.position(k, i));
                (low, high) = ([min(low[0], p.x), min(low[1], p.y)], [max(high[0], p.x), max(high[1], p.y)]);
                nearest = min(nearest, p.z);
            }
            // As `around`, by truncation of what is not negative.
            let first = |low: f32, axis: usize| {
                let edge = min(max(low - self.pad_px, first_px[axis]), end_px[axis]);
                let whole = edge as i32;
                whole + i32::from((whole as f32) < edge)
            };
            let end = |high: f32, axis: usize| min(max(high + self.pad_px + 1.0, first_px[axis]), end_px[axis]) as i32;
            let [x0, x1] = [first(low[0], 0), end(high[0], 0)];
            let [y0, y1] = [first(low[1], 1), end(high[1], 1)];
            (found.columns[i], found.rows[i]) = (x0 as u32 | (x1 as u32) << 16, y0 as u32 | (y1 as u32) << 16);
            found.crosses_near[i] = mask(nearest < self.near);
            found.is_seen[i] = mask(x0 < x1) & mask(y0 < y1) & mask(nearest <= self.far);
        }
    }

    /// Appends the cells among `cell_from_visible` that may cover a pixel centre, and their boxes.
    pub fn of_cells(
        &self,
        block: &BlockView,
        vertices: &[SceneVertex],
        screen: &[ScreenVertex],
        cell_from_visible: &[u32],
        cell_from_projected: &mut Vec<u32>,
        boxes: &mut Vec<PixelBox>,
    ) {
        let mut include = |cell, pixels| {
            if let Some(pixels) = pixels {
                cell_from_projected.push(cell);
                boxes.push(pixels);
            }
        };
        let cells = cell_from_visible.iter();
        match &block.cells {
            BlockCells::Tets(tets) => {
                cells.for_each(|&cell| include(cell, self.of_cell(tets.get(cell as usize), vertices, screen)));
            }
            BlockCells::Hexahedra(hexahedra) => {
                cells.for_each(|&cell| include(cell, self.of_cell(hexahedra.get(cell as usize), vertices, screen)));
            }
            BlockCells::Polyhedra(polyhedra) => {
                cells.for_each(|&cell| {
                    include(cell, self.of_polyhedron(polyhedra.corners(cell as usize), vertices, screen));
                });
            }
        }
    }

    /// As [`PixelBoxes::of_cell`], for a cell with any number of corners.
    pub(in crate::stages) fn of_polyhedron(
        &self,
        corners: &[u32],
        vertices: &[SceneVertex],
        screen: &[ScreenVertex],
    ) -> Option<PixelBox> {
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        let (mut nearest, mut farthest) = (f32::INFINITY, f32::NEG_INFINITY);
        for &v in corners {
            let corner = screen[v as usize];
            (low, high) = (low.min(corner.xy()), high.max(corner.xy()));
            (nearest, farthest) = (nearest.min(corner.depth), farthest.max(corner.depth));
        }
        if farthest < self.near || nearest > self.far {
            return None;
        }
        if nearest < self.near {
            let positions: Vec<[f32; 3]> = corners.iter().map(|&v| vertices[v as usize].position).collect();
            let depths: Vec<f32> = corners.iter().map(|&v| screen[v as usize].depth).collect();
            return self.across_near(&positions, &depths);
        }
        self.around(low, high)
    }

    /// The rows of pixels that cells in `bounds` may touch; `None` where nothing in it can be seen: all before the near plane,
    /// beyond the far one, or beside the pixels that boxes are cut to.
    pub fn rows_of_bounds(&self, bounds: Bounds, view: &View) -> Option<Range<u16>> {
        // A block none of whose cells is drawn has an empty box.
        if bounds.min.cmpgt(bounds.max).any() {
            return None;
        }
        let scale = view.world_per_scene.recip() as f32;
        let positions = bounds.corners().map(|corner| corner * scale);
        let corners = positions.map(|p| self.projection.project(p));
        let nearest = corners.iter().fold(f32::INFINITY, |near, corner| near.min(corner.z));
        let farthest = corners.iter().fold(f32::NEG_INFINITY, |far, corner| far.max(corner.z));
        if farthest < self.near || nearest > self.far {
            return None;
        }
        let all = self.first_px.y as u16..self.end_px.y as u16;
        // A vertex and the corners of its block are rounded on their own, by some ulp of their distance. Near the eye that may be
        // any number of pixels: there any row may be touched.
        let reach = positions.iter().fold(0.0, |far: f32, &p| far.max(p.distance(view.eye.as_vec3())));
        if nearest < self.near + 1e-5 * reach || (view.is_perspective && nearest < 1e-3 * reach) {
            return Some(all);
        }
        let rounding = 1e-6 * reach * self.projection.px_per_unit() / if view.is_perspective { nearest } else { 1.0 };
        let margin = Vec2::splat(1.0 + rounding);
        let low = corners.iter().fold(Vec2::INFINITY, |low, corner| low.min(corner.truncate()));
        let high = corners.iter().fold(Vec2::NEG_INFINITY, |high, corner| high.max(corner.truncate()));
        let rows = self.around(low - margin, high + margin)?;
        Some(rows.y0.saturating_sub(1).max(all.start)..(rows.y1 + 1).min(all.end))
    }

    /// The box around the part of a cell, or of a face, that lies behind the near plane.
    fn across_near(&self, positions: &[[f32; 3]], depths: &[f32]) -> Option<PixelBox> {
        let mut low = Vec2::INFINITY;
        let mut high = Vec2::NEG_INFINITY;
        let mut include = |p: Vec3| {
            let p = self.projection.project(p).truncate();
            (low, high) = (low.min(p), high.max(p));
        };
        for i in 0..depths.len() {
            if depths[i] < self.near {
                continue;
            }
            let inside = Vec3::from_array(positions[i]);
            include(inside);
            for j in (0..depths.len()).filter(|&j| depths[j] < self.near) {
                // Where edge i j meets the near plane; a hair behind it, so that rounding never leaves it in front.
                let t = (depths[i] - self.near) / (depths[i] - depths[j]);
                include(inside + (Vec3::from_array(positions[j]) - inside) * (t * (1.0 - 1e-6)));
            }
        }
        // The cut is rounded in space, not in pixels: near the eye a rounding error can be wide. Take a margin of its size.
        let margin = (high - low).max(Vec2::ZERO) * 1e-3 + Vec2::ONE;
        self.around(low - margin, high + margin)
    }

    /// The pixels whose centres lie between two picture positions; `None` if there is none.
    #[inline]
    pub(crate) fn around(&self, low: Vec2, high: Vec2) -> Option<PixelBox> {
        // Pixel centres are whole numbers: the first at or after the low edge, the last at or before the high one.
        let first = (low - self.pad_px).ceil().clamp(self.first_px, self.end_px);
        let end = ((high + self.pad_px).floor() + 1.0).clamp(self.first_px, self.end_px);
        (first.x < end.x && first.y < end.y).then_some(PixelBox {
            x0: first.x as u16,
            x1: end.x as u16,
            y0: first.y as u16,
            y1: end.y as u16,
        })
    }
}

#[cfg(test)]
mod tests;
