//! What `render` and `profile` draw: from arguments to a scene, a camera and a renderer.
//!
//! In: [`Arguments`] and meshes. Out: a [`Request`], checked as far as it can be before anything is read; then a [`Setup`] that draws
//! frames. What was chosen is said in one line: the array ([`array`]), the transfer function ([`transfer`]), the view ([`view`]).

mod arguments;
mod array;
mod automatic;
mod backend;
mod bands;
mod composite;
mod cubes;
mod geometry;
mod heap;
mod memory;
mod planes;
mod summary;
mod transfer;
mod view;
mod volume;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use cellfan::hierarchy::Interpolation;
use cellfan::image::DepthImage;
use cellfan::io::{Scratch, container};
use cellfan::optics::lighting::Lighting;
use cellfan::profile::{MeshRecord, Profile};
use cellfan::render::Detail;
use cellfan::{
    Camera, CpuMethod, Dataset, Error, Model, RenderOptions, Rendered, Renderer, Scene, SortMethod, TransferFunction,
    depth_planes,
};

pub(super) use arguments::Arguments;
pub(super) use backend::{Backend, Device};
use bands::BandSource;
pub(super) use composite::Composite;
use cubes::CubesDrawer;
pub(super) use geometry::Geometry;
use geometry::ReadTriangles;
use memory::Memory;
use planes::PlanesDrawer;
use serde_json::Value;
use summary::Summary;
use transfer::TransferSource;
use view::ViewSource;

use super::arguments::Cells;
use super::meshes;

/// What was asked for, found possible without reading the meshes.
pub(super) struct Request<'a> {
    meshes: &'a [PathBuf],
    frames: u32,
    arguments: &'a Arguments,
    options: RenderOptions,
    backend: Backend,
    transfer: TransferSource,
    bands: BandSource,
    view: ViewSource,
    triangles: ReadTriangles,
    external: Option<Arc<DepthImage>>,
    planes: depth_planes::Options,
    /// How fine cubes are, where they draw.
    cubes: Option<Detail>,
    /// The light that cells and cubes reflect.
    lighting: Option<Lighting>,
}

/// What is drawn, by what.
enum Drawer {
    Cells { scene: Box<Scene>, renderer: Box<Renderer>, memory: Memory },
    Planes(Box<PlanesDrawer>),
    Cubes(Box<CubesDrawer>),
}

/// A scene, the first camera, and what draws them.
pub(super) struct Setup {
    pub(super) camera: Camera,
    pub(super) options: RenderOptions,
    pub(super) backend: Backend,
    pub(super) summary: Summary,
    /// What reading took.
    pub(super) before: Profile,
    /// What to call the transfer function.
    pub(super) transfer_note: String,
    drawer: Drawer,
}

impl<'a> Request<'a> {
    /// Checks the arguments, finds a device, reads all files but the meshes, which are drawn in `frames` views.
    pub(super) fn new(
        meshes: &'a [PathBuf],
        frames: u32,
        arguments: &'a Arguments,
        geometry: &Geometry,
        composite: Option<&Composite>,
    ) -> cellfan::Result<Self> {
        let view = ViewSource::load(arguments)?;
        let triangles = geometry.read()?;
        let external = composite.map(|composite| composite.read(&view)).transpose()?.flatten();
        let depth = composite.is_some_and(|composite| composite.depth.is_some());
        let has_others = depth || external.is_some() || !triangles.is_empty();
        Ok(Self {
            meshes,
            frames,
            arguments,
            options: RenderOptions { geometry: geometry.options(), depth, ..options(arguments)? },
            planes: arguments.planes.options(arguments)?,
            lighting: arguments.planes.lighting_of_cells(arguments)?,
            cubes: arguments.cubes.detail(arguments, &geometry.options(), has_others)?,
            backend: if arguments.planes.are_chosen() {
                Backend::processor(&arguments.device)?
            } else {
                Backend::choose(&arguments.device, arguments.needs_processor())?
            },
            transfer: TransferSource::load(arguments)?,
            bands: BandSource::load(arguments)?,
            triangles,
            external,
            view,
        })
    }

