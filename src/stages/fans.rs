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
//! In the room of a fan: a tetrahedron's planes ([`PlaneFan`]). Cells with faces of four corners take the room of two
//! ([`HexFan`]), or as the papers draw them of four ([`CaseFan`]), as are cubes; in such a mesh all cells do, and tetrahedra leave the rest
//! empty. Polyhedra take a record ([`PolyFan`]), and a list behind the records of their run. To add a record: a file with its layout, its twin in WGSL, its line in [`Contents`].

mod cases;
mod classes;
mod cubes;
mod faces;
mod hexahedra;
mod planes;
pub mod polyhedra;
mod tetrahedra;

use std::ops::Range;

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::classify::{CellClass, ClassCounts};
use super::{CubesInView, PixelProjection, SceneVertex, ScreenVertex, View};
use crate::camera::Region;
use crate::columns::{Dataset, HexahedraView, PolyhedraView};
use cases::Drawn;
use tetrahedra::{Tet, TetFans};

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

pub use cases::CaseFan;
pub use faces::PolyFan;
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

/// How faces of four corners are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Faces {
    /// By their two triangles, in each fragment: [`HexFan`].
    #[default]
    Exact,
    /// By the triangles of the cell's case, as in the papers: [`CaseFan`].
    Fan,
}

/// What may stand among fans, in their room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contents {
    /// [`PlaneFan`]s.
    pub has_planes: bool,
    /// Cells with faces of four corners, and how they are drawn.
    pub whole_cells: Option<Faces>,
    /// [`PolyFan`]s, and their lists.
    pub has_polyhedra: bool,
}

impl Contents {
    /// Whether nothing but fans and their triangles is drawn, no boxes.
    pub fn has_only_fans(self) -> bool {
        !self.has_planes && self.whole_cells != Some(Faces::Exact) && !self.has_polyhedra
    }

    /// The fans whose room one record takes, whatever it is.
    pub fn fans_per_record(self) -> usize {
        match self.whole_cells {
            None => 1,
            Some(Faces::Exact) => HexFan::FANS,
            Some(Faces::Fan) => CaseFan::FANS,
        }
    }
}

/// What is drawn how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FanStyle {
    /// Tetrahedra.
    pub planes_for: PlanesFor,
    /// Other cells.
    pub faces: Faces,
}

/// What fans are made from.
#[derive(Clone, Copy)]
pub struct FanInput<'a> {
    view: &'a View,
    planes_for: PlanesFor,
    faces: Faces,
    dataset: &'a Dataset,
    vertices: &'a [SceneVertex],
    screen: &'a [ScreenVertex],
    cell_values: Option<&'a [f32]>,
    projection: PixelProjection,
    /// Whether a vertex lies before the near plane, or (planes) far outside the picture, so that cells need care.
    has_near_cells: bool,
    hexahedra: HexahedraView<'a>,
    polyhedra: PolyhedraView<'a>,
    /// What is drawn instead of the dataset's cells.
    cubes: Option<CubesInView<'a>>,
}

impl<'a> FanInput<'a> {
    /// For one view, whose projection of `vertices` is `screen`; `cell_values` holds cell data, `None` takes the vertices' scalars.
    pub fn new(
        view: &'a View,
        dataset: &'a Dataset,
        vertices: &'a [SceneVertex],
        screen: &'a [ScreenVertex],
        cell_values: Option<&'a [f32]>,
        FanStyle { planes_for, faces }: FanStyle,
    ) -> Self {
        let mut input = Self {
            view,
            planes_for,
            faces,
            dataset,
            vertices,
            screen,
            cell_values,
            projection: view.projection(),
            has_near_cells: false,
            hexahedra: dataset.hexahedra.view(),
            polyhedra: dataset.polyhedra.view(),
            cubes: None,
        };
        input.has_near_cells = screen.par_iter().with_min_len(1 << 14).any(|vertex| input.is_near(vertex));
        input
    }

    /// Whether a cell with this vertex needs care.
    #[inline]
    fn is_near(&self, vertex: &ScreenVertex) -> bool {
        let has_planes = self.planes_for != PlanesFor::NoCells;
        vertex.depth < self.view.near || (has_planes && is_far_outside(self.view.region, vertex))
    }

