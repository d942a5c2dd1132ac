//! In: control points (value, colour, extinction). Out: colour and extinction for any value.
//!
//! Piecewise linear, right-continuous where two points at one value make a step, clamped outside. Colours are linear RGB.

use super::thin_points::thin_points;
use crate::error::{Error, Result, presentable};

/// Opacity is limited to this before it becomes an extinction: an opacity of 1 would be infinite.
pub const OPACITY_LIMIT: f64 = 0.9999;

/// Colour and extinction at one scalar value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlPoint {
    /// The scalar.
    pub value: f64,
    /// Linear RGB, 0 or more; 1 is the display's white.
    pub color: [f64; 3],
    /// Per world unit length, 0 or more.
    pub extinction: f64,
}

impl ControlPoint {
    /// Extinction, red, green, blue.
    pub(super) fn channels(&self) -> [f64; 4] {
        [self.extinction, self.color[0], self.color[1], self.color[2]]
    }
}

/// Maps scalar values to colour and extinction; control points in ascending order of value.
///
/// ```
/// # use cellfan::optics::transfer::{ControlPoint, TransferFunction};
/// let transfer = TransferFunction::new(vec![
///     ControlPoint { value: 0.0, color: [1.0, 0.0, 0.0], extinction: 0.0 },
///     ControlPoint { value: 2.0, color: [0.0, 0.0, 1.0], extinction: 8.0 },
/// ])?;
/// assert_eq!(transfer.eval(0.5).extinction, 2.0);
/// assert_eq!(transfer.eval(0.5).color, [0.75, 0.0, 0.25]);
/// assert_eq!(transfer.eval(7.0).extinction, 8.0);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    points: Vec<ControlPoint>,
}

impl TransferFunction {
    /// Checks control points and keeps them as they are.
    ///
    /// # Errors
    ///
    /// If there is none, if one is not finite or out of f32 range, if values descend, or if a colour or extinction is negative;
    /// the message counts points from 1.
    pub fn new(points: Vec<ControlPoint>) -> Result<Self> {
        if points.is_empty() {
            return Err(problem("it has no control points; at least one is needed"));
        }
        for (i, point) in points.iter().enumerate() {
            let number = i + 1;
            if !point.value.is_finite() {
                return Err(problem(format!("value of point {number} is {}; it must be finite", point.value)));
            }
            for (channel, name) in point.channels().into_iter().zip(["extinction", "red", "green", "blue"]) {
                if !(0.0..=f64::from(f32::MAX)).contains(&channel) {
                    return Err(problem(format!(
                        "{name} of point {number} is {channel}; it must be finite, 0 or more"
                    )));
                }
            }
            if i > 0 && point.value < points[i - 1].value {
                let before = points[i - 1].value;
                return Err(problem(format!(
                    "value of point {number} ({}) is below the one before ({before}); values must ascend",
                    point.value
                )));
            }
        }
        Ok(Self { points })
    }

    /// One colour and extinction (per world unit length) for all values: a homogeneous medium.
    ///
    /// # Errors
    ///
    /// As [`TransferFunction::new`].
    pub fn constant(color: [f64; 3], extinction: f64) -> Result<Self> {
        Self::new(vec![ControlPoint { value: 0.0, color, extinction }])
    }

    /// The control points, values ascending.
    pub fn points(&self) -> &[ControlPoint] {
        &self.points
    }

    /// Colour and extinction at a value; at a step what holds above it. NaN gives the first point's.
    pub fn eval(&self, value: f64) -> ControlPoint {
        let above = self.points.partition_point(|point| point.value <= value);
        let at = |point: &ControlPoint| ControlPoint { value, ..*point };
        match (above.checked_sub(1).map(|below| &self.points[below]), self.points.get(above)) {
            (None, _) => at(&self.points[0]),
            (Some(below), None) => at(below),
            (Some(below), Some(above)) => {
                let t = fraction(value, below.value, above.value);
                let mix = |a: f64, b: f64| a * (1.0 - t) + b * t;
                ControlPoint {
                    value,
                    color: std::array::from_fn(|k| mix(below.color[k], above.color[k])),
                    extinction: mix(below.extinction, above.extinction),
                }
            }
        }
    }

