//! `select`: the cubes of a picture, farthest first.
//!
//! In: a [`Hierarchy`], its field, what is fine enough ([`Accept`]), what shows, and from where it is seen. Out: a [`Selection`]:
//! every sample that shows lies in exactly one of its cubes, and of two cubes that hide each other the farther one comes first.
//! From the root down, a node is left out where no sample under it shows, taken where it is fine enough, else parted; its children
//! in the order of their octants: the planes that part them lie between, and on each the side away from the eye comes first.
//! One array access for each of three numbers a node, no stack but the call's.

use rayon::prelude::*;

use super::build::Hierarchy;
use super::leaves::Leaves;
use super::level::{Level, Node, Nodes};
use crate::columns::{Cube, GridEye, Sample, SampleVisitor, Samples, VolumeField};
use crate::optics::{CullTable, Intervals};

/// Says which nodes are fine enough.
pub trait Accept: Sync {
    /// Whether the node may be drawn as one cube with the mean of its samples. A node with a sample that is not finite, whose mean is
    /// NaN, never may.
    fn accepts(&self, node: &Node) -> bool;
}

/// Nodes none of whose samples differs from their mean by more than this, in stored values (the paper's tolerance).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithinError(pub f32);

impl Accept for WithinError {
    #[inline]
    fn accepts(&self, node: &Node) -> bool {
        node.error() <= self.0
    }
}

/// Which stored values show.
#[derive(Clone, Copy, Debug)]
pub struct Shows<'a> {
    /// The intervals of the transfer function.
    pub intervals: &'a Intervals,
    /// Which of them are transparent.
    pub table: &'a CullTable,
}

impl Shows<'_> {
    /// Whether no value from `low` to `high` shows.
    #[inline]
    pub(super) fn is_transparent(self, low: f32, high: f32) -> bool {
        self.table.is_transparent(self.intervals, low, high)
    }
}

/// Cubes, farthest first.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// They themselves.
    pub cubes: Vec<Cube>,
    /// Nodes that were looked at, samples included.
    pub visited: u64,
    /// Samples that do not show.
    pub transparent: u64,
    /// Samples that are not finite.
    pub invalid: u64,
}

impl Selection {
    /// Selects from `hierarchy`, that of `field`, into this, whose memory is used again; `is_parallel` on all threads.
    pub fn select(
        &mut self,
        (hierarchy, field): (&Hierarchy, &VolumeField),
        accept: &impl Accept,
        shows: Shows,
        eye: GridEye,
        is_parallel: bool,
    ) {
        let _span = tracing::trace_span!("select").entered();
        let cubes = std::mem::take(&mut self.cubes);
        *self = field.visit(Select { hierarchy, accept, shows, eye, is_parallel, cubes });
    }

    fn clear(&mut self) {
        self.cubes.clear();
        (self.visited, self.transparent, self.invalid) = (0, 0, 0);
    }

    fn append(&mut self, other: &Self) {
        self.cubes.extend_from_slice(&other.cubes);
        self.visited += other.visited;
        self.transparent += other.transparent;
        self.invalid += other.invalid;
    }
}

struct Select<'a, A> {
    hierarchy: &'a Hierarchy,
    accept: &'a A,
    shows: Shows<'a>,
    eye: GridEye,
    is_parallel: bool,
    cubes: Vec<Cube>,
}

impl<A: Accept> SampleVisitor for Select<'_, A> {
    type Output = Selection;

    fn visit<T: Sample>(self, samples: Samples<'_, T>) -> Selection {
        let Self { hierarchy, accept, shows, eye, is_parallel, cubes } = self;
        let leaves = Leaves::new(samples, hierarchy.offset(), hierarchy.interpolation(), hierarchy.dims());
        let levels: Vec<Nodes> = hierarchy.levels().iter().map(Level::nodes).collect();
        let walk = Walk { levels: &levels, dims: hierarchy.dims(), leaves, accept, shows, eye, stop: 0 };
        let mut selection = Selection { cubes, ..Selection::default() };
        selection.clear();
        if !is_parallel || levels.len() <= LEVELS_ABOVE_PARTS {
            walk.visit(levels.len(), [0; 3], &mut selection, &mut Vec::new());
            return selection;
        }
        // The nodes some levels below the root, in order; each is then walked by itself.
        let mut parts = Vec::new();
        let stop = levels.len() - LEVELS_ABOVE_PARTS;
        Walk { stop, ..walk }.visit(levels.len(), [0; 3], &mut selection, &mut parts);
        let of_part = |&(level, node): &(usize, [u32; 3])| {
            let mut part = Selection::default();
            walk.visit(level, node, &mut part, &mut Vec::new());
            part
        };
        let of_parts: Vec<Selection> = parts.par_iter().with_max_len(1).map(of_part).collect();
        selection.cubes.reserve(of_parts.iter().map(|part| part.cubes.len()).sum());
        for part in &of_parts {
            selection.append(part);
        }
        selection
    }
}

