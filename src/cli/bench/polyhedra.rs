//! `bench polyhedra`: Roettger and Ertl's figure 4, and what an order costs.
//!
//! The paper's meshes are hexahedral grids, of which two stand in the literature and two are its own: grids of the same numbers of points
//! with the density of C60 stand for all four, so that numbers of cells compare and pictures do not. Each is drawn as hexahedra and, by
//! the signed depths of its faces, as polyhedra; truncated octahedra and Voronoi cells besides. In emission, in maximum intensity and,
//! in order, in emission-absorption. Cell data, as signed faces need it, and point data. Checked: frames as always, and that hexahedra
//! and the same cells as polyhedra give one picture.

use cellfan::cells::HEXAHEDRON;
use cellfan::columns::{Array, Association, CellCounts, CellMesh, FaceLists, NumericColumn};
use cellfan::generate::{Buckyball, Settings, honeycomb, voronoi};
use cellfan::{Dataset, Field, FieldSelection, Model, Points, RenderOptions, Renderer, Scene};
use clap::Args;
use glam::DVec3;
use serde::Serialize;
use serde_json::json;

use super::frames::{Frames, Shots};
use super::record::{Report, value};
use super::session::Session;
use super::subject::Subject;
use super::tables::{Table, digits, none};
use super::{Outcome, ensure};
use crate::cli::arguments::size;
use crate::cli::numbers::grouped;
use crate::cli::progress::Progress;

#[derive(Args)]
pub(super) struct Arguments {
    /// Size of the picture [default: 512x512].
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Polyhedra of the generated meshes beside the paper's.
    #[arg(long, value_name = "N", default_value_t = 30_000, value_parser = clap::value_parser!(u64).range(2..=3_000_000))]
    cells: u64,
}

/// A mesh of the paper's figure 4.
#[derive(Clone, Copy, Serialize)]
struct PaperMesh {
    name: &'static str,
    /// Points along each axis.
    points: [u32; 3],
    hexahedra: u64,
    frames_per_s: f64,
}

const PAPER: [PaperMesh; 4] = [
    PaperMesh { name: "Blunt Fin", points: [32, 32, 40], hexahedra: 37_479, frames_per_s: 8.5 },
    PaperMesh { name: "Bucky Ball", points: [32, 32, 32], hexahedra: 29_791, frames_per_s: 15.9 },
    PaperMesh { name: "Search Light", points: [16, 4, 32], hexahedra: 1395, frames_per_s: 115.8 },
    PaperMesh { name: "Camp Fire", points: [16, 16, 16], hexahedra: 3375, frames_per_s: 51.3 },
];
/// Hexahedra a second, section 2 and section 4.
const PAPER_MIP: f64 = 643_000.0;
const PAPER_EMISSION: f64 = 212_000.0;
const PAPER_MACHINE: &str = "NVIDIA GeForce3";

#[derive(Serialize)]
struct Row {
    mesh: String,
    kind: &'static str,
    data: &'static str,
    cells: u64,
    emission: Frames,
    mip: Frames,
    emission_absorption: Frames,
    paper: Option<PaperMesh>,
}

