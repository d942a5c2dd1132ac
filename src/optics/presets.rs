//! In: a name, a value range, an opacity profile. Out: a transfer function. To add one: a line in [`ColorMap`] and its tables.
//!
//! The maps are sRGB (viridis and inferno from the crate `colorous`, cool-warm from its definition in Moreland 2009) and are
//! converted to linear RGB, then thinned.

use std::fmt;
use std::str::FromStr;

use super::color::{Path, between_srgb, linear_from_srgb};
use super::transfer::{
    ControlPoint, TransferFunction, check_opacity, check_range, check_unit_distance, extinction_from_opacity, problem,
};
use crate::error::{Error, Result};

/// Entries in the 8-bit tables of viridis and inferno.
const TABLE: usize = 256;

/// Control points of a preset before thinning. The 8-bit tables are rough at a thousandth, so thinning alone would keep most of
/// their entries; with 33 points the worst channel is off by 0.011 (inferno, linear; measured by the test of this file).
const SAMPLES: usize = 33;

/// A map from 0 to 1 to colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMap {
    /// Dark violet over green to yellow; even in brightness (van der Walt and Smith 2015).
    #[default]
    Viridis,
    /// Black over red to pale yellow (van der Walt and Smith 2015).
    Inferno,
    /// Blue over white to red, for values on both sides of a middle (Moreland 2009).
    CoolWarm,
    /// White throughout, for absorption.
    XRay,
}

impl ColorMap {
    /// Every map, in the order of the documentation.
    pub const ALL: [Self; 4] = [Self::Viridis, Self::Inferno, Self::CoolWarm, Self::XRay];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Viridis => "viridis",
            Self::Inferno => "inferno",
            Self::CoolWarm => "cool-warm",
            Self::XRay => "x-ray",
        }
    }

    /// Linear RGB at t, clamped to 0 to 1.
    ///
    /// ```
    /// # use cellfan::optics::{color::srgb_from_linear, presets::ColorMap};
    /// let end = srgb_from_linear(ColorMap::Viridis.linear(1.0)); // #fde725
    /// assert_eq!(end.map(|c| (c * 255.0).round()), [253.0, 231.0, 37.0]);
    /// ```
    pub fn linear(self, t: f64) -> [f64; 3] {
        let t = if t > 0.0 { t.min(1.0) } else { 0.0 };
        let table = |gradient: &colorous::Gradient| {
            let place = t * (TABLE - 1) as f64;
            let texel = (place as usize).min(TABLE - 2);
            let at = |i: usize| {
                let color = gradient.eval_rational(i, TABLE);
                [color.r, color.g, color.b].map(|c| f64::from(c) / 255.0)
            };
            between_srgb(Path::Rgb, at(texel), at(texel + 1), place - texel as f64)
        };
        linear_from_srgb(match self {
            Self::Viridis => table(&colorous::VIRIDIS),
            Self::Inferno => table(&colorous::INFERNO),
            Self::CoolWarm => {
                let ends = [[59.0, 76.0, 192.0], [180.0, 4.0, 38.0]].map(|end: [f64; 3]| end.map(|c| c / 255.0));
                between_srgb(Path::Diverging, ends[0], ends[1], t)
            }
            Self::XRay => [1.0; 3],
        })
    }
}

impl fmt::Display for ColorMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for ColorMap {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|map| map.name() == name).ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            problem(format!("there is no preset {name:?}; choose one of: {names}, or name a .json or .csv file"))
        })
    }
}

/// How extinction runs over the value range; opacities are per unit distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OpacityProfile {
    /// Extinction 0 at the low end, rising linearly to that of `opacity` at the high end.
    Ramp {
        /// 0 to 1, at the high end.
        opacity: f64,
    },
    /// The same everywhere.
    Constant {
        /// 0 to 1.
        opacity: f64,
    },
}

impl Default for OpacityProfile {
    /// A ramp to opacity 0.1: with the usual unit distance, a hundredth of the diagonal, the highest value has an optical depth
    /// of 10.5 over the diagonal, the middle one of 5.3.
    fn default() -> Self {
        Self::Ramp { opacity: 0.1 }
    }
}

