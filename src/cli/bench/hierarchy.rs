//! `bench hierarchy`: the octree of a regular grid, its selections and their pictures, beside Schussman and Max's figure 9.
//!
//! Without a volume a stand-in for the paper's engine block is generated, of its size and type. Selections of one thread and of all are
//! the same cubes, and pictures by footprints and by fans the same pixels, or the program ends.

use std::path::PathBuf;

use cellfan::columns::{Volume, VolumeField};
use cellfan::generate::{SampleType, Signal, volume};
use cellfan::hierarchy::Hierarchy;
use cellfan::io::{Mesh, Scratch};
use cellfan::render::{CubeScene, CubeStats, Detail};
use cellfan::{
    Camera, ControlPoint, CpuMethod, Error, FieldSelection, Image, RenderOptions, Rendered, Renderer, TransferFunction,
};
use clap::Args;
use serde::Serialize;
use serde_json::json;

use super::record::{Report, value};
use super::session::Session;
use super::spread::{Spread, measure};
use super::tables::{Table, digits, percent};
use super::{Outcome, ensure, pool};
use crate::cli::arguments::{share, size};
use crate::cli::meshes::{self, Raw};
use crate::cli::numbers::{count, grouped};
use crate::cli::progress::Progress;

#[derive(Args)]
pub(super) struct Arguments {
    /// A regular grid: .vti, NRRD, structured points, or with --raw raw samples [default: a generated one of 256x256x110 bytes].
    #[arg(value_name = "VOLUME")]
    volume: Option<PathBuf>,
    #[command(flatten)]
    raw: Raw,
    /// Tolerances, as shares of the range of values.
    #[arg(long, value_name = "SHARE,…", value_delimiter = ',', default_value = "0,18%,48%", value_parser = share)]
    errors: Vec<f64>,
    /// Size of the pictures in pixels.
    #[arg(long, value_name = "WxH", default_value = "512x512", value_parser = size)]
    size: [u32; 2],
}

/// The paper's figure 9: error, cubes, triangles, seconds of selection and of rendering; what it leaves open is missing.
const PAPER: [(&str, f64, Option<f64>, f64, f64); 3] = [
    ("0 %", 5.20e6, None, 0.85, 37.5),
    ("18 %", 0.19e6, Some(2.3e6), 0.036, 0.95),
    ("48 %", 15.8e3, Some(0.19e6), 0.0019, 0.070),
];

/// What one tolerance gives.
#[derive(Serialize)]
struct Row {
    error: f64,
    cubes: u64,
    triangles: u64,
    nodes_visited: u64,
    select_one_thread: Spread,
    nodes_per_s: f64,
    select: Spread,
    footprints: Spread,
    fans: Spread,
}

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Outcome<Report> {
    let (name, volume) = read(arguments, session.is_quick)?;
    let field = match volume.arrays.first() {
        Some(array) => volume.field(&FieldSelection::parse(&array.name, &volume.arrays))?,
        None => volume.homogeneous_field(),
    };
    let build = build(&field, session)?;
    let transfer = transfer(&volume, &field)?;
    let scene = CubeScene::new(&volume, field, &transfer)?;
    let [width, height] = if session.is_quick { [128, 128] } else { arguments.size };
    let camera = Camera::framing(&scene.grid().corners_world(), 35.0, 20.0, width, height);
    let rows: Vec<Row> =
        arguments.errors.iter().map(|&error| row(&scene, error, &camera, session)).collect::<Outcome<_>>()?;
    let sizes = scene.grid().dims.map(|side| side.to_string()).join(" x ");
    let paper = PAPER.map(|(error, cubes, triangles, select_s, draw_s)| {
        json!({ "error": error, "cubes": cubes, "triangles": triangles, "selection_s": select_s, "rendering_s": draw_s })
    });
    Ok(Report {
        benchmark: "hierarchy",
        settings: json!({ "volume": name, "dims": scene.grid().dims, "size_px": [width, height], "view": [35.0, 20.0] }),
        results: json!({
            "build": value(build),
            "nodes": scene.hierarchy().nodes(),
            "rows": value(&rows),
            "paper": { "source": "Schussman and Max 2001, figure 9", "machine": "Pentium 4, 1.4 GHz, GeForce 2", "rows": paper },
        }),
        tables: vec![figure_9(&name, &sizes, (width, height), &rows), of_tree(&scene, &build, &rows), printed()],
    })
}

/// The volume, and what to call it.
fn read(arguments: &Arguments, is_quick: bool) -> Outcome<(String, Volume)> {
    let Some(path) = &arguments.volume else {
        let dims = if is_quick { [33, 30, 20] } else { [256, 256, 110] };
        let _progress = Progress::running("generating a volume");
        return Ok(("generated, density of C60".to_owned(), volume(dims, Signal::Buckyball, SampleType::U8)?));
    };
    let _progress = Progress::running(format!("reading {}", path.display()));
    if let Mesh::Volume(volume) = meshes::open(std::slice::from_ref(path), arguments.raw, &Scratch::memory())? {
        Ok((path.display().to_string(), volume))
    } else {
        let problem = format!("{} is no regular grid (.vti, NRRD, structured points, raw samples)", path.display());
        Err(Error::Option { option: "VOLUME", problem }.into())
    }
}

/// Nothing up to a tenth of the range, as around the paper's engine block; then more and more.
fn transfer(volume: &Volume, field: &VolumeField) -> cellfan::Result<TransferFunction> {
    let corners = volume.corners_world();
    let diagonal = corners[0].distance(corners[7]);
    let (low, high) = field.range;
    let point = |share: f64, color, depth: f64| ControlPoint {
        value: low + (high - low) * share,
        color,
        extinction: depth / diagonal,
    };
    if low >= high {
        return TransferFunction::constant([1.0; 3], 2.0 / diagonal);
    }
    let (dark, bright) = ([0.1, 0.2, 0.6], [1.0, 0.9, 0.7]);
    TransferFunction::new(vec![point(0.0, dark, 0.0), point(0.1, dark, 0.0), point(1.0, bright, 60.0)])
}

