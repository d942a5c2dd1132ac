//! PNG: 8 bits a channel, sRGB, over a background or with straight alpha.
//!
//! In: linear premultiplied RGBA, or transmitted intensities. Out: RGB where every pixel is opaque, else RGBA.
//! Channels are clamped to 0 to 1 after compositing; NaN becomes 0.

use std::io::Write;
use std::path::Path;

use ::image::codecs::png::PngEncoder;
use ::image::{ExtendedColorType, ImageEncoder};
use rayon::prelude::*;

use super::{Encoding, Image, encoder_error};
use crate::{Result, memory};

/// Four channels, and once more when they are compressed.
const BYTES_PER_PIXEL: u64 = 8;

/// Writes `image` as PNG.
pub(super) fn encode(image: &Image, encoding: &Encoding, path: &Path, writer: impl Write) -> Result<()> {
    let what = || format!("writing a PNG of {}x{} pixels", image.width, image.height);
    memory::check(what, (image.pixels.len() as u64).checked_mul(BYTES_PER_PIXEL))?;
    let (bytes, color): (Vec<u8>, _) = match (encoding.premultiplied, encoding.background) {
        (false, _) => (map_pixels(image, |[r, g, b, _]| [r, g, b].map(srgb_from_linear)), ExtendedColorType::Rgb8),
        (true, Some(background)) => {
            let behind = background.map(linear_from_srgb);
            let shown = |pixel: [f32; 4]| {
                std::array::from_fn::<_, 3, _>(|k| srgb_from_linear(pixel[k] + (1.0 - pixel[3]) * behind[k]))
            };
            (map_pixels(image, shown), ExtendedColorType::Rgb8)
        }
        (true, None) => (map_pixels(image, straight), ExtendedColorType::Rgba8),
    };
    PngEncoder::new(writer)
        .write_image(&bytes, image.width, image.height, color)
        .map_err(|error| encoder_error(path, error))
}

/// `bytes_of` every pixel, in order.
fn map_pixels<const N: usize>(image: &Image, bytes_of: impl Fn([f32; 4]) -> [u8; N] + Sync) -> Vec<u8> {
    let pixels: Vec<[u8; N]> = image.pixels.par_iter().map(|&pixel| bytes_of(pixel)).collect();
    pixels.into_flattened()
}

/// Straight alpha: the opacity, raised to the brightest channel where that is brighter (light without opacity).
fn straight(pixel: [f32; 4]) -> [u8; 4] {
    let [r, g, b, a] = pixel;
    let alpha = a.max(r).max(g).max(b);
    let level = quantise(alpha);
    // Nothing that 8 bits show, or not a number: programs that ignore alpha must not show the colour of a hundred-millionth.
    if level == 0 {
        return [0; 4];
    }
    let alpha = alpha.min(1.0);
    let [r, g, b] = [r, g, b].map(|channel| srgb_from_linear(channel / alpha));
    [r, g, b, level]
}

/// The 8-bit sRGB value of a linear intensity; IEC 61966-2-1.
fn srgb_from_linear(linear: f32) -> u8 {
    let display = if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    quantise(display)
}

/// The linear intensity of an sRGB value from 0 to 1; IEC 61966-2-1.
///
/// ```
/// # use cellfan::image::linear_from_srgb;
/// assert!((linear_from_srgb(0.5) - 0.21404).abs() < 1e-5);
/// ```
pub fn linear_from_srgb(display: f32) -> f32 {
    if display <= 0.040_45 { display / 12.92 } else { ((display + 0.055) / 1.055).powf(2.4) }
}

/// The nearest of 256 levels; clamps, NaN becomes 0.
fn quantise(value: f32) -> u8 {
    (value * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_of_known_intensities() {
        // 0.5 is level 188; 18 % grey is 118; the linear part below 0.0031308.
        let known = [(0.0, 0), (0.001, 3), (0.18, 118), (0.215_86, 128), (0.5, 188), (1.0, 255)];
        for (linear, level) in known {
            assert_eq!(srgb_from_linear(linear), level, "{linear}");
        }
        let clamped = [(-1.0, 0), (1.5, 255), (f32::INFINITY, 255), (f32::NEG_INFINITY, 0), (f32::NAN, 0)];
        for (linear, level) in clamped {
            assert_eq!(srgb_from_linear(linear), level, "{linear}");
        }
    }

    #[test]
    fn every_level_comes_back() {
        for level in 0..=255_u8 {
            assert_eq!(srgb_from_linear(linear_from_srgb(f32::from(level) / 255.0)), level);
        }
    }

    #[test]
    fn straight_alpha() {
        assert_eq!(straight([0.0; 4]), [0; 4]);
        assert_eq!(straight([f32::NAN; 4]), [0; 4]);
        assert_eq!(straight([4e-10, 0.0, 6e-10, 0.0]), [0; 4]);
        // Colour (1, 0.5, 0) at opacity 0.4.
        assert_eq!(straight([0.4, 0.2, 0.0, 0.4]), [255, 188, 0, 102]);
        assert_eq!(straight([0.0, 0.0, 0.0, 1.0]), [0, 0, 0, 255]);
        // Emission: light without opacity shows over black as it is: 0.2 = 1 · 0.2.
        assert_eq!(straight([0.2, 0.1, 0.0, 0.0]), [255, 188, 0, 51]);
        assert_eq!(straight([4.0, 0.5, 0.0, 0.0]), [255, 188, 0, 255]);
    }
}
