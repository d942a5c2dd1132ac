//! Bands with extinctions of their own: passes of one view, gathered into one picture.
//!
//! In: a frame without bands, the scene's bands. Out: four optical depths (or intensities) a pass, or two bands of light, in a
//! [`BandImage`]; the light of the first three as red, green and blue of an [`Image`], which is all where nothing is dimmed (emission). Arrays of point data take a pass each.

use super::band_arrays::{BandArray, BandArrays, CellPass};
use super::scene::SceneBands;
use super::{Drawn, RenderOptions, Renderer, Scene};
use crate::backends::{Counts, Frame};
use crate::error::{Error, Result};
use crate::image::{BandImage, Image};
use crate::optics::band_pieces::{BANDS_PER_PASS, GLOWING_BANDS_PER_PASS};
use crate::optics::{BandCells, BandColumn, BandPasses, BandTable, Integral, Model, Output};
use crate::profile::Profile;

/// Bands of light that are channels of a picture: red, green, blue.
const CHANNELS: usize = 3;

impl Renderer {
    /// Whether the model can be drawn with the scene's bands.
    pub(super) fn check_bands(&self, scene: &Scene) -> Result<()> {
        let Some(bands) = &scene.bands else { return Ok(()) };
        let count = bands.count();
        let problem = match self.options.model {
            Model::EmissionAbsorption if count < CHANNELS => {
                format!(
                    "emission-absorption takes {CHANNELS} bands or more, red, green and blue first; there are {count}"
                )
            }
            Model::Emission if count != CHANNELS => {
                format!("emission takes {CHANNELS} bands, red, green and blue; there are {count}")
            }
            Model::EmissionAbsorption | Model::Emission if self.options.integral != Integral::Exact => {
                format!("--integral {} knows no bands; leave it out", self.options.integral)
            }
            Model::EmissionAbsorption => {
                #[cfg(feature = "gpu")]
                self.check_blends_by_channel()?;
                return Ok(());
            }
            Model::Absorption | Model::Emission => return Ok(()),
            Model::Mip => "mip has no bands; choose absorption, emission or emission-absorption".to_owned(),
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
        if self.options.model == Model::Emission {
            return self.draw_emitting(scene, bands, frame, profile);
        }
        let glows = self.options.model == Model::EmissionAbsorption;
        let passes_of = |table: &BandTable, first: usize, offset: f64| {
            if glows { table.glowing_passes(&scene.transfer, first, offset) } else { table.passes(offset) }
        };
        let mut gathered = Gathered::new(scene, glows, frame.view.region.size_px());
        match bands {
            SceneBands::Table(table) => {
                self.draw_passes(&passes_of(table, 0, scene.field.offset), 0, frame, &mut gathered, profile)?;
            }
            SceneBands::Arrays(BandArrays { each, cell_passes }) => {
                // Light has the colour of the value; fans, and so GPUs, do not know which cell they are of.
                let cell_passes = if glows || self.draws_fans() { &[] } else { &cell_passes[..] };
                for pass in cell_passes {
                    self.draw_cell_pass(pass, each, frame, &mut gathered, profile)?;
                }
                let is_drawn = |band: usize| cell_passes.iter().any(|pass| pass.bands.contains(&band));
                for (band, BandArray { field, vertices, table }) in
                    each.iter().enumerate().filter(|&(band, _)| !is_drawn(band))
                {
                    let passes = passes_of(table, band, field.offset);
                    let vertices = vertices.as_deref().unwrap_or(frame.vertices);
                    self.draw_passes(&passes, band, &Frame { field, vertices, ..*frame }, &mut gathered, profile)?;
                }
            }
        }
        Ok(gathered.finish())
    }

    /// Draws bands that glow and dim nothing: what each emits along a ray is its optical depth, ∫ κ dt, as light.
    fn draw_emitting(
        &mut self,
        scene: &Scene,
        bands: &SceneBands,
        frame: &Frame,
        profile: &mut Profile,
    ) -> Result<Drawn> {
        let options = self.options;
        self.options = RenderOptions { model: Model::Absorption, output: Output::Depth, ..options };
        let drawn = self.draw_bands(scene, bands, frame, profile);
        self.options = options;
        let (mut image, _, counts) = drawn?;
        image.pixels.iter_mut().for_each(|pixel| pixel[3] = 0.0);
        self.put_behind(&mut image, frame);
        Ok((image, None, counts))
    }

    /// Draws bands from `first` on, pass by pass.
    fn draw_passes(
        &mut self,
        BandPasses { bands, passes, cull_table }: &BandPasses,
        first: usize,
        frame: &Frame,
        gathered: &mut Gathered,
        profile: &mut Profile,
    ) -> Result<()> {
        let places: Vec<usize> = (first..first + bands).collect();
        for (pass, places) in passes.iter().zip(places.chunks(gathered.per_pass())) {
            let frame = Frame { bands: Some(pass), cull_table, ..*frame };
            gathered.draw(places, &frame, |frame| {
                let (mut image, counts) = self.draw(frame, profile)?;
                self.put_behind_light(&mut image, frame, places)?;
                Ok((image, counts))
            })?;
        }
        Ok(())
    }

    /// Draws arrays of cell data in one pass.
    fn draw_cell_pass(
        &mut self,
        CellPass { bands, largest, table }: &CellPass,
        each: &[BandArray],
        frame: &Frame,
        gathered: &mut Gathered,
        profile: &mut Profile,
    ) -> Result<()> {
        let BandPasses { passes, cull_table, .. } = &table.passes(largest.offset);
        let columns: Vec<BandColumn> = bands.iter().map(|&band| each[band].column()).collect();
        let optics = BandCells { columns: &columns, output: self.options.output };
        let frame = Frame { field: largest, bands: passes.first(), cull_table, ..*frame };
        gathered.draw(bands, &frame, |frame| {
            let (mut image, counts) = self.draw_with(frame, &optics, profile)?;
            self.put_behind(&mut image, frame);
            Ok((image, counts))
        })
    }
}

/// What the passes so far have drawn.
struct Gathered {
    /// All bands.
    layers: BandImage,
    /// The first three bands of light; opacity is the mean of theirs.
    light: Option<Image>,
    counts: Counts,
    /// Memory of the pictures and of the arrays that bands come from, which a frame does not know of.
    bytes: u64,
}

impl Gathered {
    fn new(scene: &Scene, glows: bool, [width, height]: [u32; 2]) -> Self {
        let light = glows.then(|| Image::filled(width, height, [0.0; 4]));
        let layers = BandImage::filled(width, height, scene.band_names(), 0.0);
        let per_pixel = layers.names.len() as u64 * 4 + 16;
        let bytes = scene.band_bytes() + u64::from(width) * u64::from(height) * per_pixel;
        Self { layers, light, counts: Counts::default(), bytes }
    }

