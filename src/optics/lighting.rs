//! Light that a medium reflects, by Phong on both sides of its surfaces, whose normals are the gradient of the scalar.
//!
//! In: lights, a gradient, colour. Out: of each light Ka c + Kd c |n·l| + Ks |r·v|ⁿ, times its colour; r is l reflected in n. Absolute values,
//! since most of a volume is translucent and its surfaces are seen from behind. Where the gradient is zero, only ambient light is left.
//! That is linear in the colour c: light of a cell that has one gradient is its emission times one factor and its opacity times another
//! ([`Reflection`]), whatever the integral along a ray is; so [`Lit`] lights every model of emission and absorption.
//!
//! Source: Amidon 1995 (coefficients, both sides, surface strength).

use glam::{DVec3, Vec3};

use super::compositing::{CellSpan, Optics};
use super::lanes::{Contribution, LANES, Segments};
use super::{Integral, Model};
use crate::error::{Error, Result, VolCondition};

/// A light at infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Towards the light, in the world; of any length.
    pub direction: DVec3,
    /// Linear RGB; 1 is as bright as the paper's.
    pub color: [f32; 3],
}

/// Phong's reflection on both sides of what the gradient is normal to.
#[derive(Clone, Debug, PartialEq)]
pub struct Lighting {
    /// Ka: what is lit from everywhere.
    pub ambient: f32,
    /// Kd, times |n·l|.
    pub diffuse: f32,
    /// Ks, times |r·v|ⁿ.
    pub specular: f32,
    /// n.
    pub shininess: f32,
    /// All of them add up; empty for one over the eye's left shoulder.
    pub lights: Vec<Light>,
    /// Extinction is multiplied by the surface strength: the gradient of the scalar over its range, per mean spacing.
    pub has_strength: bool,
    /// What lies between a sample and a light dims its diffuse and specular reflection. On depth planes.
    pub has_shadows: bool,
}

impl Default for Lighting {
    /// The paper's coefficients.
    fn default() -> Self {
        Self {
            ambient: 0.4,
            diffuse: 0.6,
            specular: 0.3,
            shininess: 15.0,
            lights: Vec::new(),
            has_strength: false,
            has_shadows: false,
        }
    }
}

impl Lighting {
    /// Whether all is in range, and the model has light that can be reflected.
    ///
    /// # Errors
    /// [`Error::Option`].
    pub fn check(&self, model: Model) -> Result<()> {
        let bad = |option, problem: String| Err(Error::Option { option, problem });
        if !matches!(model, Model::EmissionAbsorption | Model::Emission) {
            return bad(
                "--shade",
                format!("the {model} model has no light that could be reflected; leave shading out"),
            );
        }
        let coefficients = [
            ("--ambient", self.ambient),
            ("--diffuse", self.diffuse),
            ("--specular", self.specular),
            ("--shininess", self.shininess),
        ];
        for (option, value) in coefficients {
            if !(0.0..=1e4).contains(&value) {
                return bad(option, format!("{value}; from 0 to 10000"));
            }
        }
        for light in &self.lights {
            if light.direction.try_normalize().is_none() {
                let problem = "the light source direction vector is null; expected X,Y,Z[:R,G,B]";
                return bad("--light", VolCondition::NoLight.said(problem));
            }
            if !light.color.iter().all(|channel| (0.0..=1e4).contains(channel)) {
                return bad("--light", format!("{:?}; each channel from 0 on", light.color));
            }
        }
        Ok(())
    }

    /// Whether cells that have one gradient each can be lit so.
    ///
    /// # Errors
    /// [`Error::Option`].
    pub fn check_cells(&self, model: Model, integral: Integral) -> Result<()> {
        self.check(model)?;
        let problem = match model {
            Model::EmissionAbsorption if integral == Integral::Pcp => "pcp is not lit; use --integral exact",
            Model::EmissionAbsorption if self.has_shadows => {
                "shadows are cast on depth planes; leave --shadows out, or use --method depth-planes"
            }
            Model::EmissionAbsorption => return Ok(()),
            _ => "cells are lit by emission-absorption; other models are on depth planes",
        };
        Err(Error::Option { option: "--shade", problem: problem.to_owned() })
    }

    /// The lights of a view that looks along `forward`, `right` and `down` being those of the picture: unit vectors towards them, colours.
    pub fn lamps(&self, [forward, right, down]: [DVec3; 3]) -> Vec<(Vec3, Vec3)> {
        let left_shoulder = -forward.normalize() - 0.6 * right.normalize() - 0.8 * down.normalize();
        let default = [Light { direction: left_shoulder, color: [1.0; 3] }];
        let lights = if self.lights.is_empty() { &default[..] } else { &self.lights };
        lights.iter().map(|light| (light.direction.normalize_or_zero().as_vec3(), light.color.into())).collect()
    }
}

