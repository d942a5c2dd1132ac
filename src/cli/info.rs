//! `info`: what a mesh file, or several, hold and what of it would be drawn, for people or as JSON.

mod kinds;
mod report;
mod volume;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use cellfan::columns::{self, Array, ArrayRanges, CellCounts, Points, ValueRanges};
use cellfan::io::{Mesh, Scratch, StructuredBlock, container, formats};
use cellfan::{Dataset, Error};
use clap::Args;
use kinds::KindCount;
use rayon::prelude::*;
use report::{ArrayReport, Drawn, FileReport, LatticeReport, Range, Report};

use super::meshes::{FORMATS, Raw};
use super::numbers::{bytes, count};
use super::progress::Progress;
use super::{Outcome, meshes, stdout};

#[derive(Args)]
#[command(
    after_help = "Examples:\n  cellfan info mesh.vtu\n  cellfan info left.vtu right.vtu\n  cellfan info --raw 256x256x110:u8 engine.raw\n  cellfan info mesh.vtu --json | jq .arrays"
)]
pub(super) struct Arguments {
    #[arg(required = true, value_name = "MESH", help = FORMATS)]
    meshes: Vec<PathBuf>,
    #[command(flatten)]
    raw: Raw,
    /// Write JSON.
    #[arg(long)]
    json: bool,
    /// Check a container through and through: checksums, vertex numbers, orientations.
    #[arg(long)]
    check: bool,
    /// Read a container or a volume whole instead of through a memory map.
    #[arg(long)]
    no_mmap: bool,
}

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let paths = &arguments.meshes;
    if arguments.check {
        paths.iter().try_for_each(|path| must_be_container(path))?;
        paths.iter().try_for_each(|path| check(path, !arguments.no_mmap))?;
    }
    let scratch = if arguments.no_mmap { Scratch::unmapped() } else { Scratch::memory() };
    let report = {
        let _progress = meshes::reading(paths);
        match meshes::one_container(paths, arguments.raw)? {
            Some(path) => {
                let kinds =
                    container::cells_by_kind(path, !arguments.no_mmap)?.into_iter().map(kinds::of_code).collect();
                report_container(path, &container::open(path, !arguments.no_mmap)?, kinds)
            }
            None => report(arguments, meshes::open(paths, arguments.raw, &scratch)?)
                .map_err(|error| error.in_file(meshes::label(paths)))?,
        }
    };
    stdout::write(&if arguments.json { report.to_json() } else { report.to_string() })
}

/// Other files have nothing to be checked by.
fn must_be_container(path: &Path) -> cellfan::Result<()> {
    if path.is_file() && container::is_container(path)? {
        return Ok(());
    }
    let problem = format!("\"{}\" is no container: it is checked whenever it is read", path.display());
    Err(Error::Option { option: "--check", problem })
}

/// Checks a container through and through, and says so.
fn check(path: &Path, use_map: bool) -> cellfan::Result<()> {
    let _progress = Progress::running(format!("checking {}", path.display()));
    let checked = container::check(path, use_map)?;
    let columns = count(checked.columns, "column");
    tracing::info!("{}: {columns} of {} checked, all right", path.display(), bytes(checked.bytes));
    Ok(())
}

fn report(arguments: &Arguments, mesh: Mesh) -> cellfan::Result<Report> {
    let name = |path: &Path| if arguments.raw.is_given() { RAW } else { format_name(path) };
    let points = mesh.point_count() as u64;
    let kinds = kinds::count(&mesh.cells_by_code());
    let dims = match &mesh {
        Mesh::Structured(mesh) => mesh.blocks().iter().map(StructuredBlock::dims).collect(),
        Mesh::Unstructured(_) => Vec::new(),
        Mesh::Volume(volume) => vec![volume.dims],
    };
    let arrays = mesh.arrays().iter().map(array_report).collect();
    let (bounds, lattice) = match &mesh {
        Mesh::Volume(volume) => (Some(volume::bounds(volume)), Some(LatticeReport::new(&volume.lattice))),
        _ => (mesh.points().and_then(bounds), None),
    };
    let (counts, drawn) = match mesh {
        Mesh::Volume(volume) if !volume::hides_cells(&volume) => volume::drawn(&volume),
        mesh => drawn_of(mesh)?,
    };
    Ok(Report {
        files: arguments.meshes.iter().map(|path| FileReport::new(path, name(path))).collect(),
        points,
        cells: counts.in_file,
        kinds,
        dims,
        lattice,
        bounds,
        arrays,
        counts,
        drawn,
    })
}