    /// Reads the meshes and makes the scene.
    pub(super) fn read(self) -> cellfan::Result<Setup> {
        if self.arguments.planes.are_chosen() || self.cubes.is_some() {
            return self.read_volume();
        }
        let Self {
            meshes,
            frames,
            arguments,
            options,
            backend,
            transfer,
            bands,
            view,
            lighting,
            triangles,
            external,
            ..
        } = self;
        let meshes = &arguments.at_time(meshes)?;
        let label = meshes::label(meshes);
        if arguments.memory.is_some() {
            meshes::check_budget(meshes)?;
            heap::give_back_early();
        }
        let mut before = Profile::default();
        let is_whole = arguments.cells != Some(Cells::Tetrahedra);
        let mut dataset = read(meshes, arguments, is_whole, &mut before)?;
        let start = Instant::now();
        let (bands, band_note) = bands.make(&dataset).map_err(|error| error.in_file(&label))?;
        let field = match bands.first_array() {
            Some(field) => field.clone(),
            None => array::choose(&dataset, arguments.array.as_deref()).map_err(|error| error.in_file(&label))?,
        };
        let (transfer, transfer_note) = match band_note {
            // Bands that do not glow, or in colours of their own, have no use for others; arrays glow white where nothing else is said.
            Some(note) if options.model != Model::EmissionAbsorption => {
                (TransferFunction::constant([1.0; 3], 0.0)?, note)
            }
            Some(note) if bands.are_arrays() && arguments.transfer.is_none() => {
                (TransferFunction::constant([1.0; 3], 0.0)?, format!("white, {note}"))
            }
            note => {
                let (transfer, transfer_note) = transfer.make(&dataset, &field, options.model)?;
                let bands = note.map(|bands| format!(", {bands}")).unwrap_or_default();
                (transfer, format!("{transfer_note}{bands}"))
            }
        };
        let (camera, view_note) = view.make(&dataset.corners_world())?;
        let array = (field.name.as_str(), field.association, field.range);
        let notes = (view_note.as_str(), transfer_note.as_str());
        let summary = Summary::new(&label, dataset.counts, !dataset.arrays.is_empty(), array, notes);
        // The arrays are not needed any more.
        dataset.arrays = Vec::new();
        let mut scene = bands.give_to(Scene::new(dataset, field, &transfer)).map_err(|error| error.in_file(&label))?;
        triangles.give_to(&mut scene)?;
        scene.set_external(external);
        before.add("field", start.elapsed(), 0);
        before.sample_memory();

        let memory = Memory::new(arguments.memory, &scene);
        let cpu_method = cpu_method(arguments, scene.dataset().cells(), frames, [camera.width, camera.height]);
        let options = RenderOptions { memory_bytes: memory.of_frame()?, cpu_method, ..options };
        let mut renderer = Box::new(backend.renderer(options));
        renderer.set_lighting(lighting);
        let drawer = Drawer::Cells { scene: Box::new(scene), renderer, memory };
        Ok(Setup { camera, options, backend, summary, before, transfer_note, drawer })
    }

    /// Reads a volume to be drawn on depth planes or as cubes.
    fn read_volume(self) -> cellfan::Result<Setup> {
        let Self {
            meshes,
            arguments,
            options,
            backend,
            transfer,
            view,
            planes,
            cubes,
            lighting,
            triangles,
            external,
            ..
        } = self;
        let mut before = Profile::default();
        let (volume, stored) = volume::read(meshes, arguments, &mut before)?;
        let start = Instant::now();
        let label = meshes::label(meshes);
        let chosen = volume::choose(volume, arguments, &transfer, view, options.model, &label)?;
        before.add("field", start.elapsed(), 0);
        let volume::Chosen { mut scene, camera, summary, transfer_note } = chosen;
        triangles.give_to_volume(&mut scene)?;
        scene.set_external(external);
        let drawer = match cubes {
            None => {
                let drawer = PlanesDrawer { scene, options: planes, geometry: options.geometry, depth: options.depth };
                Drawer::Planes(Box::new(drawer))
            }
            Some(detail) => {
                let size = [scene.volume().cells(), scene.volume().points()];
                let start = Instant::now();
                let interpolation = arguments.planes.interpolation()?;
                let stored = stored.filter(|_| interpolation == Interpolation::Constant);
                let stored = stored.map(|stored| stored.hierarchy(scene.field())).transpose()?.flatten();
                let scene = scene.into_cubes(interpolation, stored).map_err(|error| error.in_file(&label))?;
                before.add("hierarchy", start.elapsed(), scene.hierarchy().nodes() * 12);
                before.sample_memory();
                let mut renderer = backend.renderer(options);
                renderer.set_lighting(lighting);
                Drawer::Cubes(Box::new(CubesDrawer { scene, renderer, detail, size }))
            }
        };
        Ok(Setup { camera, options, backend, summary, before, transfer_note, drawer })
    }
}

