//! A rasteriser of opaque geometry, to colour and depth: triangles, lines, points.
//!
//! In: an [`Opaque`], a view. Out: an [`OpaquePicture`], begun with the external picture where there is one. The same conventions as those of a GPU's (`shaders/geometry.wgsl`): pixels are
//! sampled at their centres; a triangle's depth is that of its plane; a line covers the centres within half its width, a point those in
//! its square. Bands of rows in parallel, each through all primitives in their order, so that the picture does not depend on threads.
//! To add a primitive: a file that draws one into a [`Band`], its line in [`Drawer::draw`], its shaders.

mod looks;
mod project;
mod strokes;
mod triangles;

#[cfg(feature = "gpu")]
pub(in crate::backends) use strokes::LINE_SLACK_PX;

use std::ops::Range;

use rayon::prelude::*;

use self::looks::CornerLooks;
use self::project::Projector;
use crate::backends::opaque::{Opaque, OpaquePicture, area_of};
use crate::geometry::{Layer, Primitive};
use crate::stages::View;

/// Rows that one thread draws at a time.
const BAND: usize = 32;

/// What is taken off the inverse depth of a surface that something is drawn on, as a share of it (parallel rays: in scene units): more
/// than both are rounded by.
pub(crate) const SETBACK: f32 = 1e-5;

/// Draws the layers.
pub(in crate::backends) fn rasterise(opaque: &Opaque, view: &View) -> OpaquePicture {
    let area = area_of(view);
    let [width, height] = area.size_px().map(|side| side as usize);
    let columns = area.x0 as usize..area.x1 as usize;
    let projector = Projector::new(view);
    let drawers: Vec<Drawer> = opaque
        .layers()
        .iter()
        .map(|layer| {
            let mut drawer =
                Drawer { layer, projector: &projector, setback_px: opaque.setback_px().into(), rows: Vec::new() };
            drawer.rows = (0..layer.list.len()).into_par_iter().map(|i| drawer.rows_of(i)).collect();
            drawer
        })
        .collect();
    let mut picture =
        OpaquePicture { area, color: vec![[0.0; 4]; width * height], v: vec![f32::NEG_INFINITY; width * height] };
    if let Some(external) = opaque.external() {
        picture.copy(external);
    }
    let bands = picture.color.par_chunks_mut(width * BAND).zip(picture.v.par_chunks_mut(width * BAND));
    bands.enumerate().for_each(|(band, (color, v))| {
        let _span = tracing::trace_span!("geometry", band).entered();
        let compared = v.to_vec();
        let first = area.y0 as usize + band * BAND;
        let mut band = Band { rows: first..first + v.len() / width, columns: columns.clone(), color, v, compared };
        for drawer in &drawers {
            drawer.draw(&mut band);
        }
    });
    picture
}

/// Some rows of the picture, all columns that are drawn.
struct Band<'a> {
    rows: Range<usize>,
    columns: Range<usize>,
    color: &'a mut [[f32; 4]],
    v: &'a mut [f32],
    /// What depths are compared by: those of surfaces are set back a little.
    compared: Vec<f32>,
}

impl Band<'_> {
    /// Draws a fragment where it is as near as what is there.
    #[inline]
    fn put(&mut self, [x, y]: [usize; 2], v: f32, compared: f32, color: impl FnOnce() -> [f32; 3]) {
        let pixel = (y - self.rows.start) * self.columns.len() + x - self.columns.start;
        if compared >= self.compared[pixel] {
            let [r, g, b] = color();
            (self.compared[pixel], self.v[pixel], self.color[pixel]) = (compared, v, [r, g, b, 1.0]);
        }
    }

    /// The pixels of the band whose centres lie in a box, ends included: columns and rows.
    fn pixels_in(&self, [low_x, low_y]: [f64; 2], [high_x, high_y]: [f64; 2]) -> [Range<usize>; 2] {
        let range = |low: f64, high: f64, all: &Range<usize>| {
            let from = low.ceil().clamp(all.start as f64, all.end as f64) as usize;
            from..((high.floor() + 1.0).clamp(from as f64, all.end as f64) as usize)
        };
        [range(low_x, high_x, &self.columns), range(low_y, high_y, &self.rows)]
    }
}

/// Draws the primitives of a layer.
struct Drawer<'a> {
    layer: &'a Layer,
    projector: &'a Projector,
    setback_px: f64,
    /// Of each primitive the first row that it may cover and the row after the last.
    rows: Vec<[u16; 2]>,
}

impl Drawer<'_> {
    fn corners(&self, i: usize) -> &[[f32; 3]] {
        let corners = self.layer.list.primitive().corners();
        &self.layer.list.corners()[i * corners..][..corners]
    }

    fn rows_of(&self, i: usize) -> [u16; 2] {
        let height = f64::from(self.projector.size_px[1]);
        let Some([low, high]) = (match *self.corners(i) {
            [a, b, c] => triangles::rows(self.projector, [a, b, c]),
            [a, b] => strokes::rows_of_line(self, [a, b]),
            [a] => strokes::rows_of_point(self, a),
            _ => None,
        }) else {
            return [0, 0];
        };
        [low.ceil().clamp(0.0, height) as u16, (high.floor() + 1.0).clamp(0.0, height) as u16]
    }

    fn draw(&self, band: &mut Band) {
        for (i, &[first, end]) in self.rows.iter().enumerate() {
            if usize::from(first) >= band.rows.end || usize::from(end) <= band.rows.start {
                continue;
            }
            match (self.layer.list.primitive(), self.corners(i)) {
                (Primitive::Triangles, &[a, b, c]) => {
                    let looks = CornerLooks::of(&self.layer.list, i);
                    triangles::draw(self, [a, b, c], looks.as_ref(), band);
                }
                (Primitive::Lines, &[a, b]) => strokes::draw_line(self, [a, b], band),
                (Primitive::Points, &[a]) => strokes::draw_point(self, a, band),
                _ => {}
            }
        }
    }
}
