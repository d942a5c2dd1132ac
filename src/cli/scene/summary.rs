//! What is said about its choices and about cells that are not drawn as the file has them.

use std::path::Path;

use cellfan::columns::{Association, CellCounts};
use cellfan::profile::{CellStats, Exactness, OrderStats};

use crate::cli::numbers::{count, grouped, short};

/// Everything that is known before the frames.
pub(in crate::cli) struct Summary {
    chosen: String,
    counts: CellCounts,
}

impl Summary {
    /// Notes mesh, array (its name, what it is over, its range), view and transfer function.
    pub(super) fn new(
        path: &Path,
        counts: CellCounts,
        has_arrays: bool,
        (name, association, range): (&str, Association, (f64, f64)),
        (view, transfer): (&str, &str),
    ) -> Self {
        let array = if !has_arrays && range.0 >= range.1 {
            "no array, drawn homogeneous".to_owned()
        } else if name == "homogeneous" {
            "no array that varies, drawn homogeneous".to_owned()
        } else {
            let of = if association == Association::Point { "point" } else { "cell" };
            format!("{of} array \"{name}\", {} to {}", short(range.0), short(range.1))
        };
        let cells = count(counts.in_file, "cell");
        let chosen = format!("{}: {cells}; {array}; {transfer}; {view}", path.display());
        Self { chosen, counts }
    }

    /// Says it, with the order that the frames had.
    pub(in crate::cli) fn say(&self, cells: &CellStats, order: &OrderStats) {
        tracing::info!("{}; {}", self.chosen, in_words(order));
        let remarks = remarks(&self.counts, cells);
        if !remarks.is_empty() {
            tracing::info!("{}", remarks.join("; "));
        }
        tracing::debug!(
            "{} tetrahedra drawn, {} culled as transparent, {} outside the view",
            grouped(cells.drawn),
            grouped(cells.culled_transparent),
            grouped(cells.culled_outside)
        );
    }
}

/// The order and how far it can be trusted.
fn in_words(order: &OrderStats) -> String {
    let exactness = match order.exactness {
        _ if order.kind == "none" && order.exactness == Exactness::Exact => "not needed".to_owned(),
        Exactness::Exact => "exact".to_owned(),
        Exactness::Unverified => format!("by {}, not verified", order.kind),
        Exactness::CyclesBroken(cycles) => format!("by {}, {} broken", order.kind, count(cycles, "cycle")),
        Exactness::CellsOverlap(faces) => format!("by {}, cells overlap at {}", order.kind, count(faces, "face")),
    };
    let misordered = order.misordered_pairs.map(|pairs| format!(" ({} misordered)", count(pairs, "pair")));
    format!("order {exactness}{}", misordered.unwrap_or_default())
}

/// What is not drawn as the file has it.
fn remarks(counts: &CellCounts, cells: &CellStats) -> Vec<String> {
    let all = [
        (counts.lower_dimensional, "without volume by their kind skipped"),
        (counts.ghost, "hidden by vtkGhostType skipped"),
        (counts.unsupported, "of kinds that are not drawn skipped"),
        (counts.split, "split into tetrahedra: another field than the unsplit cells'"),
        (counts.quadratic, "drawn by their corners: their edges are curved in the file"),
    ];
    let drawn = [
        (counts.inverted, "turned: their corners ran the other way"),
        (counts.degenerate, "without volume left out"),
        (cells.invalid, "left out: a value of theirs is not finite"),
    ];
    let remark = |(n, what)| format!("{} {what}", count(n, "cell"));
    all.into_iter().chain(drawn).filter(|&(n, _)| n > 0).map(remark).collect()
}
