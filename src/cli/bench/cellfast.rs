//! `bench cellfast`: CellFast's tables 2 and 3, frames of tetrahedral meshes.
//!
//! Without meshes, Delaunay meshes with as many cells as the paper's, and a transfer function that leaves as many of them out. A mesh
//! that has as many cells as one of the paper's stands beside that one's figures. The paper's frames were drawn at 1280x1024 (table 2 and
//! the first column of table 3 give the same pixels a second); its larger pictures had two and three machines or accelerators.

use std::path::PathBuf;

use cellfan::generate::Kind;
use cellfan::profile::CellStats;
use cellfan::{RenderOptions, Result, Scene};
use clap::Args;
use serde::Serialize;
use serde_json::json;

use super::Outcome;
use super::device::{Device, DeviceArguments};
use super::frames::{Frames, Shots};
use super::record::{Report, value};
use super::session::Session;
use super::subject::Subject;
use super::tables::{Table, digits, digits_or_none, none, percent};
use crate::cli::arguments::size;
use crate::cli::numbers::grouped;
use crate::cli::progress::Progress;

#[derive(Args)]
pub(super) struct Arguments {
    /// Meshes to draw, whole [default: generated ones of the paper's numbers of cells].
    #[arg(value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// Sizes of the picture [default: 1280x1024, 2560x1024 and 3840x1024].
    #[arg(long, value_name = "WxH", value_delimiter = ',', value_parser = size)]
    size: Vec<[u32; 2]>,
    /// The largest mesh to generate.
    #[arg(long, value_name = "N", conflicts_with = "meshes")]
    max_cells: Option<u64>,
    /// The array to draw [default: the first that varies].
    #[arg(long, value_name = "NAME", requires = "meshes")]
    array: Option<String>,
    /// The share of the cells that the transfer function leaves out, in percent [default: the paper's for meshes of its numbers
    /// of cells, else 0].
    #[arg(long, value_name = "PERCENT", value_parser = clap::value_parser!(u32).range(0..=95))]
    culled: Option<u32>,
    /// Another transfer function: viridis, inferno, cool-warm, x-ray, or a file.
    #[arg(long, value_name = "TF", conflicts_with = "culled")]
    transfer: Option<String>,
    #[command(flatten)]
    device: DeviceArguments,
}

/// A mesh of the paper, and what it says of it.
#[derive(Clone, Copy, Serialize)]
struct PaperMesh {
    name: &'static str,
    cells: u64,
    culled_percent: u32,
    seconds: f64,
    frames_per_s: f64,
    /// At 1280x1024, 2560x1024 and 3840x1024.
    megapixels_per_s: [Option<f64>; 3],
}

/// CellFast (Wittenbrink 1999), tables 2 and 3.
const PAPER: [PaperMesh; 5] = [
    paper("phoenix", 12_936, 0, (0.065, 15.3), [Some(20.16), Some(29.79), Some(42.74)]),
    paper("langley", 70_125, 20, (0.333, 3.0), [Some(3.94), Some(4.86), Some(7.28)]),
    paper("f117", 240_122, 36, (0.967, 1.03), [None; 3]),
    paper("torso", 1_293_238, 0, (8.796, 0.11), [Some(0.15), Some(0.24), Some(0.36)]),
    paper("head", 2_443_013, 0, (19.801, 0.05), [Some(0.07), Some(0.11), Some(0.16)]),
];

const fn paper(
    name: &'static str,
    cells: u64,
    culled_percent: u32,
    (seconds, frames_per_s): (f64, f64),
    megapixels_per_s: [Option<f64>; 3],
) -> PaperMesh {
    PaperMesh { name, cells, culled_percent, seconds, frames_per_s, megapixels_per_s }
}

/// The sizes of table 3: one J5000, a Workgroup of two accelerators, a Visualize Center of three workstations.
const SIZES: [[u32; 2]; 3] = [[1280, 1024], [2560, 1024], [3840, 1024]];

/// What generating and drawing takes a cell, and a pixel.
const BYTES: (u64, u64) = (140, 80);

#[derive(Serialize)]
struct Row {
    mesh: String,
    cells: u64,
    drawn: u64,
    culled_share: f64,
    size_px: [u32; 2],
    order: &'static str,
    frames: Frames,
    frames_per_s: f64,
    cells_per_s: f64,
    megapixels_per_s: f64,
    paper: Option<PaperMesh>,
}

