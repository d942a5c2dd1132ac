//! `fans`: triangle fans for rasterisers, in draw order, written into lent memory.
//!
//! In: cells in draw order, projected vertices, the view. Out: [`FanVertex`] records and [`Fan`] headers in a [`FanSlot`].
//! Count, scan, write: [`count`] says what a run of cells needs, a prefix sum lends each run its part of the slot, [`write()`]
//! fills it in sequence and never reads back. A fan is the thick vertex, then the ring around it (CellFast, figure 3).
//!
//! A vertex carries front and back (v, q), v the inverse depth and q = s·v (parallel rays: q = s): both are affine on the
//! picture over a triangle of the fan, so that plain interpolation gives each fragment its exact entry and exit.

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

use super::classify::{Classified, ProjectionClass, classify};
use super::near::{self, Corner};
use super::{PixelProjection, SceneVertex, View};
use crate::columns::Dataset;

/// One vertex of a fan, as a rasteriser reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct FanVertex {
    /// Column and row in pixels, pixel centres at whole numbers.
    pub position_px: [f32; 2],
    /// Inverse depth v and q = s·v (parallel rays: s) where the ray enters.
    pub front: [f32; 2],
    /// The same where it leaves.
    pub back: [f32; 2],
}

/// One fan: its vertices follow each other in the slot.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Fan {
    /// The cell it belongs to.
    pub cell: u32,
    /// Its first vertex, counted from the beginning of the slot.
    pub first_vertex: u32,
    /// Its [`ProjectionClass`] as a number; gives the count of its vertices.
    pub class: u32,
}

/// Fans and vertices that a run of cells needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FanCounts {
    /// Fans: one per cell, up to three where the near plane cuts it, none where it is edge-on.
    pub fans: usize,
    /// Vertices of these fans.
    pub vertices: usize,
}

/// Memory lent by a backend, written in sequence.
pub struct FanSlot<'a> {
    /// Room for the counted fans.
    pub fans: &'a mut [Fan],
    /// Room for the counted vertices.
    pub vertices: &'a mut [FanVertex],
    /// The slot's first vertex in the backend's buffer.
    pub first_vertex: u32,
}

/// What fans are made from.
#[derive(Clone, Copy)]
pub struct FanInput<'a> {
    dataset: &'a Dataset,
    vertices: &'a [SceneVertex],
    cell_values: Option<&'a [f32]>,
    projection: PixelProjection,
    is_perspective: bool,
    near: f32,
}

/// The fans of one cell.
type CellFans = ArrayVec<(ProjectionClass, ArrayVec<FanVertex, 6>), 3>;

impl<'a> FanInput<'a> {
    /// For one view; `cell_values` holds cell data, `None` takes the vertices' scalars.
    pub fn new(view: &View, dataset: &'a Dataset, vertices: &'a [SceneVertex], cell_values: Option<&'a [f32]>) -> Self {
        let (projection, near) = (view.projection(), view.near);
        Self { dataset, vertices, cell_values, projection, is_perspective: view.is_perspective, near }
    }

    fn corners(&self, cell: u32) -> [Corner; 4] {
        self.dataset.tets.get(cell as usize).map(|v| {
            let SceneVertex { position, scalar } = self.vertices[v as usize];
            let position = Vec3::from_array(position);
            let scalar = self.cell_values.map_or(scalar, |values| values[cell as usize]);
            Corner { position, scalar, depth: self.projection.project(position).z }
        })
    }

    /// The fans of `cell`: cut at the near plane where it crosses it, then classified.
    fn of_cell(&self, cell: u32) -> CellFans {
        let is_positive = self.dataset.positive.get(cell as usize);
        let corners = self.corners(cell);
        let mut parts = [corners; 3];
        let count = near::cut(corners, self.near, &mut parts);
        let mut fans = CellFans::new();
        for part in &parts[..count] {
            let projected = part.map(|corner| self.projection.project(corner.position));
            let classified = classify(projected.map(Vec3::truncate), is_positive);
            let records = std::array::from_fn(|k| {
                let Vec3 { x, y, z: w } = projected[k];
                let v = if self.is_perspective { 1.0 / w } else { -w };
                Projected { xy: Vec2::new(x, y), v, q: part[k].scalar * if self.is_perspective { v } else { 1.0 } }
            });
            if classified.class != ProjectionClass::EdgeOn {
                fans.push((classified.class, fan(classified, records)));
            }
        }
        fans
    }
}

