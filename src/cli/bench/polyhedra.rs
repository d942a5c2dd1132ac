//! `bench polyhedra`: Roettger and Ertl's figure 4, and what an order costs.
//!
//! The paper's four [`meshes`], each drawn as hexahedra and, by the signed depths of its faces, as polyhedra; truncated octahedra and Voronoi
//! cells besides. In emission, in maximum intensity and, in order, in emission-absorption. Cell data, as signed faces need it, and point
//! data. Nothing emits where the value is least, and cells of such values are left out, as in the paper; maxima leave out none. Checked:
//! frames as always, and that hexahedra and the same cells as polyhedra give one picture.

mod meshes;

use std::path::PathBuf;

use cellfan::generate::{Settings, honeycomb, voronoi};
use cellfan::{ControlPoint, Dataset, Field, FieldSelection, Model, RenderOptions, Renderer, Scene, TransferFunction};
use clap::Args;
use serde::Serialize;
use serde_json::json;

use self::meshes::{PAPER, PaperMesh, as_polyhedra};
use super::frames::{Frames, Shots};
use super::record::{Report, value};
use super::session::Session;
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
    /// A folder with classic/bluntfin.vts and classic/Bucky.nhdr, which are drawn instead of grids of their sizes [default: `CELLFAN_DATA` of the environment].
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
}

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
    fn frames(&self) -> [&Frames; 3] {
        [&self.emission, &self.mip, &self.emission_absorption]
    }

    fn mip_to_emission(&self) -> f64 {
        self.emission.time.median_ms / self.mip.time.median_ms
    }
}

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Outcome<Report> {
    let size_px = arguments.size.unwrap_or(if session.is_quick { [120, 96] } else { [512, 512] });
    let mut rows: Vec<Row> = Vec::new();
    let data = arguments.data.clone().or_else(|| std::env::var_os("CELLFAN_DATA").map(PathBuf::from));
    for paper in PAPER.into_iter().filter(|paper| !session.is_quick || paper.hexahedra < 2000) {
        let (name, mesh) = paper.hexahedra(data.as_deref())?;
        let polyhedra = as_polyhedra(&mesh);
        let [hexahedra, polyhedra] = [("hexahedra", mesh), ("polyhedra", polyhedra)].map(|(kind, mesh)| {
            let _progress = Progress::running(format!("drawing {name} as {kind}"));
            let dataset = Dataset::from_cells(mesh)?;
            let of = |is_cell_data| row((&name, kind), dataset.clone(), is_cell_data, Some(paper), size_px, session);
            Outcome::Ok([of(true)?, of(false)?])
        });
        let (hexahedra, polyhedra) = (hexahedra?, polyhedra?);
        for (one, other) in hexahedra.iter().zip(&polyhedra) {
            for (one, other) in one.frames().into_iter().zip(other.frames()) {
                let difference = one.first.difference(&other.first, [0.0; 4])?;
                ensure(difference.mean < 1e-4, || {
                    format!("{name}: hexahedra and the same cells as polyhedra differ by {}", difference.mean)
                })?;
            }
        }
        rows.extend(hexahedra.into_iter().chain(polyhedra));
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
    let (name, cells) = (mesh.to_owned(), dataset.cells() as u64);
    let transfer = glow(field.range, DEPTH / dataset.diagonal_world())?;
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

/// Optical depth over the mesh's diagonal at the largest value: no ray ends early.
const DEPTH: f64 = 3.0;

/// Light in proportion to the value, nothing at the least.
fn glow((low, high): (f64, f64), densest: f64) -> cellfan::Result<TransferFunction> {
    TransferFunction::new(vec![
        ControlPoint { value: low, color: [0.0, 0.5, 1.0], extinction: 0.0 },
        ControlPoint { value: high, color: [1.0, 0.5, 0.0], extinction: densest },
    ])
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
        "MIP : in order",
        "million cells/s, emission",
        "paper: cells",
        "frames/s",
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
            digits(row.emission_absorption.time.median_ms / row.mip.time.median_ms),
            digits(row.cells as f64 * rate(&row.emission) * 1e-6),
            row.paper.map_or_else(none, |paper| grouped(paper.hexahedra)),
            row.paper.map_or_else(none, |paper| digits(paper.frames_per_s)),
        ]);
    }
    table.remark(format!(
        "The paper's hexahedra, on an {PAPER_MACHINE}: 0.212 million a second in emission, 0.643 in MIP, which is {:.1} : 1. The sizes of its \
         pictures are not known. \"As\" is a grid of the mesh's numbers of points with the density of C60; generated phenomena leave out cells \
         without light.",
        PAPER_MIP / PAPER_EMISSION
    ));
    table
}