impl OpacityProfile {
    /// Extinction per world unit length at both ends of the range; linear between.
    pub(super) fn ends(self, unit_distance: f64) -> Result<[f64; 2]> {
        check_unit_distance(unit_distance)?;
        let (low, high) = match self {
            Self::Ramp { opacity } => (0.0, opacity),
            Self::Constant { opacity } => (opacity, opacity),
        };
        check_opacity(low).and_then(|()| check_opacity(high))?;
        Ok([low, high].map(|opacity| extinction_from_opacity(opacity, unit_distance)))
    }
}

/// A named colour map over `range`, with extinction from `profile` at a unit distance in world units.
///
/// ```
/// # use cellfan::optics::presets::{OpacityProfile, preset};
/// let ramp = preset("x-ray", (0.0, 8.0), OpacityProfile::Ramp { opacity: 0.5 }, 1.0)?;
/// assert!((ramp.eval(4.0).extinction - 0.346_573_6).abs() < 1e-7); // ln 2 / 2
/// # Ok::<(), cellfan::Error>(())
/// ```
///
/// # Errors
///
/// If the name is unknown (the message lists those there are), the range is not finite and ascending, the unit distance is not
/// positive or the opacity lies outside 0 to 1.
pub fn preset(name: &str, range: (f64, f64), profile: OpacityProfile, unit_distance: f64) -> Result<TransferFunction> {
    let map: ColorMap = name.parse()?;
    let [low, high] = profile.ends(unit_distance)?;
    sampled(map, range, SAMPLES, |t| low * (1.0 - t) + high * t)
}

/// A map over a range with any extinction, thinned.
pub(super) fn sampled(
    map: ColorMap,
    range: (f64, f64),
    samples: usize,
    extinction: impl Fn(f64) -> f64,
) -> Result<TransferFunction> {
    check_range(range)?;
    let point = |i: usize| {
        let t = i as f64 / (samples - 1) as f64;
        let value = (range.0 * (1.0 - t) + range.1 * t).clamp(range.0, range.1);
        ControlPoint { value, color: map.linear(t), extinction: extinction(t) }
    };
    Ok(TransferFunction::new((0..samples).map(point).collect())?.thinned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_covers_its_range_with_few_points() {
        for map in ColorMap::ALL {
            let transfer = preset(map.name(), (-3.0, 5.0), OpacityProfile::default(), 0.01).unwrap();
            let points = transfer.points();
            println!("{map}: {} points", points.len());
            assert!(points.len() <= SAMPLES);
            assert_eq!((points[0].value, points[points.len() - 1].value), (-3.0, 5.0));
            let error = |t: f64| {
                let (got, exact) = (transfer.eval(-3.0 + 8.0 * t), map.linear(t));
                (0..3).map(|k| (got.color[k] - exact[k]).abs()).fold(0.0, f64::max)
            };
            let worst = (0..=1000).map(|i| error(f64::from(i) / 1000.0)).fold(0.0, f64::max);
            println!("{map}: linear colour off by {worst:.4}");
            assert!(worst < 0.012, "{map}: {worst}");
        }
    }

    #[test]
    fn an_unknown_name_lists_the_presets() {
        let message = preset("jet", (0.0, 1.0), OpacityProfile::default(), 1.0).unwrap_err().to_string();
        assert!(message.contains("viridis, inferno, cool-warm, x-ray"), "{message}");
    }

    #[test]
    fn bad_ranges_distances_and_opacities_are_refused() {
        let ramp = OpacityProfile::default();
        assert!(preset("viridis", (1.0, 0.0), ramp, 1.0).is_err());
        assert!(preset("viridis", (f64::NAN, 1.0), ramp, 1.0).is_err());
        assert!(preset("viridis", (0.0, 1.0), ramp, 0.0).is_err());
        assert!(preset("viridis", (0.0, 1.0), OpacityProfile::Ramp { opacity: 1.5 }, 1.0).is_err());
    }

    #[test]
    fn one_value_is_visible() {
        let transfer = preset("viridis", (2.0, 2.0), OpacityProfile::default(), 1.0).unwrap();
        assert!(transfer.eval(2.0).extinction > 0.0);
        assert!(transfer.pieces(0.0).len() <= 2);
    }
}
