//! `Lit`: light that samples reflect, by Phong on both sides.
//!
//! In: places, their colours. Out: what comes back towards the eye: of each light Ka c + Kd c |n·l| + Ks |r·v|ⁿ, times its colour; r is l
//! reflected in n. Absolute values, since most of a volume is translucent and its surfaces are seen from behind. n is the gradient, which is
//! interpolated as it is, so that strong ones weigh more, and made a unit vector last. Where it is zero, only ambient light is left.

use glam::{DVec3, Vec3};

use super::sample::{Grid, Places, Sampler, gradient};
use super::shadows::LightVolume;
use crate::camera::Frame;
use crate::columns::{Lattice, VolumeField};
use crate::optics::lanes::{LANES, Lanes};
use crate::optics::lighting::Lighting;

/// The lights of a picture, and what a surface is.
pub(super) struct Lit {
    ambient: f32,
    diffuse: f32,
    specular: f32,
    shininess: f32,
    lamps: Vec<Lamp>,
    /// Columns of the matrix from changes per grid step to changes per world unit.
    world_from_steps: [Vec3; 3],
    /// Strength of a gradient per world unit; none where strength is not asked for.
    strength: Option<f32>,
    grid: Grid,
}

/// A light, and how much of it arrives where.
pub(super) struct Lamp {
    pub(super) toward: Vec3,
    color: Vec3,
    pub(super) arriving: Option<LightVolume>,
}

/// Gradients of sixteen samples, and how strong the surfaces are that they are normal to.
pub(super) struct Surfaces {
    normal: [Lanes; 3],
    pub(super) strength: Lanes,
}

impl Lit {
    /// Lights of a view.
    pub(super) fn new(lighting: &Lighting, frame: &Frame, lattice: &Lattice, field: &VolumeField) -> Self {
        let lamps = lighting.lamps([frame.forward, frame.step_x, frame.step_y]);
        let lamps = lamps.into_iter().map(|(toward, color)| Lamp { toward, color, arriving: None });
        let grid_from_world = lattice.grid_from_world().matrix3;
        let (low, high) = field.range;
        let spacing = lattice.volume_of_cell().cbrt();
        let per_range = if high > low { spacing / (high - low) } else { 0.0 };
        Self {
            ambient: lighting.ambient,
            diffuse: lighting.diffuse,
            specular: lighting.specular,
            shininess: lighting.shininess,
            lamps: lamps.collect(),
            // The transpose: a gradient is a covector.
            world_from_steps: [0, 1, 2].map(|axis| grid_from_world.row(axis).as_vec3()),
            strength: lighting.has_strength.then_some(per_range as f32),
            grid: Grid::of(field),
        }
    }

    /// The lights, to find out what of them arrives.
    pub(super) fn lamps_mut(&mut self) -> &mut [Lamp] {
        &mut self.lamps
    }

    /// The surfaces at sixteen places.
    #[inline(always)]
    pub(super) fn surfaces(&self, sampler: &dyn Sampler, at: &Places) -> Surfaces {
        let mut by_step = [[0.0; LANES]; 3];
        gradient(sampler, &self.grid, at, &mut by_step);
        let mut surfaces = Surfaces { normal: [[0.0; LANES]; 3], strength: [1.0; LANES] };
        let [a, b, c] = &self.world_from_steps;
        for l in 0..LANES {
            let of = |axis: usize| by_step[0][l] * a[axis] + by_step[1][l] * b[axis] + by_step[2][l] * c[axis];
            let normal = [of(0), of(1), of(2)];
            for axis in 0..3 {
                surfaces.normal[axis][l] = normal[axis];
            }
            if let Some(strength) = self.strength {
                let squared = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
                let strength = squared.sqrt() * strength;
                surfaces.strength[l] = if strength.is_finite() { strength } else { 0.0 };
            }
        }
        surfaces
    }

    /// What a sample of colour `color` sends towards the eye.
    pub(super) fn reflected(
        &self,
        color: [f32; 3],
        surfaces: &Surfaces,
        at: &Places,
        toward_eye: &[Lanes; 3],
        lane: usize,
    ) -> [f32; 3] {
        let (color, normal) = (Vec3::from(color), Vec3::from(surfaces.normal.map(|axis| axis[lane])));
        let normal = normal.try_normalize().unwrap_or(Vec3::ZERO);
        let toward_eye = Vec3::from(toward_eye.map(|axis| axis[lane]));
        let mut sum = Vec3::ZERO;
        for Lamp { toward, color: light, arriving } in &self.lamps {
            let facing = normal.dot(*toward);
            let mut reflection = Vec3::ZERO;
            if normal != Vec3::ZERO {
                let mirrored = normal * (2.0 * facing) - *toward;
                let highlight = self.specular * mirrored.dot(toward_eye).abs().min(1.0).powf(self.shininess);
                reflection = color * (self.diffuse * facing.abs()) + highlight;
                if let Some(arriving) = arriving {
                    reflection *= arriving.at(at.map(|axis| axis[lane]));
                }
            }
            sum += *light * (color * self.ambient + reflection);
        }
        sum.to_array()
    }
}

impl Lamp {
    /// Towards the light in grid steps.
    pub(super) fn toward_in_grid(&self, lattice: &Lattice) -> DVec3 {
        lattice.grid_from_world().matrix3 * self.toward.as_dvec3()
    }
}
