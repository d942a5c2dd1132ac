//! [`BandImage`]: any number of named values a pixel, as an X-ray picture in many wavelength bands.

use std::path::Path;

use super::{Encoding, Format, Picture, exr, npy};
use crate::atomic::write_atomically;
use crate::{Error, Result};

/// A picture of named bands in linear f32, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct BandImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The bands' names, in their order.
    pub names: Vec<String>,
    /// `width · height · names.len()` values, row by row, pixel by pixel, those of a pixel together.
    pub values: Vec<f32>,
}

impl BandImage {
    /// A picture of one value.
    pub fn filled(width: u32, height: u32, names: Vec<String>, value: f32) -> Self {
        let len = width as usize * height as usize * names.len();
        Self { width, height, names, values: vec![value; len] }
    }

    /// The bands of the pixel in column `x` of row `y`.
    ///
    /// # Panics
    /// Outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> &[f32] {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) of a {}x{} picture", self.width, self.height);
        let bands = self.names.len();
        &self.values[(y as usize * self.width as usize + x as usize) * bands..][..bands]
    }

    /// How many pixels differ from `miss`, the value of a ray that meets no cell, in any band.
    #[expect(clippy::float_cmp, reason = "a miss is a value that is written, not computed")]
    pub fn covered(&self, miss: f32) -> u64 {
        let pixels = self.values.chunks_exact(self.names.len().max(1));
        pixels.filter(|bands| bands.iter().any(|&band| band != miss)).count() as u64
    }

    /// Writes the picture in the format of the path's extension: .exr (one channel a band, by its name) or .npy (`float32`, shape
    /// `(height, width, bands)`), to the bit. The file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Encode`] for another extension, for a picture without pixels or bands or one whose `values` do not fit its size, and
    /// for names that EXR cannot hold; [`Error::Io`] where the system refuses to write.
    ///
    /// ```
    /// use cellfan::image::BandImage;
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("bands.npy");
    /// let bands = ["1keV", "2keV", "4keV", "8keV", "16keV"].map(String::from).to_vec();
    /// BandImage::filled(3, 2, bands, 0.5).save(&path)?;
    /// assert_eq!(npyz::NpyFile::new(std::fs::File::open(&path)?)?.shape(), [2, 3, 5]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let format = Format::from_path(path)?;
        self.check(path)?;
        write_atomically(path, |writer| match format {
            Format::Png => {
                let problem = "a PNG holds no bands; end the name in .exr or .npy".to_owned();
                Err(Error::Encode { path: path.to_owned(), problem })
            }
            Format::Exr => exr::encode_bands(self, path, writer),
            Format::Npy => npy::encode(self, path, writer),
        })
    }

    /// There are values, as many as the size says.
    fn check(&self, path: &Path) -> Result<()> {
        let (width, height, bands, len) = (self.width, self.height, self.names.len(), self.values.len());
        let problem = if width == 0 || height == 0 || bands == 0 {
            format!("{width}x{height} pixels of {bands} bands is no size of a picture")
        } else if width as usize * height as usize * bands != len {
            format!("it has {len} values where {width}x{height} pixels of {bands} bands are needed")
        } else {
            return Ok(());
        };
        Err(Error::Encode { path: path.to_owned(), problem })
    }
}

impl Picture for BandImage {
    fn shape(&self) -> [u32; 3] {
        [self.height, self.width, self.names.len() as u32]
    }

    fn values(&self) -> &[f32] {
        &self.values
    }

    fn check(&self, path: &Path) -> Result<()> {
        Self::check(self, path)
    }

    fn save(&self, path: &Path, _: &Encoding) -> Result<()> {
        Self::save(self, path)
    }
}
