//! `Opaque`: what is opaque in a frame, an external picture and geometry before it, and the picture of both that the processor draws when
//! it is asked for.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::cpu::geometry::rasterise;
use super::tiles::TileGrid;
use crate::camera::Region;
use crate::geometry::{Layer, Primitive};
use crate::image::{DepthImage, DepthImagePart, Image};
use crate::optics::{Model, Output};
use crate::stages::View;

/// Opaque layers of one frame, and what an external picture shows behind and between them.
#[derive(Debug)]
pub struct Opaque {
    layers: Vec<Layer>,
    external: Option<OpaquePicture>,
    picture: OnceLock<OpaquePicture>,
}

/// What is opaque, as one view shows it: colour, and how near it is.
#[derive(Clone, Debug, PartialEq)]
pub struct OpaquePicture {
    /// The part of the picture that it covers: all pixels of the tiles that the view's region touches.
    pub area: Region,
    /// Linear premultiplied RGBA, row by row; zero where there is nothing. Where there is no depth it lies behind everything.
    pub color: Vec<[f32; 4]>,
    /// Inverse depth (see [`View`]); negative infinity where there is none: a ray goes on.
    pub v: Vec<f32>,
}

/// The part of the picture that `view` needs: of a tile all of it, so that its pixels have the bits that they have in the whole.
pub(super) fn area_of(view: &View) -> Region {
    TileGrid::new(view).pixels(view.size_px)
}

/// Bytes of a pixel of an [`OpaquePicture`], and of the depths that were compared to draw it.
const BYTES_PER_PIXEL: u64 = 20 + 4;

impl Opaque {
    /// Layers that are drawn one after the other.
    pub fn new(layers: Vec<Layer>) -> Self {
        Self { layers, external: None, picture: OnceLock::new() }
    }

    /// Draws the layers into a picture of another program.
    #[must_use]
    pub fn with_external(self, external: OpaquePicture) -> Self {
        Self { external: Some(external), ..self }
    }

    /// The external picture.
    pub fn external(&self) -> Option<&OpaquePicture> {
        self.external.as_ref()
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
        let external = self.external.as_ref().map_or(0, |external| external.v.len() as u64 * 20);
        lists + external + width * height * BYTES_PER_PIXEL
    }
}

impl OpaquePicture {
    /// What `part`, seen by the camera of `view`, shows.
    pub fn of_external(part: &DepthImagePart, view: &View) -> Self {
        let area = part.region();
        let [width, height] = area.size_px();
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let of_pixel = |([r, g, b, a], depth): ([f32; 4], f32)| {
            let v = v_of(view, depth);
            // What ends a ray is opaque.
            ([r, g, b, if v > f32::NEG_INFINITY { 1.0 } else { a }], v)
        };
        let (color, v) = pixels.map(|(x, y)| of_pixel(part.pixel(x, y))).unzip();
        Self { area, color, v }
    }

    /// Shows what `other`, a part of it, shows.
    pub(in crate::backends) fn copy(&mut self, other: &Self) {
        let Region { x0, y0, x1, y1 } = other.area;
        let width = (x1 - x0) as usize;
        for (row, y) in (y0..y1).enumerate() {
            let Some(first) = self.place(x0 as usize, y as usize) else { continue };
            let (to, from) = (first..first + width, row * width..(row + 1) * width);
            self.color[to.clone()].copy_from_slice(&other.color[from.clone()]);
            self.v[to].copy_from_slice(&other.v[from]);
        }
    }

    /// View depths of `region` in world units, infinite where there is nothing.
    pub(crate) fn depths_world(&self, view: &View, region: Region) -> Vec<f32> {
        let Region { x0, y0, x1, y1 } = region;
        let pixels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x as usize, y as usize)));
        pixels.map(|(x, y)| depth_of(view, self.limit(x, y))).collect()
    }

    /// Inverse depth at which the ray of pixel (x, y) of the whole picture ends; negative infinity where it goes on, and outside.
    #[inline]
    pub(crate) fn limit(&self, x: usize, y: usize) -> f32 {
        self.place(x, y).map_or(f32::NEG_INFINITY, |i| self.v[i])
    }

    /// View depth in world units at which the ray of a pixel of the whole picture ends; infinite where it goes on.
    pub(crate) fn depth_world(&self, view: &View, [x, y]: [u32; 2]) -> f64 {
        f64::from(depth_of(view, self.limit(x as usize, y as usize)))
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
        self.for_each(image, region, |shown, back, is_near| {
            let ([r, g, b, a], [back_r, back_g, back_b, back_a]) = (*shown, back);
            let over = |left: f32| {
                let alpha = if back_a >= 1.0 { 1.0 } else { 1.0 - (1.0 - a) * (1.0 - back_a) };
                [r + left * back_r, g + left * back_g, b + left * back_b, alpha]
            };
            *shown = match (model, output) {
                (Model::EmissionAbsorption, _) => over(1.0 - a),
                (Model::Emission, _) => over(1.0),
                (Model::Mip, _) => over(if a > 0.0 { 0.0 } else { 1.0 }),
                (Model::Absorption, Output::Intensity) if is_near => [0.0; 4],
                (Model::Absorption, Output::Intensity) => shown.map(|intensity| intensity * (1.0 - back_a)),
                (Model::Absorption, Output::Depth) => *shown,
            };
        });
    }

    /// Puts it behind two bands of light and their opacities, which are the bands at `places`: red, green and blue first, and others, of
    /// which it reflects the mean of these.
    pub(crate) fn put_behind_bands(&self, image: &mut Image, region: Region, places: &[usize]) {
        self.for_each(image, region, |shown, [r, g, b, back_a], _| {
            let colors = [r, g, b];
            for (k, &place) in places.iter().enumerate() {
                let back = colors.get(place).copied().unwrap_or((r + g + b) / 3.0);
                let left = 1.0 - shown[2 + k];
                shown[k] += left * back;
                shown[2 + k] = 1.0 - left * (1.0 - back_a);
            }
        });
    }

    /// Has `put` look at each pixel of `image` behind which there is something: its colour, and whether it has a depth.
    fn for_each(&self, image: &mut Image, region: Region, put: impl Fn(&mut [f32; 4], [f32; 4], bool) + Sync) {
        let width = image.width as usize;
        image.pixels.par_iter_mut().enumerate().for_each(|(pixel, shown)| {
            let (x, y) = (region.x0 as usize + pixel % width, region.y0 as usize + pixel / width);
            let Some(i) = self.place(x, y) else { return };
            let is_near = self.v[i] > f32::NEG_INFINITY;
            if is_near || self.color[i].iter().any(|channel| *channel != 0.0) {
                put(shown, self.color[i], is_near);
            }
        });
    }
}

/// Inverse depth of a view depth in world units; what lies at the eye or behind it is as near as can be.
fn v_of(view: &View, depth_world: f32) -> f32 {
    if depth_world >= DepthImage::NOTHING {
        return f32::NEG_INFINITY;
    }
    let depth = f64::from(depth_world) / view.world_per_scene;
    let v = if view.is_perspective { depth.max(f64::MIN_POSITIVE).recip() } else { -depth };
    (v as f32).clamp(f32::MIN / 8.0, f32::MAX)
}

/// The same the other way round.
fn depth_of(view: &View, v: f32) -> f32 {
    if v == f32::NEG_INFINITY {
        return f32::INFINITY;
    }
    let depth = if view.is_perspective { f64::from(v).recip() } else { -f64::from(v) };
    (depth * view.world_per_scene) as f32
}
