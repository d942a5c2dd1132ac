//! `DrawOrder`: the cells of a frame in the order in which a rasterising backend draws them, and their fans slice by slice.
//!
//! In: a [`Frame`]. Out: [`Slice`]s of the draw order, farthest cells first, each of at most so many fans.

#[cfg(feature = "gpu")]
use std::ops::Range;
use std::time::Instant;

use glam::DVec3;
use rayon::prelude::*;

use super::{Counts, Frame};
use crate::profile::Profile;
use crate::stages::classify::ClassCounts;
use crate::stages::cull;
use crate::stages::fans::{self, FanInput, FanSlot, FanStyle, PlanesFor};
use crate::stages::footprints::PixelBoxes;
use crate::stages::project::project_while;
use crate::stages::sort::radix::frames::{FrameSort, Part};
use crate::stages::sort::radix::{Pair, index_of, pair};
use crate::stages::{ScreenVertex, View};

/// Cells that one thread makes fans of at a time.
const RUN: usize = 1 << 12;

/// Parts of the cells that each thread culls, one after the other: enough for threads to end at the same time.
const PARTS_PER_THREAD: usize = 8;

/// Projected vertices and sorted cells; keeps its memory, and how the last frame's keys were spread, between frames.
#[derive(Default)]
pub(super) struct DrawOrder {
    screen: Vec<ScreenVertex>,
    pairs: Vec<Pair>,
    sort: FrameSort,
    last_view: Option<View>,
}

/// A part of the draw order.
pub(super) struct Slice {
    runs: Vec<Vec<u32>>,
    fans_of_run: Vec<usize>,
}

impl Slice {
    /// How many fans its cells have.
    pub(super) fn fans(&self) -> usize {
        self.fans_of_run.iter().sum()
    }

    /// The fans in which there are records, run after run; one run where nothing lies between.
    #[cfg(feature = "gpu")]
    pub(super) fn records(&self, input: &FanInput) -> Vec<Range<usize>> {
        let mut records: Vec<Range<usize>> = Vec::new();
        let mut first = 0;
        for (run, &fans) in self.runs.iter().zip(&self.fans_of_run) {
            let of_run = input.records(first, fans, run.len());
            first += fans;
            match records.last_mut() {
                Some(last) if last.end == of_run.start => last.end = of_run.end,
                _ => records.push(of_run),
            }
        }
        records
    }

    /// Writes them; how many there are by class.
    pub(super) fn write<S: FanSlot>(&self, input: &FanInput, memory: S) -> ClassCounts {
        fans::write_runs(input, &self.runs, &self.fans_of_run, memory)
    }
}

impl DrawOrder {
    /// Projects, culls and sorts.
    pub(super) fn find(&mut self, frame: &Frame, is_ordered: bool, profile: &mut Profile) -> Counts {
        if let Some(cubes) = &frame.cubes {
            // They come in order.
            self.screen.clear();
            self.pairs.clear();
            return Counts { drawn: cubes.cubes.len() as u64, ..Counts::default() };
        }
        let start = Instant::now();
        project_while(frame.control, frame.view, frame.vertices, &mut self.screen);
        profile.add("project", start.elapsed(), frame.vertices.len() as u64 * 32);

        let counts = self.cull_and_key(frame, profile);
        let start = Instant::now();
        if is_ordered {
            let _span = tracing::trace_span!("sort").entered();
            self.sort.finish(&mut self.pairs);
        } else {
            self.sort.finish_unsorted(&mut self.pairs);
        }
        // Each pair is read and written twice; once, where the last frame told where it goes.
        profile.add("sort", start.elapsed(), self.pairs.len() as u64 * 32);
        counts
    }

    /// What the fans of the frame are made from.
    pub(super) fn fan_input<'a>(&'a self, frame: &Frame<'a>, planes_for: PlanesFor) -> FanInput<'a> {
        let style = FanStyle { planes_for, faces: frame.faces };
        let input = FanInput::new(frame.view, frame.dataset, frame.vertices, &self.screen, frame.cell_values(), style);
        match frame.cubes {
            Some(cubes) => input.with_cubes(cubes),
            None => input,
        }
    }

