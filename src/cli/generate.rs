//! `generate`: an analytic mesh or a phenomenon as a container or a .vtu file, or a volume as NRRD.

mod volume;
mod what;

use std::path::PathBuf;

use cellfan::Error;
use cellfan::columns::CellSource;
use cellfan::generate::{
    CellShape, MAX_JITTER, Orbital, PhenomenonSettings, Scheme, Settings, generate, honeycomb, phenomenon, source,
    voronoi,
};
use cellfan::io::container::WriteOptions;
use cellfan::io::{Compression, UnstructuredMesh, check_target, write_vtu};
use clap::Args;

use super::Outcome;
use super::arguments::{finite, named, one_of};
use super::convert::{self, is_container_name};
use super::numbers::count;
use super::progress::Progress;
use volume::VolumeArguments;
use what::What;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// What to generate.
    #[arg(value_parser = named::<What>(What::all().map(|what| (what.name(), what.description()))))]
    kind: What,
    /// The file to write: a container (.cells), streamed and of any size, or .vtu; a volume as .nrrd.
    #[arg(short = 'o', long = "out", value_name = "OUT")]
    output: PathBuf,
    /// Cells wanted; a grid has the fewest boxes that give as many.
    #[arg(long, value_name = "N", default_value_t = Settings::default().cells)]
    cells: u64,
    /// Seed of everything random.
    #[arg(long, value_name = "S", default_value_t = Settings::default().seed)]
    seed: u64,
    /// How far the vertices of a grid are moved, in spacings: 0 to 0.35.
    #[arg(long, value_name = "J", default_value_t = Settings::default().jitter, value_parser = finite, allow_hyphen_values = true)]
    jitter: f64,
    /// Tetrahedra a box of the grid.
    #[arg(long, default_value = "6", value_parser = one_of([("5", Scheme::Five), ("6", Scheme::Six)]))]
    scheme: Scheme,
    /// What a phenomenon's cells are.
    #[arg(long, default_value = "hexahedra", value_parser = one_of(SHAPES))]
    shape: CellShape,
    /// When, in seconds: phenomena move.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    time: f64,
    /// Quantum numbers of the orbital.
    #[arg(long, value_name = "N,L,M", value_parser = orbital, default_value = "4,2,0")]
    orbital: Orbital,
    /// Delaunay: random points alone, without those that make the mesh fill its cube.
    #[arg(long)]
    no_fill: bool,
    /// In a .vtu or .nrrd: write the arrays as they are, not compressed: faster to write and to read, a volume in place.
    #[arg(long)]
    raw: bool,
    #[command(flatten)]
    volume: VolumeArguments,
}

const SHAPES: [(&str, CellShape); 3] =
    [("tetrahedra", CellShape::Tetrahedra), ("prisms", CellShape::Prisms), ("hexahedra", CellShape::Hexahedra)];

const EXAMPLES: &str = "\
Examples:
  cellfan generate tets --cells 1000000 -o tets.vtu
  cellfan generate orbital --orbital 3,2,1 --cells 500000 -o orbital.vtu
  cellfan generate tets --cells 100000000 -o huge.cells
  cellfan generate voronoi --cells 20000 -o voronoi.vtu
  cellfan generate delaunay --cells 200000 --seed 7 --no-fill --raw -o delaunay.vtu
  cellfan generate camp-fire --shape prisms --time 2.5 -o fire.vtu
  cellfan generate volume --dims 256x256x110 --raw -o rings.nrrd";

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let what = arguments.kind;
    if let What::Volume = what {
        return volume::run(arguments);
    }
    let path = &arguments.output;
    let is_container = is_container_name(path);
    if !is_container && !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("vtu")) {
        let problem = format!("\"{}\": meshes are written as .vtu or .cells; end the name in it", path.display());
        return Err(Error::Option { option: "--out", problem }.into());
    }
    if !(0.0..=MAX_JITTER).contains(&arguments.jitter) {
        let problem = format!("{} is not between 0 and {MAX_JITTER} spacings", arguments.jitter);
        return Err(Error::Option { option: "--jitter", problem }.into());
    }
    check_target(path)?;
    let settings = Settings {
        cells: arguments.cells,
        seed: arguments.seed,
        jitter: arguments.jitter,
        scheme: arguments.scheme,
        fill_cube: !arguments.no_fill,
        orbital: arguments.orbital,
    };
    if is_container {
        let source: Box<dyn CellSource> = {
            let _progress = Progress::running(format!("generating {what}"));
            match what {
                What::Mesh(kind) => source(kind, &settings)?,
                What::Phenomenon(kind) => Box::new(phenomenon(kind, &arguments.phenomenon())?),
                What::Honeycomb => Box::new(honeycomb(&settings)?),
                What::Voronoi => Box::new(voronoi(&settings)?),
                What::Volume => return volume::run(arguments),
            }
        };
        convert::write(source.as_ref(), path, &WriteOptions::default())?;
        return Ok(());
    }
    let mesh = {
        let _progress = Progress::running(format!("generating {what}"));
        match what {
            What::Mesh(kind) => UnstructuredMesh::from_tets(&generate(kind, &settings)?),
            What::Phenomenon(kind) => UnstructuredMesh::from_cells(&phenomenon(kind, &arguments.phenomenon())?),
            What::Honeycomb => UnstructuredMesh::from_cells(&honeycomb(&settings)?),
            What::Voronoi => UnstructuredMesh::from_cells(&voronoi(&settings)?),
            What::Volume => return volume::run(arguments),
        }
    };
    let compression = if arguments.raw { Compression::None } else { Compression::Zlib };
    {
        let _progress = Progress::running(format!("writing {}", path.display()));
        write_vtu(path, &mesh, compression)?;
    }
    let (cells, points) = (count(mesh.cells() as u64, "cell"), count(mesh.points.len() as u64, "point"));
    tracing::info!("wrote {}: {cells}, {points}", path.display());
    Ok(())
}

impl Arguments {
    fn phenomenon(&self) -> PhenomenonSettings {
        PhenomenonSettings { cells: self.cells, shape: self.shape, seed: self.seed, time_s: self.time }
    }
}

/// `N,L,M`.
fn orbital(text: &str) -> Result<Orbital, String> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let parsed = match parts[..] {
        [n, l, m] => n.parse().ok().zip(l.parse().ok()).zip(m.parse().ok()),
        _ => None,
    };
    let ((n, l), m) = parsed.ok_or("expected N,L,M, such as 4,2,0")?;
    Ok(Orbital { n, l, m })
}
