//! `bench hexahedra`: Max's counts of projection cases and times (2006, section 6).
//!
//! The paper's meshes are not to be had: half a ball of as many hexahedra stands for the laser target of its figure 13, half a twisted shell
//! of as many for its figure 14, so that times compare and shares of cases only in their kind. Classification is timed alone on one
//! thread, as in the paper; then with the triangles; then whole frames. Checked: every cell has one fate, the triangles of whole
//! cells cover half the area of their projected faces (each ray that enters leaves once), and frames as always.

mod cases;
mod subjects;

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use serde_json::json;

use super::Outcome;
use super::frames::Frames;
use super::record::{Report, value};
use super::session::Session;
use super::spread::Spread;
use super::tables::{Table, digits, none};
use crate::cli::arguments::size;
use crate::cli::numbers::grouped;
pub(super) use cases::Classified;
use cases::Counts;

#[derive(Args)]
pub(super) struct Arguments {
    /// Meshes with hexahedra instead of the generated ones.
    #[arg(value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// A mesh to generate beside the paper's two, or instead of the larger one where it is smaller [default: none].
    #[arg(long, value_name = "N", conflicts_with = "meshes", value_parser = clap::value_parser!(u32).range(300..))]
    max_cells: Option<u32>,
    /// Size of the picture [default: 512x512].
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
}

/// Cases of hexahedra as STATS.json names them, as the paper counts them in its section 6, and by which figure it names them.
const PAPER_COUNTS: [(&str, u64, &str); 8] = [
    ("count1", 78_146, "count 1, standard (figure 5)"),
    ("count1_a", 242, "count 1, alternate A (figure 6)"),
    ("count1_b", 532, "count 1, alternate B (figure 7)"),
    ("count1_c", 16, "count 1, alternate C (figure 8)"),
    ("count1_d", 31, "count 1, alternate D (figure 9)"),
    ("count4", 223, "count 4 (figure 10)"),
    ("count2", 11_333, "count 2 (figure 11)"),
    ("count0", 161, "count 0 (figure 12)"),
];
const PAPER_CELLS: u64 = 141_960;
const PAPER_DEGENERATE: u64 = 50_352;
const PAPER_NOT_CONVEX: u64 = 924;
const PAPER_MACHINE: &str = "one processor of an 800 MHz dual Xeon, nVidia 5900FXUltra";

#[derive(Serialize)]
struct Row {
    mesh: String,
    counts: Counts,
    /// One thread.
    classify: Spread,
    /// One thread.
    classify_and_fans: Spread,
    /// The paper's triangles, in the order of the visibility graph, one thread.
    frame_by_fans_one_thread: Frames,
    frame_by_fans: Frames,
    /// Planes per pixel.
    frame_by_footprints: Frames,
    layers: Option<u32>,
    /// Tetrahedra that cells were cut into.
    tetrahedra: u64,
}

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Outcome<Report> {
    let size_px = arguments.size.unwrap_or(if session.is_quick { [160, 160] } else { [512, 512] });
    let max_cells = arguments.max_cells.unwrap_or(if session.is_quick { 4000 } else { PAPER_CELLS as u32 });
    let subjects = if arguments.meshes.is_empty() {
        subjects::generated(max_cells.into(), session)?
    } else {
        subjects::read(&arguments.meshes)?
    };
    let rows: Vec<Row> =
        subjects.into_iter().map(|subject| subjects::measure(subject, size_px, session)).collect::<Outcome<_>>()?;
    let counts: serde_json::Map<_, _> =
        PAPER_COUNTS.iter().map(|(name, cells, _)| ((*name).to_owned(), json!(cells))).collect();
    Ok(Report {
        benchmark: "hexahedra",
        settings: json!({ "size": size_px, "max_cells": max_cells }),
        results: json!({
            "rows": value(&rows),
            "paper": {
                "source": "Max 2006, section 6",
                "machine": PAPER_MACHINE,
                "figure_13": {
                    "cells": PAPER_CELLS, "degenerate": PAPER_DEGENERATE, "not_convex": PAPER_NOT_CONVEX, "by_case": counts,
                    "seconds": { "read": 0.13, "classify": 3.5, "fans_and_draw": 1.51, "total": 5.27 },
                },
                "figure_14": {
                    "cells": 300, "layers": 43, "hexahedra": 274, "tetrahedra": 156,
                    "seconds": { "sort": 0.19, "classify_and_draw": 0.34, "total": 1.25 },
                },
            },
        }),
        tables: vec![counts_table(&rows), times_table(&rows)],
    })
}

