//! `FlightCheck`: what a level of detail costs in the frames of a flight, and whether it has holes.
//!
//! In: the frames of a flight, one after the other. Out, for each: how it differs from the same frame over all points of the terrain, by how much
//! more or less than the frame before, what of it pops, and how many pixels of sky lie in the ground.

use super::{FogLook, FogRenderer, FogScene};
use crate::camera::Camera;
use crate::error::Result;
use crate::fog::{Detail, Terrain};
use crate::image::Image;
use crate::optics::color::srgb_from_linear;

/// Compares the frames of a flight with those over all points of the terrain.
pub struct FlightCheck {
    renderer: FogRenderer,
    /// Linear RGB.
    sky: [f64; 3],
    /// All points of the terrain.
    full: FogScene,
    before: Option<Before>,
}

/// What is kept of a frame for the next.
struct Before {
    scene: FogScene,
    difference: f64,
}

/// What was found of a frame; levels of grey are those of 8 bits in sRGB, 0 to 255, of the luminance over the sky.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct FrameCheck {
    /// Mean over the pixels of the difference from the same frame over all points, in levels of grey.
    pub difference: f64,
    /// By how much that mean differs from the frame before; 0 for the first.
    pub jump: f64,
    /// Mean difference of the frame from one drawn with the points that the frame before had, in levels of grey: what changes at once that is not
    /// the camera's motion; 0 for the first.
    pub popping: f64,
    /// Pixels in which the sky shows below the horizon: those of sky from which no way through sky leads to the picture's upper edge.
    pub holes_px: usize,
    /// Whether the eye is in the fog.
    pub is_in_fog: bool,
}

impl FrameCheck {
    /// The largest of each.
    #[must_use]
    pub fn most(self, other: Self) -> Self {
        Self {
            difference: self.difference.max(other.difference),
            jump: self.jump.max(other.jump),
            popping: self.popping.max(other.popping),
            holes_px: self.holes_px.max(other.holes_px),
            is_in_fog: self.is_in_fog || other.is_in_fog,
        }
    }
}

impl FlightCheck {
    /// Draws a terrain with `renderer`, whose options are those of the look, before a sky of linear RGB.
    ///
    /// # Errors
    /// Those of [`FogScene::new`].
    pub fn new(renderer: FogRenderer, terrain: &Terrain, look: &FogLook, sky: [f64; 3]) -> Result<Self> {
        let full = FogScene::new(terrain.landscape(&Detail::Full, look.profile()))?;
        Ok(Self { renderer, sky, full, before: None })
    }

    /// Checks the next frame, `image`, in which `scene` was drawn.
    ///
    /// # Errors
    /// Those of [`FogRenderer::render`].
    pub fn frame(
        &mut self,
        terrain: &Terrain,
        (scene, camera, look): (FogScene, &Camera, &FogLook),
        image: &Image,
    ) -> Result<FrameCheck> {
        let greys = |image: &Image| greys(image, self.sky);
        let drawn = greys(image);
        let full = self.renderer.draw(&self.full, camera, look)?.image;
        let difference = mean_difference(&drawn, &greys(&full));
        let [ground, thickness] = terrain.heights_at(camera.eye.x, camera.eye.y);
        let is_in_fog = (ground..ground + thickness).contains(&camera.eye.z);
        let mut found = FrameCheck { difference, is_in_fog, ..FrameCheck::default() };
        if let Some(before) = self.before.take() {
            found.jump = (difference - before.difference).abs();
            let as_before = self.renderer.draw(&before.scene, camera, look)?.image;
            found.popping = mean_difference(&drawn, &greys(&as_before));
        }
        found.holes_px = holes_px(&scene.bare(camera)?);
        self.before = Some(Before { scene, difference });
        Ok(found)
    }
}

