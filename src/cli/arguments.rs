//! Values of options: from text to what the library takes, with a message that says what was expected.

use std::str::FromStr;

use bytesize::ByteSize;
use cellfan::depth_planes::{Light, Samples};
use cellfan::io::RawLayout;
use cellfan::{Error, Region};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// What becomes of cells with more than four corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cells {
    /// They stay as they are.
    Whole,
    /// They are cut.
    Tetrahedra,
}

impl Cells {
    /// Both, as the command line calls them.
    pub(super) const NAMED: [(&str, Self); 2] = [("whole", Self::Whole), ("tetrahedra", Self::Tetrahedra)];
}

/// `N` numbers with commas between them.
fn numbers<const N: usize>(text: &str, expected: &str) -> Result<[f64; N], String> {
    let parsed: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let finite = parsed.filter(|numbers| numbers.iter().all(|number| number.is_finite()));
    finite.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| format!("expected {expected}"))
}

/// `AZIMUTH,ELEVATION` in degrees.
pub(super) fn view(text: &str) -> Result<[f64; 2], String> {
    let [azimuth, elevation] = numbers(text, "AZIMUTH,ELEVATION in degrees, such as 35,20")?;
    if elevation.abs() > 90.0 {
        return Err("the elevation must lie between -90 and 90 degrees".to_owned());
    }
    Ok([azimuth, elevation])
}

/// `R,G,B` in sRGB.
pub(super) fn color(text: &str) -> Result<[f32; 3], String> {
    let color: [f64; 3] = numbers(text, "R,G,B from 0 to 1, such as 0,0,0.2")?;
    if color.iter().any(|channel| !(0.0..=1.0).contains(channel)) {
        return Err("each of R,G,B must lie between 0 and 1".to_owned());
    }
    Ok(color.map(|channel| channel as f32))
}

/// How a raw volume is written.
pub(super) fn raw_layout(text: &str) -> Result<RawLayout, String> {
    text.parse().map_err(problem_of)
}

/// `X,Y,Z`, from sample to sample.
pub(super) fn spacing(text: &str) -> Result<[f64; 3], String> {
    let spacing: [f64; 3] = numbers(text, "X,Y,Z in world units, such as 1,1,2.5")?;
    if spacing.contains(&0.0) { Err("samples must not stand in one place".to_owned()) } else { Ok(spacing) }
}

/// What an error about an option says, without its name.
fn problem_of(error: Error) -> String {
    match error {
        Error::Option { problem, .. } => problem,
        other => other.to_string(),
    }
}

/// A colour as displays take it, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Srgb(pub(super) [f32; 3]);

impl Srgb {
    /// The linear intensities.
    pub(super) fn linear(self) -> [f32; 3] {
        self.0.map(cellfan::image::linear_from_srgb)
    }
}

/// `#rrggbb`, or `R,G,B` in sRGB.
pub(super) fn srgb(text: &str) -> Result<Srgb, String> {
    let Some(digits) = text.strip_prefix('#') else {
        return color(text).map(Srgb).map_err(|problem| format!("{problem}, or #rrggbb"));
    };
    let is_whole = digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    let number = u32::from_str_radix(digits, 16).ok().filter(|_| is_whole);
    let number = number.ok_or("expected #rrggbb with six hexadecimal digits, such as #b4b8c0")?;
    Ok(Srgb([16, 8, 0].map(|shift| (number >> shift & 0xff) as f32 / 255.0)))
}

/// A width in pixels.
pub(super) fn pixels(text: &str) -> Result<f32, String> {
    let most = cellfan::geometry::GeometryOptions::MAX_PX;
    let expected = || format!("expected a width from 1 to {most} pixels");
    text.parse().ok().filter(|px| (1.0..=most).contains(px)).ok_or_else(expected)
}

/// `WIDTHxHEIGHT` in pixels.
pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    let max = cellfan::Camera::MAX_SIDE;
    match sides {
        Some(sides) if sides.iter().all(|side| (1..=max).contains(side)) => Ok(sides),
        Some(_) => Err(format!("each side must be 1 to {max} pixels")),
        None => Err("expected WIDTHxHEIGHT in pixels, such as 1024x768".to_owned()),
    }
}

/// `X0,Y0,X1,Y1` in pixels.
pub(super) fn region(text: &str) -> Result<Region, String> {
    text.parse().map_err(problem_of)
}

