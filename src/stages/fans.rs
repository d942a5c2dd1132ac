//! `fans`: triangle fans for rasterisers, in draw order, written into lent memory.
//!
//! In: cells in draw order, projected vertices, the view. Out: [`Fan`]s, or what else stands in the room of one or more, in a
//! [`FanSlot`]. Count, scan, write: [`count`] says how many a run of cells needs, a prefix sum lends each run its part of the
//! slot, [`write()`] fills it in sequence and never reads back.
//!
//! A fan is the thick vertex and the ring around it (CellFast, figure 3): triangles thick, ring i, ring i + 1, the last one closing
//! the ring, so that one list of indices serves every class. Classes with fewer triangles repeat the thick vertex in the ring.
//! A vertex carries (v, q), v the inverse depth and q = s·v (parallel rays: q = s): both are affine on the picture over a
//! triangle of the fan, so that plain interpolation gives each fragment its exact entry and exit.
//! In the room of a fan: a tetrahedron's planes ([`PlaneFan`]). In the room of two, in meshes that have any, a cell with faces of
//! four corners ([`HexFan`]); the second room of other cells stays empty. As the papers draw them: [`polyhedra`].

mod classes;
mod hexahedra;
mod planes;
pub mod polyhedra;

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::classify::{ProjectionClass, classify};
use super::footprints::PixelBoxes;
use super::near::{self, Corner};
use super::{PixelProjection, SceneVertex, ScreenVertex, View};
use crate::columns::{Dataset, HexahedraView};
use classes::{Projected, fan};

/// One fan as a rasteriser reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Fan {
    /// Column and row of the thick vertex in pixels, pixel centres at whole numbers.
    pub thick_px: [f32; 2],
    /// Smallest and largest stored value of the cell.
    pub s_range: [f32; 2],
    /// Inverse depth v and q = s·v (parallel rays: s) where the ray through the thick vertex enters.
    pub front: [f32; 2],
    /// The same where it leaves.
    pub back: [f32; 2],
    /// The vertices around it, where entry and exit are one.
    pub ring: [RingVertex; 4],
}

/// A vertex on the outline of a cell.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct RingVertex {
    /// Column and row in pixels.
    pub position_px: [f32; 2],
    /// Inverse depth v and q = s·v (parallel rays: s).
    pub vq: [f32; 2],
}

impl Fan {
    /// Its triangles as indices, 0 for the thick vertex and k + 1 for ring vertex k; those with a vertex twice cover nothing.
    pub const TRIANGLES: [[u16; 3]; 4] = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];

    /// Position, entry (v, q) and exit (v, q) of vertex `i`, counted as in [`Fan::TRIANGLES`].
    ///
    /// # Panics
    /// If `i` is above 4.
    pub fn vertex(&self, i: u16) -> ([f32; 2], [f32; 2], [f32; 2]) {
        if i == 0 {
            return (self.thick_px, self.front, self.back);
        }
        let RingVertex { position_px, vq } = self.ring[usize::from(i) - 1];
        (position_px, vq, vq)
    }
}

pub use hexahedra::HexFan;
pub use planes::PlaneFan;

/// Memory lent by a backend, written in sequence and never read.
pub trait FanSlot: Sized + Send {
    /// The first `fans` records, and the rest.
    ///
    /// # Panics
    /// If there are fewer.
    fn split_at(self, fans: usize) -> (Self, Self);

    /// Writes the next records.
    ///
    /// # Panics
    /// If there is no room left.
    fn put(&mut self, fans: &[Fan]);
}

impl FanSlot for &mut [Fan] {
    fn split_at(self, fans: usize) -> (Self, Self) {
        self.split_at_mut(fans)
    }

    fn put(&mut self, fans: &[Fan]) {
        let (here, rest) = std::mem::take(self).split_at_mut(fans.len());
        here.copy_from_slice(fans);
        *self = rest;
    }
}

/// Which cells are drawn as a [`PlaneFan`] each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanesFor {
    /// None: cells across the near plane are cut into up to three tetrahedra behind it, each with a fan.
    NoCells,
    /// Cells across the near plane, and those with vertices far outside the picture, where a rasteriser's rounding grows with
    /// the size of the triangle.
    NearCells,
    /// All but slivers whose values are better interpolated over a fan.
    AllCells,
}

/// What may stand among fans, in their room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contents {
    /// [`PlaneFan`]s.
    pub has_planes: bool,
    /// [`HexFan`]s.
    pub has_hexahedra: bool,
}

impl Contents {
    /// The fans whose room one record takes, whatever it is.
    pub fn fans_per_record(self) -> usize {
        if self.has_hexahedra { HexFan::FANS } else { 1 }
    }
}

