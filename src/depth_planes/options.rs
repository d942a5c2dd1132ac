//! What is drawn on depth planes, and how.

use std::str::FromStr;

use crate::backends::cpu::InstructionSet;
use crate::error::{Error, Result};
use crate::optics::lighting::Lighting;
use crate::optics::{Model, Output};

/// Whether values are classified before they are interpolated or after.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Classification {
    /// Colour and extinction of the eight points around a sample are interpolated, each for itself, as the paper does.
    Pre,
    /// The scalar is interpolated, and the transfer function says what it looks like.
    #[default]
    Post,
}

/// How a sample is made of the points around it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Of the eight around it, linear along each axis.
    #[default]
    Trilinear,
    /// Of 64, by the cubic B-spline: smooth, and smoothed; it does not pass through the points.
    BSpline,
    /// Of 64, by the spline of Catmull and Rom: smooth, through the points, and somewhat beyond their range.
    CatmullRom,
}

/// A way to name the variants of an option.
macro_rules! named {
    ($type:ty, $option:literal, $($name:literal => $variant:ident),*) => {
        impl $type {
            /// All, in the order of the documentation.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// The name on the command line.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }
        }

        impl FromStr for $type {
            type Err = Error;

            fn from_str(name: &str) -> Result<Self> {
                let names = || Self::ALL.iter().map(|one| one.name()).collect::<Vec<_>>().join(", ");
                let found = Self::ALL.iter().copied().find(|one| one.name() == name);
                let problem = || format!("there is no {name:?}; choose one of: {}", names());
                found.ok_or_else(|| Error::Option { option: $option, problem: problem() })
            }
        }
    };
}

named!(Classification, "--classify", "pre" => Pre, "post" => Post);
named!(Filter, "--filter", "trilinear" => Trilinear, "b-spline" => BSpline, "catmull-rom" => CatmullRom);

/// How many samples are taken along one axis of the picture, or planes across it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// One a pixel, times [`Options::render_scale`].
    Pixels,
    /// So many that no step from point to point of the grid is passed over, times [`Options::sample_rate`]: across the picture as the
    /// nearest part of the grid needs, and a pixel each at most.
    Nyquist,
    /// So many.
    Count(u32),
}

/// What is drawn on depth planes, and how.
///
/// ```
/// use cellfan::depth_planes::{Options, Samples};
/// let options = Options { samples: [Samples::Pixels, Samples::Pixels, Samples::Count(68)], ..Options::default() };
/// assert!(options.check().is_ok());
/// assert!(Options { sample_rate: -1.0, ..options }.check().is_err());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The optical model.
    pub model: Model,
    /// What an absorption picture holds.
    pub output: Output,
    /// Before or after interpolation.
    pub classification: Classification,
    /// How a sample is made of points.
    pub filter: Filter,
    /// Samples along x and y of the picture, and planes.
    pub samples: [Samples; 3],
    /// Samples a Nyquist sample.
    pub sample_rate: f64,
    /// Samples a pixel along x and y where [`Samples::Pixels`] says so; below 1 the picture is drawn small and enlarged.
    pub render_scale: f64,
    /// The paper's planes, evenly spaced in screen depth, the first and the last at the limits, and its pixels, the outermost of which
    /// lie on the picture's border: 2/(width − 1) apart.
    pub is_vol_compatible: bool,
    /// Samples less opaque than this over the distance of two planes are left out.
    pub opacity_threshold: f32,
    /// A ray ends below this transmittance; 0 never ends one.
    pub stop_transmittance: f32,
    /// Reflected light; none where the medium glows.
    pub lighting: Option<Lighting>,
    /// Draw only this plane, from 0 for the nearest: a cross-section.
    pub only_plane: Option<u32>,
    /// Draw with this instruction set where the processor has it; the picture is the same.
    pub instruction_set: Option<InstructionSet>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            model: Model::EmissionAbsorption,
            output: Output::Intensity,
            classification: Classification::Post,
            filter: Filter::Trilinear,
            samples: [Samples::Pixels, Samples::Pixels, Samples::Nyquist],
            sample_rate: 1.0,
            render_scale: 1.0,
            is_vol_compatible: false,
            opacity_threshold: 0.0,
            stop_transmittance: 1e-5,
            lighting: None,
            only_plane: None,
            instruction_set: None,
        }
    }
}

impl Options {
    /// Whether all is in range and fits together.
    ///
    /// # Errors
    /// [`Error::Option`].
    pub fn check(&self) -> Result<()> {
        let bad = |option, problem: String| Err(Error::Option { option, problem });
        if !(self.sample_rate > 0.0 && self.sample_rate <= 1e4) {
            return bad("--sample-rate", format!("{}; above 0, at most 10000 samples a grid step", self.sample_rate));
        }
        if !(self.render_scale > 0.0 && self.render_scale <= 16.0) {
            return bad("--render-scale", format!("{}; above 0, at most 16 samples a pixel", self.render_scale));
        }
        if self.samples.contains(&Samples::Count(0)) || self.samples[2] == Samples::Pixels {
            return bad(
                "--samples",
                "expected X,Y,PLANES, each a number from 1 on, or auto; X and Y also pixels".to_owned(),
            );
        }
        if !(0.0..1.0).contains(&self.opacity_threshold) {
            return bad("--opacity-threshold", format!("{}; from 0 to below 1", self.opacity_threshold));
        }
        if !(0.0..1.0).contains(&self.stop_transmittance) {
            let problem = format!("{}; a transmittance from 0 (never stop) to below 1", self.stop_transmittance);
            return bad("--stop", problem);
        }
        if self.output == Output::Depth && self.model != Model::Absorption {
            let problem = format!("depth is that of the absorption model, not of {}", self.model);
            return bad("--output", problem);
        }
        if self.filter != Filter::Trilinear && self.classification == Classification::Pre {
            let problem = format!("{} interpolates the scalar; use --classify post", self.filter.name());
            return bad("--filter", problem);
        }
        self.lighting.as_ref().map_or(Ok(()), |lighting| lighting.check(self.model))
    }
}
