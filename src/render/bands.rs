//! Bands with extinctions of their own: passes of one view, gathered into one picture.
//!
//! In: a frame without bands, the scene's bands. Out: four optical depths (or intensities) a pass in a [`BandImage`]; or three
//! channels of light, two a pass, in an [`Image`].

use super::scene::{BandArray, SceneBands};
use super::{Drawn, Renderer, Scene};
use crate::backends::{Counts, Frame};
use crate::error::{Error, Result};
use crate::image::{BandImage, Image};
use crate::optics::band_pieces::{BANDS_PER_PASS, GLOWING_BANDS_PER_PASS};
use crate::optics::{BandPasses, Integral, Model};
use crate::profile::Profile;

/// Bands of emission-absorption: red, green, blue.
const CHANNELS: usize = 3;

impl Renderer {
    /// Whether the model can be drawn with the scene's bands.
    pub(super) fn check_bands(&self, scene: &Scene) -> Result<()> {
        let Some(bands) = &scene.bands else { return Ok(()) };
        let problem = match (self.options.model, bands) {
            (Model::Absorption, _) => return Ok(()),
            (Model::EmissionAbsorption, SceneBands::Arrays(_)) => {
                "emission-absorption takes its bands from a table over the scalar that gives the colours".to_owned()
            }
            (Model::EmissionAbsorption, SceneBands::Table(table)) if table.names().len() != CHANNELS => {
                let bands = table.names().len();
                format!("emission-absorption takes {CHANNELS} bands, for red, green and blue; there are {bands}")
            }
            (Model::EmissionAbsorption, _) if self.options.integral != Integral::Exact => {
                format!("--integral {} knows no bands; leave it out", self.options.integral)
            }
            (Model::EmissionAbsorption, _) => {
                #[cfg(feature = "gpu")]
                self.check_blends_by_channel()?;
                return Ok(());
            }
            (model @ (Model::Emission | Model::Mip), _) => {
                format!("{model} has no bands; choose absorption or emission-absorption")
            }
        };
        Err(Error::Option { option: "--bands", problem })
    }

    /// Draws all passes of the scene's bands.
    pub(super) fn draw_bands(
        &mut self,
        scene: &Scene,
        bands: &SceneBands,
        frame: &Frame,
        profile: &mut Profile,
    ) -> Result<Drawn> {
        if let (Model::EmissionAbsorption, SceneBands::Table(table)) = (self.options.model, bands) {
            let passes = table.glowing_passes(&scene.transfer, scene.field.offset);
            let (image, counts) = self.draw_light(&passes, frame, profile)?;
            return Ok((image, None, counts));
        }
        let [width, height] = frame.view.size_px;
        let names = scene.band_names();
        let pixels = u64::from(width) * u64::from(height);
        let bytes = scene.band_bytes() + pixels * (names.len() as u64 * 4 + 16);
        let image = BandImage::filled(width, height, names, 0.0);
        let mut gathered = Gathered { image, bands: 0, counts: Counts::default(), bytes };
        match bands {
            SceneBands::Table(table) => {
                self.draw_depths(&table.passes(scene.field.offset), frame, &mut gathered, profile)?;
            }
            SceneBands::Arrays(arrays) => {
                for BandArray { field, vertices, passes } in arrays {
                    let vertices = vertices.as_deref().unwrap_or(frame.vertices);
                    self.draw_depths(passes, &Frame { field, vertices, ..*frame }, &mut gathered, profile)?;
                }
            }
        }
        Ok((first_four(&gathered.image), Some(gathered.image), gathered.counts))
    }

