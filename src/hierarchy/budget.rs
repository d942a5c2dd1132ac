//! A time budget: the finest selection that fits, refined while the view stands still.
//!
//! How many cubes a tolerance selects does not depend on the view: a node is taken where its error is within the tolerance and
//! those of all nodes above it are not. So all nodes are gone through once, level by level, and after that the tolerance for a
//! number of cubes is looked up; what a cube takes is learnt from the frames that were drawn.

use rayon::prelude::*;

use super::build::Hierarchy;
use super::leaves::Leaves;
use super::level::index;
use super::select::{Shows, WithinError};
use crate::columns::{Sample, SampleVisitor, Samples, VolumeField};

/// How many cubes each tolerance selects.
#[derive(Clone, Debug)]
pub struct CubeCounts {
    /// Tolerance i is i of these, in stored values.
    step: f32,
    /// Cubes at each tolerance, from 0 to one that every node is within.
    cubes: Vec<u64>,
}

/// Tolerances that are told apart.
const STEPS: usize = 4096;

impl CubeCounts {
    /// Those of `hierarchy`, that of `field`, where so much of it shows.
    pub fn new((hierarchy, field): (&Hierarchy, &VolumeField), shows: Shows) -> Self {
        field.visit(Count { hierarchy, shows })
    }

    /// The finest rule by which at most `cubes` are selected; the coarsest where there is none.
    pub fn within(&self, cubes: u64) -> WithinError {
        let step = self.cubes.iter().position(|&count| count <= cubes).unwrap_or(STEPS);
        WithinError(step as f32 * self.step)
    }

    /// Cubes of the finest selection.
    pub fn finest(&self) -> u64 {
        self.cubes[0]
    }
}

struct Count<'a> {
    hierarchy: &'a Hierarchy,
    shows: Shows<'a>,
}

/// By how much the number of cubes changes from each tolerance to the next.
type Changes = Vec<i64>;

impl SampleVisitor for Count<'_> {
    type Output = CubeCounts;

    fn visit<T: Sample>(self, samples: Samples<'_, T>) -> CubeCounts {
        let Self { hierarchy, shows } = self;
        let leaves = Leaves::new(samples, hierarchy.offset(), hierarchy.interpolation(), hierarchy.dims());
        let levels = hierarchy.levels();
        let largest = levels.last().map_or(0.0, |root| root.node(0).max - root.node(0).min);
        // Above the largest error, whatever it was rounded to.
        let step = (largest.max(0.0) * (1.0 + 1e-5) / STEPS as f32).max(f32::MIN_POSITIVE);
        let first_within = |error: f32| ((error / step).ceil() as usize).min(STEPS + 1);
        let add = |changes: &mut Changes, error: f32, above: f32| {
            let (first, end) = (first_within(error), first_within(above));
            if first < end {
                changes[first] += 1;
                changes[end] -= 1;
            }
        };
        let nothing = || vec![0; STEPS + 2];
        let sum = |mut all: Changes, some: Changes| {
            all.iter_mut().zip(some).for_each(|(all, some)| *all += some);
            all
        };
        // The smallest error of any node above those of the level at hand, from the root down.
        let mut above: Vec<f32> = vec![f32::INFINITY];
        let mut changes = nothing();
        for (number, level) in levels.iter().enumerate().rev() {
            let nodes = level.nodes();
            let error = |i: usize| Some(nodes.node(i).error()).filter(|error| !error.is_nan()).unwrap_or(f32::INFINITY);
            let of_nodes = (0..level.len()).into_par_iter().with_min_len(1 << 14).fold(nothing, |mut changes, i| {
                let node = nodes.node(i);
                if !shows.is_transparent(node.min, node.max) {
                    add(&mut changes, error(i), above[i]);
                }
                changes
            });
            changes = sum(changes, of_nodes.reduce(nothing, sum));
            let below = if number == 0 { hierarchy.dims() } else { levels[number - 1].dims };
            let place = |i: usize| {
                let [nx, ny] = [below[0] as usize, below[1] as usize];
                [i % nx, i / nx % ny, i / (nx * ny)].map(|along| along as u32)
            };
            let parent = |i: usize| index(level.dims, place(i).map(|node| node / 2));
            let of_parent = |parent: usize| above[parent].min(error(parent));
            let len = below.iter().map(|&side| side as usize).product::<usize>();
            if number > 0 {
                above = (0..len).into_par_iter().map(|i| of_parent(parent(i))).collect();
                continue;
            }
            let of_samples = (0..len).into_par_iter().with_min_len(1 << 14).fold(nothing, |mut changes, i| {
                let found = leaves.node(place(i));
                if !found.mean.is_nan() && !shows.is_transparent(found.min, found.max) {
                    add(&mut changes, 0.0, of_parent(parent(i)));
                }
                changes
            });
            changes = sum(changes, of_samples.reduce(nothing, sum));
        }
        let mut count = 0;
        let counted = changes.iter().map(|change| {
            count += change;
            count as u64
        });
        CubeCounts { step, cubes: counted.take(STEPS + 1).collect() }
    }
}

/// Chooses how many cubes a frame has, so that it takes as long as it may.
///
/// ```
/// use cellfan::hierarchy::TimeBudget;
/// let mut budget = TimeBudget::new(70.0);
/// budget.drawn(10_000, 7.0);
/// assert_eq!(budget.cubes(false), 40_000); // not all 100,000 at once: the next frame tells more
/// budget.drawn(40_000, 35.0);
/// assert_eq!(budget.cubes(false), 76_000); // 95 % of what fits
/// assert_eq!(budget.cubes(true), 80_000); // the view stands still: twice as many as before
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeBudget {
    budget_ms: f64,
    /// Cubes of the last frame, and what it took.
    last: Option<(u64, f64)>,
}

impl TimeBudget {
    /// Cubes of a frame of which nothing is known.
    const FIRST: u64 = 4096;
    /// Frames have at most so many times the cubes of the last one.
    const GROWTH: f64 = 4.0;
    /// What is left free of the budget, since frames differ.
    const SHARE: f64 = 0.95;

    /// Frames of at most `budget_ms` milliseconds.
    pub fn new(budget_ms: f64) -> Self {
        Self { budget_ms, last: None }
    }

    /// How long a frame may take.
    pub fn budget_ms(&self) -> f64 {
        self.budget_ms
    }

    /// Whether a frame has been drawn from which the time of others follows.
    pub fn is_known(&self) -> bool {
        self.last.is_some()
    }

    /// Cubes of the next frame; one of the same view as the last is finer, whatever it takes.
    pub fn cubes(&self, is_still: bool) -> u64 {
        let Some((cubes, frame_ms)) = self.last else { return Self::FIRST };
        if is_still {
            return cubes * 2;
        }
        let fitting = cubes as f64 * (Self::SHARE * self.budget_ms / frame_ms);
        fitting.min(cubes as f64 * Self::GROWTH).max(1.0) as u64
    }

    /// Notes what a frame took.
    pub fn drawn(&mut self, cubes: u64, frame_ms: f64) {
        self.last = Some((cubes.max(1), frame_ms.max(1e-6)));
    }
}
