//! Triangle fans on the CPU: the papers' method (`--cpu-method fans`), and the tile compositor's twin in tests.
//!
//! In: a [`Frame`]. Out: the same picture, by cull, keys, one global radix sort, fans in slices of the draw order, and a
//! scan-line rasteriser in f64 that blends back to front.

use std::time::Instant;

use glam::DVec2;
use rayon::prelude::*;

use crate::backends::{Counts, Frame};
use crate::image::Image;
use crate::optics::{CellSpan, LANES, Optics, Segments};
use crate::profile::Profile;
use crate::stages::classify::ProjectionClass;
use crate::stages::cull;
use crate::stages::fans::{self, Fan, FanCounts, FanInput, FanSlot, FanVertex};
use crate::stages::footprints::PixelBoxes;
use crate::stages::project::project;
use crate::stages::sort::KeyMaker;
use crate::stages::sort::radix::{Pair, index_of, pair, sort_coherent};
use crate::stages::{ScreenVertex, View};

/// Cells whose fans are in memory at once.
const SLICE: usize = 1 << 16;
/// Cells that one thread makes fans of at a time.
const RUN: usize = 1 << 12;
/// Rows that one thread rasterises at a time.
const BAND: usize = 16;

/// Draws triangle fans; keeps its memory, and the last draw order, between frames.
#[derive(Default)]
pub struct FanCompositor {
    screen: Vec<ScreenVertex>,
    pairs: Vec<Pair>,
    scratch: Vec<Pair>,
    fans: Vec<Fan>,
    vertices: Vec<FanVertex>,
}

impl FanCompositor {
    /// Draws one frame.
    pub fn draw<O: Optics>(&mut self, frame: &Frame, optics: &O, profile: &mut Profile) -> (Image, Counts) {
        let start = Instant::now();
        project(frame.view, frame.vertices, &mut self.screen);
        profile.add("project", start.elapsed(), frame.vertices.len() as u64 * 32);

        let mut counts = self.cull_and_key::<O>(frame, profile);
        let start = Instant::now();
        if O::IS_ORDERED {
            sort_coherent(&mut self.pairs, &mut self.scratch);
        }
        profile.add("sort", start.elapsed(), self.pairs.len() as u64 * 64);

        let [width, height] = frame.view.size_px;
        let mut image = Image::filled(width, height, O::CLEAR);
        let input = FanInput::new(frame.view, frame.dataset, frame.vertices, frame.cell_values());
        // Nearest first is the order of the keys; blending wants the farthest first.
        for slice in self.pairs.rchunks(SLICE) {
            let start = Instant::now();
            let by_class = make_fans(&input, slice, &mut self.fans, &mut self.vertices);
            for (sum, n) in counts.by_class.iter_mut().zip(by_class) {
                *sum += n;
            }
            profile.add("fans", start.elapsed(), self.vertices.len() as u64 * size_of::<FanVertex>() as u64);

            let start = Instant::now();
            image.pixels.par_chunks_mut(width as usize * BAND).enumerate().for_each(|(band, pixels)| {
                let mut rows = Rows { first: band * BAND, width: width as usize, pixels };
                for fan in &self.fans {
                    rows.draw_fan(frame, optics, fan, &self.vertices);
                }
            });
            profile.add("composite", start.elapsed(), self.vertices.len() as u64 * 24);
        }
        image.pixels.par_iter_mut().for_each(|pixel| *pixel = optics.pixel(*pixel));
        counts.triangles =
            ProjectionClass::ALL.iter().map(|&class| counts.by_class[class as usize] * class.triangles() as u64).sum();
        (image, counts)
    }

    /// Fills `pairs` with the cells that can show: in the last frame's order if they are to be sorted, else in memory order.
    fn cull_and_key<O: Optics>(&mut self, frame: &Frame, profile: &mut Profile) -> Counts {
        let start = Instant::now();
        let boxes = PixelBoxes::new(frame.view);
        let keys = KeyMaker::new(frame.sort_key, frame.view);
        let screen = &self.screen[..];
        let per_block: Vec<(Vec<Pair>, Counts)> = (0..frame.dataset.blocks.len())
            .into_par_iter()
            .map(|block| {
                let view = frame.dataset.block(block);
                let (mut visible, mut projected, mut areas) = (Vec::new(), Vec::new(), Vec::new());
                let culled = cull::cull(&view, frame.field, screen, (frame.pieces, frame.cull_table), &mut visible);
                boxes.of_cells(&view, frame.vertices, screen, &visible, &mut projected, &mut areas);
                let mut key_from_projected = Vec::with_capacity(projected.len());
                keys.keys(&view, frame.vertices, &projected, &mut key_from_projected);
                let counts = Counts {
                    drawn: projected.len() as u64,
                    culled_transparent: culled.transparent,
                    culled_outside: (visible.len() - projected.len()) as u64,
                    invalid: culled.invalid,
                    ..Counts::default()
                };
                let of_cell = |(&cell, &key): (&u32, &u32)| pair(key, (view.base + cell as usize) as u32);
                (projected.iter().zip(&key_from_projected).map(of_cell).collect(), counts)
            })
            .collect();
        let mut counts = Counts::default();
        for (_, block) in &per_block {
            counts += *block;
        }
        let pairs = per_block.iter().flat_map(|(pairs, _)| pairs);
        if O::IS_ORDERED {
            self.take_up_last_order(pairs, frame.dataset.tets.len());
        } else {
            self.pairs.clear();
            self.pairs.extend(pairs);
        }
        profile.add("cull", start.elapsed(), frame.dataset.tets.len() as u64 * 32);
        counts
    }

