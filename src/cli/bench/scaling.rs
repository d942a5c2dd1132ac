//! `bench scaling`: how frames grow with cells, in one picture and in one that grows with them, with threads and with pixels.
//!
//! Jittered grids of tetrahedra, written as containers and used in place, as meshes too large for other formats are. Checked: frames as always;
//! the same bytes on any number of threads; the same share of the picture for any number of cells or pixels.
//!
//! *Of one size on screen*: the picture's side grows with the cubic root of the cells, so a cell covers as many pixels in every row, and
//! lies in front of more others. What a cell costs then is what scales; in one picture small cells cost less than large ones.

use std::path::PathBuf;

use cellfan::generate::{Kind, Settings, source};
use cellfan::io::container::{self, WriteOptions};
use cellfan::{Error, FieldSelection, RenderOptions, Scene};
use clap::Args;
use serde::Serialize;
use serde_json::json;

use super::device::{Device, DeviceArguments};
use super::frames::{Frames, Shots};
use super::record::{Report, value};
use super::session::Session;
use super::subject::Subject;
use super::tables::{Table, digits, none};
use super::{Outcome, ensure, pool};
use crate::cli::numbers::{count, grouped};
use crate::cli::progress::Progress;

#[derive(Args)]
pub(super) struct Arguments {
    /// The largest of the meshes, which start at 100,000 cells and grow tenfold [default: 100000000; with --quick 20000].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1000..))]
    max_cells: Option<u32>,
    /// Cells of the mesh that is drawn by more threads and at more pixels [default: 1000000, or --max-cells].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1000..))]
    cells: Option<u32>,
    /// The largest side of the pictures, which start at 256x256 and double [default: 4096; with --quick 256].
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(64..=16_384))]
    max_side: Option<u32>,
    /// Where generated meshes are put for the time being, 19 bytes a cell [default: the system's folder for such files].
    #[arg(long, value_name = "FOLDER")]
    folder: Option<PathBuf>,
    #[command(flatten)]
    device: DeviceArguments,
}

/// The smallest mesh.
const FIRST_CELLS: u64 = 100_000;
/// The smallest picture, and that of meshes and threads.
const SIDES: (u32, u32) = (256, 1024);
/// The side of the picture in which a cell of a million is of the size that all have; cells cover some ten pixels then.
const SIDE_OF_A_MILLION: f64 = 512.0;
/// The fewest cells whose cost is compared: fewer leave threads without work.
const FEWEST_COMPARED: u64 = 900_000;
/// What writing a mesh takes.
const WRITING_BYTES: u64 = 1 << 30;
/// What a frame takes a cell beside the mapped file, which should stay in memory too, and a pixel.
const BYTES: (u64, u64) = (27 + 19, 100);

#[derive(Serialize)]
struct Row {
    cells: u64,
    threads: usize,
    size_px: [u32; 2],
    frames: Frames,
    ns_per_cell: f64,
    cells_per_s: f64,
    megapixels_per_s: f64,
}

impl Row {
    fn new(threads: usize, size_px: [u32; 2], frames: Frames) -> Self {
        let (cells, seconds) = (frames.cells.total, frames.time.median_s());
        Self {
            cells,
            threads,
            size_px,
            ns_per_cell: seconds * 1e9 / cells as f64,
            cells_per_s: cells as f64 / seconds,
            megapixels_per_s: f64::from(size_px[0]) * f64::from(size_px[1]) / seconds * 1e-6,
            frames,
        }
    }
}

/// A mesh that is used in place.
struct Generated {
    scene: Scene,
    /// Dropped after it.
    _folder: Option<tempfile::TempDir>,
}

/// What is measured with.
struct Bench<'a> {
    session: &'a mut Session,
    device: Device,
    folder: PathBuf,
}

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Outcome<Report> {
    let device = Device::find(&arguments.device)?;
    let is_quick = session.is_quick;
    let max_cells = u64::from(arguments.max_cells.unwrap_or(if is_quick { 20_000 } else { 100_000_000 }));
    let cells = arguments.cells.map_or(1_000_000.min(max_cells), u64::from);
    let max_side = arguments.max_side.unwrap_or(if is_quick { 256 } else { 4096 });
    let folder = arguments.folder.clone().unwrap_or_else(std::env::temp_dir);
    let device_name = device.to_json();
    let mut bench = Bench { session, device, folder };
    let fixed = bench.scene(cells, 0.0)?;
    let (mut by_threads, mut by_pixels) = (Vec::new(), Vec::new());
    if let Some(Generated { scene, .. }) = &fixed {
        by_threads = bench.by_threads(scene, SIDES.1.min(max_side))?;
        by_pixels = bench.by_pixels(scene, max_side)?;
    }
    drop(fixed);
    let (by_cells, of_one_size) = bench.by_cells(max_cells, SIDES.1.min(max_side))?;
    Ok(Report {
        benchmark: "scaling",
        settings: json!({ "max_cells": max_cells, "cells": cells, "max_side": max_side, "device": device_name, "generated": "tets" }),
        results: json!({ "by_cells": value(&by_cells), "of_one_size": value(&of_one_size), "by_threads": value(&by_threads), "by_pixels": value(&by_pixels) }),
        tables: vec![
            cells_table(&by_cells),
            size_table(&of_one_size),
            threads_table(&by_threads),
            pixels_table(&by_pixels),
        ],
    })
}