/// What fans are made from.
#[derive(Clone, Copy)]
pub struct FanInput<'a> {
    view: &'a View,
    planes_for: PlanesFor,
    dataset: &'a Dataset,
    vertices: &'a [SceneVertex],
    screen: &'a [ScreenVertex],
    cell_values: Option<&'a [f32]>,
    projection: PixelProjection,
    /// Whether a vertex lies before the near plane, or (planes) far outside the picture, so that cells need care.
    has_near_cells: bool,
    hexahedra: HexahedraView<'a>,
}

/// The fans of one cell, and their classes; planes have none.
type CellFans = ArrayVec<(Option<ProjectionClass>, Fan), 3>;

/// Fans that are written at once.
const WRITTEN_AT_ONCE: usize = 16;

impl<'a> FanInput<'a> {
    /// For one view, whose projection of `vertices` is `screen`; `cell_values` holds cell data, `None` takes the vertices' scalars.
    pub fn new(
        view: &'a View,
        dataset: &'a Dataset,
        vertices: &'a [SceneVertex],
        screen: &'a [ScreenVertex],
        cell_values: Option<&'a [f32]>,
        planes_for: PlanesFor,
    ) -> Self {
        let projection = view.projection();
        let hexahedra = dataset.hexahedra.view();
        let has_near_cells = false;
        let mut input =
            Self { view, planes_for, dataset, vertices, screen, cell_values, projection, has_near_cells, hexahedra };
        input.has_near_cells = screen.par_iter().with_min_len(1 << 14).any(|vertex| input.is_near(vertex));
        input
    }

    /// Whether a cell with this vertex needs care.
    #[inline]
    fn is_near(&self, vertex: &ScreenVertex) -> bool {
        // Half a picture beyond its edge.
        let [width, height] = self.view.size_px.map(|side| side as f32);
        let is_far_outside =
            || (vertex.x_px - 0.5 * width).abs() > width || (vertex.y_px - 0.5 * height).abs() > height;
        vertex.depth < self.view.near || (self.planes_for != PlanesFor::NoCells && is_far_outside())
    }

    /// What there may be among the fans.
    pub fn contents(&self) -> Contents {
        let has_planes = match self.planes_for {
            PlanesFor::NoCells => false,
            PlanesFor::NearCells => self.has_near_cells,
            PlanesFor::AllCells => true,
        };
        Contents { has_planes, has_hexahedra: !self.hexahedra.is_empty() }
    }

    /// See [`Contents::fans_per_record`].
    fn fans_per_record(&self) -> usize {
        self.contents().fans_per_record()
    }

    /// No cell has more fans than this.
    pub fn fans_per_cell_max(&self) -> usize {
        self.fans_per_record() * if self.has_near_cells && self.planes_for == PlanesFor::NoCells { 3 } else { 1 }
    }

    /// The projected corners of a cell, and its scalars.
    #[inline]
    fn corners(&self, cell: u32) -> ([Vec3; 4], [f32; 4]) {
        let corners = self.dataset.tets.get(cell as usize).map(|v| self.screen[v as usize]);
        let constant = self.cell_values.map(|values| values[cell as usize]);
        (
            corners.map(|corner| Vec3::new(corner.x_px, corner.y_px, corner.depth)),
            corners.map(|corner| constant.unwrap_or(corner.scalar)),
        )
    }

    /// Whether the cell is a tetrahedron that needs care.
    #[inline]
    fn is_near_cell(&self, cell: u32) -> bool {
        self.has_near_cells
            && (cell as usize) < self.dataset.tets.len()
            && self.dataset.tets.get(cell as usize).iter().any(|&v| self.is_near(&self.screen[v as usize]))
    }

    /// The fan of a tetrahedron.
    #[inline]
    fn of_corners(&self, projected: [Vec3; 4], scalars: [f32; 4], is_positive: bool) -> (ProjectionClass, Fan) {
        let classified = classify(projected.map(Vec3::truncate), is_positive);
        let records = std::array::from_fn(|k| {
            let Vec3 { x, y, z: w } = projected[k];
            let v = self.view.inverse_depth(w);
            Projected { xy: Vec2::new(x, y), v, q: scalars[k] * if self.view.is_perspective { v } else { 1.0 } }
        });
        let fold = |of: fn(f32, f32) -> f32| of(of(scalars[0], scalars[1]), of(scalars[2], scalars[3]));
        (classified.class, fan(classified, records, [fold(f32::min), fold(f32::max)]))
    }

    /// The parts of a cell that lie behind the near plane.
    #[cold]
    fn of_cut_cell(&self, cell: u32) -> CellFans {
        let (projected, scalars) = self.corners(cell);
        let corners = self.dataset.tets.get(cell as usize).map(|v| self.vertices[v as usize].position);
        let corners = std::array::from_fn(|k| Corner {
            position: Vec3::from_array(corners[k]),
            scalar: scalars[k],
            depth: projected[k].z,
        });
        let mut parts = [corners; 3];
        let count = near::cut(corners, self.view.near, &mut parts);
        let of_part = |part: &[Corner; 4]| {
            let projected = part.map(|corner| self.projection.project(corner.position));
            let scalars = part.map(|corner| corner.scalar);
            let (class, fan) = self.of_corners(projected, scalars, self.dataset.positive.get(cell as usize));
            (Some(class), fan)
        };
        parts[..count].iter().map(of_part).collect()
    }

