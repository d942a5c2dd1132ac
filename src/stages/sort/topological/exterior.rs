//! `exterior`: which cells follow each other on a ray that crosses the open between them (Cook et al. 2004).
//!
//! In: the exterior faces, the sides of their cells, the view. Out: relations. An A-buffer (Carpenter 1984): the faces that the ray
//! of each pixel centre meets, nearest first; where it leaves a cell and enters another next, the first comes before the second.
//!
//! Bands of 16 rows in parallel, each in squares of 16 pixels. A square in which no face that rays leave lies before one that rays
//! enter has no such place: those of a convex mesh cost a look at the range of depths of their faces. O(faces + pixels met); a band
//! holds 24 bytes twice for each face at each of its pixels.

use std::ops::Range;

use rayon::prelude::*;

use super::graph::{Relation, relation};
use super::outline::{Outline, Seen};
use crate::control::Control;
use crate::stages::footprints::{PixelBox, PixelBoxes};
use crate::stages::sort::adjacency::Adjacency;

/// Side of a square in pixels, and rows of a band.
pub(super) const SQUARE: usize = 16;
/// Faces, and outlines of a band, between two looks at the token.
const FACES: usize = 1 << 12;
const OUTLINES: usize = 1 << 6;
/// A face on more bands than this is looked at by all of them. Chosen: it bounds the lists of all bands.
const MANY_BANDS: usize = 8;
/// Entries and exits closer than this stand in the order in which cells follow each other, and not overlap: what compositors allow
/// too (`ORDER_SLACK`), in inverse depth, relative in perspective, else in scene units.
const SLACK: f64 = 2e-6;
/// Rounding of the depths that squares are judged by, in f32, in the same units.
const DEPTH_SLACK: f32 = 1e-5;

/// Finds relations; keeps its memory between frames.
#[derive(Default)]
pub(super) struct Exterior {
    outlines: Vec<Outline>,
    /// The outlines of each band, and where they begin.
    outlines_from_band: Vec<u32>,
    starts: Vec<usize>,
    /// Outlines on many bands.
    tall: Vec<u32>,
}

impl Exterior {
    /// Writes what the rays of all pixels relate to `relations`, ascending, each once; until the end is asked for.
    pub(super) fn relations(
        &mut self,
        control: &Control,
        seen: Seen,
        adjacency: &Adjacency,
        relations: &mut Vec<Relation>,
    ) {
        let boxes = PixelBoxes::new(seen.view);
        self.outlines.clear();
        let faces = adjacency.exterior().par_chunks(FACES).filter(|_| !control.is_cancelled());
        let outlines = faces.flat_map_iter(|faces| faces.iter().flat_map(|&face| seen.outlines(&boxes, face)));
        self.outlines.par_extend(outlines);
        let bands = (seen.view.size_px[1] as usize).div_ceil(SQUARE);
        self.sort_into_bands(bands);

        relations.clear();
        let of_bands = (0..bands).into_par_iter().map_init(Band::default, |band, number| {
            let own = &self.outlines_from_band[self.starts[number]..self.starts[number + 1]];
            let tall = self.tall.iter().filter(|&&i| self.outlines[i as usize].bands().contains(&number));
            band.relations(control, seen, own.iter().chain(tall).map(|&i| &self.outlines[i as usize]), number)
        });
        relations.par_extend(of_bands.flatten_iter());
        relations.par_sort_unstable();
        relations.dedup();
    }

    /// Count, scan, write.
    fn sort_into_bands(&mut self, bands: usize) {
        let is_tall = |outline: &Outline| outline.bands().len() > MANY_BANDS;
        let Self { outlines, outlines_from_band, starts, tall } = self;
        starts.clear();
        starts.resize(bands + 1, 0);
        tall.clear();
        for (i, outline) in outlines.iter().enumerate() {
            if is_tall(outline) {
                tall.push(i as u32);
            } else {
                starts[outline.bands()].iter_mut().for_each(|count| *count += 1);
            }
        }
        let mut next = 0;
        for start in starts.iter_mut() {
            next += std::mem::replace(start, next);
        }
        outlines_from_band.clear();
        outlines_from_band.resize(next, 0);
        let mut places = starts.clone();
        for (i, outline) in outlines.iter().enumerate().filter(|(_, outline)| !is_tall(outline)) {
            for band in outline.bands() {
                outlines_from_band[places[band]] = i as u32;
                places[band] += 1;
            }
        }
    }
}

/// A ray enters a cell through an exterior face, or leaves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Event {
    /// Inverse depth.
    pub(super) v: f64,
    /// The pixel in its band.
    pub(super) pixel: u32,
    pub(super) cell: u32,
    pub(super) is_exit: bool,
}

const NO_EVENT: Event = Event { v: 0.0, pixel: 0, cell: 0, is_exit: false };

/// What one thread needs for a band.
#[derive(Default)]
struct Band {
    /// Of each square the nearest exit and the farthest entry.
    squares: Vec<[f32; 2]>,
    events: Vec<Event>,
    events_from_pixel: Vec<Event>,
    starts: Vec<u32>,
    ray: Ray,
}