/// A transmittance at which a ray may end.
pub(super) fn transmittance(text: &str) -> Result<f32, String> {
    let expected = "expected a transmittance from 0 (never stop) to below 1, such as 1e-5";
    text.parse().ok().filter(|t| (0.0..1.0).contains(t)).ok_or_else(|| expected.to_owned())
}

/// A positive length.
pub(super) fn length(text: &str) -> Result<f64, String> {
    let expected = "expected a positive length in world units";
    text.parse().ok().filter(|&length: &f64| length.is_finite() && length > 0.0).ok_or_else(|| expected.to_owned())
}

/// A number of bytes, such as `300M` or `1.5Gi`.
pub(super) fn bytes(text: &str) -> Result<u64, String> {
    let expected = "expected a number of bytes, with k, M, G for powers of 1000 or Ki, Mi, Gi for powers of 1024";
    text.parse().map(|bytes: ByteSize| bytes.as_u64()).map_err(|_| expected.to_owned())
}

/// A positive factor.
pub(super) fn factor(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|&factor: &f64| factor.is_finite() && factor > 0.0)
        .ok_or_else(|| "expected a number above 0".to_owned())
}

/// A number that is not negative.
pub(super) fn number(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|&number: &f32| number.is_finite() && number >= 0.0)
        .ok_or_else(|| "expected a number from 0 on".to_owned())
}

/// `X,Y,PLANES`: numbers, `auto` or `pixels`.
pub(super) fn samples(text: &str) -> Result<[Samples; 3], String> {
    let one = |(axis, text): (usize, &str)| match text.trim() {
        "auto" => Some(Samples::Nyquist),
        "pixels" if axis < 2 => Some(Samples::Pixels),
        number => number.parse().ok().filter(|&count: &u32| count > 0).map(Samples::Count),
    };
    let three: Option<Vec<Samples>> = text.split(',').enumerate().map(one).collect();
    three.and_then(|three| three.try_into().ok()).ok_or_else(|| {
        "expected X,Y,PLANES, each a number from 1 on or auto, X and Y also pixels, such as pixels,pixels,200"
            .to_owned()
    })
}

/// `X,Y,Z[:R,G,B]`: towards a light, and its linear colour.
pub(super) fn light(text: &str) -> Result<Light, String> {
    let expected = "X,Y,Z[:R,G,B], the direction towards the light and its colour, such as 1,-1,2:1,0.9,0.8";
    let (direction, color) = text.split_once(':').map_or((text, None), |(direction, color)| (direction, Some(color)));
    let direction: [f64; 3] = numbers(direction, expected)?;
    let color = color.map_or(Ok([1.0; 3]), |color| numbers(color, expected))?;
    if direction.iter().all(|&along| along == 0.0) {
        return Err("the direction towards the light is null (Vol's error 113)".to_owned());
    }
    if color.iter().any(|&channel| channel < 0.0) {
        return Err("the light's colour must not be negative".to_owned());
    }
    Ok(Light { direction: direction.into(), color: color.map(|channel| channel as f32) })
}

/// A share that is not negative: 18% or 0.18.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let (number, scale) = text.strip_suffix('%').map_or((text, 1.0), |percent| (percent, 100.0));
    let share = number.trim().parse().ok().filter(|&number: &f64| number.is_finite() && number >= 0.0);
    share
        .map(|share| share / scale)
        .ok_or_else(|| "expected a share that is not negative, such as 18% or 0.18".to_owned())
}

/// A finite number.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| "expected a number".to_owned())
}