    /// A cell as its planes; none for a sliver behind the near plane, which has a fan.
    fn of_planes(&self, cell: u32, is_near: bool) -> Option<Fan> {
        let tet = self.dataset.tets.get(cell as usize);
        let Some(pixels) = PixelBoxes::new(self.view).of_cell(tet, self.vertices, self.screen) else {
            return Some(Fan::default());
        };
        let constant = self.cell_values.map(|values| values[cell as usize]);
        let is_positive = self.dataset.positive.get(cell as usize);
        let (fan, is_steep) = PlaneFan::new(self.view, pixels, (tet, is_positive), self.vertices, constant);
        (is_near || !is_steep).then(|| bytemuck::cast(fan))
    }

    /// A cell with faces of four corners.
    #[inline]
    fn of_hexahedron(&self, cell: usize) -> HexFan {
        let number = cell - self.dataset.tets.len();
        let vertex = self.hexahedra.get(number);
        let Some(pixels) = PixelBoxes::new(self.view).of_cell(vertex, self.vertices, self.screen) else {
            return HexFan::default();
        };
        let constant = self.cell_values.map(|values| values[cell]);
        HexFan::new(self.view, pixels, (vertex, self.hexahedra.shape(number)), (self.vertices, self.screen), constant)
    }

    /// The fans of `cell`, a tetrahedron.
    #[inline]
    fn of_tetrahedron(&self, cell: u32) -> CellFans {
        let is_near = self.is_near_cell(cell);
        if is_near && self.planes_for == PlanesFor::NoCells {
            return self.of_cut_cell(cell);
        }
        if (is_near || self.planes_for == PlanesFor::AllCells)
            && let Some(fan) = self.of_planes(cell, is_near)
        {
            return std::iter::once((None, fan)).collect();
        }
        let (projected, scalars) = self.corners(cell);
        let (class, fan) = self.of_corners(projected, scalars, self.dataset.positive.get(cell as usize));
        std::iter::once((Some(class), fan)).collect()
    }
}

/// How many fans `cells` need: a record each, and up to three where a tetrahedron is cut at the near plane.
pub fn count(input: &FanInput, cells: &[u32]) -> usize {
    let records = |&cell: &u32| if input.is_near_cell(cell) { input.of_cut_cell(cell).len() } else { 1 };
    let are_cut = input.has_near_cells && input.planes_for == PlanesFor::NoCells;
    input.fans_per_record() * if are_cut { cells.iter().map(records).sum() } else { cells.len() }
}

/// Writes the fans of `cells`, in their order, into `slot`; counts them by class. A cell seen edge-on has a fan that covers nothing.
///
/// # Panics
/// If the slot has not the room that [`count`] asks for.
pub fn write(input: &FanInput, cells: &[u32], slot: &mut impl FanSlot) -> [u64; 5] {
    let mut by_class = [0; 5];
    let mut some: ArrayVec<Fan, WRITTEN_AT_ONCE> = ArrayVec::new();
    let fans_per_record = input.fans_per_record();
    for &cell in cells {
        if cell as usize >= input.dataset.tets.len() {
            let fans: [Fan; HexFan::FANS] = bytemuck::cast(input.of_hexahedron(cell as usize));
            put(&mut some, &fans, slot);
            continue;
        }
        for (class, fan) in input.of_tetrahedron(cell) {
            if let Some(class) = class {
                by_class[class as usize] += 1;
            }
            put(&mut some, &[fan, Fan::default()][..fans_per_record], slot);
        }
    }
    slot.put(&some);
    by_class
}

/// Adds a record to those that are written at once.
#[inline]
fn put(some: &mut ArrayVec<Fan, WRITTEN_AT_ONCE>, record: &[Fan], slot: &mut impl FanSlot) {
    if some.remaining_capacity() < record.len() {
        slot.put(some);
        some.clear();
    }
    some.extend(record.iter().copied());
}

/// Writes the fans of `runs` of cells, each of as many fans as `counts` says, one run after the other, in parallel.
pub fn write_runs<S: FanSlot>(input: &FanInput, runs: &[Vec<u32>], counts: &[usize], memory: S) -> [u64; 5] {
    let mut slots = Vec::with_capacity(runs.len());
    let mut free = memory;
    for &count in counts {
        let (slot, rest) = free.split_at(count);
        free = rest;
        slots.push(slot);
    }
    let by_run = runs.par_iter().zip(slots).map(|(run, mut slot)| write(input, run, &mut slot));
    by_run.reduce(|| [0; 5], |a, b| std::array::from_fn(|class| a[class] + b[class]))
}

#[cfg(test)]
mod tests;
