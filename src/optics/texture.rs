//! In: a segment's length u and mean extinction v. Out: opacity 1 - e^(-uv), from a table.
//!
//! Schussman and Max 2001, section 7: a texture holds 1 - e^(-uv) at (u, v), the ray's length and the mean of the extinction at
//! its ends are texture coordinates, and the hardware interpolates. The paper gives neither size nor depth of the texture:
//! hardware of the day held 8 bits, so both that and float texels are here. It is kept to reproduce that paper's pictures.

use super::integral::SegmentWeights;
use crate::error::{Error, Result};

/// What a texel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelFormat {
    /// Opacity rounded to 1/255: an opacity below 1/510 is lost.
    EightBit,
    /// Opacity as f32.
    Float,
}

/// An n by n table of 1 - e^(-uv), interpolated bilinearly, clamped at its edges.
///
/// With float texels the error is at most τ²/(8 (n - 1)²), τ the product of both maxima: 2e-4 for n = 256 and τ = 10; eight bits add 1/510.
///
/// ```
/// # use cellfan::optics::texture::{OpacityTexture, TexelFormat};
/// let texture = OpacityTexture::new(256, 2.0, 5.0, TexelFormat::Float)?;
/// assert!((texture.opacity(0.7, 2.0) - 0.753_403).abs() < 2e-4); // 1 - e^-1.4
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct OpacityTexture {
    size: usize,
    texel_per_length: f32,
    texel_per_extinction: f32,
    texels: Vec<f32>,
}

impl OpacityTexture {
    /// A table of `size` by `size` texels (2 to 4096) for lengths up to `length_max` and mean extinctions up to `extinction_max`.
    ///
    /// # Errors
    ///
    /// If the size is out of range or a maximum is not a positive finite number.
    pub fn new(size: usize, length_max: f32, extinction_max: f32, format: TexelFormat) -> Result<Self> {
        let refuse = |problem: String| Err(Error::Option { option: "--integral texture", problem });
        if !(2..=4096).contains(&size) {
            return refuse(format!("a table of {size} by {size} texels; 2 to 4096 are possible"));
        }
        for limit in [length_max, extinction_max] {
            if !(limit.is_finite() && limit > 0.0) {
                return refuse(format!("a table up to {limit}; lengths and extinctions must have a positive limit"));
            }
        }
        let last = (size - 1) as f64;
        let depth = f64::from(length_max) * f64::from(extinction_max);
        let texel = |i: usize| {
            let opacity = -(-depth * ((i % size) as f64 / last) * ((i / size) as f64 / last)).exp_m1();
            match format {
                TexelFormat::EightBit => ((opacity * 255.0).round() / 255.0) as f32,
                TexelFormat::Float => opacity as f32,
            }
        };
        Ok(Self {
            size,
            texel_per_length: (last / f64::from(length_max)) as f32,
            texel_per_extinction: (last / f64::from(extinction_max)) as f32,
            texels: (0..size * size).map(texel).collect(),
        })
    }

    /// Opacity of a segment of this length (world units) and mean extinction (per world unit); clamped to the table.
    pub fn opacity(&self, length: f32, extinction: f32) -> f32 {
        let (column, u) = self.place(length * self.texel_per_length);
        let (row, v) = self.place(extinction * self.texel_per_extinction);
        let along = |row: usize| {
            let at = row * self.size + column;
            self.texels[at] * (1.0 - u) + self.texels[at + 1] * u
        };
        along(row) * (1.0 - v) + along(row + 1) * v
    }

    /// The weights of a segment: mean of the end colours times the opacity.
    pub fn segment_weights(&self, length: f32, k0: f32, k1: f32) -> SegmentWeights {
        let opacity = self.opacity(length, 0.5 * (k0 + k1));
        SegmentWeights { w0: 0.5 * opacity, w1: 0.5 * opacity, transmittance: 1.0 - opacity }
    }

    /// Texels a side.
    pub fn size(&self) -> usize {
        self.size
    }

    /// What a length and an extinction are multiplied by for their place among the texels.
    pub fn texel_per_length_and_extinction(&self) -> [f32; 2] {
        [self.texel_per_length, self.texel_per_extinction]
    }

    /// Opacities, a row of growing length for each extinction.
    pub fn texels(&self) -> &[f32] {
        &self.texels
    }

    /// Texel and fraction towards the next; NaN and below count as 0.
    fn place(&self, texels: f32) -> (usize, f32) {
        let clamped = texels.max(0.0).min((self.size - 1) as f32);
        let texel = (clamped as usize).min(self.size - 2);
        (texel, clamped - texel as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(texture: &OpacityTexture, length_max: f32, extinction_max: f32) -> f64 {
        let mut worst = 0.0_f64;
        for i in 0..=900_u16 {
            for j in 0..=900_u16 {
                let (u, v) = (length_max * f32::from(i) / 900.0, extinction_max * f32::from(j) / 900.0);
                let exact = -(-f64::from(u) * f64::from(v)).exp_m1();
                worst = worst.max((f64::from(texture.opacity(u, v)) - exact).abs());
            }
        }
        worst
    }

    #[test]
    fn the_error_is_what_the_documentation_says() {
        for size in [64, 256] {
            let bound = 100.0 / (8.0 * ((size - 1) * (size - 1)) as f64);
            let float = worst(&OpacityTexture::new(size, 2.0, 5.0, TexelFormat::Float).unwrap(), 2.0, 5.0);
            let eight = worst(&OpacityTexture::new(size, 2.0, 5.0, TexelFormat::EightBit).unwrap(), 2.0, 5.0);
            println!("{size} texels: float {float:.2e} (bound {bound:.2e}), eight bits {eight:.2e}");
            assert!(float < bound + 1e-6 && float > 0.2 * bound);
            assert!(eight < bound + 1.0 / 510.0 + 1e-6 && eight > 1e-3);
        }
    }

    #[test]
    fn outside_the_table_it_clamps() {
        let texture = OpacityTexture::new(16, 1.0, 4.0, TexelFormat::Float).unwrap();
        assert_eq!(texture.opacity(5.0, 9.0), texture.opacity(1.0, 4.0));
        assert_eq!(texture.opacity(-1.0, 2.0), 0.0);
        assert_eq!(texture.opacity(f32::NAN, 2.0), 0.0);
        let weights = texture.segment_weights(0.5, 1.0, 3.0);
        assert!((weights.w0 + weights.w1 + weights.transmittance - 1.0).abs() < 1e-6);
    }

    #[test]
    fn impossible_tables_are_refused() {
        for (size, length, extinction) in [(1, 1.0, 1.0), (5000, 1.0, 1.0), (8, 0.0, 1.0), (8, 1.0, f32::INFINITY)] {
            assert!(OpacityTexture::new(size, length, extinction, TexelFormat::Float).is_err());
        }
    }
}
