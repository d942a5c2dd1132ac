//! `render`: a mesh becomes a picture, or several.
//!
//! In: [`Arguments`], checked as far as they can be before anything is read. Out: pictures, STATS.json, and a line on
//! stderr that says what was chosen: the array ([`array`]), the transfer function ([`transfer`]) and the view ([`view`]).

mod arguments;
mod array;
mod automatic;
mod backend;
mod bands;
mod heap;
mod memory;
mod pictures;
mod summary;
mod transfer;
mod view;

use std::path::{Path, PathBuf};
use std::time::Instant;

use cellfan::image::{Encoding, Format};
use cellfan::io::container;
use cellfan::optics::Output;
use cellfan::profile::{Profile, Stats, peak_rss_bytes};
use cellfan::{
    CpuMethod, Dataset, Error, Image, Model, RenderOptions, Rendered, Scene, SortMethod, TransferFunction, io,
};

pub(super) use arguments::Arguments;
use backend::Backend;
use bands::BandSource;
use memory::Memory;
use pictures::Pictures;
use summary::Summary;
use transfer::TransferSource;
use view::ViewSource;

use super::arguments::Cells;
use super::progress::Progress;
use super::{Outcome, meshes, stdout};

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let label = meshes::label(&arguments.meshes);
    let output_path = arguments.output_path();
    let options = options(arguments, &output_path)?;
    let mut backend = Backend::choose(arguments)?;
    let encoding = encoding(arguments);
    let mut pictures = Pictures::create(output_path, encoding, arguments.frames)?;
    let stats_path = arguments.stats.as_deref().filter(|path| *path != Path::new("-"));
    stats_path.map(io::check_target).transpose()?;
    let transfer = TransferSource::load(arguments)?;
    let bands = BandSource::load(arguments)?;
    let view = ViewSource::load(arguments)?;

    if arguments.memory.is_some() {
        meshes::check_budget(&arguments.meshes)?;
        heap::give_back_early();
    }
    let mut before = Profile::default();
    let is_whole = arguments.cells != Some(Cells::Tetrahedra);
    let mut dataset = read(&arguments.meshes, !arguments.no_mmap, is_whole, &mut before)?;
    let start = Instant::now();
    let (bands, band_note) = bands.make(&dataset).map_err(|error| error.in_file(&label))?;
    let field = match bands.first_array() {
        Some(field) => field.clone(),
        None => array::choose(&dataset, arguments.array.as_deref()).map_err(|error| error.in_file(&label))?,
    };
    let (transfer, note) = match band_note {
        // Bands that do not glow have no use for colours; arrays glow white where nothing else is said.
        Some(note) if options.model == Model::Absorption => (TransferFunction::constant([1.0; 3], 0.0)?, note),
        Some(note) if bands.are_arrays() && arguments.transfer.is_none() => {
            (TransferFunction::constant([1.0; 3], 0.0)?, format!("white, {note}"))
        }
        note => {
            let (transfer, transfer_note) = transfer.make(&dataset, &field, options.model)?;
            let bands = note.map(|bands| format!(", {bands}")).unwrap_or_default();
            (transfer, format!("{transfer_note}{bands}"))
        }
    };
    let (camera, view_note) = view.make(&dataset)?;
    let summary = Summary::new(&label, &dataset, &field, &view_note, &note);
    // The arrays are not needed any more.
    dataset.arrays = Vec::new();
    let scene = bands.give_to(Scene::new(dataset, field, &transfer)).map_err(|error| error.in_file(&label))?;
    before.add("field", start.elapsed(), 0);
    before.sample_memory();

    let memory = Memory::new(arguments.memory, &scene);
    let options = RenderOptions { memory_bytes: memory.of_frame()?, ..options };
    let mut renderer = backend.renderer(options);
    let mut after = Profile::default();
    let mut frames = Frames::default();
    let count = arguments.frames.unwrap_or(1);
    {
        let progress = match count {
            1 => Progress::running("drawing"),
            _ => Progress::counting("drawing", count.into()),
        };
        for frame in 0..count {
            let degrees = f64::from(frame) * arguments.orbit / f64::from(count);
            let camera = if frame == 0 { camera.clone() } else { camera.orbited(degrees) };
            let rendered =
                backend.render(&mut renderer, options, &scene, &camera).map_err(|error| memory.in_process(error))?;
            let start = Instant::now();
            pictures.push(&rendered)?;
            after.add("write", start.elapsed(), 0);
            after.sample_memory();
            frames.add(rendered, options);
            progress.step();
        }
    }
    let start = Instant::now();
    let written = pictures.finish()?;
    after.add("write", start.elapsed(), 0);

    let Some(last) = &frames.last else { return Ok(()) };
    let stats = Stats {
        cells: last.cells.clone(),
        triangles: last.triangles,
        order: last.order,
        before,
        frame: Profile::median(&frames.profiles),
        after,
        frames: frames.times_ms,
        backend: backend.name(),
        adapter: backend.adapter(),
        threads: rayon::current_num_threads(),
        peak_rss_bytes: peak_rss_bytes(),
        memory_bytes: arguments.memory,
    };
    backend.say();
    summary.say(&stats);
    if frames.are_blank {
        tracing::warn!(
            "no ray meets anything that shows: look elsewhere (--view), or give a --transfer with some extinction"
        );
    }
    tracing::info!("wrote {written}");
    tracing::debug!("stages\n{stats}");
    match (stats_path, &arguments.stats) {
        (Some(path), _) => stats.save(path)?,
        (None, Some(_)) => stdout::write(&stats.to_json())?,
        (None, None) => {}
    }
    Ok(())
}

