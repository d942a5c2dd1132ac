//! Triangle fans on the CPU: the papers' method (`--cpu-method fans`), and the tile compositor's twin in tests.
//!
//! In: a [`Frame`]. Out: the same picture, by cull, keys, one global radix sort, fans in slices of the draw order, and a
//! scan-line rasteriser in f64 that blends back to front.
//!
//! Sixteen fragments of a triangle are integrated at once, and their form of the integral is that of the thickest: which are
//! together is decided in squares of the whole picture, so that a region has its bits. What lies beside it is not kept.

use std::ops::Range;
use std::time::Instant;

use glam::DVec2;
use rayon::prelude::*;

use crate::backends::draw_order::DrawOrder;
use crate::backends::{Counts, Frame};
use crate::camera::Region;
use crate::image::Image;
use crate::optics::lanes::two_sum;
use crate::optics::{CellSpan, LANES, Optics, Segments};
use crate::profile::Profile;
use crate::stages::View;
use crate::stages::fans::{CaseFan, Fan, HexFan, PlanesFor};

/// Fans that are in memory at once.
const SLICE: usize = 1 << 16;
/// Rows that one thread rasterises at a time, and columns that it does.
const SQUARE: usize = 16;

/// Draws triangle fans; keeps its memory, and the last draw order, between frames.
#[derive(Default)]
pub struct FanCompositor {
    order: DrawOrder,
    fans: Vec<Fan>,
}

impl FanCompositor {
    /// Draws one frame.
    pub fn draw<O: Optics>(&mut self, frame: &Frame, optics: &O, profile: &mut Profile) -> (Image, Counts) {
        let mut counts = self.order.find(frame, O::IS_ORDERED, profile);
        let region = frame.view.region;
        let [width, height] = region.size_px();
        let mut image = Image::filled(width, height, O::CLEAR);
        // What f32 loses of sums.
        let mut lost = vec![[0.0; 4]; if O::IS_SUM { image.pixels.len() } else { 0 }];
        let input = self.order.fan_input(frame, PlanesFor::NoCells);
        let fans_per_record = input.contents().fans_per_record();
        for slice in self.order.slices(&input, SLICE) {
            if frame.control.is_cancelled() {
                break;
            }
            let start = Instant::now();
            self.fans.clear();
            self.fans.resize(slice.fans(), Fan::default());
            counts.add_classes(slice.write(&input, &mut self.fans[..]));
            profile.add("fans", start.elapsed(), (self.fans.len() * size_of::<Fan>()) as u64);

            let start = Instant::now();
            let draw = |number: usize, pixels: &mut [[f32; 4]], lost: &mut [[f32; 4]]| {
                let _span = tracing::trace_span!("composite", band = number).entered();
                let mut band = Band::new(frame.view, number, pixels, lost);
                for record in self.fans.chunks(fans_per_record) {
                    if let Some(cell) = HexFan::of_record(record) {
                        band.draw_hexahedron(frame, optics, &cell);
                    } else if let Some(cell) = CaseFan::of_record(record) {
                        band.draw_case(frame, optics, &cell);
                    } else {
                        band.draw_fan(frame, optics, &record[0]);
                    }
                }
            };
            let bands = bands_of(region, &mut image.pixels).into_par_iter();
            if O::IS_SUM {
                let lost = bands_of(region, &mut lost);
                bands.zip(lost).for_each(|((number, pixels), (_, lost))| draw(number, pixels, lost));
            } else {
                bands.for_each(|(number, pixels)| draw(number, pixels, &mut []));
            }
            profile.add("composite", start.elapsed(), (self.fans.len() * size_of::<Fan>()) as u64);
        }
        let kept = image.pixels.par_iter_mut().zip(&lost);
        kept.for_each(|(sum, lost)| *sum = std::array::from_fn(|c| sum[c] + lost[c]));
        image.pixels.par_iter_mut().for_each(|pixel| *pixel = optics.pixel(*pixel));
        (image, counts)
    }
}

/// The pixels of each band of rows that `region` touches, with its number in the whole picture.
fn bands_of(region: Region, pixels: &mut [[f32; 4]]) -> Vec<(usize, &mut [[f32; 4]])> {
    let [width, _] = region.size_px();
    let (mut bands, mut rest) = (Vec::new(), pixels);
    for number in region.y0 as usize / SQUARE..(region.y1 as usize).div_ceil(SQUARE) {
        let rows = (number * SQUARE).max(region.y0 as usize)..((number + 1) * SQUARE).min(region.y1 as usize);
        let (pixels, below) = rest.split_at_mut(rows.len() * width as usize);
        bands.push((number, pixels));
        rest = below;
    }
    bands
}