    /// Cubes that are drawn instead of the dataset's cells: their numbers are those of cells.
    pub fn cubes(&self) -> Option<&CubesInView<'a>> {
        self.cubes.as_ref()
    }

    /// What there may be among the fans.
    pub fn contents(&self) -> Contents {
        let has_planes = match self.planes_for {
            PlanesFor::NoCells => false,
            PlanesFor::NearCells => self.has_near_cells,
            PlanesFor::AllCells => true,
        };
        if self.cubes.is_some() {
            let has_planes = has_planes && self.has_near_cells;
            return Contents { has_planes, whole_cells: Some(Faces::Fan), has_polyhedra: false };
        }
        let whole_cells = (!self.hexahedra.is_empty()).then_some(self.faces);
        Contents { has_planes, whole_cells, has_polyhedra: !self.polyhedra.is_empty() }
    }

    /// See [`Contents::fans_per_record`].
    fn fans_per_record(&self) -> usize {
        self.contents().fans_per_record()
    }

    /// No cell has more fans than this.
    pub fn fans_per_cell_max(&self) -> usize {
        let Contents { whole_cells, has_polyhedra, .. } = self.contents();
        let is_split = whole_cells == Some(Faces::Fan) && (self.cubes.is_none() || self.has_near_cells);
        let parts = if is_split { cases::PARTS_MAX } else { 1 };
        let cuts = if self.has_near_cells && self.planes_for == PlanesFor::NoCells { 3 } else { 1 };
        let of_list = if has_polyhedra {
            PolyFan::list_fans_max(self.dataset.polyhedra.most(), self.fans_per_record())
        } else {
            0
        };
        self.fans_per_record() * parts * cuts + of_list
    }

    /// The fans in which the records of a run stand, of the `fans` from `first` on that [`count`] says `cells` cells need: behind them
    /// come lists.
    pub fn records(&self, first: usize, fans: usize, cells: usize) -> Range<usize> {
        let fans = if self.contents().has_polyhedra { cells * self.fans_per_record() } else { fans };
        first..first + fans
    }

    /// Whether a cell is a tetrahedron.
    #[inline]
    fn is_tet(&self, cell: u32) -> bool {
        (cell as usize) < self.dataset.tets.len()
    }

    /// How many records a cell has.
    #[inline]
    fn records_of(&self, cell: u32) -> usize {
        if let Some(cubes) = &self.cubes {
            return self.records_of_cube(cubes, &cubes.cubes[cell as usize]);
        }
        if self.is_tet(cell) {
            return self.fans_of(&self.tet(cell));
        }
        if let Some(listed) = self.polyhedron(cell) {
            return 1 + listed.fans / self.fans_per_record();
        }
        match self.faces {
            Faces::Exact => 1,
            Faces::Fan => match self.of_whole_cell(cell as usize) {
                Drawn::EdgeOn => 0,
                Drawn::Case(..) => 1,
                Drawn::Parts(parts) => parts.iter().map(|part| self.fans_of(part)).sum(),
            },
        }
    }
}

/// Whether a vertex is more than half of the width or height of `region` beyond its edge.
#[inline]
fn is_far_outside(region: Region, vertex: &ScreenVertex) -> bool {
    let [width, height] = region.size_px().map(|side| side as f32);
    let [x, y] = [vertex.x_px - region.x0 as f32, vertex.y_px - region.y0 as f32];
    (x - 0.5 * width).abs() > width || (y - 0.5 * height).abs() > height
}

/// How many fans `cells` need.
pub fn count(input: &FanInput, cells: &[u32]) -> usize {
    let fans_per_record = input.fans_per_record();
    if input.fans_per_cell_max() == fans_per_record {
        return fans_per_record * cells.len();
    }
    fans_per_record * cells.iter().map(|&cell| input.records_of(cell)).sum::<usize>()
}

