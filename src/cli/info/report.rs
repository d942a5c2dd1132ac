//! What `info` found out, as text and as JSON.

use std::fmt::{self, Display, Formatter};
use std::path::Path;

use cellfan::columns::{Association, CellCounts, Lattice};
use serde::Serialize;
use serde_json::json;

use super::kinds::KindCount;
use super::remarks;
use crate::cli::numbers::{bytes, count, grouped, short};

/// Blocks that are shown to people.
const MOST_BLOCKS: usize = 24;

/// Smallest and largest finite value; none where no value is finite.
pub(super) type Range = Option<[f64; 2]>;

/// An array of the file.
#[derive(Serialize)]
pub(super) struct ArrayReport {
    pub(super) name: String,
    pub(super) association: Association,
    pub(super) components: usize,
    #[serde(rename = "type")]
    pub(super) number_type: &'static str,
    pub(super) tuples: u64,
    /// One a component, over the whole file.
    #[serde(rename = "ranges")]
    pub(super) component_ranges: Vec<Range>,
    /// Of the Euclidean norm; none for a scalar.
    pub(super) magnitude_range: Range,
}

/// What is drawn of the mesh.
#[derive(Serialize)]
pub(super) struct Drawn {
    pub(super) tetrahedra: u64,
    /// Whole cells with more than four corners: a container keeps them, other files are reported as cut.
    pub(super) hexahedra: u64,
    pub(super) polyhedra: u64,
    pub(super) vertices: u64,
    pub(super) blocks: u64,
    /// What the mesh and its arrays take in memory; next to nothing for a container that is mapped.
    pub(super) memory_bytes: u64,
}

/// Where the points of a volume are.
#[derive(Serialize)]
pub(super) struct LatticeReport {
    /// Of point (0, 0, 0).
    origin: [f64; 3],
    /// From point to point along i, j and k.
    spacing: [f64; 3],
    /// Of i, j and k, of length one.
    directions: [[f64; 3]; 3],
}

impl LatticeReport {
    pub(super) fn new(lattice: &Lattice) -> Self {
        let steps = lattice.steps();
        let steps = [steps.x_axis, steps.y_axis, steps.z_axis];
        Self {
            origin: lattice.origin().to_array(),
            spacing: steps.map(glam::DVec3::length),
            directions: steps.map(|step| step.normalize_or_zero().to_array()),
        }
    }

    /// Whether i, j and k run along x, y and z.
    #[expect(clippy::float_cmp, reason = "what is not quite upright is said")]
    fn is_upright(&self) -> bool {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        self.directions.iter().zip(axes).all(|(direction, axis)| *direction == axis)
    }
}

/// A file and its format.
#[derive(Serialize)]
pub(super) struct FileReport {
    file: String,
    format: &'static str,
}

impl FileReport {
    pub(super) fn new(path: &Path, format: &'static str) -> Self {
        Self { file: path.display().to_string(), format }
    }
}

/// Everything about one file, or several as one mesh.
pub(super) struct Report {
    pub(super) files: Vec<FileReport>,
    pub(super) points: u64,
    pub(super) cells: u64,
    pub(super) kinds: Vec<KindCount>,
    /// Points along i, j and k of each block of a structured grid.
    pub(super) dims: Vec<[usize; 3]>,
    /// Of a volume.
    pub(super) lattice: Option<LatticeReport>,
    /// Lowest and highest corner.
    pub(super) bounds: Option<[[f64; 3]; 2]>,
    pub(super) arrays: Vec<ArrayReport>,
    pub(super) counts: CellCounts,
    /// Or why nothing is.
    pub(super) drawn: Result<Drawn, String>,
}

