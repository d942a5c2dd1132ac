//! In: rows `value r g b extinction`. Out: a transfer function.

use crate::error::Result;
use crate::optics::transfer::{ControlPoint, TransferFunction, problem};

impl TransferFunction {
    /// Reads rows `value r g b extinction` (linear RGB, extinction per world unit), separated by commas, semicolons, tabs or blanks.
    ///
    /// What follows # is a comment; one row of names may come first.
    ///
    /// ```
    /// # use cellfan::optics::transfer::TransferFunction;
    /// let transfer = TransferFunction::parse_csv("# fog\n0, 1, 1, 1, 0\n2, 1, 1, 1, 4\n")?;
    /// assert_eq!(transfer.eval(1.0).extinction, 2.0);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If a row does not hold five numbers, with its line; or as [`TransferFunction::new`].
    pub fn parse_csv(text: &str) -> Result<Self> {
        let mut points = Vec::new();
        let mut header_allowed = true;
        for (i, line) in text.lines().enumerate() {
            let fields = fields_of(line);
            if fields.is_empty() {
                continue;
            }
            if std::mem::take(&mut header_allowed) && is_header(&fields) {
                continue;
            }
            points.push(row(&fields).map_err(|what| problem(format!("line {}: {what}", i + 1)))?);
            let last = points.len() - 1;
            check_row(&points[last], last.checked_sub(1).map(|before| &points[before]))
                .map_err(|what| problem(format!("line {}: {what}", i + 1)))?;
        }
        Self::new(points)
    }
}

/// The fields of a line, without its comment.
pub(super) fn fields_of(line: &str) -> Vec<&str> {
    let content = line.split('#').next().unwrap_or_default();
    let fields = content.split(|c: char| c.is_whitespace() || c == ',' || c == ';');
    fields.filter(|field| !field.is_empty()).collect()
}

/// Whether a row holds names. `nan` and `inf` parse as numbers and are refused as such; a header has none.
pub(super) fn is_header(fields: &[&str]) -> bool {
    fields.iter().all(|field| field.parse::<f64>().is_err())
}

fn row(fields: &[&str]) -> Result<ControlPoint, String> {
    if fields.len() != 5 {
        return Err(format!("{} fields where 5 are needed: value r g b extinction", fields.len()));
    }
    let mut numbers = [0.0; 5];
    for (number, field) in numbers.iter_mut().zip(fields) {
        *number = field.parse().map_err(|_| format!("{field:?} is not a number"))?;
    }
    let [value, r, g, b, extinction] = numbers;
    Ok(ControlPoint { value, color: [r, g, b], extinction })
}

/// What [`TransferFunction::new`] checks too, here so that the message names the line.
fn check_row(point: &ControlPoint, before: Option<&ControlPoint>) -> Result<(), String> {
    if let Some(number) = std::iter::once(point.value).chain(point.channels()).find(|number| !number.is_finite()) {
        return Err(format!("{number} is not finite"));
    }
    if let Some(number) = point.channels().into_iter().find(|&number| number < 0.0) {
        return Err(format!("{number} is negative; colours and extinction must be 0 or more"));
    }
    match before {
        Some(before) if point.value < before.value => {
            Err(format!("value {} is below the one before ({}); values must ascend", point.value, before.value))
        }
        _ => Ok(()),
    }
}
