//! `Opaque`: the geometry of a frame, and the picture of it that the processor draws when it is asked for.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::cpu::geometry::rasterise;
use super::tiles::TileGrid;
use crate::camera::Region;
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
    /// The part of the picture that it covers: all pixels of the tiles that the view's region touches.
    pub area: Region,
    /// Linear RGB, row by row; black where there is nothing.
    pub color: Vec<[f32; 3]>,
    /// Inverse depth (see [`View`]); negative infinity where there is nothing: a ray goes on.
    pub v: Vec<f32>,
}

/// The part of the picture that `view` needs: of a tile all of it, so that its pixels have the bits that they have in the whole.
pub(super) fn area_of(view: &View) -> Region {
    TileGrid::new(view).pixels(view.size_px)
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

    /// Bytes of memory that lists and picture of `view` take; rows of primitives while it is drawn.
    pub(crate) fn bytes(&self, view: &View) -> u64 {
        let lists: u64 = self.layers.iter().map(|layer| layer.list.bytes() + 4 * layer.list.len() as u64).sum();
        let [width, height] = area_of(view).size_px().map(u64::from);
        lists + width * height * BYTES_PER_PIXEL
    }
}

impl OpaquePicture {
    /// Inverse depth at which the ray of pixel (x, y) of the whole picture ends; negative infinity where it goes on, and outside.
    #[inline]
    pub(crate) fn limit(&self, x: usize, y: usize) -> f32 {
        self.place(x, y).map_or(f32::NEG_INFINITY, |i| self.v[i])
    }

    /// Where a pixel of the whole picture is.
    #[inline]
    fn place(&self, x: usize, y: usize) -> Option<usize> {
        let [x0, y0, x1, y1] = <[u32; 4]>::from(self.area).map(|side| side as usize);
        ((x0..x1).contains(&x) && (y0..y1).contains(&y)).then(|| (y - y0) * (x1 - x0) + x - x0)
    }

    /// Puts it behind what `image`, the part of the picture in `region`, shows of the volume in front of it: see
    /// [`GeometryOptions`](crate::geometry::GeometryOptions).
    pub fn put_behind(&self, image: &mut Image, region: Region, model: Model, output: Output) {
        let width = image.width as usize;
        image.pixels.par_iter_mut().enumerate().for_each(|(pixel, shown)| {
            let (x, y) = (region.x0 as usize + pixel % width, region.y0 as usize + pixel / width);
            let Some(i) = self.place(x, y).filter(|&i| self.v[i] > f32::NEG_INFINITY) else { return };
            let ([r, g, b, a], [back_r, back_g, back_b]) = (*shown, self.color[i]);
            let over = |left: f32| [r + left * back_r, g + left * back_g, b + left * back_b, 1.0];
            *shown = match (model, output) {
                (Model::EmissionAbsorption, _) => over(1.0 - a),
                (Model::Emission, _) => over(1.0),
                (Model::Mip, _) => over(if a > 0.0 { 0.0 } else { 1.0 }),
                (Model::Absorption, Output::Intensity) => [0.0; 4],
                (Model::Absorption, Output::Depth) => *shown,
            };
        });
    }
}