/// Writes the fans of `cells`, in their order, into `slot`; counts them by class. A cell seen edge-on has a fan that covers nothing.
///
/// # Panics
/// If the slot has not the room that [`count`] asks for.
pub fn write(input: &FanInput, cells: &[u32], slot: &mut impl FanSlot) -> ClassCounts {
    let mut writer = Writer { input, fans: ArrayVec::new(), slot, by_class: ClassCounts::default() };
    // Of all records and lists, those that come behind the record at hand.
    let mut behind = cells.len() * input.fans_per_record();
    for &cell in cells {
        if let Some(cubes) = &input.cubes {
            writer.put_cube(cubes, &cubes.cubes[cell as usize]);
        } else if input.is_tet(cell) {
            writer.put_tet(&input.tet(cell));
        } else if let Some(listed) = input.polyhedron(cell) {
            writer.put_padded(bytemuck::cast(input.of_polyhedron(listed, behind)));
            behind += listed.fans;
        } else if input.faces == Faces::Exact {
            writer.put(&bytemuck::cast::<_, [Fan; HexFan::FANS]>(input.of_hexahedron(cell as usize)));
        } else {
            match input.of_whole_cell(cell as usize) {
                Drawn::EdgeOn => writer.by_class.add(CellClass::EDGE_ON),
                Drawn::Case(class, fan) => {
                    writer.by_class.add(class);
                    writer.put(&bytemuck::cast::<_, [Fan; CaseFan::FANS]>(*fan));
                }
                Drawn::Parts(parts) => {
                    writer.by_class.add(CellClass::SPLIT);
                    parts.iter().for_each(|part| writer.put_tet(part));
                }
            }
        }
        behind = behind.saturating_sub(input.fans_per_record());
    }
    writer.slot.put(&writer.fans);
    if !input.polyhedra.is_empty() && input.cubes.is_none() {
        let mut list = Vec::new();
        for listed in cells.iter().filter_map(|&cell| input.polyhedron(cell)) {
            input.write_list(listed, &mut list);
            writer.slot.put(&list);
        }
    }
    writer.by_class
}

/// Fans that are written at once: whole records.
const WRITTEN_AT_ONCE: usize = 16;

/// Collects records, and writes them some at a time.
struct Writer<'a, 'b, S> {
    input: &'a FanInput<'a>,
    fans: ArrayVec<Fan, WRITTEN_AT_ONCE>,
    slot: &'b mut S,
    by_class: ClassCounts,
}

impl<S: FanSlot> Writer<'_, '_, S> {
    #[inline]
    fn put(&mut self, record: &[Fan]) {
        if self.fans.remaining_capacity() < record.len() {
            self.slot.put(&self.fans);
            self.fans.clear();
        }
        self.fans.extend(record.iter().copied());
    }

    #[inline]
    fn put_tet(&mut self, tet: &Tet) {
        self.put_fans(self.input.of_tet(tet));
    }

    #[inline]
    fn put_fans(&mut self, fans: TetFans) {
        for (class, fan) in fans {
            if let Some(class) = class {
                self.by_class.add(class.into());
            }
            self.put_padded(fan);
        }
    }

    /// A fan in the room of a record.
    #[inline]
    fn put_padded(&mut self, fan: Fan) {
        self.put(&[fan, Fan::default(), Fan::default(), Fan::default()][..self.input.fans_per_record()]);
    }
}

/// Writes the fans of `runs` of cells, each of as many fans as `counts` says, one run after the other, in parallel.
pub fn write_runs<S: FanSlot>(input: &FanInput, runs: &[Vec<u32>], counts: &[usize], memory: S) -> ClassCounts {
    let mut slots = Vec::with_capacity(runs.len());
    let mut free = memory;
    for &count in counts {
        let (slot, rest) = free.split_at(count);
        free = rest;
        slots.push(slot);
    }
    let by_run = runs.par_iter().zip(slots).map(|(run, mut slot)| {
        let _span = tracing::trace_span!("fans", cells = run.len()).entered();
        write(input, run, &mut slot)
    });
    by_run.reduce(ClassCounts::default, |mut all, some| {
        all += some;
        all
    })
}

#[cfg(test)]
mod tests;
