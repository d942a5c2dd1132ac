//! `enlarged`: a picture drawn small, at the size that was asked for.
//!
//! Linear between the centres of the small picture's pixels, in premultiplied light; beyond the outermost centres it goes on level.

use rayon::prelude::*;

use crate::camera::Region;
use crate::image::Image;

/// Where the samples of a picture of another size lie, along one axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    pub(super) pixels: u32,
    pub(super) samples: u32,
    /// Whether the outermost samples are the outermost pixels, and not the borders alike.
    pub(super) is_to_the_border: bool,
}

impl Scale {
    /// The sample position of a pixel.
    pub(super) fn sample(self, pixel: u32) -> f64 {
        let (pixels, samples) = (f64::from(self.pixels), f64::from(self.samples));
        if self.pixels == self.samples {
            f64::from(pixel)
        } else if self.is_to_the_border && self.pixels > 1 {
            f64::from(pixel) * (samples - 1.0) / (pixels - 1.0)
        } else {
            (f64::from(pixel) + 0.5) * samples / pixels - 0.5
        }
    }

    /// The pixel nearest to a sample.
    pub(super) fn pixel(self, sample: u32) -> u32 {
        let back = Self { pixels: self.samples, samples: self.pixels, ..self };
        (back.sample(sample) + 0.5).clamp(0.0, f64::from(self.pixels - 1)) as u32
    }

    /// The samples that pixels `from` to before `to` are made of.
    pub(super) fn samples(self, from: u32, to: u32) -> [u32; 2] {
        let last = self.samples - 1;
        let at = |pixel| self.sample(pixel).clamp(0.0, f64::from(last)) as u32;
        [at(from), (at(to - 1) + 1).min(last) + 1]
    }

    /// Two neighbouring samples and the share of the second.
    fn neighbours(self, pixel: u32) -> (u32, u32, f32) {
        let last = self.samples - 1;
        let at = self.sample(pixel).clamp(0.0, f64::from(last));
        let first = at as u32;
        (first, (first + 1).min(last), (at - f64::from(first)) as f32)
    }
}

/// The pixels in `region`, of samples in `drawn`.
pub(super) fn enlarged(small: &Image, drawn: Region, region: Region, scales: [Scale; 2]) -> Image {
    let [width, height] = region.size_px();
    let at = |x: u32, y: u32| small.pixels[((y - drawn.y0) * small.width + x - drawn.x0) as usize];
    let columns: Vec<_> = (region.x0..region.x1).map(|x| scales[0].neighbours(x)).collect();
    let mix = |a: [f32; 4], b: [f32; 4], t: f32| -> [f32; 4] { std::array::from_fn(|c| a[c] + (b[c] - a[c]) * t) };
    let mut image = Image::filled(width, height, [0.0; 4]);
    image.pixels.par_chunks_mut(width as usize).enumerate().for_each(|(row, pixels)| {
        let (top, bottom, down) = scales[1].neighbours(region.y0 + row as u32);
        for (pixel, &(left, right, across)) in pixels.iter_mut().zip(&columns) {
            let row = |y: u32| mix(at(left, y), at(right, y), across);
            *pixel = mix(row(top), row(bottom), down);
        }
    });
    image
}
