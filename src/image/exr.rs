//! `OpenEXR`: channels R, G, B, A in f32, linear, premultiplied as the format expects; run-length coded, no loss.

use std::io::{Seek, Write};
use std::path::Path;

use ::image::codecs::openexr::OpenExrEncoder;
use ::image::{ExtendedColorType, ImageEncoder};

use super::{Image, encoder_error};
use crate::Result;

/// Writes `image` as EXR.
pub(super) fn encode(image: &Image, path: &Path, writer: impl Write + Seek) -> Result<()> {
    OpenExrEncoder::new(writer)
        .write_image(bytemuck::cast_slice(&image.pixels), image.width, image.height, ExtendedColorType::Rgba32F)
        .map_err(|error| encoder_error(path, error))
}
