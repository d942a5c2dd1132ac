//! A polyhedron by its faces: a [`PolyFan`] in the room of a fan, whose box a rasteriser draws, and behind those of the run a list
//! of its corners and faces, in which each fragment finds the triangles that its ray crosses.
//!
//! In: a cell, its pixel box. Out: a [`PolyFan`], and its list: for each corner (x·w, y·w, w, s), columns and rows of the whole
//! picture (parallel rays: x, y, w, s); then the corners around each face, counterclockwise seen from outside, two a word, the
//! first of each marked.
//!
//! The corners are homogeneous as those of a [`HexFan`](super::HexFan) across the near plane are, for all cells: a corner has the
//! same bits in each cell that has it, and an edge runs from the corner of lower number to the other, so that cells at an edge
//! decide alike on which side of it a ray runs. Depths are taken from the cell's middle, as the tile compositor takes them
//! (`stages/footprints/polyhedra.rs`, where it is said how crossings are found).

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::{Fan, FanInput};
use crate::columns::{Most, PolyhedraView};
use crate::stages::footprints::PixelBoxes;
use crate::stages::footprints::polyhedra::LEAST;

/// A polyhedron in the room of a [`Fan`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct PolyFan {
    /// First column, and from bit 16 on the column after the last; the same for rows.
    pub box_px: [u32; 2],
    /// Largest and smallest stored value: a [`Fan`] has them the other way round, which tells the two apart.
    pub s_range: [f32; 2],
    /// How many fans behind this one its list begins.
    pub list: u32,
    /// How many corners the list begins with.
    pub corners: u32,
    /// How many corners its faces have, those of several faces more than once.
    pub around: u32,
    /// [`PolyFan::POLYHEDRON`], [`PolyFan::IS_CONSTANT`].
    pub flags: u32,
    /// The depth of its middle.
    pub w_middle: f32,
    /// Shorter segments, in depth, are rounding.
    pub w_least: f32,
    unused: [u32; 14],
}

const _: () = assert!(size_of::<PolyFan>() == size_of::<Fan>());

/// Four words of a list, one of its corners, or eight of the corners around faces.
type Words = [u32; 4];
/// Words of four that a fan has room for.
const WORDS_PER_FAN: usize = size_of::<Fan>() / size_of::<Words>();
const AROUND_PER_WORDS: usize = 8;

impl PolyFan {
    /// Set in all; neither a [`HexFan`](super::HexFan) nor a [`PlaneFan`](super::PlaneFan) has it.
    pub const POLYHEDRON: u32 = 1 << 30;
    /// The cell has one value, the smallest of its range.
    pub const IS_CONSTANT: u32 = 1 << 25;
    /// Marks the first corner of a face.
    pub const FIRST: u16 = 1 << 15;
    /// A list has no more corners.
    pub const CORNERS_MAX: usize = Self::FIRST as usize;

    /// The fans whose room a list takes, of so many corners with so many around faces; records stand at multiples of `per_record`.
    fn list_fans(corners: usize, around: usize, per_record: usize) -> usize {
        let fans = (corners + around.div_ceil(AROUND_PER_WORDS)).div_ceil(WORDS_PER_FAN);
        fans.next_multiple_of(per_record)
    }

    /// The most that a cell takes, beside its own room.
    pub(super) fn list_fans_max(Most { corners, around, .. }: Most, per_record: usize) -> usize {
        Self::list_fans(corners, around, per_record)
    }
}

/// A polyhedron and what a list of it needs.
#[derive(Clone, Copy)]
pub(super) struct Listed<'a> {
    polyhedra: PolyhedraView<'a>,
    /// Its number among the polyhedra.
    number: usize,
    around: usize,
    /// The fans whose room its list takes.
    pub(super) fans: usize,
}

impl<'a> Listed<'a> {
    fn new(polyhedra: PolyhedraView<'a>, number: usize, per_record: usize) -> Self {
        let around = polyhedra.faces(number).map(|face| face.around.len()).sum();
        let fans = PolyFan::list_fans(polyhedra.corners(number).len(), around, per_record);
        Self { polyhedra, number, around, fans }
    }

