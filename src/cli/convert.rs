//! `convert`: a mesh of any format, or several, as a container.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Instant;

use cellfan::Error;
use cellfan::columns::CellSource;
use cellfan::io::container::{self, Phase, WriteOptions, Written};
use cellfan::io::{Mesh, Scratch, WholeCells, check_target};
use clap::Args;

use super::arguments::{Cells, bytes as memory, one_of};
use super::meshes::{FORMATS, Raw};
use super::numbers::{bytes, count};
use super::progress::Progress;
use super::{Outcome, meshes};

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[arg(required = true, value_name = "MESH", help = FORMATS)]
    meshes: Vec<PathBuf>,
    #[command(flatten)]
    raw: Raw,
    /// The container to write.
    #[arg(value_name = "OUT.cells")]
    output: PathBuf,
    /// Memory for cells, arrays and sorting, 800M or 2Gi; what does not fit goes through temporary files in the output's
    /// folder. Points take 40 bytes each beside it, for a moment 76 where there are other cells than tetrahedra
    /// [default: 1Gi].
    #[arg(long, value_name = "BYTES", value_parser = memory, allow_hyphen_values = true)]
    memory: Option<u64>,
    /// Keep hexahedra, wedges, pyramids and voxels whole, structured blocks without a list of corners, regular grids with the octrees
    /// of their arrays; or cut all into tetrahedra.
    #[arg(long, value_name = "CELLS", default_value = "whole", value_parser = one_of(Cells::NAMED))]
    cells: Cells,
    /// Also write which cells share a face, which an order by neighbours then need not find: 16 bytes a tetrahedron, 24 a
    /// hexahedron, wedge, pyramid or voxel, nothing in structured blocks.
    #[arg(long)]
    adjacency: bool,
}

const EXAMPLES: &str = "\
Examples:
  cellfan convert mesh.vtu mesh.cells
  cellfan convert --adjacency mesh.vtu mesh.cells
  cellfan convert --cells tetrahedra grid.vts tetrahedra.cells
  cellfan convert --raw 256x256x110:u8 engine.raw engine.cells
  cellfan convert left.vtu right.vtu both.cells
  cellfan convert --memory 500M huge.vtu huge.cells";

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let (paths, output) = (&arguments.meshes, &arguments.output);
    check_name(output)?;
    check_target(output)?;
    if let Some(path) = meshes::one_container(paths, arguments.raw)? {
        let problem = format!("\"{}\" is a container already", path.display());
        return Err(Error::Option { option: "MESH", problem }.into());
    }
    let memory_bytes = arguments.memory.unwrap_or(WriteOptions::default().memory_bytes);
    // One half holds columns all the time, the other sorts.
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let scratch = Scratch::in_folder(folder, memory_bytes / 2);
    let options = WriteOptions { memory_bytes: memory_bytes / 2, adjacency: arguments.adjacency };
    let mesh = {
        let _progress = meshes::reading(paths);
        meshes::open(paths, arguments.raw, &scratch)?
    };
    let in_file = |error: Error| error.in_file(meshes::label(paths));
    if arguments.cells == Cells::Tetrahedra {
        let tets = {
            let _progress = Progress::running("cutting cells");
            mesh.into_tets_in(&scratch).map_err(in_file)?
        };
        write(&tets, output, &options).map_err(in_file)?;
        return Ok(());
    }
    let mesh = match mesh {
        Mesh::Volume(volume) => {
            told(output, |tell| container::write_volume(volume, output, tell)).map_err(in_file)?;
            return Ok(());
        }
        mesh => mesh,
    };
    match mesh.into_whole_in(&scratch).map_err(in_file)? {
        WholeCells::Listed(cells) => write(&cells, output, &options).map_err(in_file)?,
        WholeCells::Structured(cells) => {
            told(output, |tell| container::write_structured(cells, output, tell)).map_err(in_file)?
        }
    };
    Ok(())
}

/// Refuses names that would not be recognised as a container.
pub(super) fn check_name(output: &Path) -> cellfan::Result<()> {
    if is_container_name(output) {
        return Ok(());
    }
    let problem = format!("\"{}\": containers are written as .cells; end the name in it", output.display());
    Err(Error::Option { option: "OUT.cells", problem })
}

pub(super) fn is_container_name(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("cells"))
}

/// Writes a container with a bar for each phase, and says what was written.
pub(super) fn write(source: &dyn CellSource, output: &Path, options: &WriteOptions) -> cellfan::Result<Written> {
    told(output, |tell| container::write(source, output, options, tell))
}

/// Has a container written with a bar for each phase, and says what was written.
pub(super) fn told(
    output: &Path,
    write: impl FnOnce(&(dyn Fn(Phase, u64, u64) + Sync)) -> cellfan::Result<Written>,
) -> cellfan::Result<Written> {
    let start = Instant::now();
    let bar: Mutex<Option<(Phase, Progress)>> = Mutex::new(None);
    let tell = |phase: Phase, done: u64, of: u64| {
        let Ok(mut bar) = bar.lock() else { return };
        if bar.as_ref().is_none_or(|(shown, _)| *shown != phase) {
            *bar = None; // one leaves before the next appears
            *bar = Some((phase, Progress::counting(name(phase), of)));
        }
        if let Some((_, progress)) = &*bar {
            progress.reach(done);
        }
    };
    let written = write(&tell);
    drop(bar);
    let written = written?;
    let rate = written.cells as f64 / start.elapsed().as_secs_f64() / 1e6;
    let (narrow, blocks) = written.narrow_blocks;
    tracing::info!(
        "wrote {}: {}, {}, {}; {rate:.1} million cells/s",
        output.display(),
        count(written.cells, "cell"),
        count(written.vertices, "used point"),
        bytes(written.file_bytes),
    );
    tracing::debug!(narrow, blocks, "blocks with 16-bit vertex numbers");
    Ok(written)
}

fn name(phase: Phase) -> &'static str {
    match phase {
        Phase::Order => "ordering cells",
        Phase::Cells => "writing cells",
        Phase::Vertices => "writing vertices",
        Phase::Neighbours => "finding neighbours",
        Phase::Ranges => "finding ranges",
        Phase::Octrees => "building octrees",
    }
}
