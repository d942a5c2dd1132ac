//! In: rows `value k1 k2 … kn`, or `{"bands": [names], "points": [{"value", "extinctions"}, …]}`. Out: a table of bands.

use serde::Deserialize;

use super::csv::{fields_of, is_header};
use crate::error::Result;
use crate::optics::bands::{BandPoint, BandTable, check_point, numbered, problem};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    bands: Option<Vec<String>>,
    points: Vec<Point>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    value: f64,
    extinctions: Vec<f64>,
}

impl BandTable {
    /// Reads a table whose format is told by the file's extension: `json` or `csv`, any case.
    ///
    /// # Errors
    ///
    /// If the extension is neither, or as the format's own function.
    pub fn parse(text: &str, file_extension: &str) -> Result<Self> {
        let text = text.trim_start_matches('\u{feff}');
        match file_extension.to_ascii_lowercase().as_str() {
            "json" => Self::parse_json(text),
            "csv" | "txt" => Self::parse_csv(text),
            other => Err(problem(format!("a file ending in {other:?} is not known; give a .json or .csv file"))),
        }
    }

    /// Reads rows `value k1 k2 … kn` (extinctions per world unit), separated by commas, semicolons, tabs or blanks.
    ///
    /// What follows # is a comment. One row of names may come first: of the scalar, then of each band; without it bands are called
    /// `band1`, `band2` and so on.
    ///
    /// ```
    /// # use cellfan::optics::BandTable;
    /// let table = BandTable::parse_csv("density, 1keV, 2keV  # per metre\n0, 0, 0\n2, 8, 1\n")?;
    /// assert_eq!(table.names(), ["1keV", "2keV"]);
    /// assert_eq!(table.eval(1.0), [4.0, 0.5]);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Bands`](crate::Error::Bands) with the line of a row that is wrong; or as [`BandTable::new`].
    pub fn parse_csv(text: &str) -> Result<Self> {
        let mut names: Vec<String> = Vec::new();
        let mut points: Vec<BandPoint> = Vec::new();
        for (i, line) in text.lines().enumerate() {
            let fields = fields_of(line);
            if fields.is_empty() {
                continue;
            }
            let in_line = |what: String| problem(format!("line {}: {what}", i + 1));
            if names.is_empty() && points.is_empty() {
                let is_header = is_header(&fields);
                names = if is_header {
                    fields[1..].iter().map(ToString::to_string).collect()
                } else {
                    numbered(fields.len() - 1)
                };
                if names.is_empty() {
                    return Err(in_line("one column; a value and at least one extinction are needed".to_owned()));
                }
                if is_header {
                    continue;
                }
            }
            let point = row(&fields, names.len()).map_err(in_line)?;
            check_point(&names, &point, points.last()).map_err(in_line)?;
            points.push(point);
        }
        Self::new(names, points)
    }

    /// Reads `{"bands": ["1keV", "2keV"], "points": [{"value": 0, "extinctions": [8, 1]}, …]}`; `bands` may be left out.
    ///
    /// ```
    /// # use cellfan::optics::BandTable;
    /// let table = BandTable::parse_json(r#"{"points": [{"value": 0, "extinctions": [8, 1]}]}"#)?;
    /// assert_eq!(table.names(), ["band1", "band2"]);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Bands`](crate::Error::Bands) if the text is not such JSON (with line and column); or as [`BandTable::new`].
    pub fn parse_json(text: &str) -> Result<Self> {
        let file: File =
            serde_json::from_str(text).map_err(|error| problem(format!("not a table of bands: {error}")))?;
        let bands = file.points.first().map_or(0, |point| point.extinctions.len());
        let points = file.points.into_iter().map(|Point { value, extinctions }| BandPoint { value, extinctions });
        Self::new(file.bands.unwrap_or_else(|| numbered(bands)), points.collect())
    }
}

fn row(fields: &[&str], bands: usize) -> Result<BandPoint, String> {
    if fields.len() != bands + 1 {
        return Err(format!("{} fields where {} are needed: a value, {bands} extinctions", fields.len(), bands + 1));
    }
    let mut numbers = Vec::with_capacity(fields.len());
    for field in fields {
        numbers.push(field.parse::<f64>().map_err(|_| format!("{field:?} is not a number"))?);
    }
    let extinctions = numbers.split_off(1);
    Ok(BandPoint { value: numbers[0], extinctions })
}
