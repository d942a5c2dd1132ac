//! The meshes of `bench hexahedra`, and what is measured of each.

use std::hint::black_box;
use std::path::PathBuf;

use cellfan::io::StructuredMesh;
use cellfan::stages::View;
use cellfan::stages::classify::polyhedra::Projection;
use cellfan::stages::fans::Faces;
use cellfan::stages::fans::polyhedra::CellFans;
use cellfan::stages::project::{project, scene_vertices};
use cellfan::{CpuMethod, Dataset, Error, Model, RenderOptions, Renderer, Result, Scene, SortMethod, TransferFunction};

use super::cases::Classified;
use super::{PAPER_CELLS, Row};
use crate::cli::bench::curvilinear::{half_ball, half_shell};
use crate::cli::bench::frames::{Shots, camera};
use crate::cli::bench::session::Session;
use crate::cli::bench::spread::measure as time;
use crate::cli::bench::subject::Subject;
use crate::cli::bench::{Outcome, ensure, pool};
use crate::cli::numbers::{count, grouped};
use crate::cli::progress::Progress;

/// A mesh and how it is drawn.
pub(super) struct HexMesh {
    name: String,
    dataset: Dataset,
    model: Model,
}

/// What a hexahedron takes while it is generated and drawn, in bytes.
const BYTES_PER_CELL: u64 = 1000;

/// Figures 13 (of the paper's size, and of `max_cells`) and 14.
pub(super) fn generated(max_cells: u64, session: &mut Session) -> Result<Vec<HexMesh>> {
    let mesh =
        |name: String, mesh: StructuredMesh, model| Ok(HexMesh { name, dataset: mesh.into_whole_dataset()?, model });
    let mut meshes = vec![mesh("half shell, as figure 14".to_owned(), half_shell()?, Model::EmissionAbsorption)?];
    let mut sizes = vec![PAPER_CELLS.min(max_cells), max_cells];
    sizes.dedup();
    for cells in sizes {
        if !session.admits(&format!("half a ball of {}", count(cells, "hexahedron")), cells * BYTES_PER_CELL, 0.0) {
            continue;
        }
        let _progress = Progress::running(format!("generating {} hexahedra", grouped(cells)));
        let name = if cells == PAPER_CELLS { "half ball, as figure 13" } else { "half ball" };
        meshes.push(mesh(name.to_owned(), half_ball(cells)?, Model::Absorption)?);
    }
    Ok(meshes)
}

/// The meshes of files.
pub(super) fn read(paths: &[PathBuf]) -> Result<Vec<HexMesh>> {
    let read = |path: &PathBuf| {
        let _progress = Progress::running(format!("reading {}", path.display()));
        let Subject { name, dataset, .. } = Subject::read(path, None)?;
        if dataset.hexahedra.is_empty() {
            let problem =
                "there is no cell with faces of four corners in it; bench cellfast draws tetrahedra".to_owned();
            return Err(Error::Option { option: "MESH", problem }.in_file(path));
        }
        Ok(HexMesh { name, dataset, model: Model::Absorption })
    };
    paths.iter().map(read).collect()
}

/// Classifies and draws one.
pub(super) fn measure(mesh: HexMesh, size_px: [u32; 2], session: &Session) -> Outcome<Row> {
    let HexMesh { name, dataset, model } = mesh;
    let _progress = Progress::running(format!("drawing {name}"));
    let extinction = 3.0 / dataset.diagonal_world();
    let field = dataset.homogeneous_field();
    let view = View::new(&camera(&dataset, size_px, 0.0), &dataset)?;
    let mut screen = Vec::new();
    project(&view, &scene_vertices(&dataset, &field), &mut screen);
    let wrong = |what: &str| format!("{name}: {what}");
    let Some(classified) = Classified::new(&dataset, &view, &screen) else {
        return Err(crate::cli::Failure::WrongAnswer(wrong("there is no table of cases for hexahedra")));
    };
    let counts = classified.counts();
    ensure(counts.accounted() == counts.cells, || wrong(&format!("not every cell has a fate: {counts:?}")))?;
    let ratio = classified.covered_ratio();
    ensure(counts.whole() == 0 || (ratio - 1.0).abs() < 1e-4, || {
        wrong(&format!("the triangles cover {ratio} times half the area of the faces"))
    })?;

    let usual = if counts.cells > 500_000 { 7 } else { 15 };
    let is_whole = |corners| matches!(classified.classify(corners), Projection::Whole(_));
    let check =
        |whole: &usize| ensure(*whole as u64 == counts.whole(), || wrong("a run counts other cases than the first"));
    let classify =
        |whole: &mut usize| *whole = classified.corners.iter().filter(|corners| is_whole(black_box(corners))).count();
    let classify = time(session, session.runs(usual), &mut 0, |_| {}, classify, check)?;
    let make = |whole: &mut usize| {
        *whole =
            classified.whole().map(|(corners, placed)| drop(black_box(CellFans::new(&placed, corners, 0)))).count();
    };
    let classify_and_fans = time(session, session.runs(usual), &mut 0, |_| {}, make, check)?;
    drop((classified, screen));

    let scene = Scene::new(dataset, field, &TransferFunction::constant([0.9, 0.7, 0.5], extinction)?);
    let footprints = RenderOptions { model, ..RenderOptions::default() };
    let fans =
        RenderOptions { cpu_method: CpuMethod::Fans, faces: Faces::Fan, sort: SortMethod::Topological, ..footprints };
    let draw = |options: RenderOptions| {
        // Fans on the processor are the slow twin: seconds a frame.
        let usual = if options.cpu_method == CpuMethod::Fans && counts.cells > 10_000 { 5 } else { usual };
        let shots = Shots { scene: &scene, name: &name, size_px, options, runs: session.runs(usual) };
        shots.draw(session, &mut Renderer::new(options))
    };
    let frame_by_fans_one_thread = pool(1)?.install(|| draw(fans))?;
    let frame_by_fans = draw(fans)?;
    let same = frame_by_fans.first.pixels == frame_by_fans_one_thread.first.pixels;
    ensure(same, || wrong("another number of threads gives another picture"))?;
    let frame_by_footprints = draw(footprints)?;
    let of_tetrahedra = |(class, _): &&(&str, u64)| class.starts_with("class");
    let tetrahedra = frame_by_fans.cells.by_class.iter().filter(of_tetrahedra).map(|(_, cells)| cells).sum();
    let layers = frame_by_fans.order.layers;
    Ok(Row {
        mesh: name,
        counts,
        classify,
        classify_and_fans,
        frame_by_fans_one_thread,
        frame_by_fans,
        frame_by_footprints,
        layers,
        tetrahedra,
    })
}
