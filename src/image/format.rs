//! Which format a path asks for, and how a picture is prepared for a format that is looked at.

use std::path::Path;

use crate::atomic::check_target;
use crate::{Error, Result};

/// A file format of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 bits a channel, sRGB: to look at.
    Png,
    /// `OpenEXR`, f32, linear.
    Exr,
    /// `NumPy`, `float32`, linear.
    Npy,
}

impl Format {
    /// The format of the path's extension, in upper or lower case.
    ///
    /// # Errors
    /// [`Error::Encode`] where it is none of .png, .exr and .npy.
    ///
    /// ```
    /// # use cellfan::image::Format;
    /// assert_eq!(Format::from_path("a/out.EXR")?, Format::Exr);
    /// let error = Format::from_path("out.jpg").unwrap_err().to_string();
    /// assert!(error.ends_with("\".jpg\" is no picture format here; end the name in .png, .exr or .npy"));
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            Some("npy") => Ok(Self::Npy),
            other => {
                let problem = match other {
                    Some(found) => {
                        format!("\".{found}\" is no picture format here; end the name in .png, .exr or .npy")
                    }
                    None => "a name without an extension says no format; end it in .png, .exr or .npy".into(),
                };
                Err(Error::Encode { path: path.to_owned(), problem })
            }
        }
    }
}

/// How a PNG shows a picture; EXR and NPY keep the linear values and do not ask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoding {
    /// The colour behind the picture: sRGB display values, each from 0 to 1, as on the command line.
    ///
    /// The picture is composited over it in linear light. None: the PNG has straight alpha. A light without opacity
    /// (the emission model) or brighter than its opacity then gets the opacity of its brightest channel, so that the
    /// PNG over black shows what the picture is.
    pub background: Option<[f32; 3]>,
    /// Whether the picture is a premultiplied colour with its opacity.
    ///
    /// False: transmitted intensities (the absorption model); the PNG shows the first three, opaque, without a
    /// background.
    pub premultiplied: bool,
}

impl Default for Encoding {
    /// Premultiplied colour; straight alpha.
    fn default() -> Self {
        Self { background: None, premultiplied: true }
    }
}

impl Encoding {
    /// For the absorption model: transmitted intensities, opaque.
    pub const TRANSMITTED: Self = Self { background: None, premultiplied: false };

    /// The background lies in its range.
    pub(super) fn check(&self) -> Result<()> {
        match self.background {
            Some(color) if !color.iter().all(|channel| (0.0..=1.0).contains(channel)) => Err(Error::Option {
                option: "--background",
                problem: format!("{color:?} is not a colour; give R,G,B as sRGB values from 0 to 1"),
            }),
            _ => Ok(()),
        }
    }
}

/// Finds out before the work whether a picture can be saved as `path`: extension, background, folder.
///
/// # Errors
/// As [`Image::save`](super::Image::save), as far as they can be known without a picture.
///
/// ```
/// # use cellfan::image::{check_output, Encoding};
/// assert!(check_output("out.png", &Encoding::default()).is_ok());
/// assert!(check_output("no such folder/out.png", &Encoding::default()).is_err());
/// assert!(check_output("out.png", &Encoding { background: Some([0.0, 0.0, 255.0]), premultiplied: true }).is_err());
/// ```
pub fn check_output(path: impl AsRef<Path>, encoding: &Encoding) -> Result<Format> {
    let path = path.as_ref();
    let format = Format::from_path(path)?;
    encoding.check()?;
    check_target(path)?;
    Ok(format)
}
