//! `info`: what a mesh file holds and what of it would be drawn, for people or as JSON.

mod kinds;
mod report;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use cellfan::columns::{Array, CellCounts, Points};
use cellfan::io::{UnstructuredMesh, formats, open_mesh};
use cellfan::{Dataset, Error};
use clap::Args;
use rayon::prelude::*;
use report::{ArrayReport, Drawn, Range, Report};

use super::progress::Progress;
use super::{Outcome, stdout};

#[derive(Args)]
#[command(after_help = "Examples:\n  cellfan info mesh.vtu\n  cellfan info mesh.vtu --json | jq .arrays")]
pub(super) struct Arguments {
    /// The mesh: .vtu, .pvtu or .vtk.
    mesh: PathBuf,
    /// Write JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let path = &arguments.mesh;
    let report = {
        let _progress = Progress::running(format!("reading {}", path.display()));
        let mesh = open_mesh(path)?;
        report(path, mesh).map_err(|error| error.in_file(path))?
    };
    stdout::write(&if arguments.json { report.to_json() } else { report.to_string() })
}

fn report(path: &Path, mesh: UnstructuredMesh) -> cellfan::Result<Report> {
    let points = mesh.points.len() as u64;
    let kinds = kinds::count(&mesh.types);
    let arrays = mesh.arrays.iter().map(array_report).collect();
    let bounds = bounds(&mesh.points);
    let tets = mesh.into_tets()?;
    let counts = tets.counts;
    let (counts, drawn) = match Dataset::from_tets(tets) {
        Ok(dataset) => (dataset.counts, Ok(drawn(&dataset))),
        // A mesh without volume is no damaged file.
        Err(error @ Error::NoCells { .. }) => (counts, Err(error.to_string())),
        Err(error) => return Err(error),
    };
    Ok(Report {
        file: path.display().to_string(),
        format: format_name(path),
        points,
        cells: counts.in_file,
        kinds,
        bounds,
        arrays,
        counts,
        drawn,
    })
}

fn drawn(dataset: &Dataset) -> Drawn {
    let (vertices, cells) = (dataset.positions.len() as u64, dataset.tets.len() as u64);
    let array_bytes: u64 = dataset.arrays.iter().map(|array| array.values.len() as u64 * bytes_each(array)).sum();
    // Position and file index a vertex; corners, file index and orientation a cell.
    let memory_bytes = vertices * (12 + 4) + cells * (16 + 4) + cells.div_ceil(8) + array_bytes;
    Drawn { tetrahedra: cells, vertices, blocks: dataset.blocks.len() as u64, memory_bytes }
}

fn bytes_each(array: &Array) -> u64 {
    let bits = array.values.type_name().trim_start_matches(|c: char| c.is_alphabetic());
    bits.parse().map_or(8, |bits: u64| bits / 8)
}

fn array_report(array: &Array) -> ArrayReport {
    let Array { name, association, components, values } = array;
    let scalar =
        |component: usize| range((0..array.tuples()).into_par_iter().map(|i| values.get(i * components + component)));
    let magnitude =
        |i: usize| (i * components..(i + 1) * components).map(|k| values.get(k).powi(2)).sum::<f64>().sqrt();
    ArrayReport {
        name: name.clone(),
        association: *association,
        components: *components,
        number_type: values.type_name(),
        tuples: array.tuples() as u64,
        component_ranges: (0..*components).map(scalar).collect(),
        magnitude_range: (*components > 1).then(|| range((0..array.tuples()).into_par_iter().map(magnitude))).flatten(),
    }
}

/// The smallest and the largest finite value, if there is any.
fn range(values: impl ParallelIterator<Item = f64>) -> Range {
    let nothing = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold(|| nothing, |(low, high), value| (low.min(value), high.max(value)))
        .reduce(|| nothing, |a, b| (a.0.min(b.0), a.1.max(b.1)));
    (low <= high).then_some([low, high])
}

/// Of all points of the file, used by a cell or not; none where there is no finite one.
fn bounds(points: &Points) -> Option<[[f64; 3]; 2]> {
    let axis = |axis: usize| range((0..points.len()).into_par_iter().map(|i| points.get(i).to_array()[axis]));
    let ([x0, x1], [y0, y1], [z0, z1]) = (axis(0)?, axis(1)?, axis(2)?);
    Some([[x0, y0, z0], [x1, y1, z1]])
}

/// The format, found as the reader finds it.
fn format_name(path: &Path) -> &'static str {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(formats::HEAD_BYTES as u64).read_to_end(&mut head));
    read.ok().and_then(|_| formats::find(&head, path).ok()).map_or("unknown", |format| format.name)
}

/// The figures that are worth a line: what is not drawn as the file has it.
fn remarks(counts: &CellCounts) -> Vec<(u64, &'static str)> {
    let all = [
        (counts.lower_dimensional, "skipped: no volume by their kind (points, lines, faces)"),
        (counts.ghost, "skipped: hidden by vtkGhostType"),
        (counts.unsupported, "skipped: kinds that this version does not draw"),
        (counts.split, "split into tetrahedra: another field than the unsplit cell's"),
        (counts.quadratic, "quadratic: drawn by their corners"),
        (counts.inverted, "inverted (of the tetrahedra): turned"),
        (counts.degenerate, "degenerate (of the tetrahedra): no volume, left out"),
    ];
    all.into_iter().filter(|&(n, _)| n > 0).collect()
}