impl Band {
    fn relations<'o>(
        &mut self,
        control: &Control,
        seen: Seen,
        outlines: impl Iterator<Item = &'o Outline> + Clone,
        number: usize,
    ) -> Vec<Relation> {
        let [width, height] = seen.view.size_px.map(|side| side as usize);
        let rows = number * SQUARE..((number + 1) * SQUARE).min(height);
        self.squares.clear();
        self.squares.resize(width.div_ceil(SQUARE), [f32::NEG_INFINITY, f32::INFINITY]);
        for Outline { pixels, v_range: [farthest, nearest], is_exit, .. } in outlines.clone() {
            for [exit, entry] in &mut self.squares[squares_of(*pixels)] {
                if *is_exit {
                    *exit = exit.max(*nearest);
                } else {
                    *entry = entry.min(*farthest);
                }
            }
        }
        let scale = |v: f32| if seen.view.is_perspective { v.abs() } else { 1.0 };
        let may_cross = |[exit, entry]: [f32; 2]| exit >= entry - DEPTH_SLACK * scale(entry);
        let v_near = seen.v_near();

        self.events.clear();
        for (nth, outline) in outlines.enumerate() {
            if nth % OUTLINES == 0 && control.is_cancelled() {
                return Vec::new();
            }
            let squares = squares_of(outline.pixels);
            if !self.squares[squares.clone()].iter().any(|&square| may_cross(square)) {
                continue;
            }
            let triangle = seen.triangle(outline);
            let PixelBox { x0, x1, y0, y1 } = outline.pixels;
            for square in squares.filter(|&square| may_cross(self.squares[square])) {
                let columns = (square * SQUARE).max(x0.into())..((square + 1) * SQUARE).min(x1.into());
                for y in rows.start.max(y0.into())..rows.end.min(y1.into()) {
                    let first = (y - rows.start) * width;
                    triangle.for_each_in_row(y, columns.clone(), |x, v| {
                        if v <= v_near {
                            let (pixel, cell) = ((first + x) as u32, outline.cell);
                            self.events.push(Event { v, pixel, cell, is_exit: outline.is_exit });
                        }
                    });
                }
            }
        }
        self.relate(control, rows.len() * width, seen.view.is_perspective)
    }

    /// Sorts events by pixel (count, scan, write) and relates those of each.
    fn relate(&mut self, control: &Control, pixels: usize, is_perspective: bool) -> Vec<Relation> {
        let Self { events, events_from_pixel, starts, ray, .. } = self;
        let mut relations = Vec::new();
        if events.is_empty() {
            return relations;
        }
        starts.clear();
        starts.resize(pixels + 1, 0);
        for event in events.iter() {
            starts[event.pixel as usize + 1] += 1;
        }
        for pixel in 0..pixels {
            starts[pixel + 1] += starts[pixel];
        }
        events_from_pixel.clear();
        events_from_pixel.resize(events.len(), NO_EVENT);
        for event in events.iter() {
            let place = &mut starts[event.pixel as usize];
            events_from_pixel[*place as usize] = *event;
            *place += 1;
        }
        // Pixel by pixel much is the same; what is still there twice goes whenever the list has doubled.
        let mut limit = 1 << 16;
        for events in events_from_pixel.chunk_by_mut(|a, b| a.pixel == b.pixel) {
            if control.is_cancelled() {
                break;
            }
            ray.relate(events, is_perspective);
            relations.extend(ray.relations.iter().filter(|r| !ray.last.contains(r)));
            std::mem::swap(&mut ray.relations, &mut ray.last);
            if relations.len() > limit {
                relations.sort_unstable();
                relations.dedup();
                limit = limit.max(2 * relations.len());
            }
        }
        relations.sort_unstable();
        relations.dedup();
        relations
    }
}

fn squares_of(pixels: PixelBox) -> Range<usize> {
    pixels.x0 as usize / SQUARE..(pixels.x1 as usize).div_ceil(SQUARE)
}

/// What a ray relates.
#[derive(Default)]
pub(super) struct Ray {
    pub(super) relations: Vec<Relation>,
    /// What the ray before it did.
    last: Vec<Relation>,
    entries: Vec<Event>,
    exits: Vec<Event>,
    /// The cells that were left since the last was entered.
    left: Vec<u32>,
}

impl Ray {
    /// Relates the cells that are left to those entered next.
    ///
    /// Events that are as near as cells of two parts which touch (or overlap by rounding) follow each other as they do on a ray
    /// through disjoint cells: in a cell what comes next is its exit, in the open it is an entry.
    pub(super) fn relate(&mut self, events: &mut [Event], is_perspective: bool) {
        events.sort_unstable_by(|a, b| b.v.total_cmp(&a.v).then(a.cell.cmp(&b.cell)));
        self.relations.clear();
        self.left.clear();
        let exits = events.iter().filter(|event| event.is_exit).count();
        // Every cell entered is left: more are left than entered if the ray begins in one.
        let mut is_inside = 2 * exits > events.len();
        let mut last_was_exit = true;
        let mut rest = &*events;
        while let Some(first) = rest.first() {
            let reach = first.v - SLACK * if is_perspective { first.v } else { 1.0 };
            let (group, after) = rest.split_at(rest.iter().take_while(|event| event.v >= reach).count());
            rest = after;
            self.entries.clear();
            self.exits.clear();
            // Taken from the ends: the farthest first.
            for event in group.iter().rev() {
                if event.is_exit { self.exits.push(*event) } else { self.entries.push(*event) }
            }
            for _ in group {
                let (wanted, other) =
                    if is_inside { (&mut self.exits, &mut self.entries) } else { (&mut self.entries, &mut self.exits) };
                let Some(Event { cell, is_exit, .. }) = wanted.pop().or_else(|| other.pop()) else { break };
                is_inside = !is_exit;
                if is_exit {
                    if !last_was_exit {
                        self.left.clear();
                    }
                    self.left.push(cell);
                } else {
                    // Cells that overlap are entered before the last is left: each comes after what was left before.
                    let since = if last_was_exit { 0 } else { self.left.len().saturating_sub(1) };
                    let left = self.left[since..].iter().filter(|&&nearer| nearer != cell);
                    self.relations.extend(left.map(|&nearer| relation(nearer, cell)));
                }
                last_was_exit = is_exit;
            }
        }
    }
}