    /// The same function with its values mapped linearly from their own range to `range`.
    ///
    /// ```
    /// # use cellfan::optics::transfer::{ControlPoint, TransferFunction};
    /// # let point = |value, extinction| ControlPoint { value, color: [1.0; 3], extinction };
    /// let unit = TransferFunction::new(vec![point(0.0, 0.0), point(1.0, 4.0)])?;
    /// assert_eq!(unit.stretched((10.0, 30.0))?.eval(15.0).extinction, 1.0);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the range is not finite or descends.
    pub fn stretched(&self, range: (f64, f64)) -> Result<Self> {
        check_range(range)?;
        let (first, last) = (self.points[0].value, self.points[self.points.len() - 1].value);
        let stretch = |point: &ControlPoint| {
            let t = if last > first { fraction(point.value, first, last) } else { 0.0 };
            ControlPoint { value: (range.0 * (1.0 - t) + range.1 * t).clamp(range.0, range.1), ..*point }
        };
        Self::new(self.points.iter().map(stretch).collect())
    }

    /// The same function with every extinction multiplied by `factor`.
    ///
    /// # Errors
    ///
    /// If the factor is negative or not finite, or an extinction leaves the range of f32.
    pub fn scaled_extinction(&self, factor: f64) -> Result<Self> {
        let scale = |point: &ControlPoint| ControlPoint { extinction: point.extinction * factor, ..*point };
        Self::new(self.points.iter().map(scale).collect())
    }

    /// The same function with fewer points, within 1/1000 of the range of extinction and of colour; steps stay.
    #[must_use]
    pub fn thinned(&self) -> Self {
        Self { points: thin_points(&self.points) }
    }
}

/// Extinction per world unit length of a medium that has this opacity over `unit_distance` world units.
///
/// ```
/// # use cellfan::optics::transfer::extinction_from_opacity;
/// assert!((extinction_from_opacity(0.5, 2.0) - 0.346_573_6).abs() < 1e-7); // ln 2 / 2
/// ```
pub fn extinction_from_opacity(opacity: f64, unit_distance: f64) -> f64 {
    -(-opacity.min(OPACITY_LIMIT)).ln_1p() / unit_distance
}

/// Where `value` lies between two others, without overflow; `low < high`.
pub(super) fn fraction(value: f64, low: f64, high: f64) -> f64 {
    let width = high - low;
    // Halved only where it must be: half of the smallest number is 0.
    if width.is_finite() { (value - low) / width } else { (0.5 * value - 0.5 * low) / (0.5 * high - 0.5 * low) }
}

/// A range that something can be stretched over.
pub(super) fn check_range(range: (f64, f64)) -> Result<()> {
    if range.0.is_finite() && range.1.is_finite() && range.0 <= range.1 {
        return Ok(());
    }
    Err(problem(format!(
        "cannot be stretched over the values {} to {}; give a finite, ascending range",
        range.0, range.1
    )))
}

/// A unit distance that opacity can be converted with.
pub(super) fn check_unit_distance(unit_distance: f64) -> Result<()> {
    if unit_distance.is_finite() && unit_distance > 0.0 {
        return Ok(());
    }
    Err(problem(format!("unit distance is {unit_distance}; it must be a positive length in world units")))
}

/// An opacity as files give it.
pub(super) fn check_opacity(opacity: f64) -> Result<()> {
    if (0.0..=1.0).contains(&opacity) {
        return Ok(());
    }
    Err(problem(format!("opacity is {opacity}; it must lie between 0 and 1")))
}

pub(super) fn problem(problem: impl Into<String>) -> Error {
    Error::TransferFunction { problem: presentable(problem.into()) }
}

#[cfg(test)]
mod tests;
