//! In: `{"points": [{"value", "color", "extinction" or "opacity"}, …], "unit_distance"}`. Out: a transfer function.

use serde::Deserialize;

use crate::error::Result;
use crate::optics::transfer::{
    ControlPoint, TransferFunction, check_opacity, check_unit_distance, extinction_from_opacity, problem,
};

#[derive(Deserialize)]
struct File {
    points: Vec<Point>,
    unit_distance: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    value: f64,
    color: [f64; 3],
    extinction: Option<f64>,
    opacity: Option<f64>,
}

impl TransferFunction {
    /// Reads control points with linear RGB and an extinction per world unit, or an opacity over the unit distance.
    ///
    /// The file's own `"unit_distance"` (world units) goes before the one handed in.
    ///
    /// ```
    /// # use cellfan::optics::transfer::TransferFunction;
    /// let text = r#"{"points": [{"value": 0, "color": [1, 0.5, 0], "extinction": 3}]}"#;
    /// assert_eq!(TransferFunction::parse_json(text, 1.0)?.eval(9.0).extinction, 3.0);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the text is not such JSON (with line and column), a point has both or neither of extinction and opacity, an opacity
    /// lies outside 0 to 1, the unit distance is not positive; or as [`TransferFunction::new`].
    pub fn parse_json(text: &str, unit_distance: f64) -> Result<Self> {
        let file: File =
            serde_json::from_str(text).map_err(|error| problem(format!("not a list of points: {error}")))?;
        let unit_distance = file.unit_distance.unwrap_or(unit_distance);
        let point = |(i, point): (usize, Point)| {
            let what = || format!("point {}", i + 1);
            let extinction = extinction_of(point.extinction, point.opacity, unit_distance, what)?;
            Ok(ControlPoint { value: point.value, color: point.color, extinction })
        };
        Self::new(file.points.into_iter().enumerate().map(point).collect::<Result<_>>()?)
    }
}

/// The extinction of an entry that has it, or an opacity over the unit distance.
pub(super) fn extinction_of(
    extinction: Option<f64>,
    opacity: Option<f64>,
    unit_distance: f64,
    what: impl Fn() -> String,
) -> Result<f64> {
    match (extinction, opacity) {
        (Some(extinction), None) => Ok(extinction),
        (None, Some(opacity)) => {
            check_unit_distance(unit_distance)?;
            check_opacity(opacity)?;
            Ok(extinction_from_opacity(opacity, unit_distance))
        }
        (Some(_), Some(_)) => Err(problem(format!("{} has both extinction and opacity; leave one out", what()))),
        (None, None) => Err(problem(format!("{} has neither extinction nor opacity", what()))),
    }
}
