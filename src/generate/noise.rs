//! Perlin noise in several octaves (An Image Synthesizer, 1985): smooth random fields of the plane and of space.

use fastnoise_lite::{FastNoiseLite, FractalType, NoiseType};
use glam::{DVec2, DVec3};

/// A random field without a preferred place; its largest features are as wide as its wavelength.
pub(crate) struct Noise {
    noise: FastNoiseLite,
}

impl Noise {
    /// `octaves` of noise, each of half the wavelength and half the strength of the one before.
    pub(crate) fn new(seed: u64, wavelength: f64, octaves: i32) -> Self {
        let mut noise = FastNoiseLite::with_seed((seed ^ seed >> 32) as i32);
        noise.set_noise_type(Some(NoiseType::Perlin));
        noise.set_fractal_type(Some(FractalType::FBm));
        noise.set_fractal_octaves(Some(octaves));
        noise.set_frequency(Some((1.0 / wavelength) as f32));
        Self { noise }
    }

    /// The value at a place of the plane, −1 to 1.
    pub(crate) fn plane(&self, p: DVec2) -> f64 {
        f64::from(self.noise.get_noise_2d(p.x as f32, p.y as f32)).clamp(-1.0, 1.0)
    }

    /// The value at a place of space, −1 to 1.
    pub(crate) fn space(&self, p: DVec3) -> f64 {
        f64::from(self.noise.get_noise_3d(p.x as f32, p.y as f32, p.z as f32)).clamp(-1.0, 1.0)
    }
}

/// 0 below `low`, 1 above `high`, smooth between them.
pub(crate) fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_smooth_has_no_mean_and_depends_on_the_seed() {
        let noise = Noise::new(5, 0.25, 3);
        let at = |i: i32| DVec3::new(f64::from(i) * 0.013, f64::from(i % 7) * 0.11, f64::from(i % 13) * 0.07);
        let values: Vec<f64> = (0..2000).map(|i| noise.space(at(i))).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let most = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        assert!(mean.abs() < 0.05 && most > 0.3 && most <= 1.0, "{mean} {most}");
        let step = noise.space(at(3)) - noise.space(at(3) + DVec3::splat(1e-5));
        assert!(step.abs() < 1e-3, "{step}");
        let other = Noise::new(6, 0.25, 3);
        assert!((0..50).any(|i| (noise.space(at(i)) - other.space(at(i))).abs() > 0.05));
        assert!((noise.plane(DVec2::splat(0.3)) - noise.space(DVec3::new(0.3, 0.3, 0.9))).abs() > 1e-6);
    }
}