    /// Puts this frame's pairs where the last frame's stood; cells that were not drawn then come last.
    fn take_up_last_order<'a>(&mut self, pairs: impl Iterator<Item = &'a Pair>, cells: usize) {
        const ABSENT: u64 = u64::MAX;
        self.scratch.clear();
        self.scratch.resize(cells, ABSENT);
        for &new in pairs {
            self.scratch[index_of(new) as usize] = new;
        }
        let mut order = std::mem::take(&mut self.pairs);
        order.retain_mut(|pair| {
            let Some(new) = self.scratch.get_mut(index_of(*pair) as usize) else { return false };
            *pair = std::mem::replace(new, ABSENT);
            *pair != ABSENT
        });
        order.extend(self.scratch.iter().filter(|&&new| new != ABSENT));
        self.pairs = order;
    }
}

/// Makes the fans of `slice`, farthest first, in parallel runs.
fn make_fans(input: &FanInput, slice: &[Pair], fans: &mut Vec<Fan>, vertices: &mut Vec<FanVertex>) -> [u64; 5] {
    let cells = |run: &'_ [Pair]| run.iter().rev().map(|&pair| index_of(pair)).collect::<Vec<u32>>();
    let runs: Vec<Vec<u32>> = slice.par_rchunks(RUN).map(cells).collect();
    let counts: Vec<FanCounts> = runs.par_iter().map(|run| fans::count(input, run.iter().copied())).collect();
    fans.clear();
    fans.resize(counts.iter().map(|count| count.fans).sum(), Fan::default());
    vertices.clear();
    vertices.resize(counts.iter().map(|count| count.vertices).sum(), FanVertex::default());
    // Prefix sum: each run is lent its part of the memory.
    let (mut fans, mut vertices, mut first_vertex) = (&mut fans[..], &mut vertices[..], 0);
    let mut slots = Vec::with_capacity(runs.len());
    for count in &counts {
        let (these, rest) = std::mem::take(&mut fans).split_at_mut(count.fans);
        let (own, others) = std::mem::take(&mut vertices).split_at_mut(count.vertices);
        (fans, vertices) = (rest, others);
        slots.push(FanSlot { fans: these, vertices: own, first_vertex });
        first_vertex += count.vertices as u32;
    }
    let by_run = runs.into_par_iter().zip(slots).map(|(run, slot)| fans::write(input, run, slot));
    by_run.reduce(|| [0; 5], |a, b| std::array::from_fn(|class| a[class] + b[class]))
}

/// Some rows of the picture; pixels hold contributions.
struct Rows<'a> {
    first: usize,
    width: usize,
    pixels: &'a mut [[f32; 4]],
}