    /// Bands that a pass draws.
    fn per_pass(&self) -> usize {
        if self.light.is_some() { GLOWING_BANDS_PER_PASS } else { BANDS_PER_PASS }
    }

    /// Draws the pass of the bands at `places` within what they all leave of the memory budget.
    fn draw(
        &mut self,
        places: &[usize],
        frame: &Frame,
        draw: impl FnOnce(&Frame) -> Result<(Image, Counts)>,
    ) -> Result<()> {
        let budget = frame.memory_bytes;
        let memory_bytes = budget.map(|bytes| bytes.saturating_sub(self.bytes));
        let (image, counts) =
            draw(&Frame { memory_bytes, ..*frame }).map_err(|error| with_bands(error, budget, self.bytes))?;
        self.add(&image, places, &counts);
        Ok(())
    }

    /// Adds a pass of the bands at `places`.
    fn add(&mut self, pass: &Image, places: &[usize], counts: &Counts) {
        let all = self.layers.names.len();
        for (pixel, of_pass) in self.layers.values.chunks_exact_mut(all).zip(&pass.pixels) {
            places.iter().zip(of_pass).for_each(|(&band, value)| pixel[band] = *value);
        }
        if let Some(light) = &mut self.light {
            let channels = places.iter().filter(|&&band| band < CHANNELS).count();
            for (pixel, of_pass) in light.pixels.iter_mut().zip(&pass.pixels) {
                let (of_light, opacity) = of_pass.split_at(GLOWING_BANDS_PER_PASS);
                pixel[3] += opacity[..channels].iter().sum::<f32>() / CHANNELS as f32;
                places[..channels].iter().zip(of_light).for_each(|(&channel, light)| pixel[channel] = *light);
            }
        }
        self.counts = busier(&self.counts, counts);
    }

    /// The picture, all bands where it does not hold them, and what was counted.
    fn finish(self) -> Drawn {
        let Self { layers, light, counts, .. } = self;
        match light {
            None => (first_four(&layers), Some(layers), counts),
            Some(light) => (light, Some(layers).filter(|layers| layers.names.len() > CHANNELS), counts),
        }
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
fn busier(a: &Counts, b: &Counts) -> Counts {
    let counts = if b.drawn > a.drawn || *a == Counts::default() { *b } else { *a };
    Counts {
        violations: a.violations + b.violations,
        tiles_redone: a.tiles_redone + b.tiles_redone,
        triangles: a.triangles + b.triangles,
        uploaded_bytes: a.uploaded_bytes + b.uploaded_bytes,
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