/// The lights of a view, and what surfaces are.
#[derive(Clone, Debug)]
pub struct Lamps {
    ambient: f32,
    diffuse: f32,
    specular: f32,
    shininess: f32,
    /// Unit vectors towards them, and their colours.
    all: Vec<(Vec3, Vec3)>,
}

/// What a cell sends towards the eye, of what it emits and of what it hides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection {
    /// Times its emission.
    pub color: [f32; 3],
    /// Times its opacity.
    pub highlight: [f32; 3],
    /// Times its extinction.
    pub strength: f32,
}

impl Lamps {
    /// Those of a view, whose axes [`Lighting::lamps`] takes.
    pub fn new(lighting: &Lighting, axes: [DVec3; 3]) -> Self {
        let Lighting { ambient, diffuse, specular, shininess, .. } = *lighting;
        Self { ambient, diffuse, specular, shininess, all: lighting.lamps(axes) }
    }

    /// The reflection of a surface with this gradient, of any length, seen from `toward_eye`, a unit vector; of strength 1.
    ///
    /// ```
    /// use cellfan::optics::lighting::{Lamps, Light, Lighting};
    /// use glam::{DVec3, Vec3};
    /// let light = Light { direction: DVec3::Z, color: [1.0, 0.5, 0.0] };
    /// let lamps = Lamps::new(&Lighting { lights: vec![light], ..Lighting::default() }, DVec3::AXES);
    /// // Seen from where the light comes from, face on: Ka + Kd, and the whole highlight.
    /// let reflection = lamps.reflection(Vec3::Z * -7.0, Vec3::Z);
    /// assert_eq!((reflection.color, reflection.highlight), ([1.0, 0.5, 0.0], [0.3, 0.15, 0.0]));
    /// // No gradient: ambient light.
    /// assert_eq!(lamps.reflection(Vec3::ZERO, Vec3::Z).color, [0.4, 0.2, 0.0]);
    /// ```
    pub fn reflection(&self, gradient: Vec3, toward_eye: Vec3) -> Reflection {
        let normal = gradient.try_normalize().unwrap_or(Vec3::ZERO);
        let (mut color, mut highlight) = (Vec3::ZERO, Vec3::ZERO);
        for &(toward, light) in &self.all {
            color += light * self.ambient;
            if normal != Vec3::ZERO {
                let facing = normal.dot(toward);
                let mirrored = normal * (2.0 * facing) - toward;
                color += light * (self.diffuse * facing.abs());
                highlight += light * (self.specular * mirrored.dot(toward_eye).abs().min(1.0).powf(self.shininess));
            }
        }
        Reflection { color: color.to_array(), highlight: highlight.to_array(), strength: 1.0 }
    }
}

/// Says what cells reflect.
pub trait Reflecting: Sync {
    /// Of cell `cell` of the dataset, or cube `cell` of the frame.
    fn of(&self, cell: usize) -> Reflection;
}

/// A model of emission and absorption whose cells reflect light.
///
/// Its contributions are the model's: light and transmittance.
#[derive(Clone, Copy)]
pub struct Lit<'a, O> {
    /// The model.
    pub optics: O,
    /// What its cells reflect.
    pub surfaces: &'a dyn Reflecting,
}

impl<O: Optics> Optics for Lit<'_, O> {
    const IS_ORDERED: bool = O::IS_ORDERED;
    const CLEAR: [f32; 4] = O::CLEAR;

    #[inline(always)]
    fn contributions(&self, span: CellSpan, segments: &[Segments], out: &mut [Contribution]) {
        let Some(cell) = span.cell else { return self.optics.contributions(span, segments, out) };
        let Reflection { color, highlight, strength } = self.surfaces.of(cell);
        let span = span.within(span.length_world_max * strength);
        for (&segments, out) in segments.iter().zip(out) {
            let mut segments = segments;
            for length in &mut segments.length_world {
                *length *= strength;
            }
            self.optics.contributions(span, &[segments], std::slice::from_mut(out));
            for i in 0..LANES {
                let opacity = 1.0 - out[3][i];
                for c in 0..3 {
                    out[c][i] = out[c][i] * color[c] + opacity * highlight[c];
                }
            }
        }
    }

    #[inline(always)]
    fn over(front: [f32; 4], back: [f32; 4]) -> [f32; 4] {
        O::over(front, back)
    }

    fn slipped_in(whole: [f32; 4], behind: [f32; 4], fragment: [f32; 4]) -> Option<[f32; 4]> {
        O::slipped_in(whole, behind, fragment)
    }

    #[inline(always)]
    fn transmittance(contribution: [f32; 4]) -> f32 {
        O::transmittance(contribution)
    }

    fn pixel(&self, contribution: [f32; 4]) -> [f32; 4] {
        self.optics.pixel(contribution)
    }
}