impl Bench<'_> {
    /// A generated mesh, used in place; none where it does not fit.
    fn scene(&mut self, cells: u64, expected_s: f64) -> Outcome<Option<Generated>> {
        let needs = (cells * BYTES.0).max(WRITING_BYTES.min(cells * 140));
        if !self.session.admits(&format!("a mesh of {}", count(cells, "cell")), needs, expected_s) {
            return Ok(None);
        }
        let _progress = Progress::running(format!("generating {}", count(cells, "cell")));
        let at = |error: std::io::Error| Error::Io { path: self.folder.clone(), source: error };
        let folder = tempfile::Builder::new().prefix("cellfan-bench").tempdir_in(&self.folder).map_err(at)?;
        let path = folder.path().join("mesh.cells");
        let settings = Settings { cells, ..Settings::default() };
        container::write(source(Kind::Tets, &settings)?.as_ref(), &path, &WriteOptions::default(), &|_, _, _| {})?;
        let mut dataset = container::open(&path, true)?;
        let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays))?;
        dataset.arrays = Vec::new();
        // The map outlives its file's name where the system allows that: nothing is left behind, however the program ends.
        let folder = (!cfg!(unix)).then_some(folder);
        let subject = Subject { name: String::new(), dataset, field };
        let transfer = subject.ramp(0.0)?;
        let scene = Scene::new(subject.dataset, subject.field, &transfer);
        Ok(Some(Generated { scene, _folder: folder }))
    }

    fn draw(&self, scene: &Scene, side: u32, usual_runs: usize) -> Outcome<Frames> {
        let options = RenderOptions::default();
        let name = format!("{} at {side}x{side}", count(scene.dataset().cells() as u64, "cell"));
        let shots = Shots { scene, name: &name, size_px: [side; 2], options, runs: self.session.runs(usual_runs) };
        shots.draw(self.session, &mut self.device.renderer(options))
    }

    /// All meshes in pictures of one size, and in such that their cells are of one size.
    fn by_cells(&mut self, max_cells: u64, side: u32) -> Outcome<(Vec<Row>, Vec<Row>)> {
        let mut sizes: Vec<u64> =
            (0..5).map(|power| FIRST_CELLS * 10_u64.pow(power)).take_while(|&cells| cells <= max_cells).collect();
        if sizes.is_empty() {
            sizes.push(max_cells);
        }
        let (mut rows, mut of_one_size, mut last_s): (Vec<Row>, Vec<Row>, f64) = (Vec::new(), Vec::new(), 0.0);
        for cells in sizes {
            let start = std::time::Instant::now();
            let Some(Generated { scene, .. }) = &self.scene(cells, 10.0 * last_s)? else { continue };
            let _progress = Progress::running(format!("drawing {}", count(cells, "cell")));
            let usual = if cells > 2_000_000 { 5 } else { 11 };
            let draw = |rows: &mut Vec<Row>, side: u32| -> Outcome {
                rows.push(Row::new(rayon::current_num_threads(), [side; 2], self.draw(scene, side, usual)?));
                Ok(())
            };
            draw(&mut rows, side)?;
            let side = SIDE_OF_A_MILLION * (scene.dataset().cells() as f64 * 1e-6).cbrt();
            draw(&mut of_one_size, side.round() as u32)?;
            last_s = start.elapsed().as_secs_f64();
        }
        same_cover(&rows)?;
        same_cover(&of_one_size)?;
        Ok((rows, of_one_size))
    }

    /// One thread, two, four … and all.
    fn by_threads(&mut self, scene: &Scene, side: u32) -> Outcome<Vec<Row>> {
        let all = rayon::current_num_threads();
        let numbers = (0..).map(|power| 1 << power).take_while(|&threads| threads < all).chain([all]);
        let mut rows: Vec<Row> = Vec::new();
        for threads in numbers {
            let _progress = Progress::running(format!("drawing on {}", count(threads as u64, "thread")));
            let frames = pool(threads)?.install(|| self.draw(scene, side, 11))?;
            let is_same = rows.first().is_none_or(|row| row.frames.first.pixels == frames.first.pixels);
            ensure(is_same, || format!("{threads} threads draw another picture than one"))?;
            rows.push(Row::new(threads, [side; 2], frames));
        }
        Ok(rows)
    }

    fn by_pixels(&mut self, scene: &Scene, max_side: u32) -> Outcome<Vec<Row>> {
        let mut rows: Vec<Row> = Vec::new();
        let sides = (0..).map(|power| SIDES.0 << power).take_while(|&side| side <= max_side);
        let sides: Vec<u32> = if max_side < SIDES.0 { vec![max_side] } else { sides.collect() };
        for side in sides {
            let what = format!("a picture of {side}x{side}");
            let expected_s =
                rows.last().map_or(0.0, |row| 4.0 * row.frames.time.median_s() * self.session.runs(11) as f64);
            if self.session.admits(&what, u64::from(side).pow(2) * BYTES.1, expected_s) {
                let _progress = Progress::running(format!("drawing {what}"));
                rows.push(Row::new(rayon::current_num_threads(), [side; 2], self.draw(scene, side, 11)?));
            }
        }
        same_cover(&rows)?;
        Ok(rows)
    }
}