impl Row {
    fn mip_to_emission(&self) -> f64 {
        self.emission.time.median_ms / self.mip.time.median_ms
    }
}

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Outcome<Report> {
    let size_px = arguments.size.unwrap_or(if session.is_quick { [120, 96] } else { [512, 512] });
    let mut rows: Vec<Row> = Vec::new();
    for paper in PAPER.into_iter().filter(|paper| !session.is_quick || paper.hexahedra < 2000) {
        for is_cell_data in [true, false] {
            let of = |kind| {
                let _progress = Progress::running(format!("drawing {} {kind}", grouped(paper.hexahedra)));
                let mesh = Dataset::from_cells(grid(paper.points, kind == "polyhedra"))?;
                row((&format!("as {}", paper.name), kind), mesh, is_cell_data, Some(paper), size_px, session)
            };
            let [hexahedra, polyhedra] = [of("hexahedra")?, of("polyhedra")?];
            let frames = [(&hexahedra.emission, &polyhedra.emission), (&hexahedra.mip, &polyhedra.mip)];
            for (one, other) in
                frames.into_iter().chain([(&hexahedra.emission_absorption, &polyhedra.emission_absorption)])
            {
                let difference = one.first.difference(&other.first, [0.0; 4])?;
                ensure(difference.mean < 1e-4, || {
                    format!("{}: hexahedra and the same cells as polyhedra differ by {}", paper.name, difference.mean)
                })?;
            }
            rows.extend([hexahedra, polyhedra]);
        }
    }
    let cells = if session.is_quick { arguments.cells.min(300) } else { arguments.cells };
    let settings = Settings { cells, jitter: 0.0, ..Settings::default() };
    for (name, mesh) in [("truncated octahedra", honeycomb(&settings)?), ("Voronoi cells", voronoi(&settings)?)] {
        let _progress = Progress::running(format!("drawing {name}"));
        let dataset = Dataset::from_cells(mesh)?;
        for is_cell_data in [true, false] {
            rows.push(row((name, "polyhedra"), dataset.clone(), is_cell_data, None, size_px, session)?);
        }
    }
    Ok(Report {
        benchmark: "polyhedra",
        settings: json!({ "size": size_px, "cells": cells }),
        results: json!({
            "rows": value(&rows),
            "paper": {
                "source": "Roettger and Ertl 2003, figure 4, sections 2 and 4",
                "machine": PAPER_MACHINE,
                "rows": value(PAPER),
                "hexahedra_per_s": { "emission": PAPER_EMISSION, "mip": PAPER_MIP },
            },
        }),
        tables: vec![table(&rows)],
    })
}

