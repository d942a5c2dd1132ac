//! Pictures of other programs, read to be composited: .png (sRGB, straight alpha) and .exr (linear, premultiplied).

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use ::image::codecs::png::PngDecoder;
use ::image::{DynamicImage, ImageDecoder};

use super::zbuffer::allocate;
use super::{Image, exr, linear_from_srgb};
use crate::camera::Camera;
use crate::error::{Error, Result, VolCondition, presentable};

/// What every EXR begins with.
const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Whether a file is an EXR.
pub(super) fn is_exr(bytes: &[u8]) -> bool {
    bytes.starts_with(&EXR_MAGIC)
}

/// Reads a whole file; what cannot be opened or read has Vol's numbers for that.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>> {
    let vol = |condition, problem| Error::Vol { condition, problem }.in_file(path);
    let mut file = File::open(path).map_err(|error| vol(VolCondition::Open, format!("cannot be opened: {error}")))?;
    let length = file.metadata().map_or(0, |file| file.len());
    allocate(VolCondition::Memory, || format!("a file of {length} bytes"), length)
        .map_err(|error| error.in_file(path))?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(|error| vol(VolCondition::Read, format!("cannot be read: {error}")))?;
    Ok(bytes)
}

/// Reads a picture.
pub(super) fn image(path: &Path) -> Result<Image> {
    decode(&bytes(path)?, path)
}

/// Reads a picture that is in memory.
///
/// # Errors
/// [`Error::Malformed`], [`Error::Unsupported`]; [`Error::Vol`] (106) where there is no memory for it.
pub(super) fn decode(bytes: &[u8], path: &Path) -> Result<Image> {
    if is_exr(bytes) {
        return exr::decode(bytes, path).map(|(image, _)| image);
    }
    let malformed = |error: ::image::ImageError| {
        let problem = presentable(error.to_string());
        Error::Malformed { path: path.to_owned(), place: "PNG".to_owned(), problem }
    };
    if !bytes.starts_with(b"\x89PNG") {
        let (what, advice) =
            ("a picture that is neither PNG nor EXR".to_owned(), "convert it to one of them".to_owned());
        return Err(Error::Unsupported { path: path.to_owned(), what, advice });
    }
    let mut limits = ::image::Limits::default();
    limits.max_image_width = Some(Camera::MAX_SIDE);
    limits.max_image_height = Some(Camera::MAX_SIDE);
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(malformed)?;
    let (width, height) = decoder.dimensions();
    check_expansion(bytes, path, [width, height], 32)?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(malformed)?.into_rgba32f();
    let premultiplied = |pixel: &::image::Rgba<f32>| {
        let [r, g, b, a] = pixel.0;
        [linear_from_srgb(r) * a, linear_from_srgb(g) * a, linear_from_srgb(b) * a, a]
    };
    Ok(Image { width, height, pixels: decoded.pixels().map(premultiplied).collect() })
}

/// Most pixels for a byte of a file: that of the best compressed one that means something, one colour in all of it, has about 1000.
const MOST_PIXELS_PER_BYTE: u64 = 2048;

/// Whether a picture may have so many pixels, each of which takes `bytes_per_pixel` of memory while it is read.
///
/// # Errors
/// [`Error::Malformed`] where the file is too short for them, [`Error::Vol`] (106) where the memory is.
pub(super) fn check_expansion(
    bytes: &[u8],
    path: &Path,
    [width, height]: [u32; 2],
    bytes_per_pixel: u64,
) -> Result<()> {
    let pixels = u64::from(width) * u64::from(height);
    let is_possible = pixels <= MOST_PIXELS_PER_BYTE.saturating_mul(bytes.len() as u64);
    if width == 0 || height == 0 || width.max(height) > Camera::MAX_SIDE || !is_possible {
        let problem = format!("{width}x{height} pixels in {} bytes; the file is damaged", bytes.len());
        return Err(Error::Malformed { path: path.to_owned(), place: "size".to_owned(), problem });
    }
    let what = || format!("a picture of {width}x{height} pixels");
    allocate(VolCondition::ImageMemory, what, pixels * bytes_per_pixel).map_err(|error| error.in_file(path))
}