impl Report {
    /// One JSON object, indented, with a newline at the end.
    pub(super) fn to_json(&self) -> String {
        let skipped = self.counts.lower_dimensional + self.counts.ghost + self.counts.unsupported;
        let only = match &self.files[..] {
            [only] => Some(only),
            _ => None,
        };
        let value = json!({
            "file": only.map(|only| &only.file),
            "format": only.map(|only| only.format),
            "files": self.files,
            "points": self.points,
            "cells": self.cells,
            "kinds": self.kinds,
            "dims": self.dims,
            "lattice": self.lattice,
            "bounds": self.bounds.map(|[min, max]| json!({ "min": min, "max": max })),
            "arrays": self.arrays,
            "skipped": skipped,
            "counts": self.counts,
            "drawn": self.drawn.as_ref().ok(),
            "problem": self.drawn.as_ref().err(),
        });
        format!("{value:#}\n")
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for FileReport { file, format } in &self.files {
            writeln!(f, "{file}: {format}")?;
        }
        if self.files.len() > 1 {
            writeln!(f, "together:")?;
        }
        writeln!(f, "{}, {}", count(self.points, "point"), count(self.cells, "cell"))?;
        for kind in &self.kinds {
            writeln!(f, "  {:>12}  {}", grouped(kind.count), kind.name)?;
        }
        for dims in self.dims.iter().take(MOST_BLOCKS) {
            writeln!(f, "  block of {} points", dims.map(|along| grouped(along as u64)).join(" x "))?;
        }
        if self.dims.len() > MOST_BLOCKS {
            writeln!(f, "  and {} more blocks", self.dims.len() - MOST_BLOCKS)?;
        }
        let corner = |p: [f64; 3]| p.map(short).join(", ");
        if let Some(lattice) = &self.lattice {
            writeln!(f, "spacing: {}, origin ({})", lattice.spacing.map(short).join(" x "), corner(lattice.origin))?;
            if !lattice.is_upright() {
                writeln!(f, "directions: {}", lattice.directions.map(|d| format!("({})", corner(d))).join(", "))?;
            }
        }
        if let Some([min, max]) = self.bounds {
            writeln!(f, "bounds: ({}) to ({})", corner(min), corner(max))?;
        }
        writeln!(f, "{}", if self.arrays.is_empty() { "no arrays" } else { "arrays:" })?;
        let width = self.arrays.iter().map(|array| array.name.chars().count()).max().unwrap_or(0);
        for array in &self.arrays {
            array.line(f, width)?;
        }
        match &self.drawn {
            Ok(Drawn { tetrahedra, hexahedra, polyhedra, vertices, memory_bytes, .. }) => {
                let kinds = [
                    (*tetrahedra, "tetrahedra"),
                    (*hexahedra, "whole cells of more corners"),
                    (*polyhedra, "polyhedra"),
                ];
                let cells = kinds.into_iter().filter(|(cells, _)| *cells > 0);
                let cells =
                    cells.map(|(cells, kind)| format!("{} {kind}", grouped(cells))).collect::<Vec<_>>().join(" and ");
                let (vertices, memory) = (grouped(*vertices), bytes(*memory_bytes));
                writeln!(f, "drawn: {cells} of {vertices} vertices, {memory} in memory")?;
            }
            Err(problem) => writeln!(f, "cannot be drawn: {problem}")?,
        }
        remarks(&self.counts).into_iter().try_for_each(|(n, what)| writeln!(f, "  {:>12}  {what}", grouped(n)))
    }
}

impl ArrayReport {
    fn line(&self, f: &mut Formatter<'_>, width: usize) -> fmt::Result {
        let association = match self.association {
            Association::Point => "point",
            Association::Cell => "cell",
        };
        let of = if self.components == 1 { String::new() } else { format!("[{}]", self.components) };
        let number_type = format!("{}{of}", self.number_type);
        let (range, what) = match self.components {
            1 => (self.component_ranges[0], ""),
            _ => (self.magnitude_range, "magnitude "),
        };
        let range = range
            .map_or("no finite value".to_owned(), |[low, high]| format!("{what}{} to {}", short(low), short(high)));
        writeln!(f, "  {:<width$}  {association:<5}  {number_type:<7}  {range}", self.name)
    }
}