impl Arguments {
    /// What only the processor can do.
    fn needs_processor(&self) -> Option<&'static str> {
        if self.memory.is_some() {
            return Some("--memory is kept on the CPU only (a GPU has --gpu-memory)");
        }
        if let Some(problem) = self.planes.needs_processor() {
            return Some(problem);
        }
        (self.cpu_method == Some(CpuMethod::Fans)).then_some("--cpu-method fans is the CPU's")
    }

    /// The meshes, at the time that was asked for.
    fn at_time(&self, meshes: &[PathBuf]) -> cellfan::Result<Vec<PathBuf>> {
        match self.time {
            Some(time) => meshes.iter().map(|path| cellfan::io::openfoam_time(path, time)).collect(),
            None => Ok(meshes.to_vec()),
        }
    }

    /// Everything that was chosen and may change what frames take, by name.
    pub(super) fn settings(&self, setup: &Setup) -> BTreeMap<String, Value> {
        let cells = if self.cells == Some(Cells::Tetrahedra) { "tetrahedra" } else { "whole" };
        let more: [(&str, Value); 11] = [
            ("adapter", setup.backend.adapter().into()),
            ("array", setup.array_name().into()),
            ("backend", setup.backend.name().into()),
            ("bands", setup.band_names().into()),
            ("cells", cells.into()),
            ("gpu_memory", self.device.gpu_memory.into()),
            ("memory", self.memory.into()),
            ("mesh_triangles", setup.added_triangles().into()),
            ("no_mmap", self.no_mmap.into()),
            ("threads", rayon::current_num_threads().into()),
            ("transfer", setup.transfer_note.clone().into()),
        ];
        let mut settings = setup.options.settings();
        if self.planes.are_chosen() {
            settings.insert("method".to_owned(), "depth-planes".into());
        }
        if let Drawer::Cubes(drawer) = &setup.drawer {
            settings.insert("method".to_owned(), format!("cubes, {:?}", drawer.detail).into());
        }
        settings.extend(more.into_iter().map(|(name, value)| (name.to_owned(), value)));
        settings
    }
}

impl Setup {
    /// Draws one frame.
    pub(super) fn draw(&mut self, camera: &Camera) -> cellfan::Result<Rendered> {
        let Self { options, backend, drawer, .. } = self;
        match drawer {
            Drawer::Cells { scene, renderer, memory } => {
                let draw = |renderer: &mut Renderer| renderer.render(scene, camera);
                backend.render(&mut **renderer, *options, draw).map_err(|error| memory.in_process(error))
            }
            Drawer::Planes(drawer) => drawer.draw(camera, None),
            Drawer::Cubes(drawer) => drawer.draw(backend, *options, camera),
        }
    }

    /// How many depth planes the first view has.
    pub(super) fn plane_count(&self) -> cellfan::Result<u32> {
        match &self.drawer {
            Drawer::Cells { .. } | Drawer::Cubes(_) => {
                let problem = "is for depth planes; add --method depth-planes".to_owned();
                Err(Error::Option { option: "--cross-sections", problem })
            }
            Drawer::Planes(drawer) => drawer.count(&self.camera),
        }
    }

    /// Draws one plane of the first view alone.
    pub(super) fn draw_plane(&mut self, plane: u32) -> cellfan::Result<Rendered> {
        match &self.drawer {
            Drawer::Cells { .. } | Drawer::Cubes(_) => self.draw(&self.camera.clone()),
            Drawer::Planes(drawer) => drawer.draw(&self.camera, Some(plane)),
        }
    }

    /// What the array is called.
    fn array_name(&self) -> String {
        match &self.drawer {
            Drawer::Cells { scene, .. } => scene.field().name.clone(),
            Drawer::Planes(drawer) => drawer.scene.field().name.clone(),
            Drawer::Cubes(drawer) => drawer.scene.field().name.clone(),
        }
    }

    fn added_triangles(&self) -> u64 {
        match &self.drawer {
            Drawer::Cells { scene, .. } => scene.added_triangles(),
            Drawer::Planes(drawer) => drawer.scene.added_triangles(),
            Drawer::Cubes(_) => 0,
        }
    }

    fn band_names(&self) -> Vec<String> {
        match &self.drawer {
            Drawer::Cells { scene, .. } => scene.band_names(),
            Drawer::Planes(_) | Drawer::Cubes(_) => Vec::new(),
        }
    }

