//! `Transfer`: what scalars look like.

use std::path::PathBuf;

use cellfan::optics::presets::{OpacityProfile, preset};
use cellfan::{ControlPoint, TransferFunction};
use pyo3::prelude::*;

use crate::error::{raised, refused};

/// A point as Python sees it: value, linear red, green, blue, extinction.
type Point = (f64, (f64, f64, f64), f64);

/// Colour and extinction by value: linear between points (value, (red, green, blue), extinction), values ascending, two at one value a step.
///
/// Colours are linear, from 0; extinction is per unit length of the world. Rows of five numbers do as well.
///
/// >>> transfer = cellfan.Transfer([(0, (1, 0, 0), 0), (2, (0, 0, 1), 8)])
/// >>> transfer(0.5)
/// ((0.75, 0.0, 0.25), 2.0)
#[pyclass(frozen, eq, module = "cellfan")]
#[derive(Clone, PartialEq)]
pub(crate) struct Transfer {
    pub(crate) inner: TransferFunction,
}

fn checked(function: cellfan::Result<TransferFunction>) -> PyResult<Transfer> {
    function.map(|inner| Transfer { inner }).map_err(raised)
}

#[pymethods]
impl Transfer {
    #[new]
    fn new(points: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mut found = Vec::new();
        for (nth, row) in points.try_iter()?.enumerate() {
            let row = row?;
            let [value, r, g, b, extinction] = match row.extract::<(f64, [f64; 3], f64)>() {
                Ok((value, [r, g, b], extinction)) => [value, r, g, b, extinction],
                Err(_) => row.extract().map_err(|_| {
                    refused(format!(
                        "transfer function: point {} is not (value, (red, green, blue), extinction)",
                        nth + 1
                    ))
                })?,
            };
            found.push(ControlPoint { value, color: [r, g, b], extinction });
        }
        checked(TransferFunction::new(found))
    }

    /// One colour and extinction for all values.
    #[staticmethod]
    fn constant(color: [f64; 3], extinction: f64) -> PyResult<Self> {
        checked(TransferFunction::constant(color, extinction))
    }

    /// A colour map ("viridis", "inferno", "cool-warm", "x-ray") over a range of values; extinction rises from 0 to that of
    /// `opacity` over `unit_distance` (a hundredth of the mesh's diagonal is usual).
    #[staticmethod]
    #[pyo3(signature = (name, value_range, unit_distance, *, opacity = 0.1))]
    fn preset(name: &str, value_range: (f64, f64), unit_distance: f64, opacity: f64) -> PyResult<Self> {
        // One value everywhere is a range too.
        let (low, high) = value_range;
        #[expect(clippy::float_cmp, reason = "what is one value, is the same bits")]
        let is_one = low == high;
        let range = if is_one { (low - 0.5, high + 0.5) } else { value_range };
        checked(preset(name, range, OpacityProfile::Ramp { opacity }, unit_distance))
    }

    /// Reads a file: cellfan's JSON or CSV, or a colour map of ParaView's, which is stretched over `value_range`.
    #[staticmethod]
    #[pyo3(signature = (path, value_range = (0.0, 1.0), unit_distance = 1.0))]
    fn read(path: PathBuf, value_range: (f64, f64), unit_distance: f64) -> PyResult<Self> {
        let text = std::fs::read_to_string(&path)?;
        let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        let parsed = TransferFunction::parse(&text, &extension, unit_distance, value_range);
        checked(parsed.map_err(|error| error.in_file(path)))
    }

    /// The points.
    #[getter]
    fn points(&self) -> Vec<Point> {
        self.inner.points().iter().map(|point| (point.value, point.color.into(), point.extinction)).collect()
    }

    /// Colour and extinction at a value.
    fn __call__(&self, value: f64) -> ((f64, f64, f64), f64) {
        let point = self.inner.eval(value);
        (point.color.into(), point.extinction)
    }

    /// The same over another range of values.
    fn stretched(&self, value_range: (f64, f64)) -> PyResult<Self> {
        checked(self.inner.stretched(value_range))
    }

    /// The same with so many times the extinction.
    fn scaled(&self, factor: f64) -> PyResult<Self> {
        checked(self.inner.scaled_extinction(factor))
    }

    fn __repr__(&self) -> String {
        let points = self.inner.points();
        let ends = points.first().zip(points.last()).map(|(first, last)| (first.value, last.value));
        format!("Transfer({} points, values {:?})", points.len(), ends.unwrap_or_default())
    }
}