/// Where a mesh comes from.
enum Source<'a> {
    File(&'a PathBuf),
    Generated(PaperMesh),
}

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Outcome<Report> {
    let device = Device::find(&arguments.device)?;
    let sizes = match &arguments.size[..] {
        [] if session.is_quick => vec![[320, 256]],
        [] => SIZES.to_vec(),
        sizes => sizes.to_vec(),
    };
    let max_cells = arguments.max_cells.unwrap_or(if session.is_quick { 20_000 } else { u64::MAX });
    let sources: Vec<Source> = if arguments.meshes.is_empty() {
        PAPER.into_iter().filter(|mesh| mesh.cells <= max_cells).map(Source::Generated).collect()
    } else {
        arguments.meshes.iter().map(Source::File).collect()
    };
    let pixels = sizes.iter().map(|&[w, h]| u64::from(w) * u64::from(h)).max().unwrap_or(0);
    let (mut rows, mut last) = (Vec::new(), (1, 0.0));
    for source in sources {
        if let Source::Generated(mesh) = &source {
            let what = format!("a mesh like {} of {} cells", mesh.name, grouped(mesh.cells));
            let expected_s = last.1 * mesh.cells as f64 / last.0 as f64;
            if !session.admits(&what, mesh.cells * BYTES.0 + pixels * BYTES.1, expected_s) {
                continue;
            }
        }
        let start = std::time::Instant::now();
        let of_mesh = of_mesh(arguments, &source, &sizes, &device, session)?;
        last = (of_mesh.first().map_or(1, |row| row.cells), start.elapsed().as_secs_f64());
        rows.extend(of_mesh);
    }
    let settings = json!({
        "sizes": sizes,
        "model": RenderOptions::default().model.to_string(),
        "transfer": arguments.transfer,
        "device": device.to_json(),
    });
    let results = json!({
        "rows": value(&rows),
        "paper": { "source": "Wittenbrink 1999, tables 2 and 3", "machine": MACHINE, "rows": PAPER },
    });
    let (by_mesh, by_pixels) = (table_2(&rows, sizes[0]), table_3(&rows, &sizes));
    Ok(Report { benchmark: "cellfast", settings, results, tables: vec![by_mesh, by_pixels] })
}

/// One mesh at all sizes.
fn of_mesh(
    arguments: &Arguments,
    source: &Source,
    sizes: &[[u32; 2]],
    device: &Device,
    session: &Session,
) -> Outcome<Vec<Row>> {
    let subject = load(source, arguments.array.as_deref())?;
    let cells = subject.dataset.counts.in_file;
    let paper = PAPER.into_iter().find(|mesh| match source {
        Source::Generated(like) => mesh.name == like.name,
        Source::File(_) => mesh.cells == cells,
    });
    let culled_percent = arguments.culled.or(paper.map(|mesh| mesh.culled_percent)).unwrap_or(0);
    let transfer = match &arguments.transfer {
        Some(name) => subject.transfer(name)?,
        None => subject.ramp(f64::from(culled_percent) / 100.0)?,
    };
    let name = match source {
        Source::Generated(like) => format!("like {} (Delaunay)", like.name),
        Source::File(_) => subject.name.clone(),
    };
    let scene = Scene::new(subject.dataset, subject.field, &transfer);
    let progress = Progress::counting(format!("drawing {name}"), sizes.len() as u64);
    let options = RenderOptions::default();
    let mut renderer = device.renderer(options);
    let mut rows = Vec::new();
    for &size_px in sizes {
        let runs = session.runs(if cells > 1_000_000 { 7 } else { 15 });
        let shots = Shots { scene: &scene, name: &name, size_px, options, runs };
        let frames = shots.draw(session, &mut renderer)?;
        let seconds = frames.time.median_s();
        let CellStats { total, drawn, culled_transparent, .. } = frames.cells;
        rows.push(Row {
            mesh: name.clone(),
            cells: total,
            drawn,
            culled_share: culled_transparent as f64 / total as f64,
            size_px,
            order: frames.order.kind,
            frames_per_s: 1.0 / seconds,
            cells_per_s: total as f64 / seconds,
            megapixels_per_s: f64::from(size_px[0]) * f64::from(size_px[1]) / seconds * 1e-6,
            paper,
            frames,
        });
        progress.step();
    }
    Ok(rows)
}

