//! In: a name from the command line or a file. Out: what a ray computes, and how a segment of it is integrated.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// What a pixel holds; s is the scalar along the ray, κ extinction, c colour.
///
/// ```
/// # use cellfan::optics::model::Model;
/// let model: Model = "emission-absorption".parse().unwrap();
/// assert!(!model.is_order_free());
/// assert_eq!("mip".parse::<Model>().unwrap().to_string(), "mip");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// RGB = ∫ c κ e^(-∫κ) dt, A = 1 - e^(-∫κ); premultiplied.
    #[default]
    EmissionAbsorption,
    /// Transmitted intensity e^(-∫ κ b dt), or its exponent, in four bands of weight b = r, g, b, 1, or of functions of their
    /// own ([`BandTable`](super::BandTable)); a miss is 1, or 0.
    Absorption,
    /// RGB = ∫ c κ dt, A = 0.
    Emission,
    /// RGB = c at the largest s on the ray, A = 1 where the ray meets a cell.
    Mip,
}

impl Model {
    /// Every model, in the order of the documentation.
    pub const ALL: [Self; 4] = [Self::EmissionAbsorption, Self::Absorption, Self::Emission, Self::Mip];

    /// Whether cells may be drawn in any order; the sort is skipped then.
    pub fn is_order_free(self) -> bool {
        self != Self::EmissionAbsorption
    }

    /// Whether a cell of zero extinction can still be seen: nothing may be culled then.
    pub fn shows_transparent_cells(self) -> bool {
        self == Self::Mip
    }

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::EmissionAbsorption => "emission-absorption",
            Self::Absorption => "absorption",
            Self::Emission => "emission",
            Self::Mip => "mip",
        }
    }
}

/// How light and opacity of one segment are computed in emission-absorption, T is exact in `Exact` and `Average`; and, with `Pcp`, in emission.
///
/// ```
/// # use cellfan::optics::model::Integral;
/// assert_eq!("average".parse::<Integral>().unwrap(), Integral::Average);
/// assert_eq!(Integral::default().to_string(), "exact");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integral {
    /// The integral of linear extinction and colour, to 1e-6: [`segment_weights`](super::integral::segment_weights).
    #[default]
    Exact,
    /// The mean colour times the exact opacity: [`segment_weights_average`](super::integral::segment_weights_average).
    Average,
    /// The mean colour times an opacity looked up in a table: [`OpacityTexture`](super::texture::OpacityTexture).
    Texture,
    /// Emission by the mean of both ends, times a length in eight bits of the cell's depth: [`NormalisedLengths`](super::NormalisedLengths).
    Pcp,
}

impl Integral {
    /// Every integral, in the order of the documentation.
    pub const ALL: [Self; 4] = [Self::Exact, Self::Average, Self::Texture, Self::Pcp];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Average => "average",
            Self::Texture => "texture",
            Self::Pcp => "pcp",
        }
    }
}

/// What a pixel of the absorption model holds.
///
/// ```
/// # use cellfan::optics::model::Output;
/// assert_eq!("depth".parse::<Output>().unwrap(), Output::Depth);
/// assert_eq!(Output::Depth.miss(), 0.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Output {
    /// Transmitted intensity e^-τ; a miss is 1.
    #[default]
    Intensity,
    /// Optical depth τ; a miss is 0.
    Depth,
}

impl Output {
    /// Every output, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::Intensity, Self::Depth];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Intensity => "intensity",
            Self::Depth => "depth",
        }
    }

    /// The value of a ray that meets no cell.
    pub fn miss(self) -> f32 {
        match self {
            Self::Intensity => 1.0,
            Self::Depth => 0.0,
        }
    }

    /// The pixel of a ray's optical depths.
    pub(super) fn of_depths(self, depths: [f32; 4]) -> [f32; 4] {
        match self {
            Self::Intensity => depths.map(|depth| (-depth).exp()),
            Self::Depth => depths,
        }
    }
}

/// What is computed for a ray: a model, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Shading {
    /// The optical model.
    pub model: Model,
    /// How a segment is integrated.
    pub integral: Integral,
    /// What absorption puts into a pixel.
    pub output: Output,
    /// Whether extinction is that of bands of their own.
    pub has_bands: bool,
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl fmt::Display for Integral {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Model {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|model| model.name() == name).ok_or_else(|| unknown("--model", name, &Self::ALL))
    }
}

impl FromStr for Integral {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|integral| integral.name() == name);
        found.ok_or_else(|| unknown("--integral", name, &Self::ALL))
    }
}

impl FromStr for Output {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|output| output.name() == name).ok_or_else(|| unknown("--output", name, &Self::ALL))
    }
}

fn unknown(option: &'static str, name: &str, all: &[impl ToString]) -> Error {
    let names: Vec<String> = all.iter().map(ToString::to_string).collect();
    Error::Option { option, problem: format!("there is no {name:?}; choose one of: {}", names.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_the_same_everywhere() {
        for model in Model::ALL {
            assert_eq!(model.name().parse::<Model>().unwrap(), model);
            assert_eq!(serde_json::to_string(&model).unwrap(), format!("\"{model}\""));
        }
        for integral in Integral::ALL {
            assert_eq!(integral.name().parse::<Integral>().unwrap(), integral);
            assert_eq!(serde_json::to_string(&integral).unwrap(), format!("\"{integral}\""));
        }
        for output in Output::ALL {
            assert_eq!(output.name().parse::<Output>().unwrap(), output);
            assert_eq!(serde_json::to_string(&output).unwrap(), format!("\"{output}\""));
        }
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let message = "fog".parse::<Model>().unwrap_err().to_string();
        assert_eq!(
            message,
            "--model: there is no \"fog\"; choose one of: emission-absorption, absorption, emission, mip"
        );
    }
}