fn row(
    (mesh, kind): (&str, &'static str),
    dataset: Dataset,
    is_cell_data: bool,
    paper: Option<PaperMesh>,
    size_px: [u32; 2],
    session: &Session,
) -> Outcome<Row> {
    let (array, data) = if is_cell_data { ("cell_value", "cells") } else { ("value", "points") };
    let field: Field = dataset.field(&FieldSelection::parse(array, &dataset.arrays))?;
    let subject = Subject { name: mesh.to_owned(), dataset, field };
    let transfer = subject.ramp(0.0)?;
    let Subject { name, dataset, field } = subject;
    let cells = dataset.cells() as u64;
    let scene = Scene::new(dataset, field, &transfer);
    let draw = |model| {
        let options = RenderOptions { model, ..RenderOptions::default() };
        let shots = Shots { scene: &scene, name: &name, size_px, options, runs: session.runs(15) };
        shots.draw(session, &mut Renderer::new(options))
    };
    let (emission, mip) = (draw(Model::Emission)?, draw(Model::Mip)?);
    let emission_absorption = draw(Model::EmissionAbsorption)?;
    Ok(Row { mesh: name, kind, data, cells, emission, mip, emission_absorption, paper })
}

fn table(rows: &[Row]) -> Table {
    let head = [
        "mesh",
        "cells",
        "kind",
        "data of",
        "emission, frames/s",
        "±",
        "MIP, frames/s",
        "MIP : emission",
        "in order, frames/s",
        "emission : in order",
        "million cells/s, emission",
        "paper, frames/s",
    ];
    let mut table = Table::new("Polyhedra without and with an order (Roettger and Ertl 2003, figure 4)", &head);
    for row in rows {
        let rate = |frames: &Frames| 1e3 / frames.time.median_ms;
        table.row([
            row.mesh.clone(),
            grouped(row.cells),
            row.kind.to_owned(),
            row.data.to_owned(),
            digits(rate(&row.emission)),
            format!("{:.0} %", row.emission.time.percent() / 2.0),
            digits(rate(&row.mip)),
            digits(row.mip_to_emission()),
            digits(rate(&row.emission_absorption)),
            digits(row.emission_absorption.time.median_ms / row.emission.time.median_ms),
            digits(row.cells as f64 * rate(&row.emission) * 1e-6),
            row.paper.map_or_else(none, |paper| digits(paper.frames_per_s)),
        ]);
    }
    table.remark(format!(
        "The paper's hexahedra, on an {PAPER_MACHINE}: 0.212 million a second in emission, 0.643 in MIP, which is {:.1} : 1. Its \
         pictures' sizes are not known, and grids of its numbers of points stand for its meshes.",
        PAPER_MIP / PAPER_EMISSION
    ));
    table
}

/// A grid of the unit cube with so many points along each axis and the density of C60.
fn grid(points: [u32; 3], as_polyhedra: bool) -> CellMesh {
    let [ni, nj, nk] = points;
    let bucky = Buckyball::new();
    let at = |i: u32, j: u32, k: u32| {
        DVec3::new(f64::from(i), f64::from(j), f64::from(k))
            / (DVec3::new(f64::from(ni), f64::from(nj), f64::from(nk)) - 1.0)
    };
    let all = (0..nk).flat_map(move |k| (0..nj).flat_map(move |j| (0..ni).map(move |i| [i, j, k])));
    let index = |i: u32, j: u32, k: u32| i + ni * (j + nj * k);
    let cells = || all.clone().filter(move |&[i, j, k]| i + 1 < ni && j + 1 < nj && k + 1 < nk);
    let density = |p: DVec3| bucky.density(p) as f32;
    let array = |name: &str, association, values: Vec<f32>| Array {
        name: name.to_owned(),
        association,
        components: 1,
        values: NumericColumn::from(values),
    };
    let middle = DVec3::splat(0.5) / (DVec3::new(f64::from(ni), f64::from(nj), f64::from(nk)) - 1.0);
    let arrays = vec![
        array("value", Association::Point, all.clone().map(|[i, j, k]| density(at(i, j, k))).collect()),
        array("cell_value", Association::Cell, cells().map(|[i, j, k]| density(at(i, j, k) + middle)).collect()),
    ];
    let hexahedra: Vec<[u32; 8]> = cells()
        .map(|[i, j, k]| {
            let around = |k: u32| [index(i, j, k), index(i + 1, j, k), index(i + 1, j + 1, k), index(i, j + 1, k)];
            let ([a, b, c, d], [e, f, g, h]) = (around(k), around(k + 1));
            [a, b, c, d, e, f, g, h]
        })
        .collect();
    let count = hexahedra.len() as u32;
    let mesh = CellMesh {
        points: Points::F64(all.clone().map(|[i, j, k]| at(i, j, k).to_array()).collect()),
        arrays,
        counts: CellCounts { in_file: count.into(), ..CellCounts::default() },
        ..CellMesh::empty()
    };
    if !as_polyhedra {
        return CellMesh { hexahedra: hexahedra.into(), file_from_hexahedron: (0..count).collect(), ..mesh };
    }
    let mut polyhedra = FaceLists::default();
    for corners in &hexahedra {
        for face in HEXAHEDRON.faces {
            polyhedra.push_face(&[0, 1, 2, 3].map(|i| corners[usize::from(face[i])]));
        }
        polyhedra.end_cell();
    }
    CellMesh { polyhedra, file_from_polyhedron: (0..count).collect(), ..mesh }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_have_as_many_cells_as_the_paper_s() {
        for paper in PAPER {
            for as_polyhedra in [false, true] {
                let dataset = Dataset::from_cells(grid(paper.points, as_polyhedra)).unwrap();
                assert_eq!(dataset.cells() as u64, paper.hexahedra, "{}", paper.name);
                assert_eq!(dataset.polyhedra.is_empty(), !as_polyhedra);
            }
        }
    }
}