/// What `cells` need.
pub fn count(input: &FanInput, cells: impl IntoIterator<Item = u32>) -> FanCounts {
    let mut counts = FanCounts::default();
    for cell in cells {
        for (class, _) in input.of_cell(cell) {
            counts.fans += 1;
            counts.vertices += class.fan_vertices();
        }
    }
    counts
}

/// Writes the fans of `cells`, in their order, into `slot`; counts them by class.
///
/// # Panics
/// If the slot is not exactly as large as [`count`] says.
pub fn write(input: &FanInput, cells: impl IntoIterator<Item = u32>, slot: FanSlot) -> [u64; 5] {
    let mut by_class = [0; 5];
    let (mut fans, mut vertices) = (slot.fans.iter_mut(), slot.vertices);
    let mut next = 0;
    for cell in cells {
        for (class, ring) in input.of_cell(cell) {
            let first_vertex = slot.first_vertex + next as u32;
            let header = fans.next().expect("the slot was counted for these cells");
            *header = Fan { cell, first_vertex, class: class as u32 };
            vertices[next..next + ring.len()].copy_from_slice(&ring);
            next += ring.len();
            by_class[class as usize] += 1;
        }
    }
    vertices = &mut vertices[next..];
    assert!(vertices.is_empty() && fans.next().is_none(), "the slot was counted for these cells");
    by_class
}

/// A projected vertex with what is interpolated over the picture.
#[derive(Clone, Copy, Debug)]
struct Projected {
    xy: Vec2,
    v: f32,
    q: f32,
}

impl Projected {
    /// The point of the segment to `other` at `t`; on the picture everything is affine.
    fn lerp(self, other: Self, t: f32) -> Self {
        Self {
            xy: self.xy + (other.xy - self.xy) * t,
            v: self.v + (other.v - self.v) * t,
            q: self.q + (other.q - self.q) * t,
        }
    }
}

fn thick(xy: Vec2, front: Projected, back: Projected) -> FanVertex {
    FanVertex { position_px: xy.to_array(), front: [front.v, front.q], back: [back.v, back.q] }
}

fn thin(p: Projected) -> FanVertex {
    thick(p.xy, p, p)
}

/// The thick vertex and its ring.
fn fan(classified: Classified, projected: [Projected; 4]) -> ArrayVec<FanVertex, 6> {
    let Classified { class, roles, inner_is_front } = classified;
    let [a, b, c, d] = roles.map(|role| projected[role as usize]);
    let on_either_side = |inner: Projected, outer: Projected| {
        if inner_is_front { thick(inner.xy, inner, outer) } else { thick(inner.xy, outer, inner) }
    };
    match class {
        ProjectionClass::EdgeOn => ArrayVec::new(),
        // a lies inside b c d: the other side of the cell there is a point of that face.
        ProjectionClass::Class1 => {
            let (q, r, s) = (c.xy - b.xy, d.xy - b.xy, a.xy - b.xy);
            let area = q.perp_dot(r);
            let (u, t) = (s.perp_dot(r) / area, q.perp_dot(s) / area);
            let face = Projected {
                xy: a.xy,
                v: b.v + (c.v - b.v) * u + (d.v - b.v) * t,
                q: b.q + (c.q - b.q) * u + (d.q - b.q) * t,
            };
            [on_either_side(a, face), thin(b), thin(c), thin(d), thin(b)].into_iter().collect()
        }
        // Front edge a b and back edge c d cross: a + t (b − a) = c + u (d − c), by Cramer.
        ProjectionClass::Class2 => {
            let (ab, cd, ac) = (b.xy - a.xy, d.xy - c.xy, c.xy - a.xy);
            let area = ab.perp_dot(cd);
            let (t, u) = (ac.perp_dot(cd) / area, ac.perp_dot(ab) / area);
            let (front, back) = (a.lerp(b, t), c.lerp(d, u));
            [thick(front.xy, front, back), thin(a), thin(c), thin(b), thin(d), thin(a)].into_iter().collect()
        }
        // a lies on edge b d.
        ProjectionClass::Class3 => {
            let bd = d.xy - b.xy;
            let t = (a.xy - b.xy).dot(bd) / bd.length_squared();
            [on_either_side(a, b.lerp(d, t)), thin(b), thin(c), thin(d)].into_iter().collect()
        }
        // a lies in front of b.
        ProjectionClass::Class4 => [thick(a.xy, a, b), thin(c), thin(d)].into_iter().collect(),
    }
}

#[cfg(test)]
mod tests;