/// A band of rows; pixels hold contributions.
struct Band<'a> {
    /// What is gone through: squares that the region touches, as far as the picture reaches.
    columns: Range<usize>,
    rows: Range<usize>,
    region: Region,
    /// Those of the region in these rows.
    pixels: &'a mut [[f32; 4]],
    /// What rounding took from them, where contributions add up.
    lost: &'a mut [[f32; 4]],
}

impl<'a> Band<'a> {
    fn new(view: &View, number: usize, pixels: &'a mut [[f32; 4]], lost: &'a mut [[f32; 4]]) -> Self {
        let (region, [width, height]) = (view.region, view.size_px.map(|side| side as usize));
        let columns = region.x0 as usize / SQUARE * SQUARE..(region.x1 as usize).next_multiple_of(SQUARE).min(width);
        let rows = number * SQUARE..((number + 1) * SQUARE).min(height);
        Self { columns, rows, region, pixels, lost }
    }

    /// Columns and rows of a box, square by square.
    fn squares(&self, columns: Range<usize>, rows: Range<usize>) -> impl Iterator<Item = [Range<usize>; 2]> + use<> {
        let clip = |range: Range<usize>, to: &Range<usize>| range.start.max(to.start)..range.end.min(to.end);
        let (columns, rows) = (clip(columns, &self.columns), clip(rows, &self.rows));
        (columns.start / SQUARE..columns.end.div_ceil(SQUARE))
            .map(move |square| [clip(columns.clone(), &(square * SQUARE..(square + 1) * SQUARE)), rows.clone()])
    }

    /// Where a pixel of the picture is among those of the region, if it is.
    fn place(&self, [x, y]: [usize; 2]) -> Option<usize> {
        let Region { x0, y0, x1, y1 } = self.region;
        let (columns, rows) = (x0 as usize..x1 as usize, self.rows.start.max(y0 as usize)..y1 as usize);
        let is_inside = columns.contains(&x) && rows.contains(&y);
        is_inside.then(|| (y - rows.start) * columns.len() + x - columns.start)
    }

    /// Puts a contribution in front of a pixel.
    fn add<O: Optics>(&mut self, pixel: usize, front: [f32; 4]) {
        if !O::IS_SUM {
            self.pixels[pixel] = O::over(front, self.pixels[pixel]);
            return;
        }
        for ((sum, lost), front) in self.pixels[pixel].iter_mut().zip(&mut self.lost[pixel]).zip(front) {
            let (rounded, error) = two_sum(*sum, front);
            *sum = rounded;
            *lost += error;
        }
    }

    fn draw_fan<O: Optics>(&mut self, frame: &Frame, optics: &O, fan: &Fan) {
        let rows = (0..5).fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), i| {
            let ([_, y], ..) = fan.vertex(i);
            (low.min(y), high.max(y))
        });
        if rows.1 < self.rows.start as f32 || rows.0 > self.rows.end as f32 {
            return;
        }
        let [low, high] = fan.s_range;
        let span = CellSpan::new(frame.intervals(), low, high);
        for triangle in Fan::TRIANGLES {
            self.draw_triangle(frame, optics, (span, fan.s_range), triangle.map(|i| fan.vertex(i)));
        }
    }

    fn draw_case<O: Optics>(&mut self, frame: &Frame, optics: &O, cell: &CaseFan) {
        let [low, high] = cell.s_range;
        let span = CellSpan::new(frame.intervals(), low, high);
        for triangle in cell.triangles() {
            let triangle = triangle.map(|vertex| (vertex.position_px, vertex.front, vertex.back));
            self.draw_triangle(frame, optics, (span, cell.s_range), triangle);
        }
    }

    /// Draws the parts of all rays through the box of a hexahedron.
    fn draw_hexahedron<O: Optics>(&mut self, frame: &Frame, optics: &O, cell: &HexFan) {
        let [columns, rows] = cell.box_px.map(|ends| (ends & 0xffff) as usize..(ends >> 16) as usize);
        let [s_max, s_min] = cell.s_range;
        let span = CellSpan::new(frame.intervals(), s_min, s_max);
        for [of_square, rows_of_square] in self.squares(columns.clone(), rows.clone()) {
            let mut lanes = LaneBuffer::default();
            for y in rows_of_square {
                for x in of_square.clone() {
                    let at = [(x - columns.start) as f64, (y - rows.start) as f64];
                    // Farthest first, each over what is there.
                    for part in cell.parts(frame.view, at).into_iter().rev() {
                        if lanes.push(frame, self.place([x, y]), [x, y], part, [s_min, s_max]) {
                            lanes.flush(optics, span, self);
                        }
                    }
                }
            }
            lanes.flush(optics, span, self);
        }
    }

    /// Rasterises one triangle by its edge functions, in f64: exact for vertices in f32 within the picture's precision.
    fn draw_triangle<O: Optics>(
        &mut self,
        frame: &Frame,
        optics: &O,
        cell: (CellSpan, [f32; 2]),
        triangle: [([f32; 2], [f32; 2], [f32; 2]); 3],
    ) {
        let p = triangle.map(|(position_px, ..)| DVec2::from_array(position_px.map(f64::from)));
        let area = (p[1] - p[0]).perp_dot(p[2] - p[0]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let (order, area) = if area > 0.0 { ([0, 1, 2], area) } else { ([0, 2, 1], -area) };
        let (p, triangle) = (order.map(|i| p[i]), order.map(|i| triangle[i]));
        let low = p[0].min(p[1]).min(p[2]);
        let high = p[0].max(p[1]).max(p[2]);
        let rows = low.y.ceil().max(0.0) as usize..(high.y.floor() + 1.0).max(0.0) as usize;
        let columns = low.x.ceil().max(0.0) as usize..(high.x.floor() + 1.0).max(0.0) as usize;
        for [columns, rows] in self.squares(columns, rows) {
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
                    if !is_inside {
                        continue;
                    }
                    let ends = triangle.map(|(_, front, back)| [front, back]);
                    let mix =
                        |end: usize, k: usize| -> f64 { (0..3).map(|i| weights[i] * f64::from(ends[i][end][k])).sum() };
                    let depth_and_value =
                        |[v, q]: [f64; 2]| if frame.view.is_perspective { [1.0 / v, q / v] } else { [-v, q] };
                    let part = [0, 1].map(|end| depth_and_value([mix(end, 0), mix(end, 1)]));
                    if lanes.push(frame, self.place([x, y]), [x, y], part, cell.1) {
                        lanes.flush(optics, cell.0, self);
                    }
                }
            }
            lanes.flush(optics, cell.0, self);
        }
    }
}

