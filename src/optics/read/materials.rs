//! In: `{"materials": [{"name", "from", "to", "color", "extinction" or "opacity"}, …], "unit_distance"}`. Out: a transfer function.

use serde::Deserialize;

use super::json::extinction_of;
use crate::error::Result;
use crate::optics::materials::Material;
use crate::optics::transfer::{TransferFunction, problem};

#[derive(Deserialize)]
struct File {
    materials: Vec<Entry>,
    unit_distance: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    #[serde(default)]
    name: String,
    from: f64,
    to: f64,
    color: [f64; 3],
    extinction: Option<f64>,
    opacity: Option<f64>,
}

/// Whether a JSON file lists materials.
pub(super) fn is_materials(text: &str) -> bool {
    let value: Result<serde_json::Value, _> = serde_json::from_str(text);
    value.is_ok_and(|value| value.get("materials").is_some())
}

impl TransferFunction {
    /// Reads materials: the values at which each is alone, linear RGB, and an extinction per world unit or an opacity over the unit
    /// distance.
    ///
    /// ```
    /// # use cellfan::TransferFunction;
    /// let text = r#"{"materials": [{"name": "air", "from": 0, "to": 1, "color": [0, 0, 0], "extinction": 0},
    ///                              {"name": "bone", "from": 3, "to": 9, "color": [1, 1, 1], "extinction": 8}]}"#;
    /// assert_eq!(TransferFunction::parse(text, "json", 1.0, (0.0, 9.0))?.eval(1.5).extinction, 2.0);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`TransferFunction::parse_json`] and [`TransferFunction::from_materials`].
    pub fn parse_materials(text: &str, unit_distance: f64) -> Result<Self> {
        let file: File =
            serde_json::from_str(text).map_err(|error| problem(format!("not a list of materials: {error}")))?;
        let unit_distance = file.unit_distance.unwrap_or(unit_distance);
        let material = |(i, entry): (usize, Entry)| {
            let what = || format!("material {}", i + 1);
            let extinction = extinction_of(entry.extinction, entry.opacity, unit_distance, what)?;
            Ok(Material { name: entry.name, values: [entry.from, entry.to], color: entry.color, extinction })
        };
        Self::from_materials(&file.materials.into_iter().enumerate().map(material).collect::<Result<Vec<_>>>()?)
    }
}