/// All meshes fill the same cube: they cover the same share of the picture, but for pixels at its outline.
fn same_cover(rows: &[Row]) -> Outcome {
    let Some(first) = rows.first() else { return Ok(()) };
    rows.iter().try_for_each(|row| {
        let (expected, found) = (first.frames.covered_share, row.frames.covered_share);
        // An outline of four sides, a pixel wide.
        let slack = 4.0 / f64::from(first.size_px[0].min(row.size_px[0]));
        ensure((found - expected).abs() <= slack, || {
            format!("{} at {:?} cover {found} of the picture, others {expected}", count(row.cells, "cell"), row.size_px)
        })
    })
}

fn spread(row: &Row) -> String {
    format!("{:.0} %", row.frames.time.percent() / 2.0)
}

fn cells_table(rows: &[Row]) -> Table {
    let title = rows
        .first()
        .map_or_else(String::new, |row| format!(", {0}x{0}, {1}", row.size_px[0], count(row.threads as u64, "thread")));
    let mut table =
        Table::new(format!("Frames by cells{title}"), &["cells", "ms", "±", "ns a cell", "million cells/s"]);
    for row in rows {
        let numbers =
            [digits(row.frames.time.median_ms), spread(row), digits(row.ns_per_cell), digits(row.cells_per_s * 1e-6)];
        table.row(std::iter::once(grouped(row.cells)).chain(numbers));
    }
    table
}

fn size_table(rows: &[Row]) -> Table {
    let title = rows.first().map_or_else(String::new, |row| format!(", {}", count(row.threads as u64, "thread")));
    let head = ["cells", "picture", "ms", "±", "ns a cell", "million cells/s"];
    let mut table = Table::new(format!("Frames of cells of one size on screen{title}"), &head);
    for row in rows {
        let [width, height] = row.size_px;
        table.row([
            grouped(row.cells),
            format!("{width}x{height}"),
            digits(row.frames.time.median_ms),
            spread(row),
            digits(row.ns_per_cell),
            digits(row.cells_per_s * 1e-6),
        ]);
    }
    let compared = || rows.iter().filter(|row| row.cells >= FEWEST_COMPARED).map(|row| row.ns_per_cell);
    if compared().count() > 1 {
        let (least, most) = (compared().fold(f64::INFINITY, f64::min), compared().fold(0.0, f64::max));
        table.remark(format!(
            "From a million cells on, a cell costs at most {:.2} times what it costs at least.",
            most / least
        ));
    }
    table
}

fn threads_table(rows: &[Row]) -> Table {
    let title =
        rows.first().map_or_else(String::new, |row| format!(", {}, {1}x{1}", count(row.cells, "cell"), row.size_px[0]));
    let mut table = Table::new(
        format!("Frames by threads{title}"),
        &["threads", "ms", "±", "million cells/s", "times as fast as one", "of what threads could give"],
    );
    for row in rows {
        let speedup = rows.first().map(|one| one.frames.time.median_ms / row.frames.time.median_ms);
        table.row([
            row.threads.to_string(),
            digits(row.frames.time.median_ms),
            spread(row),
            digits(row.cells_per_s * 1e-6),
            speedup.map_or_else(none, digits),
            speedup.map_or_else(none, |speedup| format!("{:.0} %", 100.0 * speedup / row.threads as f64)),
        ]);
    }
    table
}

fn pixels_table(rows: &[Row]) -> Table {
    let title = rows.first().map_or_else(String::new, |row| {
        format!(", {}, {}", count(row.cells, "cell"), count(row.threads as u64, "thread"))
    });
    let mut table =
        Table::new(format!("Frames by pixels{title}"), &["picture", "ms", "±", "million cells/s", "megapixels/s"]);
    for row in rows {
        let [width, height] = row.size_px;
        table.row([
            format!("{width}x{height}"),
            digits(row.frames.time.median_ms),
            spread(row),
            digits(row.cells_per_s * 1e-6),
            digits(row.megapixels_per_s),
        ]);
    }
    table
}
