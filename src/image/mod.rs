//! [`Image`]: linear RGBA in f32, row 0 on top; files of it, and the difference of two. [`BandImage`]: any number of bands. [`DepthImage`]: with
//! a depth for each pixel; its files, read and written.
//!
//! In: pixels from a backend. Out: .png (to look at), .exr and .npy (the linear values, to the bit), by the extension.
//! Several frames: [`FrameWriter`]. Files appear whole or not at all.
//! To add a format: a file with `encode(image, …, writer)`, its extension in [`Format`], its line in [`Image::save`].

mod bands;
mod depth_image;
mod difference;
mod exr;
mod format;
mod frames;
mod npy;
mod png;
mod read;
#[cfg(test)]
mod tests;
mod zbuffer;

use std::path::Path;

pub use bands::BandImage;
pub use depth_image::{DepthImage, DepthImagePart};
pub use difference::ImageDifference;
pub use format::{Encoding, Format, check_output};
pub use frames::{FrameWriter, frame_path};
pub use png::linear_from_srgb;
pub use zbuffer::{ByteOrder, ZBuffer};

use crate::atomic::write_atomically;
use crate::{Error, Result};

/// A picture: linear RGBA, premultiplied (transmitted intensities in the absorption model), rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width · height` pixels, row by row.
    pub pixels: Vec<[f32; 4]>,
}

impl Image {
    /// A picture of one value.
    pub fn filled(width: u32, height: u32, pixel: [f32; 4]) -> Self {
        Self { width, height, pixels: vec![pixel; width as usize * height as usize] }
    }

    /// The pixel in column `x` of row `y`.
    ///
    /// # Panics
    /// Outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [f32; 4] {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) of a {}x{} picture", self.width, self.height);
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// Writes the picture in the format of the path's extension: .png, .exr or .npy.
    ///
    /// EXR (channels R, G, B, A in f32) and NPY (`float32`, shape `(height, width, 4)`) keep the linear values to the
    /// bit; `encoding` concerns PNG alone (see [`Encoding`]). The file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Encode`] for another extension, for a picture without pixels or one whose `pixels` do not fit its
    /// size; [`Error::Option`] for a background outside 0 to 1; [`Error::Io`] where the system refuses to write.
    ///
    /// ```
    /// use cellfan::image::{Encoding, Image};
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("half.png");
    /// let half = Image::filled(2, 1, [0.25, 0.25, 0.25, 0.5]);
    /// half.save(&path, &Encoding { background: Some([0.0, 0.0, 1.0]), ..Encoding::default() })?;
    /// let shown = image::open(&path)?.into_rgb8();
    /// assert_eq!(shown.get_pixel(0, 0).0, [137, 137, 225]); // sRGB of 0.25, 0.25, 0.25 + (1 - 0.5) * 1
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn save(&self, path: impl AsRef<Path>, encoding: &Encoding) -> Result<()> {
        let path = path.as_ref();
        let format = Format::from_path(path)?;
        encoding.check()?;
        self.check(path)?;
        write_atomically(path, |writer| match format {
            Format::Png => png::encode(self, encoding, path, writer),
            Format::Exr => exr::encode(self, path, writer),
            Format::Npy => npy::encode(self, path, writer),
        })
    }

    /// The bytes of the PNG that [`Image::save`] writes.
    ///
    /// # Errors
    /// Those of [`Image::save`], but for the system's.
    ///
    /// ```
    /// # use cellfan::image::{Encoding, Image};
    /// let png = Image::filled(2, 1, [0.25, 0.25, 0.25, 0.5]).to_png(&Encoding::default())?;
    /// assert_eq!(image::load_from_memory(&png).unwrap().into_rgba8().get_pixel(1, 0).0, [188, 188, 188, 128]);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn to_png(&self, encoding: &Encoding) -> Result<Vec<u8>> {
        let (path, mut bytes) = (Path::new("PNG"), Vec::new());
        encoding.check()?;
        self.check(path)?;
        png::encode(self, encoding, path, &mut bytes)?;
        Ok(bytes)
    }

    /// How many pixels differ from `miss`, the value of a ray that meets no cell.
    ///
    /// `miss` is `[0.0; 4]`, and `[1.0; 4]` in the absorption model. A picture without a covered pixel is blank.
    ///
    /// ```
    /// # use cellfan::image::Image;
    /// let mut image = Image::filled(2, 2, [0.0; 4]);
    /// image.pixels[3] = [0.0, 0.0, 0.0, 0.5];
    /// assert_eq!(image.covered([0.0; 4]), 1);
    /// ```
    #[expect(clippy::float_cmp, reason = "a miss is a value that is written, not computed")]
    pub fn covered(&self, miss: [f32; 4]) -> u64 {
        self.pixels.iter().filter(|&&pixel| pixel != miss).count() as u64
    }

    /// There are pixels, as many as width and height say.
    fn check(&self, path: &Path) -> Result<()> {
        let (width, height, len) = (self.width, self.height, self.pixels.len());
        let problem = if width == 0 || height == 0 {
            format!("{width}x{height} is no size of a picture")
        } else if width as usize * height as usize != len {
            format!("it has {len} pixels where {width}x{height} are needed")
        } else {
            return Ok(());
        };
        Err(Error::Encode { path: path.to_owned(), problem })
    }
}

/// A picture that can be written as a file, alone or as one of several frames.
pub trait Picture {
    /// Height, width, and channels of a pixel.
    fn shape(&self) -> [u32; 3];

    /// All values, row by row, pixel by pixel, the channels of a pixel together.
    fn values(&self) -> &[f32];

    /// Whether there are as many values as the shape says.
    ///
    /// # Errors
    /// [`Error::Encode`], for the file `path`, where there are not, or none at all.
    fn check(&self, path: &Path) -> Result<()>;

    /// Writes the picture in the format of the path's extension.
    ///
    /// # Errors
    /// As [`Image::save`] and [`BandImage::save`].
    fn save(&self, path: &Path, encoding: &Encoding) -> Result<()>;
}

impl Picture for Image {
    fn shape(&self) -> [u32; 3] {
        [self.height, self.width, 4]
    }

    fn values(&self) -> &[f32] {
        self.pixels.as_flattened()
    }

    fn check(&self, path: &Path) -> Result<()> {
        Self::check(self, path)
    }

    fn save(&self, path: &Path, encoding: &Encoding) -> Result<()> {
        Self::save(self, path, encoding)
    }
}

/// What an encoder of the `image` crate said, as this crate's error.
fn encoder_error(path: &Path, error: ::image::ImageError) -> Error {
    match error {
        ::image::ImageError::IoError(source) => Error::Io { path: path.to_owned(), source },
        other => Error::Encode { path: path.to_owned(), problem: other.to_string() },
    }
}