    /// Slices of at most `fans` fans, farthest first: nearest first is the order of the keys, blending wants the farthest first.
    pub(super) fn slices<'a>(&'a self, input: &'a FanInput, fans: usize) -> impl Iterator<Item = Slice> + 'a {
        let per_slice = (fans / input.fans_per_cell_max()).max(1);
        let len = input.cubes().map_or(self.pairs.len(), |cubes| cubes.cubes.len());
        let cell = move |place: usize| match input.cubes() {
            Some(_) => place as u32,
            None => index_of(self.pairs[len - 1 - place]),
        };
        (0..len).step_by(per_slice).map(move |first| {
            let end = (first + per_slice).min(len);
            let run = |run: usize| (run..(run + RUN).min(end)).map(cell).collect::<Vec<u32>>();
            let runs: Vec<Vec<u32>> = (first..end).into_par_iter().step_by(RUN).map(run).collect();
            let fans_of_run = runs.par_iter().map(|run| fans::count(input, run)).collect();
            Slice { runs, fans_of_run }
        })
    }

    /// Puts the cells that can show, with their keys, into the parts of the sort.
    fn cull_and_key(&mut self, frame: &Frame, profile: &mut Profile) -> Counts {
        let start = Instant::now();
        let blocks = frame.dataset.blocks.len();
        let blocks_of_part = blocks.div_ceil(PARTS_PER_THREAD * rayon::current_num_threads()).max(1);
        let moved = self.last_view.replace(*frame.view).and_then(|last| moved(&last, frame));
        let parts = self.sort.begin(blocks.div_ceil(blocks_of_part), moved);
        let boxes = PixelBoxes::new(frame.view).within(frame.view.region);
        let screen = &self.screen[..];
        let of_part = |(number, part): (usize, &mut Part)| {
            let (mut visible, mut projected, mut areas, mut keys) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
            let mut counts = Counts::default();
            let first = number * blocks_of_part;
            for block in first..(first + blocks_of_part).min(blocks) {
                if frame.control.is_cancelled() {
                    break;
                }
                let _span = tracing::trace_span!("cull", block).entered();
                let view = frame.dataset.block(block);
                visible.clear();
                projected.clear();
                areas.clear();
                keys.clear();
                let culled =
                    cull::cull(&view, frame.field, screen, (frame.intervals(), frame.cull_table), &mut visible);
                boxes.of_cells(&view, frame.vertices, screen, &visible, &mut projected, &mut areas);
                frame.keys.keys(&view, frame.vertices, &projected, &mut keys);
                counts += Counts {
                    drawn: projected.len() as u64,
                    culled_transparent: culled.transparent,
                    culled_outside: (visible.len() - projected.len()) as u64,
                    invalid: culled.invalid,
                    ..Counts::default()
                };
                let of_cell = |(&cell, &key): (&u32, &u32)| pair(key, (view.base + cell as usize) as u32);
                part.extend(projected.iter().zip(&keys).map(of_cell));
            }
            counts
        };
        let of_parts: Vec<Counts> = parts.par_iter_mut().enumerate().map(of_part).collect();
        let mut counts = Counts::default();
        for part in of_parts {
            counts += part;
        }
        profile.add("cull", start.elapsed(), frame.dataset.cells() as u64 * 32);
        counts
    }
}

/// How far a depth has moved since the last view, at most, as a share of the range of depths; `None` where the two do not compare.
fn moved(last: &View, frame: &Frame) -> Option<f64> {
    if last.is_perspective != frame.view.is_perspective || last.region != frame.view.region {
        return None;
    }
    let corners = frame.dataset.bounds.corners().map(|corner| corner.as_dvec3() / frame.view.world_per_scene);
    let depth = |view: &View, corner: DVec3| {
        if view.is_perspective { corner.distance(view.eye) } else { (corner - view.eye).dot(view.forward) }
    };
    let depths = corners.map(|corner| depth(frame.view, corner));
    let steps = corners.map(|corner| (depth(frame.view, corner) - depth(last, corner)).abs());
    let near = depths.into_iter().fold(f64::INFINITY, f64::min);
    let far = depths.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let moved = steps.into_iter().fold(0.0, f64::max) / (far - near);
    moved.is_finite().then_some(moved)
}
