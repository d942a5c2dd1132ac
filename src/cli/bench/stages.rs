//! `bench stages`: each stage alone, on one thread and on all, against the memory bandwidth that as many threads have.
//!
//! A stage's bytes are what it reads and writes, once each, as the library's own profile counts them; what a cache misses beyond that shows as
//! a small share of the bandwidth, and so does arithmetic. Inputs are made outside the timer, memory is reused. Where the
//! library leaves the threads to the backend, blocks of cells are spread over them as the CPU backend does.

mod cells;
mod drawing;
mod order;
mod seen;
mod whole;

use clap::Args;
use serde::Serialize;
use serde_json::json;

use super::Outcome;
use super::bandwidth::Bandwidth;
use super::pool;
use super::record::{Report, value};
use super::session::Session;
use super::spread::{Spread, measure};
use super::tables::{Table, digits, none};
use crate::cli::numbers::{count, grouped};
use crate::cli::progress::Progress;
use cellfan::generate::Kind;
use seen::Seen;

#[derive(Args)]
pub(super) struct Arguments {
    /// Cells of the generated Delaunay mesh; of hexahedra there are a sixth [default: 1000000; with --quick 10000].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1000..))]
    cells: Option<u32>,
    /// Width and height of the picture [default: 1024; with --quick 256].
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(64..=16_384))]
    side: Option<u32>,
}

/// What a cell takes while all this is measured, in bytes.
const BYTES_PER_CELL: u64 = 700;

/// One stage on some threads.
#[derive(Serialize)]
struct Row {
    stage: &'static str,
    /// What is counted: cells, pairs, segments.
    unit: &'static str,
    units: u64,
    threads: usize,
    /// Read and written, once each.
    bytes: u64,
    time: Spread,
    ns_per_unit: f64,
    gb_per_s: f64,
    bandwidth_share: f64,
}

/// A stage's name and what it works on.
#[derive(Clone, Copy)]
struct Stage {
    name: &'static str,
    unit: &'static str,
    units: u64,
    bytes: u64,
}

impl Stage {
    /// A stage that takes so many bytes a cell.
    fn of_cells(name: &'static str, cells: u64, bytes_each: usize) -> Self {
        Self { name, unit: "cells", units: cells, bytes: cells * bytes_each as u64 }
    }
}

/// What is measured, as it goes on.
struct Bench<'a> {
    session: &'a Session,
    /// Of one thread, and of all where these are more.
    bandwidths: Vec<Bandwidth>,
    rows: Vec<Row>,
    progress: Progress,
}

impl Bench<'_> {
    /// Runs a stage on one thread and on all; `prepare` and `check` are not timed.
    fn stage<T: Send>(
        &mut self,
        stage: Stage,
        mut memory: T,
        prepare: impl Fn(&mut T) + Sync,
        work: impl Fn(&mut T) + Sync,
        check: impl Fn(&T) -> Outcome + Sync,
    ) -> Outcome {
        let runs = self.session.runs(11);
        for bandwidth in self.bandwidths.clone() {
            let measured = || measure(self.session, runs, &mut memory, &prepare, &work, &check);
            let time = pool(bandwidth.threads)?.install(measured)?;
            self.add(stage, bandwidth, time);
        }
        self.progress.step();
        Ok(())
    }

    fn add(&mut self, stage: Stage, bandwidth: Bandwidth, time: Spread) {
        let Stage { name, unit, units, bytes } = stage;
        let gb_per_s = bytes as f64 / time.median_ms * 1e-6;
        self.rows.push(Row {
            stage: name,
            unit,
            units,
            threads: bandwidth.threads,
            bytes,
            time,
            ns_per_unit: time.median_ms * 1e6 / units as f64,
            gb_per_s,
            bandwidth_share: gb_per_s / bandwidth.gb_per_s(),
        });
    }
}

