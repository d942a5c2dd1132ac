//! In: a colour map as `ParaView` exports it. Out: a transfer function over a value range.
//!
//! `RGBPoints` is a flat list value, r, g, b (sRGB); `Points`, if there, a flat list value, opacity, midpoint, sharpness. Each is
//! stretched by its own range over the array's. Between points a colour takes the path that `ColorSpace` names; an opacity the
//! curve of VTK's `vtkPiecewiseFunction`. Both are sampled 16 times a span, at the same values, and thinned. Colours for NaN, and for
//! values out of range, are not used; HSV always takes the shorter way round.

use serde::Deserialize;
use serde_json::Value;

use crate::error::Result;
use crate::optics::color::{Path, between_srgb, linear_from_srgb};
use crate::optics::presets::OpacityProfile;
use crate::optics::transfer::{
    ControlPoint, TransferFunction, check_opacity, check_range, check_unit_distance, extinction_from_opacity, fraction,
    problem,
};

/// Samples between two points of the file, before thinning.
const SAMPLES: usize = 16;

/// Points of the largest map: each becomes tens of samples, of which memory holds two sides.
const MOST_ROWS: usize = 4096;

#[derive(Deserialize)]
#[serde(rename_all = "PascalCase")]
struct ColorMapFile {
    #[serde(default)]
    name: String,
    color_space: Option<String>,
    #[serde(rename = "RGBPoints")]
    rgb_points: Vec<f64>,
    points: Option<Vec<f64>>,
}

/// Rows of four numbers; the first, stretched to 0 to 1, ascends.
type Rows = Vec<[f64; 4]>;

/// Whether the text is JSON with the marks of a `ParaView` colour map.
pub(super) fn is_paraview(text: &str) -> bool {
    match serde_json::from_str(text) {
        Ok(Value::Array(_)) => true,
        Ok(Value::Object(map)) => map.contains_key("RGBPoints"),
        _ => false,
    }
}

impl TransferFunction {
    /// Reads the first colour map of a `ParaView` export, stretched over `range`; opacities refer to `unit_distance` (world units).
    ///
    /// Without opacities, extinction is the ramp of [`OpacityProfile::default`].
    ///
    /// ```
    /// # use cellfan::optics::transfer::TransferFunction;
    /// let text = r#"[{"ColorSpace": "RGB", "Name": "grey", "RGBPoints": [-1, 0, 0, 0, 1, 1, 1, 1]}]"#;
    /// let grey = TransferFunction::parse_paraview(text, 1.0, (0.0, 10.0))?;
    /// assert!((grey.eval(5.0).color[0] - 0.214).abs() < 2e-3); // sRGB 0.5
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the text is not such JSON, has no colour points, names an unknown colour space, or a number is out of place.
    pub fn parse_paraview(text: &str, unit_distance: f64, range: (f64, f64)) -> Result<Self> {
        check_range(range)?;
        check_unit_distance(unit_distance)?;
        let refuse = |error: serde_json::Error| problem(format!("not a ParaView colour map: {error}"));
        let file: ColorMapFile = match serde_json::from_str(text).map_err(refuse)? {
            Value::Array(maps) => {
                let map = maps.into_iter().find(|map| map.get("RGBPoints").is_some());
                let map = map.ok_or_else(|| problem("none of its colour maps has \"RGBPoints\""))?;
                serde_json::from_value(map).map_err(refuse)?
            }
            map => serde_json::from_value(map).map_err(refuse)?,
        };
        let in_map = |what: String| problem(format!("ParaView colour map {:?}: {what}", file.name));
        let colors = rows(&file.rgb_points, "RGBPoints").map_err(in_map)?;
        if colors.iter().any(|row| row[1..].iter().any(|c| !(0.0..=1.0).contains(c))) {
            return Err(in_map("a colour in RGBPoints lies outside 0 to 1".into()));
        }
        let path = path(file.color_space.as_deref().unwrap_or("RGB")).map_err(in_map)?;
        let opacities = match &file.points {
            Some(points) if !points.is_empty() => Some(rows(points, "Points").map_err(in_map)?),
            _ => None,
        };
        for row in opacities.iter().flatten() {
            check_opacity(row[1])?;
            if row[2..].iter().any(|shape| !(0.0..=1.0).contains(shape)) {
                return Err(in_map("a midpoint or sharpness in Points lies outside 0 to 1".into()));
            }
        }
        let ends = OpacityProfile::default().ends(unit_distance)?;
        let extinction = |t: f64, side: Side| match &opacities {
            Some(rows) => extinction_from_opacity(opacity_at(rows, t, side), unit_distance),
            None => ends[0] * (1.0 - t) + ends[1] * t,
        };
        let mut points = Vec::new();
        for t in sample_places(&[Some(&colors), opacities.as_ref()]) {
            // Both sides of each place: where they differ, that is a step, and where not, one point is enough.
            let at = |side: Side| ControlPoint {
                value: (range.0 * (1.0 - t) + range.1 * t).clamp(range.0, range.1),
                color: linear_from_srgb(color_at(&colors, path, t, side)),
                extinction: extinction(t, side),
            };
            let (below, above) = (at(Side::Below), at(Side::Above));
            if is_step(&below, &above) {
                points.push(below);
            }
            points.push(above);
        }
        Ok(Self::new(points)?.thinned())
    }
}