    fn corners(&self) -> &'a [u32] {
        self.polyhedra.corners(self.number)
    }
}

impl<'a> FanInput<'a> {
    /// Cell `cell`, if it is a polyhedron.
    #[inline]
    pub(super) fn polyhedron(&self, cell: u32) -> Option<Listed<'a>> {
        let number = (cell as usize).checked_sub(self.dataset.first_polyhedron())?;
        Some(Listed::new(self.polyhedra, number, self.fans_per_record()))
    }

    /// Its record, so many fans before its list.
    pub(super) fn of_polyhedron(&self, listed: Listed, list: usize) -> PolyFan {
        let corners = listed.corners();
        let Some(pixels) = PixelBoxes::new(self.view).of_polyhedron(corners, self.vertices, self.screen) else {
            return PolyFan::default();
        };
        let constant = self.cell_values.map(|values| values[self.dataset.first_polyhedron() + listed.number]);
        let mut s = [f32::INFINITY, f32::NEG_INFINITY];
        let mut w = s;
        for &v in corners {
            let corner = self.screen[v as usize];
            let scalar = constant.unwrap_or(corner.scalar);
            (s, w) = ([s[0].min(scalar), s[1].max(scalar)], [w[0].min(corner.depth), w[1].max(corner.depth)]);
        }
        let [columns, rows] = [[pixels.x0, pixels.x1], [pixels.y0, pixels.y1]]
            .map(|[first, end]| u32::from(first) | u32::from(end) << 16);
        let is_constant = if s[0] < s[1] { 0 } else { PolyFan::IS_CONSTANT };
        PolyFan {
            box_px: [columns, rows],
            // Apart by more than a GPU may take for 0.
            s_range: [s[1].max(s[0] + s[0].abs() * 1e-6 + 1e-30), s[0]],
            list: list as u32,
            corners: corners.len() as u32,
            around: listed.around as u32,
            flags: PolyFan::POLYHEDRON | is_constant,
            w_middle: 0.5 * (w[0] + w[1]),
            w_least: LEAST * (w[1] - w[0]),
            ..PolyFan::default()
        }
    }

    /// Puts its list, as long as was said, into `list`, which is emptied before.
    pub(super) fn write_list(&self, listed: Listed, list: &mut Vec<Fan>) {
        let mut words: Vec<Words> = Vec::with_capacity(listed.fans * WORDS_PER_FAN);
        let view = self.view.beside();
        let [to_x, to_y] = [view.step_x, view.step_y].map(|step| step / step.length_squared());
        let first = [to_x, to_y].map(|axis| view.corner.dot(axis));
        for &v in listed.corners() {
            let from_eye = DVec3::from_array(self.vertices[v as usize].position.map(f64::from)) - view.eye;
            let w = from_eye.dot(view.forward);
            let scale = if view.is_perspective { w } else { 1.0 };
            let [x, y] = [from_eye.dot(to_x) - first[0] * scale, from_eye.dot(to_y) - first[1] * scale];
            words.push([x as f32, y as f32, w as f32, self.vertices[v as usize].scalar].map(f32::to_bits));
        }
        let mut around: Vec<u16> = Vec::with_capacity(listed.around);
        for face in listed.polyhedra.faces(listed.number) {
            let local = |&v: &u32| listed.corners().binary_search(&v).unwrap_or(0) as u16;
            let (first, rest) = (&face.around[0], &face.around[1..]);
            around.push(local(first) | PolyFan::FIRST);
            if face.is_reversed {
                around.extend(rest.iter().rev().map(local));
            } else {
                around.extend(rest.iter().map(local));
            }
        }
        for eight in around.chunks(AROUND_PER_WORDS) {
            let of = |i: usize| eight.get(i).copied().map_or(0, u32::from);
            words.push(std::array::from_fn(|k| of(2 * k) | of(2 * k + 1) << 16));
        }
        words.resize(listed.fans * WORDS_PER_FAN, [0; 4]);
        list.clear();
        list.extend_from_slice(bytemuck::cast_slice(&words));
    }
}