/// Stages that are measured, for the bar.
const STAGES: u64 = 22;

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Outcome<Report> {
    let is_quick = session.is_quick;
    let cells = u64::from(arguments.cells.unwrap_or(if is_quick { 10_000 } else { 1_000_000 }));
    let side = arguments.side.unwrap_or(if is_quick { 256 } else { 1024 });
    let mut rows = Vec::new();
    let mut bandwidths = Vec::new();
    if session.admits(&format!("stages on {}", count(cells, "cell")), cells * BYTES_PER_CELL + (1 << 30), 0.0) {
        let all = rayon::current_num_threads();
        {
            let _progress = Progress::running("measuring the memory's bandwidth");
            bandwidths.push(Bandwidth::measure(session, 1)?);
            if all > 1 {
                bandwidths.push(Bandwidth::measure(session, all)?);
            }
        }
        let seen = {
            let _progress = Progress::running(format!("generating {}", count(cells, "cell")));
            Seen::new(Kind::Delaunay, cells, side)?
        };
        let progress = Progress::counting("measuring stages", STAGES);
        let mut bench = Bench { session, bandwidths: bandwidths.clone(), rows: Vec::new(), progress };
        cells::run(&mut bench, &seen)?;
        order::run(&mut bench, &seen)?;
        drawing::run(&mut bench, seen)?;
        whole::run(&mut bench, cells / 6, side)?;
        rows = bench.rows;
    }
    let tables = vec![bandwidth_table(&bandwidths), stages_table(&rows, &bandwidths)];
    Ok(Report {
        benchmark: "stages",
        settings: json!({ "cells": cells, "side_px": side, "generated": "delaunay" }),
        results: json!({ "bandwidth": value(&bandwidths), "rows": value(&rows) }),
        tables,
    })
}

fn bandwidth_table(bandwidths: &[Bandwidth]) -> Table {
    let mut table = Table::new("Memory bandwidth: GB/s", &["threads", "copy", "triad"]);
    for of in bandwidths {
        table.row([of.threads.to_string(), digits(of.copy_gb_per_s), digits(of.triad_gb_per_s)]);
        if of.threads == 1 {
            let mib = of.array_bytes >> 20;
            table.remark(format!(
                "STREAM's copy and triad over arrays of {mib} MiB; the better one is the bandwidth below."
            ));
        }
    }
    table
}

/// A line a stage: one thread, then all.
fn stages_table(rows: &[Row], bandwidths: &[Bandwidth]) -> Table {
    let all = bandwidths.last().map_or(1, |of| of.threads);
    let on_all = |what: &str| format!("{what}, {}", count(all as u64, "thread"));
    let (ns, gb, share) = (on_all("ns each"), on_all("GB/s"), on_all("of bandwidth"));
    let mut head = vec!["stage", "of", "bytes each", "ns each, 1 thread", "±", "GB/s", "of bandwidth"];
    if all > 1 {
        head.extend([ns.as_str(), "±", gb.as_str(), share.as_str()]);
    }
    let mut table = Table::new("Each stage alone", &head);
    for row in rows.iter().filter(|row| row.threads == 1) {
        let of_run = |row: &Row| {
            let is_counted = row.bytes > 0;
            let if_counted = |text: String| if is_counted { text } else { none() };
            [
                digits(row.ns_per_unit),
                format!("{:.0} %", row.time.percent() / 2.0),
                if_counted(digits(row.gb_per_s)),
                if_counted(format!("{:.0} %", 100.0 * row.bandwidth_share)),
            ]
        };
        let bytes = if row.bytes > 0 { digits(row.bytes as f64 / row.units as f64) } else { none() };
        let first = [row.stage.to_owned(), format!("{} {}", grouped(row.units), row.unit), bytes];
        let on_all = rows.iter().find(|other| other.stage == row.stage && other.threads == all && all > 1);
        let cells = first.into_iter().chain(of_run(row)).chain(on_all.into_iter().flat_map(of_run));
        table.row(cells);
    }
    table.remark("Bytes are those a stage reads and writes, once each; ± is half the distance of the quartiles.");
    table
}