/// How many cells of each case; of the paper those of figure 13.
fn counts_table(rows: &[Row]) -> Table {
    let names: Vec<&str> = rows.iter().map(|row| row.mesh.as_str()).collect();
    let head: Vec<&str> = std::iter::once("cells").chain(names).chain(["Max, figure 13"]).collect();
    let mut table = Table::new("Hexahedra by projection case, in the first view", &head);
    let of_whole =
        |cells: u64, whole: u64| format!("{} ({:.2} %)", grouped(cells), 100.0 * cells as f64 / whole.max(1) as f64);
    let mut line = |name: &str, of: &dyn Fn(&Counts) -> String, theirs: String| {
        table.row([name.to_owned()].into_iter().chain(rows.iter().map(|row| of(&row.counts))).chain([theirs]));
    };
    let whole_of_paper = PAPER_COUNTS.iter().map(|(_, cells, _)| cells).sum();
    line("all", &|counts| grouped(counts.cells), grouped(PAPER_CELLS));
    line("corners coincide", &|counts| grouped(counts.degenerate), grouped(PAPER_DEGENERATE));
    line("cut: a face is concave or crosses itself", &|counts| grouped(counts.split), grouped(PAPER_NOT_CONVEX));
    line("edge-on or without volume", &|counts| grouped(counts.edge_on + counts.absent), none());
    line("whole", &|counts| grouped(counts.whole()), grouped(whole_of_paper));
    for (name, cells, text) in PAPER_COUNTS {
        line(text, &|counts| of_whole(counts.of_case(name), counts.whole()), of_whole(cells, whole_of_paper));
    }
    table.remark("Shares are of whole cells. Max 2006, section 6, cuts the degenerate cells of its mesh beforehand; ours are whole as far as they have a case.");
    table
}

/// What they take.
fn times_table(rows: &[Row]) -> Table {
    let head = [
        "mesh",
        "cells",
        "classify, ns a cell",
        "and triangles",
        "frame, fans, 1 thread, ms",
        "±",
        "of it the order",
        "fans, all threads",
        "footprints, all threads",
        "layers",
        "tetrahedra",
    ];
    let mut table = Table::new("Hexahedra: times", &head);
    for row in rows {
        let per_cell = |time: &Spread| digits(time.median_ms * 1e6 / row.counts.cells as f64);
        let frames = &row.frame_by_fans_one_thread;
        table.row([
            row.mesh.clone(),
            grouped(row.counts.cells),
            per_cell(&row.classify),
            per_cell(&row.classify_and_fans),
            digits(frames.time.median_ms),
            format!("{:.0} %", frames.time.percent() / 2.0),
            frames.stages_ms.get("topological").map_or_else(none, |stage| digits(stage.duration_ms)),
            digits(row.frame_by_fans.time.median_ms),
            digits(row.frame_by_footprints.time.median_ms),
            row.layers.map_or_else(none, |layers| layers.to_string()),
            grouped(row.tetrahedra),
        ]);
    }
    table.row(["Max, figure 13", "141,960", "24,655", "-", "5,010", "-", "-", "-", "-", "-", "-"].map(str::to_owned));
    table.row(["Max, figure 14", "300", "-", "-", "530", "-", "190", "-", "-", "43", "156"].map(str::to_owned));
    table.remark(format!(
        "Max 2006, section 6, on {PAPER_MACHINE}: figure 13 without order, 3.5 s to classify, 1.51 s for triangles and drawing, 0.13 s to \
         read; its total of 5.27 s is 0.13 s more than these. Figure 14: 0.19 s to sort, 0.34 s to classify and draw."
    ));
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_counts_add_up() {
        let whole: u64 = PAPER_COUNTS.iter().map(|(_, cells, _)| cells).sum();
        assert_eq!(whole, 90_684);
        assert_eq!(PAPER_CELLS - PAPER_DEGENERATE - PAPER_NOT_CONVEX, whole);
    }
}