impl Rows<'_> {
    fn draw_fan<O: Optics>(&mut self, frame: &Frame, optics: &O, fan: &Fan, vertices: &[FanVertex]) {
        let class = ProjectionClass::ALL[fan.class as usize];
        let ring = &vertices[fan.first_vertex as usize..][..class.fan_vertices()];
        let rows = ring.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), vertex| {
            (low.min(vertex.position_px[1]), high.max(vertex.position_px[1]))
        });
        if rows.1 < self.first as f32 || rows.0 > (self.first + self.pixels.len() / self.width) as f32 {
            return;
        }
        let is_perspective = frame.view.is_perspective;
        let scalars = ring.iter().flat_map(|vertex| [vertex.front, vertex.back]);
        let (low, high) = scalars
            .map(|[v, q]| if is_perspective { q / v } else { q })
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), s| (low.min(s), high.max(s)));
        let span = CellSpan::new(frame.pieces, low, high);
        for two in ring[1..].windows(2) {
            self.draw_triangle(frame.view, optics, (span, [low, high]), [&ring[0], &two[0], &two[1]]);
        }
    }

    /// Rasterises one triangle by its edge functions, in f64: exact for vertices in f32 within the picture's precision.
    fn draw_triangle<O: Optics>(
        &mut self,
        view: &View,
        optics: &O,
        cell: (CellSpan, [f32; 2]),
        triangle: [&FanVertex; 3],
    ) {
        let p = triangle.map(|vertex| DVec2::from_array(vertex.position_px.map(f64::from)));
        let area = (p[1] - p[0]).perp_dot(p[2] - p[0]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let (order, area) = if area > 0.0 { ([0, 1, 2], area) } else { ([0, 2, 1], -area) };
        let (p, triangle) = (order.map(|i| p[i]), order.map(|i| triangle[i]));
        let low = p[0].min(p[1]).min(p[2]);
        let high = p[0].max(p[1]).max(p[2]);
        let last_row = self.first + self.pixels.len() / self.width;
        let rows = low.y.ceil().max(self.first as f64) as usize..((high.y.floor() + 1.0) as usize).min(last_row);
        let columns = low.x.ceil().max(0.0) as usize..((high.x.floor() + 1.0).max(0.0) as usize).min(self.width);
        let mut lanes = LaneBuffer::default();
        for y in rows {
            for x in columns.clone() {
                let at = DVec2::new(x as f64, y as f64);
                // Barycentric weights; a pixel centre on an edge belongs to the triangle below or to the right of it.
                let mut weights = [0.0; 3];
                let is_inside = (0..3).all(|i| {
                    let (a, b) = (p[(i + 1) % 3], p[(i + 2) % 3]);
                    let (edge, weight) = (b - a, (b - a).perp_dot(at - a));
                    weights[i] = weight / area;
                    weight > 0.0 || (weight == 0.0 && (edge.y < 0.0 || (edge.y == 0.0 && edge.x > 0.0)))
                });
                if is_inside {
                    let mix = |of: fn(&FanVertex) -> f32| -> f64 {
                        (0..3).map(|i| weights[i] * f64::from(of(triangle[i]))).sum()
                    };
                    let front = [mix(|vertex| vertex.front[0]), mix(|vertex| vertex.front[1])];
                    let back = [mix(|vertex| vertex.back[0]), mix(|vertex| vertex.back[1])];
                    let pixel = (y - self.first) * self.width + x;
                    if lanes.push(view, pixel, [x, y], front, back, cell.1) {
                        lanes.flush(optics, cell.0, self.pixels);
                    }
                }
            }
        }
        lanes.flush(optics, cell.0, self.pixels);
    }
}

/// Up to sixteen fragments of one triangle, each of another pixel.
struct LaneBuffer {
    len: usize,
    pixels: [usize; LANES],
    segments: Segments,
}

impl Default for LaneBuffer {
    fn default() -> Self {
        let segments = Segments { enter: [0.0; LANES], leave: [0.0; LANES], length_world: [0.0; LANES] };
        Self { len: 0, pixels: [0; LANES], segments }
    }
}

impl LaneBuffer {
    /// Adds a fragment; true when the buffer is full.
    fn push(
        &mut self,
        view: &View,
        pixel: usize,
        [x, y]: [usize; 2],
        front: [f64; 2],
        back: [f64; 2],
        [s_min, s_max]: [f32; 2],
    ) -> bool {
        let depth_and_value = |[v, q]: [f64; 2]| if view.is_perspective { (1.0 / v, q / v) } else { (-v, q) };
        let ((w0, s0), (w1, s1)) = (depth_and_value(front), depth_and_value(back));
        let clip = |w: f64| w.clamp(f64::from(view.near), f64::from(view.far));
        let (clipped0, clipped1) = (clip(w0), clip(w1));
        // Where a plane cuts the segment, the value there: linear along the ray.
        let value = |w: f64| if w1 > w0 { s0 + (s1 - s0) * (w - w0) / (w1 - w0) } else { s0 };
        let length = (clipped1 - clipped0).max(0.0) * view.length_world_per_depth(x as f64, y as f64);
        self.pixels[self.len] = pixel;
        self.segments.enter[self.len] = (value(clipped0) as f32).clamp(s_min, s_max);
        self.segments.leave[self.len] = (value(clipped1) as f32).clamp(s_min, s_max);
        self.segments.length_world[self.len] = length as f32;
        self.len += 1;
        self.len == LANES
    }

    fn flush<O: Optics>(&mut self, optics: &O, span: CellSpan, pixels: &mut [[f32; 4]]) {
        if self.len == 0 {
            return;
        }
        self.segments.length_world[self.len..].fill(0.0);
        let mut contributions = [[[0.0; LANES]; 4]];
        optics.contributions(span, &[self.segments], &mut contributions);
        let [contribution] = contributions;
        for (i, &pixel) in self.pixels[..self.len].iter().enumerate() {
            let front = std::array::from_fn(|c| contribution[c][i]);
            pixels[pixel] = O::over(front, pixels[pixel]);
        }
        self.len = 0;
    }
}