fn build(field: &VolumeField, session: &Session) -> Outcome<Spread> {
    let _progress = Progress::running("building the octree");
    let mut trees = Vec::new();
    let samples = field.len() as u64;
    measure(
        session,
        session.runs(5),
        &mut trees,
        Vec::clear,
        |trees| trees.push(Hierarchy::new(field)),
        |trees| match trees.first() {
            Some(Ok(tree)) => ensure(tree.nodes() >= samples, || "the octree lacks nodes".to_owned()),
            _ => Ok(()),
        },
    )
}

/// Selects and draws one tolerance in each way.
fn row(scene: &CubeScene, error: f64, camera: &Camera, session: &Session) -> Outcome<Row> {
    let _progress = Progress::running(format!("drawing cubes within {}", percent(error)));
    let one_thread = pool(1)?;
    let draw = |renderer: &mut Renderer| renderer.render_cubes(scene, Detail::Error(error), camera);
    let options = RenderOptions::default();
    let mut tiles = Renderer::new(options);
    let mut fans = Renderer::new(RenderOptions { cpu_method: CpuMethod::Fans, ..options });
    let alone = several(session, session.runs(3), || one_thread.install(|| draw(&mut tiles)))?;
    let together = several(session, session.runs(5), || draw(&mut tiles))?;
    let by_fans = several(session, session.runs(1), || draw(&mut fans))?;
    let [(_, stats), (tiled, of_all), (fanned, _)] = [&alone.last, &together.last, &by_fans.last];
    ensure(stats.cubes == of_all.cubes && stats.visited == of_all.visited, || {
        format!("one thread selects {}, all {}", count(stats.cubes, "cube"), of_all.cubes)
    })?;
    let apart = mean_difference(&tiled.image, &fanned.image);
    ensure(apart < 1e-4, || format!("footprints and fans differ by {apart:.1e}"))?;
    Ok(Row {
        error,
        cubes: stats.cubes,
        triangles: fanned.triangles,
        nodes_visited: stats.visited,
        select_one_thread: alone.select,
        nodes_per_s: stats.visited as f64 / alone.select.median_s(),
        select: together.select,
        footprints: together.draw,
        fans: by_fans.draw,
    })
}

/// Frames, and what they took.
struct Frames {
    select: Spread,
    draw: Spread,
    last: (Rendered, CubeStats),
}

fn several(
    session: &Session,
    runs: usize,
    mut draw: impl FnMut() -> cellfan::Result<(Rendered, CubeStats)>,
) -> Outcome<Frames> {
    let mut last = draw()?;
    let (mut select_ms, mut draw_ms) = (Vec::new(), Vec::new());
    for run in 1..session.warm_up + runs.max(1) {
        last = draw()?;
        if run >= session.warm_up {
            select_ms.push(last.1.select_ms);
            draw_ms.push(last.1.draw_ms);
        }
    }
    if select_ms.is_empty() {
        (select_ms, draw_ms) = (vec![last.1.select_ms], vec![last.1.draw_ms]);
    }
    Ok(Frames { select: Spread::of(select_ms), draw: Spread::of(draw_ms), last })
}

fn mean_difference(a: &Image, b: &Image) -> f64 {
    let pairs = a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
    pairs.map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / a.pixels.as_flattened().len() as f64
}

fn figure_9(name: &str, sizes: &str, (width, height): (u32, u32), rows: &[Row]) -> Table {
    let title = format!("{name}, {sizes} samples, {width}x{height} pixels (as figure 9)");
    let head = ["error", "cubes", "triangles", "selection, ms", "rendering, ms: footprints", "fans"];
    let mut table = Table::new(title, &head);
    for row in rows {
        let times = [row.select.median_ms, row.footprints.median_ms, row.fans.median_ms].map(digits);
        let counts = [percent(row.error), grouped(row.cubes), grouped(row.triangles)];
        table.row(counts.into_iter().chain(times));
    }
    table.remark("Cubes that show nothing are left out. Triangles are those of fans; footprints have none.");
    table
}

fn of_tree(scene: &CubeScene, build: &Spread, rows: &[Row]) -> Table {
    let nodes = count(scene.hierarchy().nodes(), "node");
    let title = format!("The octree: {nodes}, built in {} ms; selection by one thread", digits(build.median_ms));
    let mut table = Table::new(title, &["error", "nodes visited", "ms", "million nodes/s"]);
    for row in rows {
        let figures = [row.select_one_thread.median_ms, row.nodes_per_s * 1e-6].map(digits);
        table.row([percent(row.error), grouped(row.nodes_visited)].into_iter().chain(figures));
    }
    table
}

fn printed() -> Table {
    let title = "Schussman and Max 2001, figure 9: engine block, 256x256x110 samples; Pentium 4 of 1.4 GHz, GeForce 2";
    let mut table = Table::new(title, &["error", "cubes", "triangles", "selection, ms", "rendering, ms"]);
    for (error, cubes, triangles, select_s, draw_s) in PAPER {
        let triangles = triangles.map_or("not given".to_owned(), |triangles| grouped(triangles as u64));
        let times = [select_s * 1e3, draw_s * 1e3].map(digits);
        table.row([error.to_owned(), grouped(cubes as u64), triangles].into_iter().chain(times));
    }
    table
}
