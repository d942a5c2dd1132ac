//! The difference of two pictures, over the pixels that show something.
#![expect(clippy::float_cmp, reason = "a miss is a value that is written, not computed; equal channels differ by 0")]

use super::Image;
use crate::{Error, Result};

/// How far two pictures differ, in linear values, over covered pixels.
///
/// A pixel is covered where either picture differs from the value of a ray that meets no cell. A channel that is NaN
/// on either side differs by infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageDifference {
    /// How many pixels are covered.
    pub covered: u64,
    /// The mean absolute difference over covered pixels and channels.
    pub mean: f64,
    /// The largest absolute difference of any channel.
    pub max: f32,
    /// Column and row of the (first) pixel where it is.
    pub max_at: (u32, u32),
    /// The mean absolute difference of R, G, B and A over covered pixels.
    pub mean_of_channel: [f64; 4],
    /// The largest absolute difference of R, G, B and A.
    pub max_of_channel: [f32; 4],
}

impl ImageDifference {
    /// Whether neither picture shows anything: nothing was compared, whatever the differences say.
    pub fn is_blank(&self) -> bool {
        self.covered == 0
    }
}

impl Image {
    /// Compares two pictures of one size, over covered pixels.
    ///
    /// `miss` is the value of a ray that meets no cell: `[0.0; 4]`, and `[1.0; 4]` in the absorption model.
    ///
    /// # Errors
    /// [`Error::ImageSize`] where the sizes differ.
    ///
    /// ```
    /// # use cellfan::image::Image;
    /// let a = Image::filled(2, 1, [0.5, 0.5, 0.5, 1.0]);
    /// let mut b = a.clone();
    /// b.pixels[1] = [0.5, 0.75, 0.5, 1.0];
    /// let difference = a.difference(&b, [0.0; 4])?;
    /// assert_eq!((difference.max, difference.max_at), (0.25, (1, 0)));
    /// assert_eq!(difference.mean, 0.25 / 8.0);
    /// assert!(!difference.is_blank());
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn difference(&self, other: &Self, miss: [f32; 4]) -> Result<ImageDifference> {
        let (size, other_size) = ((self.width, self.height), (other.width, other.height));
        if size != other_size || self.pixels.len() != other.pixels.len() {
            return Err(Error::ImageSize { size, other_size });
        }
        let mut covered = 0_u64;
        let mut sum = [0.0_f64; 4];
        let mut max_of_channel = [0.0_f32; 4];
        let (mut max, mut max_index) = (0.0_f32, 0);
        for (i, (a, b)) in self.pixels.iter().zip(&other.pixels).enumerate() {
            if *a == miss && *b == miss {
                continue;
            }
            covered += 1;
            for k in 0..4 {
                let difference = channel_difference(a[k], b[k]);
                sum[k] += f64::from(difference);
                max_of_channel[k] = max_of_channel[k].max(difference);
                if difference > max {
                    (max, max_index) = (difference, i);
                }
            }
        }
        let count = covered.max(1) as f64;
        let mean_of_channel = sum.map(|s| s / count);
        let width = self.width.max(1) as usize;
        Ok(ImageDifference {
            covered,
            mean: mean_of_channel.iter().sum::<f64>() / 4.0,
            max,
            max_at: ((max_index % width) as u32, (max_index / width) as u32),
            mean_of_channel,
            max_of_channel,
        })
    }
}

/// |a − b|; 0 for equal infinities, infinity for NaN.
fn channel_difference(a: f32, b: f32) -> f32 {
    let difference = if a == b { 0.0 } else { (a - b).abs() };
    if difference.is_nan() { f32::INFINITY } else { difference }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misses_do_not_dilute_the_mean() {
        let mut a = Image::filled(10, 10, [0.0; 4]);
        let mut b = a.clone();
        a.pixels[37] = [0.5, 0.0, 0.0, 0.5];
        b.pixels[37] = [0.25, 0.0, 0.0, 0.625];
        let d = a.difference(&b, [0.0; 4]).unwrap();
        assert_eq!((d.covered, d.max, d.max_at), (1, 0.25, (7, 3)));
        assert_eq!(d.mean_of_channel, [0.25, 0.0, 0.0, 0.125]);
        assert_eq!(d.max_of_channel, [0.25, 0.0, 0.0, 0.125]);
        assert_eq!(d.mean, 0.375 / 4.0);
    }

    #[test]
    fn blank_pictures_are_equal_and_blank() {
        let misses = Image::filled(3, 2, [1.0; 4]);
        let d = misses.difference(&misses, [1.0; 4]).unwrap();
        assert!(d.is_blank());
        assert_eq!((d.mean, d.max, misses.covered([1.0; 4])), (0.0, 0.0, 0));
        // One blank picture against one that is not must not pass.
        let d = misses.difference(&Image::filled(3, 2, [0.5; 4]), [1.0; 4]).unwrap();
        assert_eq!((d.covered, d.max), (6, 0.5));
    }

    #[test]
    fn one_changed_level_is_found() {
        let a = Image::filled(64, 64, [0.5; 4]);
        let mut b = a.clone();
        b.pixels[64 * 63 + 1][3] = 0.5 + 1.0 / 255.0;
        let d = a.difference(&b, [0.0; 4]).unwrap();
        assert!((d.max - 1.0 / 255.0).abs() < 1e-7 && d.max_at == (1, 63));
    }

    #[test]
    fn nan_is_infinitely_far_even_from_itself() {
        let nan = Image::filled(1, 1, [0.0, f32::NAN, 0.0, 1.0]);
        let d = nan.difference(&nan, [0.0; 4]).unwrap();
        assert_eq!((d.max, d.max_of_channel), (f32::INFINITY, [0.0, f32::INFINITY, 0.0, 0.0]));
        let infinite = Image::filled(1, 1, [f32::INFINITY; 4]);
        assert_eq!(infinite.difference(&infinite, [0.0; 4]).unwrap().max, 0.0);
    }

    #[test]
    fn sizes_must_agree() {
        let error = Image::filled(4, 2, [0.0; 4]).difference(&Image::filled(2, 4, [0.0; 4]), [0.0; 4]).unwrap_err();
        assert_eq!(error.to_string(), "pictures of 4x2 and 2x4 pixels cannot be compared; draw both at one size");
    }
}