/// One of a list of names, each of which stands for a value.
pub(super) fn one_of<T>(choices: impl IntoIterator<Item = (&'static str, T)>) -> impl TypedValueParser<Value = T>
where
    T: Clone + Send + Sync + 'static,
{
    let choices: Vec<_> = choices.into_iter().collect();
    let names: Vec<_> = choices.iter().map(|&(name, _)| PossibleValue::new(name)).collect();
    PossibleValuesParser::new(names).try_map(move |given: String| {
        let found = choices.iter().find(|&&(name, _)| name == given);
        found.map(|(_, value)| value.clone()).ok_or("no such value")
    })
}

/// Those of a list of names that the library parses itself, with a line of help each.
pub(super) fn named<T>(
    choices: impl IntoIterator<Item = (&'static str, &'static str)>,
) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = cellfan::Error> + Clone + Send + Sync + 'static,
{
    let values = choices.into_iter().map(|(name, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(values).try_map(|given| given.parse::<T>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_colors_and_sizes() {
        assert_eq!(view("-35, 20.5"), Ok([-35.0, 20.5]));
        assert_eq!(color("0,0.5,1"), Ok([0.0, 0.5, 1.0]));
        assert_eq!(size("64x32768"), Ok([64, 32_768]));
        for bad in ["", "1", "1,2,3", "1,x", "nan,0", "inf,0", "0,91"] {
            assert!(view(bad).is_err(), "{bad}");
        }
        for bad in ["", "0,0", "0,0,255", "-1,0,0", "red"] {
            assert!(color(bad).is_err(), "{bad}");
        }
        for bad in ["", "64", "0x5", "5x0", "64x32769", "-1x5", "5 x 5", "5x5x5"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn colors_of_geometry_and_widths() {
        assert_eq!(srgb("#ff8000"), Ok(Srgb([1.0, 128.0 / 255.0, 0.0])));
        assert_eq!(srgb("0,0.5,1"), Ok(Srgb([0.0, 0.5, 1.0])));
        assert!((Srgb([0.5, 1.0, 0.0]).linear()[0] - 0.214_041).abs() < 1e-5);
        assert!(
            ["", "#", "#fff", "#ff80000", "#gg0000", "#+f0000", "red", "2,0,0"].iter().all(|bad| srgb(bad).is_err())
        );
        assert_eq!(pixels("1.5"), Ok(1.5));
        assert!(["0.5", "65", "-1", "nan", ""].iter().all(|bad| pixels(bad).is_err()));
    }

    #[test]
    fn samples_and_lights() {
        assert_eq!(samples("pixels,auto,68"), Ok([Samples::Pixels, Samples::Nyquist, Samples::Count(68)]));
        assert!(
            ["", "1,1", "1,1,0", "1,1,pixels", "1,1,-1", "1,1,1,1", "a,1,1"].iter().all(|bad| samples(bad).is_err())
        );
        let lit = light("0,-1,2:1,0.5,0").unwrap();
        assert_eq!((lit.direction.to_array(), lit.color), ([0.0, -1.0, 2.0], [1.0, 0.5, 0.0]));
        assert_eq!(light("1,0,0").map(|light| light.color), Ok([1.0; 3]));
        assert!(["", "0,0,0", "1,0", "1,0,0:", "1,0,0:1,1", "1,0,0:-1,0,0"].iter().all(|bad| light(bad).is_err()));
        assert_eq!((share("18%"), share("0.18"), share("0")), (Ok(0.18), Ok(0.18), Ok(0.0)));
        assert!(["", "%", "-1%", "nan", "inf%", "18 percent"].iter().all(|bad| share(bad).is_err()));
        assert!(factor("0").is_err() && factor("0.25").is_ok() && number("-1").is_err() && number("0").is_ok());
    }

    #[test]
    fn regions() {
        assert_eq!(region("0,5, 32768,7").map(Region::size_px), Ok([32_768, 2]));
        for bad in ["", "0,0,5", "0,0,5,5,5", "-1,0,5,5", "0,0,x,5", "0,0,1.5,2"] {
            assert!(region(bad).is_err_and(|problem| problem.starts_with("expected X0,Y0,X1,Y1")), "{bad}");
        }
    }

    #[test]
    fn bytes_with_their_units() {
        assert_eq!((bytes("4096"), bytes("20k"), bytes("1.5M")), (Ok(4096), Ok(20_000), Ok(1_500_000)));
        assert_eq!((bytes("2G"), bytes("2Gi"), bytes("3 MiB")), (Ok(2_000_000_000), Ok(2 << 30), Ok(3 << 20)));
        assert_eq!((bytes("1Ki"), bytes("1KB"), bytes("0")), (Ok(1024), Ok(1000), Ok(0)));
        for bad in ["", "-1", "M", "1X", "nan", "1 2"] {
            assert!(bytes(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_in_their_ranges() {
        assert_eq!((transmittance("0"), transmittance("1e-3")), (Ok(0.0), Ok(1e-3)));
        assert!(["1", "-1e-9", "nan", "x"].iter().all(|bad| transmittance(bad).is_err()));
        assert_eq!(length("2.5"), Ok(2.5));
        assert!(["0", "-1", "inf", "nan", ""].iter().all(|bad| length(bad).is_err()));
        assert!(finite("-360").is_ok() && finite("inf").is_err());
    }
}
