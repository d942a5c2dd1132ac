//! In: the text of a transfer-function file, or of a table of bands. Out: a [`TransferFunction`], a
//! [`BandTable`](super::BandTable). To add a format: a file in `read/` and a line in
//! [`TransferFunction::parse`].
//!
//! Colours: our JSON and CSV hold linear RGB, like the pictures; `ParaView`'s colour maps hold sRGB and are converted.

mod bands;
mod csv;
mod json;
mod materials;
mod paraview;

use super::transfer::{TransferFunction, problem};
use crate::error::Result;

/// Beyond this many control points a file's function is thinned within 1/1000.
const THIN_ABOVE: usize = 100;

impl TransferFunction {
    /// Reads a transfer function whose format is told by the file's extension (`json` or `csv`, any case) and its contents.
    ///
    /// `unit_distance` (world units, usually a hundredth of the mesh's diagonal) is what opacities refer to unless the file
    /// says; `range` is the array's finite value range, over which a `ParaView` colour map is stretched. More than 100 points are
    /// thinned.
    ///
    /// ```
    /// # use cellfan::optics::transfer::TransferFunction;
    /// let text = r#"{"points": [{"value": 0, "color": [1, 1, 1], "opacity": 0.5}], "unit_distance": 2}"#;
    /// let transfer = TransferFunction::parse(text, "json", 0.1, (0.0, 1.0))?;
    /// assert!((transfer.eval(0.0).extinction - 0.346_573_6).abs() < 1e-7); // ln 2 / 2
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the extension is neither, or as the format's own function.
    pub fn parse(text: &str, file_extension: &str, unit_distance: f64, range: (f64, f64)) -> Result<Self> {
        let text = text.trim_start_matches('\u{feff}');
        let transfer = match file_extension.to_ascii_lowercase().as_str() {
            "json" if paraview::is_paraview(text) => Self::parse_paraview(text, unit_distance, range)?,
            "json" if materials::is_materials(text) => Self::parse_materials(text, unit_distance)?,
            "json" => Self::parse_json(text, unit_distance)?,
            "csv" | "txt" => Self::parse_csv(text)?,
            other => {
                return Err(problem(format!("a file ending in {other:?} is not known; give a .json or .csv file")));
            }
        };
        Ok(if transfer.points().len() > THIN_ABOVE { transfer.thinned() } else { transfer })
    }
}

#[cfg(test)]
mod tests;