/// Up to sixteen fragments of one cell; of one pixel the farthest first.
struct LaneBuffer {
    len: usize,
    /// Where each goes, if it is in the region.
    places: [Option<usize>; LANES],
    segments: Segments,
}

impl Default for LaneBuffer {
    fn default() -> Self {
        let segments = Segments { enter: [0.0; LANES], leave: [0.0; LANES], length_world: [0.0; LANES] };
        Self { len: 0, places: [None; LANES], segments }
    }
}

impl LaneBuffer {
    /// Adds a fragment, a segment between two depths with their values; true when the buffer is full.
    fn push(
        &mut self,
        frame: &Frame,
        place: Option<usize>,
        [x, y]: [usize; 2],
        [[w0, s0], [w1, s1]]: [[f64; 2]; 2],
        [s_min, s_max]: [f32; 2],
    ) -> bool {
        let view = frame.view;
        let far = match frame.limits().map(|picture| f64::from(picture.limit(x, y))) {
            Some(limit) if limit > f64::NEG_INFINITY => {
                f64::from(view.far).min(if view.is_perspective { 1.0 / limit } else { -limit })
            }
            _ => f64::from(view.far),
        };
        let clip = |w: f64| w.clamp(far.min(view.near.into()), far);
        let (clipped0, clipped1) = (clip(w0), clip(w1));
        // Where a plane cuts the segment, the value there: linear along the ray.
        let value = |w: f64| if w1 > w0 { s0 + (s1 - s0) * (w - w0) / (w1 - w0) } else { s0 };
        let length = (clipped1 - clipped0).max(0.0) * view.length_world_per_depth(x as f64, y as f64);
        self.places[self.len] = place;
        self.segments.enter[self.len] = (value(clipped0) as f32).clamp(s_min, s_max);
        self.segments.leave[self.len] = (value(clipped1) as f32).clamp(s_min, s_max);
        self.segments.length_world[self.len] = length as f32;
        self.len += 1;
        self.len == LANES
    }

    fn flush<O: Optics>(&mut self, optics: &O, span: CellSpan, band: &mut Band) {
        if self.len == 0 {
            return;
        }
        self.segments.length_world[self.len..].fill(0.0);
        let mut contributions = [[[0.0; LANES]; 4]];
        let longest = self.segments.length_world.iter().copied().fold(0.0, f32::max);
        optics.contributions(span.within(longest), &[self.segments], &mut contributions);
        let [contribution] = contributions;
        for (i, place) in self.places[..self.len].iter().enumerate() {
            let front = std::array::from_fn(|c| contribution[c][i]);
            if let Some(pixel) = *place {
                band.add::<O>(pixel, front);
            }
        }
        self.len = 0;
    }
}