    /// Draws depths or intensities, pass by pass.
    fn draw_depths(
        &mut self,
        BandPasses { bands, passes, cull_table }: &BandPasses,
        frame: &Frame,
        gathered: &mut Gathered,
        profile: &mut Profile,
    ) -> Result<()> {
        let of_bands = gathered.bytes;
        let budget = frame.memory_bytes;
        let memory_bytes = budget.map(|bytes| bytes.saturating_sub(of_bands));
        for (pass, first) in passes.iter().zip((0..*bands).step_by(BANDS_PER_PASS)) {
            let frame = Frame { bands: Some(pass), cull_table, memory_bytes, ..*frame };
            let (image, counts) = self.draw(&frame, profile).map_err(|error| with_bands(error, budget, of_bands))?;
            gathered.add(&image, BANDS_PER_PASS.min(bands - first), counts);
        }
        Ok(())
    }

    /// Draws the light of red, green and blue, two channels a pass; opacity is the mean of theirs.
    fn draw_light(
        &mut self,
        BandPasses { passes, cull_table, .. }: &BandPasses,
        frame: &Frame,
        profile: &mut Profile,
    ) -> Result<(Image, Counts)> {
        let [width, height] = frame.view.size_px;
        let of_image = 16 * u64::from(width) * u64::from(height);
        let budget = frame.memory_bytes;
        let memory_bytes = budget.map(|bytes| bytes.saturating_sub(of_image));
        let mut whole = Image::filled(width, height, [0.0; 4]);
        let mut counts = Counts::default();
        for (pass, first) in passes.iter().zip((0..CHANNELS).step_by(GLOWING_BANDS_PER_PASS)) {
            let frame = Frame { bands: Some(pass), cull_table, memory_bytes, ..*frame };
            let (image, of_pass) = self.draw(&frame, profile).map_err(|error| with_bands(error, budget, of_image))?;
            for (pixel, light) in whole.pixels.iter_mut().zip(&image.pixels) {
                let (light, opacity) = light.split_at(GLOWING_BANDS_PER_PASS);
                let channels = GLOWING_BANDS_PER_PASS.min(CHANNELS - first);
                pixel[first..first + channels].copy_from_slice(&light[..channels]);
                pixel[3] += opacity[..channels].iter().sum::<f32>() / CHANNELS as f32;
            }
            counts = busier(counts, of_pass);
        }
        Ok((whole, counts))
    }
}

/// What the passes so far have drawn.
struct Gathered {
    image: BandImage,
    /// Bands that are there.
    bands: usize,
    counts: Counts,
    /// Memory of the pictures and of the arrays that bands come from, which a frame does not know of.
    bytes: u64,
}

impl Gathered {
    /// Adds a pass of so many bands.
    fn add(&mut self, pass: &Image, bands: usize, counts: Counts) {
        let (first, all) = (self.bands, self.image.names.len());
        for (pixel, of_pass) in self.image.values.chunks_exact_mut(all).zip(&pass.pixels) {
            pixel[first..first + bands].copy_from_slice(&of_pass[..bands]);
        }
        self.bands += bands;
        self.counts = busier(self.counts, counts);
    }
}

/// The first four bands, the last one again where there are fewer.
fn first_four(image: &BandImage) -> Image {
    let last = image.names.len() - 1;
    let pixel = |bands: &[f32]| std::array::from_fn(|c| bands[c.min(last)]);
    let pixels = image.values.chunks_exact(last + 1).map(pixel).collect();
    Image { width: image.width, height: image.height, pixels }
}

/// The counts of the pass that drew more cells: bands that are arrays leave out different ones. What was counted of the order adds up.
fn busier(a: Counts, b: Counts) -> Counts {
    let counts = if b.drawn > a.drawn || a == Counts::default() { b } else { a };
    Counts {
        violations: a.violations + b.violations,
        tiles_redone: a.tiles_redone + b.tiles_redone,
        triangles: a.triangles + b.triangles,
        ..counts
    }
}

/// A budget that was too small for a pass, in terms of the frame, which takes `bytes` more.
fn with_bands(error: Error, budget: Option<u64>, bytes: u64) -> Error {
    match (error, budget) {
        (Error::Memory { needed_bytes, what, advice, .. }, Some(budget_bytes)) => {
            Error::Memory { budget_bytes, needed_bytes: needed_bytes + bytes, what, advice }
        }
        (other, _) => other,
    }
}
