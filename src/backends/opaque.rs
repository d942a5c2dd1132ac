//! `Opaque`: the geometry of a frame, and the picture of it that the processor draws when it is asked for.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::cpu::geometry::rasterise;
use crate::geometry::{Layer, Primitive};
use crate::image::Image;
use crate::optics::{Model, Output};
use crate::stages::View;

/// Opaque layers of one frame.
#[derive(Debug)]
pub struct Opaque {
    layers: Vec<Layer>,
    picture: OnceLock<OpaquePicture>,
}

/// Opaque geometry as one view shows it: colour, and how near it is.
#[derive(Clone, Debug, PartialEq)]
pub struct OpaquePicture {
    /// Width and height in pixels.
    pub size_px: [u32; 2],
    /// Linear RGB, row by row; black where there is nothing.
    pub color: Vec<[f32; 3]>,
    /// Inverse depth (see [`View`]); negative infinity where there is nothing: a ray goes on.
    pub v: Vec<f32>,
}

/// Bytes of a pixel of an [`OpaquePicture`], and of the depths that were compared to draw it.
const BYTES_PER_PIXEL: u64 = 16 + 4;

impl Opaque {
    /// Layers that are drawn one after the other.
    pub fn new(layers: Vec<Layer>) -> Self {
        Self { layers, picture: OnceLock::new() }
    }

    /// The layers.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// How many primitives of a kind there are.
    pub fn count(&self, primitive: Primitive) -> u64 {
        let of_kind = self.layers.iter().filter(|layer| layer.list.primitive() == primitive);
        of_kind.map(|layer| layer.list.len() as u64).sum()
    }

    /// How far a surface stands back in comparisons, in pixels of its slope: half of what is drawn on it is wide. Nothing where
    /// nothing is drawn on it.
    pub(crate) fn setback_px(&self) -> f32 {
        let strokes = self.layers.iter().filter(|layer| layer.list.primitive() != Primitive::Triangles);
        strokes.map(|layer| 0.5 * layer.width_px + 0.5).fold(0.0, f32::max)
    }

    /// The picture for `view`, drawn at the first call: of one frame, all calls have the same view.
    pub fn picture(&self, view: &View) -> &OpaquePicture {
        self.picture.get_or_init(|| rasterise(self, view))
    }

    /// Bytes of memory that lists and picture take; rows of primitives while it is drawn.
    pub(crate) fn bytes(&self, [width, height]: [u32; 2]) -> u64 {
        let lists: u64 = self.layers.iter().map(|layer| layer.list.bytes() + 4 * layer.list.len() as u64).sum();
        lists + u64::from(width) * u64::from(height) * BYTES_PER_PIXEL
    }
}

impl OpaquePicture {
    /// Inverse depth at which the ray of pixel (x, y) ends; negative infinity where it goes on, and outside the picture.
    #[inline]
    pub(crate) fn limit(&self, x: usize, y: usize) -> f32 {
        let [width, height] = self.size_px.map(|side| side as usize);
        if x < width && y < height { self.v[y * width + x] } else { f32::NEG_INFINITY }
    }

    /// Whether there is something at pixel `i`.
    fn is_covered(&self, i: usize) -> bool {
        self.v[i] > f32::NEG_INFINITY
    }

    /// Puts it behind what `image` shows of the volume in front of it: see
    /// [`GeometryOptions`](crate::geometry::GeometryOptions).
    pub fn put_behind(&self, image: &mut Image, model: Model, output: Output) {
        let pixels = image.pixels.par_iter_mut().enumerate().filter(|&(i, _)| self.is_covered(i));
        pixels.for_each(|(i, pixel)| {
            let ([r, g, b, a], [back_r, back_g, back_b]) = (*pixel, self.color[i]);
            let over = |left: f32| [r + left * back_r, g + left * back_g, b + left * back_b, 1.0];
            *pixel = match (model, output) {
                (Model::EmissionAbsorption, _) => over(1.0 - a),
                (Model::Emission, _) => over(1.0),
                (Model::Mip, _) => over(if a > 0.0 { 0.0 } else { 1.0 }),
                (Model::Absorption, Output::Intensity) => [0.0; 4],
                (Model::Absorption, Output::Depth) => *pixel,
            };
        });
    }
}
