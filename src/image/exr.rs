//! `OpenEXR`: f32, linear, run-length coded, no loss. Channels R, G, B, A, premultiplied as the format expects; or one channel a
//! band, by its name.

use std::io::{Seek, Write};
use std::path::Path;

use ::exr::image::write::WritableImage;
use ::exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image as ExrImage, Layer};
use ::exr::meta::attribute::Text;
use ::exr::meta::header::LayerAttributes;
use ::image::codecs::openexr::OpenExrEncoder;
use ::image::{ExtendedColorType, ImageEncoder};

use super::{BandImage, Image, encoder_error};
use crate::{Error, Result, memory};

/// Writes `image` as EXR.
pub(super) fn encode(image: &Image, path: &Path, writer: impl Write + Seek) -> Result<()> {
    OpenExrEncoder::new(writer)
        .write_image(bytemuck::cast_slice(&image.pixels), image.width, image.height, ExtendedColorType::Rgba32F)
        .map_err(|error| encoder_error(path, error))
}

/// Writes `image` as EXR, one channel a band.
pub(super) fn encode_bands(image: &BandImage, path: &Path, writer: impl Write + Seek) -> Result<()> {
    let bands = image.names.len();
    let what = || format!("writing an EXR of {}x{} pixels in {bands} bands", image.width, image.height);
    // Once channel by channel, once coded.
    memory::check(what, (image.values.len() as u64).checked_mul(8))?;
    let refuse = |problem: String| Error::Encode { path: path.to_owned(), problem };
    let channel = |(k, name): (usize, &String)| {
        let text = Text::new_or_none(name).filter(|_| !name.is_empty() && name.len() < 256).ok_or_else(|| {
            refuse(format!("an EXR cannot have a channel {name:?}; give the band a plain, short name"))
        })?;
        let values = image.values.iter().skip(k).step_by(bands).copied().collect();
        Ok(AnyChannel::new(text, FlatSamples::F32(values)))
    };
    let channels = AnyChannels::sort(image.names.iter().enumerate().map(channel).collect::<Result<_>>()?);
    let size = (image.width as usize, image.height as usize);
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::FAST_LOSSLESS, channels);
    // On one thread: blocks of the file then stand in one order.
    ExrImage::from_layer(layer).write().non_parallel().to_buffered(writer).map_err(|error| match error {
        ::exr::error::Error::Io(source) => Error::Io { path: path.to_owned(), source },
        other => refuse(other.to_string()),
    })
}