/// Whether two limits at one place differ by more than the rounding of colour conversions (1e-4).
fn is_step(below: &ControlPoint, above: &ControlPoint) -> bool {
    let jump = |k: usize| (below.color[k] - above.color[k]).abs() > 1e-3;
    let (low, high) = (below.extinction.min(above.extinction), below.extinction.max(above.extinction));
    (0..3).any(jump) || high - low > 1e-3 * high
}

/// Which limit is meant at a step.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Below,
    Above,
}

fn path(color_space: &str) -> Result<Path, String> {
    match color_space.to_ascii_lowercase().as_str() {
        "rgb" => Ok(Path::Rgb),
        "hsv" => Ok(Path::Hsv),
        // CIEDE2000 differs from Lab in how distance is measured; its straight path is close to that of Lab.
        "lab" | "ciede2000" | "lab/ciede2000" => Ok(Path::Lab),
        "diverging" => Ok(Path::Diverging),
        "step" => Ok(Path::Step),
        _ => {
            Err(format!("colour space {color_space:?} is not known; RGB, HSV, Lab, CIEDE2000, Diverging and Step are"))
        }
    }
}

fn rows(numbers: &[f64], name: &str) -> Result<Rows, String> {
    let (rows, rest) = numbers.as_chunks::<4>();
    if rows.is_empty() || !rest.is_empty() {
        return Err(format!("{name} has {} numbers; it needs four a point", numbers.len()));
    }
    if rows.len() > MOST_ROWS {
        return Err(format!("{name} has {} points; at most {MOST_ROWS} are read", rows.len()));
    }
    if !rows.is_sorted_by(|a, b| a[0] <= b[0]) {
        return Err(format!("values in {name} do not ascend"));
    }
    let (first, last) = (rows[0][0], rows[rows.len() - 1][0]);
    let place = |value: f64| if last > first { fraction(value, first, last) } else { 0.0 };
    Ok(rows.iter().map(|row| [place(row[0]), row[1], row[2], row[3]]).collect())
}

/// Where to sample, ascending: the points of all rows and places between them, with both sides of every midpoint.
fn sample_places(all: &[Option<&Rows>]) -> Vec<f64> {
    let mut places = vec![0.0, 1.0];
    for (kind, rows) in all.iter().enumerate() {
        for pair in rows.iter().flat_map(|rows| rows.windows(2)) {
            let (low, high) = (pair[0][0], pair[1][0]);
            places.extend((0..=SAMPLES).map(|i| low + (high - low) * (i as f64 / SAMPLES as f64)));
            if kind == 1 {
                places.push(low + (high - low) * pair[0][2]);
            }
        }
    }
    places.retain(|place| (0.0..=1.0).contains(place));
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

/// The two rows around a place and how far it is from the first to the second.
fn span(rows: &Rows, t: f64, side: Side) -> (&[f64; 4], &[f64; 4], f64) {
    let above = rows.partition_point(|row| if side == Side::Above { row[0] <= t } else { row[0] < t });
    let low = &rows[above.saturating_sub(1)];
    let high = &rows[above.min(rows.len() - 1)];
    let along = if high[0] > low[0] { (t - low[0]) / (high[0] - low[0]) } else { 0.0 };
    (low, high, along)
}

fn color_at(rows: &Rows, path: Path, t: f64, side: Side) -> [f64; 3] {
    let (low, high, along) = span(rows, t, side);
    between_srgb(path, [low[1], low[2], low[3]], [high[1], high[2], high[3]], along)
}

/// VTK's curve between two opacities: straight for sharpness 0, a step at the midpoint for 1, Hermite between.
fn opacity_at(rows: &Rows, t: f64, side: Side) -> f64 {
    let (low, high, along) = span(rows, t, side);
    let (from, to, midpoint, sharpness) = (low[1], high[1], low[2].clamp(1e-5, 1.0 - 1e-5), low[3]);
    let mut s =
        if along < midpoint { 0.5 * along / midpoint } else { 0.5 + 0.5 * (along - midpoint) / (1.0 - midpoint) };
    if sharpness > 0.99 {
        let before = if side == Side::Above { s < 0.5 } else { s <= 0.5 };
        return if before { from } else { to };
    }
    if sharpness < 0.01 {
        return from * (1.0 - s) + to * s;
    }
    let power = 1.0 + 10.0 * sharpness;
    s = if s < 0.5 { 0.5 * (2.0 * s).powf(power) } else { 1.0 - 0.5 * (2.0 * (1.0 - s)).powf(power) };
    let tangent = (1.0 - sharpness) * (to - from);
    let (s2, s3) = (s * s, s * s * s);
    let curve = (2.0 * s3 - 3.0 * s2 + 1.0) * from
        + (3.0 * s2 - 2.0 * s3) * to
        + (s3 - 2.0 * s2 + s) * tangent
        + (s3 - s2) * tangent;
    curve.clamp(from.min(to), from.max(to))
}