/// Levels that one thread walks before the others help: 512 parts at most.
const LEVELS_ABOVE_PARTS: usize = 3;

/// A walk through the tree, or, with a level to stop at, only down to it.
struct Walk<'a, T, A> {
    levels: &'a [Nodes<'a>],
    /// Smallest boxes along i, j and k.
    dims: [u32; 3],
    leaves: Leaves<'a, T>,
    accept: &'a A,
    shows: Shows<'a>,
    eye: GridEye,
    /// Nodes of this level, and those above that are not parted, are listed; 0 for none.
    stop: usize,
}

impl<T: Sample, A> Clone for Walk<'_, T, A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Sample, A> Copy for Walk<'_, T, A> {}

impl<T: Sample, A: Accept> Walk<'_, T, A> {
    /// Selects from the tree under `node` of a level above the samples, 0 being theirs; `parts` lists where the walk stops.
    fn visit(&self, level: usize, node: [u32; 3], selection: &mut Selection, parts: &mut Vec<(usize, [u32; 3])>) {
        let Some(above) = level.checked_sub(1) else {
            return self.sample(node, selection);
        };
        let found = self.levels[above].at(node);
        if found.min > found.max {
            selection.visited += 1;
            selection.invalid += self.samples_under(level, node);
            return;
        }
        if !found.mean.is_nan() && self.shows.is_transparent(found.min, found.max) {
            selection.visited += 1;
            selection.transparent += self.samples_under(level, node);
            return;
        }
        let is_taken = self.accept.accepts(&found);
        if self.stop > 0 && (is_taken || level == self.stop) {
            parts.push((level, node));
            return;
        }
        selection.visited += 1;
        if is_taken {
            let node = node.map(|node| node as u16);
            selection.cubes.push(Cube { node, level: level as u16, value: found.mean });
            return;
        }
        let below = if above == 0 { self.dims } else { self.levels[above - 1].dims };
        let far = self.far_side(above, node);
        for number in 0..8_u32 {
            let octant = number ^ far;
            let child = [2 * node[0] + (octant & 1), 2 * node[1] + (octant >> 1 & 1), 2 * node[2] + (octant >> 2)];
            if child[0] >= below[0] || child[1] >= below[1] || child[2] >= below[2] {
                continue;
            }
            if above == 0 {
                self.sample(child, selection);
            } else {
                self.visit(above, child, selection, parts);
            }
        }
    }

    /// The octant farthest from the eye: bit a is set where that is the upper half along axis a. Counted from it by exclusive or,
    /// no octant comes after one that it may hide.
    #[inline]
    fn far_side(&self, below: usize, node: [u32; 3]) -> u32 {
        let is_upper = |axis: usize| match self.eye {
            GridEye::At(eye) => eye[axis] < f64::from((2 * node[axis] + 1) << below),
            GridEye::Along(direction) => direction[axis] < 0.0,
        };
        u32::from(is_upper(0)) | u32::from(is_upper(1)) << 1 | u32::from(is_upper(2)) << 2
    }

    #[inline]
    fn sample(&self, node: [u32; 3], selection: &mut Selection) {
        selection.visited += 1;
        let found = self.leaves.node(node);
        if found.mean.is_nan() {
            selection.invalid += 1;
        } else if self.shows.is_transparent(found.min, found.max) {
            selection.transparent += 1;
        } else {
            selection.cubes.push(Cube { node: node.map(|node| node as u16), level: 0, value: found.mean });
        }
    }

    fn samples_under(&self, level: usize, node: [u32; 3]) -> u64 {
        let along = |axis: usize| u64::from(((node[axis] + 1) << level).min(self.dims[axis]) - (node[axis] << level));
        along(0) * along(1) * along(2)
    }
}
