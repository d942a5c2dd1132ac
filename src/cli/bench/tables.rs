//! Tables for a terminal, in Markdown, so that they can stand in a document as they are.

use std::fmt;

use comfy_table::{CellAlignment, presets};

/// A table with its title and remarks.
pub(super) struct Table {
    title: String,
    body: comfy_table::Table,
    remarks: Vec<String>,
}

impl Table {
    /// A table without rows; the first column is text, the others are numbers.
    pub(super) fn new(title: impl Into<String>, head: &[&str]) -> Self {
        let mut body = comfy_table::Table::new();
        body.load_style(presets::ASCII_MARKDOWN).set_header(head.iter().copied());
        for column in body.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        Self { title: title.into(), body, remarks: Vec::new() }
    }

    pub(super) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.body.add_row(cells);
    }

    /// A sentence under the table.
    pub(super) fn remark(&mut self, text: impl Into<String>) {
        self.remarks.push(text.into());
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n\n{}", self.title, self.body)?;
        self.remarks.iter().try_for_each(|remark| writeln!(f, "\n{remark}"))
    }
}

/// Three significant digits.
pub(super) fn digits(number: f64) -> String {
    match number.abs() {
        size if size >= 99.95 || size == 0.0 => format!("{number:.0}"),
        size if size >= 9.995 => format!("{number:.1}"),
        size if size >= 0.9995 => format!("{number:.2}"),
        size if size >= 0.09995 => format!("{number:.3}"),
        size if size >= 9.995e-4 => format!("{number:.4}"),
        _ => format!("{number:.1e}"),
    }
}

/// A figure of a paper; `-` where it has none.
pub(super) fn digits_or_none(number: Option<f64>) -> String {
    number.map_or_else(none, |number| number.to_string())
}

pub(super) fn none() -> String {
    "-".to_owned()
}

/// A share of 0 to 1.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", digits(100.0 * share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let known = [(0.0, "0"), (1234.5, "1234"), (99.97, "100"), (12.345, "12.3"), (1.2345, "1.23")];
        let small = [(0.12345, "0.123"), (0.012_345, "0.0123"), (0.001_234, "0.0012"), (1.2e-5, "1.2e-5")];
        for (number, text) in known.into_iter().chain(small) {
            assert_eq!(digits(number), text);
        }
        assert_eq!(
            (percent(0.1234), digits_or_none(Some(0.05)), digits_or_none(None)),
            ("12.3 %".to_owned(), "0.05".to_owned(), none())
        );
    }

    #[test]
    fn a_table_is_markdown() {
        let mut table = Table::new("Title", &["name", "ms"]);
        table.row(["a".to_owned(), "1.5".to_owned()]);
        table.remark("Remark.");
        assert_eq!(table.to_string(), "Title\n\n| name |  ms |\n|------|-----|\n| a    | 1.5 |\n\nRemark.\n");
    }
}