/// The grey of each pixel, in levels of 8 bits, not rounded.
fn greys(image: &Image, sky: [f64; 3]) -> Vec<f64> {
    let grey = |&[r, g, b, a]: &[f32; 4]| {
        let [r, g, b] = [(r, 0), (g, 1), (b, 2)].map(|(c, k)| f64::from(c) + (1.0 - f64::from(a)) * sky[k]);
        let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        255.0 * srgb_from_linear([luminance.clamp(0.0, 1.0); 3])[0]
    };
    image.pixels.iter().map(grey).collect()
}

fn mean_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>() / a.len() as f64
}

/// Pixels without ground that are not joined to the upper edge by others, side by side or corner to corner.
fn holes_px(bare: &Image) -> usize {
    let [width, height] = [bare.width as usize, bare.height as usize];
    let mut is_sky: Vec<bool> = bare.pixels.iter().map(|pixel| pixel[3] < 0.5).collect();
    let mut reached: Vec<usize> = (0..width).filter(|&x| is_sky[x]).collect();
    for &x in &reached {
        is_sky[x] = false;
    }
    while let Some(at) = reached.pop() {
        let (x, y) = (at % width, at / width);
        for y in y.saturating_sub(1)..(y + 2).min(height) {
            for x in x.saturating_sub(1)..(x + 2).min(width) {
                if std::mem::take(&mut is_sky[x + width * y]) {
                    reached.push(x + width * y);
                }
            }
        }
    }
    is_sky.iter().filter(|&&is_left| is_left).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fog::{Flight, Landscape, MapSettings, fog_map, ground_map};
    use crate::optics::Model;
    use crate::render::Renderer;

    #[test]
    fn sky_in_the_ground_is_a_hole_and_sky_above_it_is_none() {
        // Ground from row 3 on, with a valley in which the sky reaches row 5.
        let mut bare = Image::filled(8, 8, [0.0; 4]);
        let at = |x: usize, y: usize| x + 8 * y;
        for i in 0..64 {
            let is_valley = i % 8 == 5 && i / 8 < 6;
            bare.pixels[i][3] = f32::from(i / 8 >= 3 && !is_valley);
        }
        assert_eq!(holes_px(&bare), 0);
        bare.pixels[at(2, 6)] = [0.0; 4];
        bare.pixels[at(1, 5)] = [0.0; 4];
        assert_eq!(holes_px(&bare), 2);
        // Joined by a corner.
        bare.pixels[at(6, 6)] = [0.0; 4];
        assert_eq!(holes_px(&bare), 2);
    }

    #[test]
    fn a_crack_in_a_landscape_is_found() {
        let settings = MapSettings { points: 33, ..MapSettings::default() };
        let ground = ground_map(&settings).unwrap();
        let fog = fog_map(&ground, &settings).unwrap();
        let terrain = Terrain::new(&ground, &fog, 10.0, [1.6, 0.25]).unwrap();
        let look = FogLook::new(Model::Emission, &terrain).unwrap();
        let camera = Flight::new(&terrain, 0.35).camera(0.3, [96, 72]);
        let landscape = FogRenderer::landscape(&terrain, &camera, &look);
        let scene = |landscape: &Landscape| FogScene::new(landscape.clone()).unwrap();
        let holes = |landscape: &Landscape| holes_px(&scene(landscape).bare(&camera).unwrap());
        assert_eq!(holes(&landscape), 0);
        // Without one triangle that shows, sky shows through it.
        let most = (0..landscape.triangles.len()).map(|lost| {
            let mut torn = landscape.clone();
            torn.triangles.remove(lost);
            torn
        });
        assert!(most.map(|torn| holes(&torn)).max() > Some(0));
        let renderer = || FogRenderer::new(Renderer::new(FogRenderer::options(&look)));
        let mut check = FlightCheck::new(renderer(), &terrain, &look, [0.2; 3]).unwrap();
        let image = renderer().draw(&scene(&landscape), &camera, &look).unwrap().image;
        let [first, again] =
            [(); 2].map(|()| check.frame(&terrain, (scene(&landscape), &camera, &look), &image).unwrap());
        assert!(first.difference < 2.0 && first.popping == 0.0 && first.holes_px == 0);
        assert_eq!((again.difference, again.jump, again.popping), (first.difference, 0.0, 0.0));
    }
}