    /// What a report says of the mesh.
    pub(super) fn mesh_record(&self, name: &str) -> MeshRecord {
        match &self.drawer {
            Drawer::Cells { scene, .. } => scene.mesh_record(name),
            Drawer::Cubes(drawer) => drawer.mesh_record(name),
            Drawer::Planes(drawer) => {
                let volume = drawer.scene.volume();
                MeshRecord { name: name.to_owned(), cells: volume.cells() as u64, vertices: volume.points() as u64 }
            }
        }
    }

    /// Says that no frame shows anything.
    pub(super) fn warn_blank() {
        tracing::warn!(
            "no ray meets anything that shows: look elsewhere (--view), or give a --transfer with some extinction"
        );
    }

    /// The camera of frame `frame` of `count` that turn the eye by `degrees` in all.
    pub(super) fn orbited(&self, frame: u32, count: u32, degrees: f64) -> Camera {
        if frame == 0 {
            self.camera.clone()
        } else {
            self.camera.orbited(f64::from(frame) * degrees / f64::from(count))
        }
    }
}

/// Reads the meshes as one and puts its cells in order.
fn read(paths: &[PathBuf], arguments: &Arguments, is_whole: bool, profile: &mut Profile) -> cellfan::Result<Dataset> {
    let (use_map, raw) = (!arguments.no_mmap, arguments.raw);
    let _progress = meshes::reading(paths);
    let start = Instant::now();
    if let Some(path) = meshes::one_container(paths, raw)? {
        let dataset = container::open(path, use_map)?;
        profile.add("read", start.elapsed(), if use_map { 0 } else { path.metadata().map_or(0, |file| file.len()) });
        if is_whole || dataset.hexahedra.is_empty() {
            return Ok(dataset);
        }
        let tetrahedra = profile.time("order", || dataset.into_tetrahedra()).map_err(|error| error.in_file(path));
        profile.sample_memory();
        return tetrahedra;
    }
    let scratch = if use_map { Scratch::memory() } else { Scratch::unmapped() };
    let mesh = meshes::open(paths, raw, &scratch)?;
    let bytes = paths.iter().map(|path| path.metadata().map_or(0, |file| file.len())).sum();
    profile.add("read", start.elapsed(), bytes);
    profile.sample_memory();
    let into_dataset = || if is_whole { mesh.into_whole_dataset() } else { mesh.into_dataset() };
    let dataset = profile.time("order", into_dataset).map_err(|error| error.in_file(meshes::label(paths)));
    profile.sample_memory();
    dataset
}

/// What composites on the CPU where nothing is said: rays where order counts, there are more cells than pixels, and frames enough that it pays to find what
/// lies across each face, which takes as long as one or two of them.
fn cpu_method(arguments: &Arguments, cells: usize, frames: u32, [width, height]: [u32; 2]) -> CpuMethod {
    const OFTEN: u32 = 3;
    let is_ordered = arguments.model == Model::EmissionAbsorption;
    let takes_any_order = matches!(arguments.sort, SortMethod::Auto | SortMethod::Exact) && !arguments.check_order;
    let has_more_cells = cells as u64 > u64::from(width) * u64::from(height);
    match arguments.cpu_method {
        Some(method) => method,
        None if frames >= OFTEN && has_more_cells && is_ordered && takes_any_order => CpuMethod::Rays,
        None => CpuMethod::Footprints,
    }
}

fn options(arguments: &Arguments) -> cellfan::Result<RenderOptions> {
    // The renderer would refuse it too, but only when the mesh has been read.
    if arguments.sort == SortMethod::Exact && arguments.cpu_method == Some(CpuMethod::Fans) {
        let problem = "exact needs --cpu-method footprints; with fans say --sort topological".to_owned();
        return Err(Error::Option { option: "--sort", problem });
    }
    let takes_all_cells = arguments.cpu_method == Some(CpuMethod::Fans)
        || arguments.check_order
        || arguments.sort == SortMethod::Topological;
    if arguments.memory.is_some() && takes_all_cells {
        let problem =
            "--cpu-method fans, --check-order and --sort topological take all cells at once and keep no budget"
                .to_owned();
        return Err(Error::Option { option: "--memory", problem });
    }
    Ok(RenderOptions {
        model: arguments.model,
        integral: arguments.integral,
        output: arguments.output,
        sort: arguments.sort,
        stop_transmittance: arguments.stop,
        cpu_method: arguments.cpu_method.unwrap_or_default(),
        check_order: arguments.check_order,
        faces: arguments.faces,
        ..RenderOptions::default()
    })
}
