//! Wavelength bands: an extinction of their own for each, as piecewise linear functions of the scalar.
//!
//! In: control points (value, one extinction a band), from a file ([`read`](super::read)) or from code. Out: the extinction of
//! each band for a value; pieces for compositors, so many bands a pass ([`band_pieces`](super::band_pieces)).

use super::transfer::fraction;
use crate::error::{Error, Result, presentable};

/// Extinctions at one scalar value.
#[derive(Clone, Debug, PartialEq)]
pub struct BandPoint {
    /// The scalar.
    pub value: f64,
    /// Per world unit length, 0 or more, one a band.
    pub extinctions: Vec<f64>,
}

/// Maps scalar values to the extinctions of any number of bands: piecewise linear, right-continuous where two points at one value
/// make a step, clamped outside.
///
/// ```
/// # use cellfan::optics::{BandPoint, BandTable};
/// let table = BandTable::new(
///     vec!["soft".into(), "hard".into()],
///     vec![
///         BandPoint { value: 0.0, extinctions: vec![0.0, 0.0] },
///         BandPoint { value: 2.0, extinctions: vec![8.0, 1.0] },
///     ],
/// )?;
/// assert_eq!(table.eval(0.5), [2.0, 0.25]);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BandTable {
    names: Vec<String>,
    points: Vec<BandPoint>,
}

impl BandTable {
    /// Checks names and control points and keeps them as they are.
    ///
    /// # Errors
    ///
    /// [`Error::Bands`] if there is no band or no point, if a name is empty or there twice, if a point has not one extinction for
    /// each band, if a number is not finite or out of f32 range, if values descend, or if an extinction is negative; the message
    /// counts points from 1.
    pub fn new(names: Vec<String>, points: Vec<BandPoint>) -> Result<Self> {
        if names.is_empty() || points.is_empty() {
            let (bands, rows) = (names.len(), points.len());
            return Err(problem(format!("{bands} bands and {rows} control points; at least one of each is needed")));
        }
        for (i, name) in names.iter().enumerate() {
            if name.trim().is_empty() {
                return Err(problem(format!("band {} has no name", i + 1)));
            }
            if names[..i].contains(name) {
                return Err(problem(format!("two bands are called {name:?}; each needs a name of its own")));
            }
        }
        for (i, point) in points.iter().enumerate() {
            check_point(&names, point, i.checked_sub(1).map(|before| &points[before]))
                .map_err(|what| problem(format!("point {}: {what}", i + 1)))?;
        }
        Ok(Self { names, points })
    }

    /// One extinction (per world unit length) a band for all values, the bands called `band1`, `band2` and so on.
    ///
    /// # Errors
    ///
    /// As [`BandTable::new`].
    pub fn constant(extinctions: Vec<f64>) -> Result<Self> {
        Self::new(numbered(extinctions.len()), vec![BandPoint { value: 0.0, extinctions }])
    }

    /// The bands' names, in their order.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The control points, values ascending.
    pub fn points(&self) -> &[BandPoint] {
        &self.points
    }

    /// The extinction of each band at a value; at a step what holds above it. NaN gives the first point's.
    pub fn eval(&self, value: f64) -> Vec<f64> {
        eval(&self.points, value)
    }
}

/// The names of bands that have none.
pub(super) fn numbered(bands: usize) -> Vec<String> {
    (1..=bands).map(|k| format!("band{k}")).collect()
}

/// What one control point must be.
pub(super) fn check_point(names: &[String], point: &BandPoint, before: Option<&BandPoint>) -> Result<(), String> {
    let BandPoint { value, extinctions } = point;
    if extinctions.len() != names.len() {
        return Err(format!("{} extinctions where there are {} bands", extinctions.len(), names.len()));
    }
    if !value.is_finite() {
        return Err(format!("value is {value}; it must be finite"));
    }
    for (extinction, name) in extinctions.iter().zip(names) {
        if !(0.0..=f64::from(f32::MAX)).contains(extinction) {
            return Err(format!("extinction of {name:?} is {extinction}; it must be finite, 0 or more"));
        }
    }
    match before {
        Some(before) if *value < before.value => {
            Err(format!("value {value} is below the one before ({}); values must ascend", before.value))
        }
        _ => Ok(()),
    }
}

/// All columns at a value, which is right-continuous.
pub(super) fn eval(points: &[BandPoint], value: f64) -> Vec<f64> {
    let above = points.partition_point(|point| point.value <= value);
    between(points, above, value)
}

/// All columns just below a value.
pub(super) fn eval_below(points: &[BandPoint], value: f64) -> Vec<f64> {
    let above = points.partition_point(|point| point.value < value);
    between(points, above, value)
}

/// All columns at a value between point `above` and the one before it; those of the only one there is.
fn between(points: &[BandPoint], above: usize, value: f64) -> Vec<f64> {
    match (above.checked_sub(1).map(|below| &points[below]), points.get(above)) {
        (None, _) => points[0].extinctions.clone(),
        (Some(below), None) => below.extinctions.clone(),
        (Some(below), Some(above)) => {
            let t = fraction(value, below.value, above.value);
            let ends = below.extinctions.iter().zip(&above.extinctions);
            ends.map(|(a, b)| a * (1.0 - t) + b * t).collect()
        }
    }
}

pub(super) fn problem(problem: impl Into<String>) -> Error {
    Error::Bands { problem: presentable(problem.into()) }
}

#[cfg(test)]
mod tests;