fn load(source: &Source, array: Option<&str>) -> Result<Subject> {
    match source {
        Source::File(path) => {
            let _progress = Progress::running(format!("reading {}", path.display()));
            Subject::read(path, array)
        }
        Source::Generated(mesh) => {
            let _progress = Progress::running(format!("generating {} cells", grouped(mesh.cells)));
            Subject::generated(Kind::Delaunay, mesh.cells)
        }
    }
}

const MACHINE: &str = "HP J5000, PA-RISC 8500 at 440 MHz, fx-6 Pro";

/// Culled share, cells, seconds and frames/s, at the first of the sizes.
fn table_2(rows: &[Row], size_px: [u32; 2]) -> Table {
    let [width, height] = size_px;
    let head = [
        "mesh",
        "culled",
        "cells",
        "s",
        "±",
        "frames/s",
        "cells/s",
        "CellFast: mesh",
        "culled",
        "tetrahedra",
        "s",
        "frames/s",
    ];
    let mut table = Table::new(format!("Frames at {width}x{height}, every one a new view: seconds"), &head);
    for row in rows.iter().filter(|row| row.size_px == size_px) {
        let ours = [
            row.mesh.clone(),
            percent(row.culled_share),
            grouped(row.cells),
            digits(row.frames.time.median_s()),
            format!("{:.0} %", row.frames.time.percent() / 2.0),
            digits(row.frames_per_s),
            grouped(row.cells_per_s as u64),
        ];
        let paper = row.paper.map_or_else(
            || [(); 5].map(|()| none()),
            |mesh| {
                let (culled, cells) = (format!("{} %", mesh.culled_percent), grouped(mesh.cells));
                [mesh.name.to_owned(), culled, cells, mesh.seconds.to_string(), mesh.frames_per_s.to_string()]
            },
        );
        table.row(ours.into_iter().chain(paper));
    }
    table.remark(format!(
        "CellFast: Wittenbrink 1999, table 2, on an {MACHINE}, at 1280x1024. ± is half the distance of the quartiles."
    ));
    table
}

/// Megapixels a second at each size.
fn table_3(rows: &[Row], sizes: &[[u32; 2]]) -> Table {
    let size_text = |[width, height]: &[u32; 2]| format!("{width}x{height}");
    let mut head = vec!["mesh".to_owned()];
    for size in sizes {
        head.extend([size_text(size), "CellFast".to_owned()]);
    }
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let mut table = Table::new("Megapixels a second", &head);
    let first = sizes.first();
    for mesh in rows.iter().filter(|row| Some(&row.size_px) == first) {
        let cells = sizes.iter().flat_map(|size| {
            let row = rows.iter().find(|row| row.mesh == mesh.mesh && row.size_px == *size);
            let place = SIZES.iter().position(|of_paper| of_paper == size);
            let theirs = mesh.paper.zip(place).and_then(|(mesh, place)| mesh.megapixels_per_s[place]);
            [row.map_or_else(none, |row| digits(row.megapixels_per_s)), digits_or_none(theirs)]
        });
        table.row(std::iter::once(mesh.mesh.clone()).chain(cells));
    }
    table.remark(
        "CellFast: Wittenbrink 1999, table 3: one J5000; a Workgroup, one J5000 with two fx-6 Pro; a Visualize Center, three J5000 with one each.",
    );
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_tables_agree_where_they_tell_the_same() {
        for mesh in PAPER {
            // 15.3 frames/s are printed for 0.065 s; 1.03 for 0.967 s.
            assert!((mesh.frames_per_s * mesh.seconds - 1.0).abs() < 0.05, "{}", mesh.name);
            // Pixels a second of table 3 are those of table 2 at 1280x1024.
            if let Some(megapixels) = mesh.megapixels_per_s[0] {
                let expected = 1280.0 * 1024.0 * 1e-6 / mesh.seconds;
                assert!((megapixels - expected).abs() < 0.006, "{}: {megapixels} is not {expected}", mesh.name);
            }
        }
    }
}