/// What is kept of the frames.
#[derive(Default)]
struct Frames {
    profiles: Vec<Profile>,
    times_ms: Vec<f64>,
    /// The last frame, without its picture.
    last: Option<Rendered>,
    are_blank: bool,
}

impl Frames {
    fn add(&mut self, rendered: Rendered, options: RenderOptions) {
        let miss = if options.model == Model::Absorption { options.output.miss() } else { 0.0 };
        let covered = rendered.bands.as_ref().map_or(rendered.image.covered([miss; 4]), |bands| bands.covered(miss));
        self.are_blank = covered == 0 && (self.are_blank || self.last.is_none());
        self.profiles.push(rendered.profile.clone());
        self.times_ms.push(rendered.frame_ms);
        self.last = Some(Rendered { image: Image::filled(0, 0, [0.0; 4]), bands: None, ..rendered });
    }
}

/// Reads the meshes as one and puts its cells in order.
fn read(paths: &[PathBuf], use_map: bool, is_whole: bool, profile: &mut Profile) -> cellfan::Result<Dataset> {
    let _progress = meshes::reading(paths);
    let start = Instant::now();
    if let Some(path) = meshes::one_container(paths)? {
        let dataset = container::open(path, use_map)?;
        profile.add("read", start.elapsed(), if use_map { 0 } else { path.metadata().map_or(0, |file| file.len()) });
        if is_whole || dataset.hexahedra.is_empty() {
            return Ok(dataset);
        }
        let tetrahedra = profile.time("order", || dataset.into_tetrahedra()).map_err(|error| error.in_file(path));
        profile.sample_memory();
        return tetrahedra;
    }
    let mesh = io::open_meshes(paths)?;
    let bytes = paths.iter().map(|path| path.metadata().map_or(0, |file| file.len())).sum();
    profile.add("read", start.elapsed(), bytes);
    profile.sample_memory();
    let into_dataset = || if is_whole { mesh.into_whole_dataset() } else { mesh.into_dataset() };
    let dataset = profile.time("order", into_dataset).map_err(|error| error.in_file(meshes::label(paths)));
    profile.sample_memory();
    dataset
}

fn options(arguments: &Arguments, path: &Path) -> cellfan::Result<RenderOptions> {
    // The renderer would refuse it too, but only when the mesh has been read.
    if arguments.sort == SortMethod::Exact && arguments.cpu_method == CpuMethod::Fans {
        let problem = "exact needs --cpu-method footprints; with fans say --sort topological".to_owned();
        return Err(Error::Option { option: "--sort", problem });
    }
    let takes_all_cells =
        arguments.cpu_method == CpuMethod::Fans || arguments.check_order || arguments.sort == SortMethod::Topological;
    if arguments.memory.is_some() && takes_all_cells {
        let problem =
            "--cpu-method fans, --check-order and --sort topological take all cells at once and keep no budget"
                .to_owned();
        return Err(Error::Option { option: "--memory", problem });
    }
    if arguments.output == Output::Depth && Format::from_path(path)? == Format::Png {
        let problem = "a PNG cannot show optical depths; write .exr or .npy (-o OUT.exr)".to_owned();
        return Err(Error::Option { option: "--output", problem });
    }
    Ok(RenderOptions {
        model: arguments.model,
        integral: arguments.integral,
        output: arguments.output,
        sort: arguments.sort,
        stop_transmittance: arguments.stop,
        cpu_method: arguments.cpu_method,
        check_order: arguments.check_order,
        faces: arguments.faces,
        ..RenderOptions::default()
    })
}

fn encoding(arguments: &Arguments) -> Encoding {
    if arguments.model != Model::Absorption {
        return Encoding { background: arguments.background, ..Encoding::default() };
    }
    if arguments.background.is_some() {
        tracing::warn!("an absorption picture shows transmitted light and has no background: --background is ignored");
    }
    Encoding::TRANSMITTED
}