/// What becomes of the cells, and what is drawn of them, or why nothing is.
fn drawn_of(mesh: Mesh) -> cellfan::Result<(CellCounts, Result<Drawn, String>)> {
    let tets = mesh.into_tets()?;
    let counts = tets.counts;
    match Dataset::from_tets(tets) {
        Ok(dataset) => Ok((dataset.counts, Ok(drawn(&dataset)))),
        // A mesh without volume is no damaged file.
        Err(error @ Error::NoCells { .. }) => Ok((counts, Err(error.to_string()))),
        Err(error) => Err(error),
    }
}

/// What a container says of itself, without reading its columns through.
fn report_container(path: &Path, dataset: &Dataset, kinds: Vec<KindCount>) -> Report {
    let array = |(array, ranges): (&Array, &ArrayRanges)| {
        let of = |scalar: &ValueRanges| {
            let (low, high) = scalar.range;
            (low <= high).then_some([low, high])
        };
        let (whole, parts) = ranges.by_component.split_first().map_or((None, &[][..]), |(w, p)| (of(w), p));
        let is_scalar = array.components == 1;
        ArrayReport {
            name: array.name.clone(),
            association: array.association,
            components: array.components,
            number_type: array.values.type_name(),
            tuples: array.tuples() as u64,
            component_ranges: if is_scalar { vec![whole] } else { parts.iter().map(of).collect() },
            magnitude_range: whole.filter(|_| !is_scalar),
        }
    };
    let bounds = dataset.bounds;
    let corner = |p: glam::Vec3| (dataset.origin + p.as_dvec3()).to_array();
    let dims = |block: &columns::StructuredBlock| block.dims.map(|points| points as usize);
    Report {
        files: vec![FileReport::new(path, CONTAINER)],
        points: dataset.positions.len() as u64,
        cells: dataset.cells() as u64,
        kinds,
        dims: dataset.hexahedra.structured_blocks().iter().map(dims).collect(),
        lattice: None,
        bounds: Some([corner(bounds.min), corner(bounds.max)]),
        arrays: dataset.arrays.iter().zip(&dataset.array_ranges).map(array).collect(),
        counts: dataset.counts,
        drawn: Ok(drawn(dataset)),
    }
}

fn drawn(dataset: &Dataset) -> Drawn {
    let hexahedra = (dataset.hexahedra.len() - dataset.hexahedra.absent()) as u64;
    let (tetrahedra, vertices) = (dataset.tets.len() as u64, dataset.positions.len() as u64);
    let (blocks, memory_bytes) = (dataset.blocks.len() as u64, dataset.owned_bytes());
    let polyhedra = dataset.polyhedra.len() as u64;
    Drawn { tetrahedra, hexahedra, polyhedra, vertices, blocks, memory_bytes }
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

/// What containers are called.
const CONTAINER: &str = "cellfan container";

/// What raw volumes are called.
const RAW: &str = "raw volume";

/// The format, found as the reader finds it.
fn format_name(path: &Path) -> &'static str {
    if path.is_file() && container::is_container(path).unwrap_or(false) {
        return CONTAINER;
    }
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(formats::HEAD_BYTES as u64).read_to_end(&mut head));
    read.ok().and_then(|_| formats::find(&head, path).ok()).map_or("unknown", |format| format.name)
}

/// The figures that are worth a line: what is not drawn as the file has it.
fn remarks(counts: &CellCounts) -> Vec<(u64, &'static str)> {
    let all = [
        (counts.lower_dimensional, "skipped: no volume by their kind (points, lines, faces)"),
        (counts.ghost, "skipped: hidden by vtkGhostType or IBlank"),
        (counts.unsupported, "skipped: kinds that this version does not draw"),
        (counts.split, "split into tetrahedra: another field than the unsplit cell's"),
        (counts.quadratic, "quadratic: drawn by their corners"),
        (counts.inverted, "inverted: turned"),
        (counts.degenerate, "degenerate (of the tetrahedra): no volume, left out"),
    ];
    all.into_iter().filter(|&(n, _)| n > 0).collect()
}
