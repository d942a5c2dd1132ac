//! `Renderer`: run the stages in order and feed a backend.
//!
//! In: a [`Scene`] (mesh, field, transfer function, bands), or the [`CubeScene`] of a regular grid, and a [`Camera`]. Out: a
//! [`Rendered`] picture with its figures.

mod band_arrays;
mod bands;
mod cubes;
mod depth_planes;
mod fog;
#[cfg(feature = "gpu")]
mod gpu;
mod lit;
mod opaque;
mod options;
mod order;
mod profiled;
mod rays;
mod scene;
mod update;
mod volume_scene;

pub use cubes::{CubeScene, CubeStats, Detail};
pub use depth_planes::depth_planes;
pub use fog::{FlightCheck, FogLook, FogRenderer, FogScene, FrameCheck};
pub use options::{CpuMethod, RenderOptions};
pub use profiled::profile_views;
pub use scene::Scene;
pub(crate) use update::Stillness;
pub use volume_scene::VolumeScene;

use std::sync::Arc;
use std::time::Instant;

use crate::backends::cpu::{FanCompositor, RayCompositor, TileCompositor};
#[cfg(feature = "gpu")]
use crate::backends::gpu::GpuCompositor;
use crate::backends::{Counts, Frame};
use crate::camera::Camera;
use crate::columns::Dataset;
use crate::control::Control;
use crate::error::{Error, Result};
use crate::image::{BandImage, DepthImage, Image};
use crate::memory;
#[cfg(feature = "gpu")]
use crate::optics::Shading;
use crate::optics::lighting::Lighting;
use crate::optics::{
    Absorption, Averaged, BandDepths, BandLight, CullTable, Emission, EmissionAbsorption, Integral, Mip, Model,
    NormalisedLengths, Optics, Output, Textured,
};
use crate::profile::{CellStats, GeometryStats, OrderStats, Profile};
use crate::stages::View;
use crate::stages::fans::{Faces, PolyFan};
use crate::stages::sort::topological::Topological;
use crate::stages::sort::{KeyMaker, SortMethod};

/// A picture and how it came about.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The picture; see [`Model`] for its channels. Absorption in bands of their own: the first four, the last one again where there
    /// are fewer. Emission-absorption in such: the light of the first three, and 1 less the mean transmittance of these.
    pub image: Image,
    /// All bands, where the scene has bands of their own: in the absorption model, and in emission-absorption (the light of each) where
    /// they are more than three.
    pub bands: Option<BandImage>,
    /// View depth of what is opaque in each pixel, in world units, where [`RenderOptions::depth`] asks for it; infinite where there is nothing.
    pub depth_world: Option<Vec<f32>>,
    /// What became of the cells.
    pub cells: CellStats,
    /// Triangles rasterised; none with footprints.
    pub triangles: u64,
    /// Opaque geometry that was drawn.
    pub geometry: GeometryStats,
    /// The order and how far it can be trusted.
    pub order: OrderStats,
    /// What each stage took.
    pub profile: Profile,
    /// From the camera to the finished picture, in milliseconds.
    pub frame_ms: f64,
}

impl Rendered {
    /// The picture with its depths, to be composited with others; none where [`RenderOptions::depth`] did not ask for depths, or the picture went
    /// into a texture.
    pub fn depth_image(&self) -> Option<DepthImage> {
        DepthImage::new(self.image.clone(), self.depth_world.clone()?).ok()
    }
}

/// Draws scenes; keeps what survives a change of view.
///
/// Runs on the threads of the rayon pool it is called in; the picture does not depend on their number.
///
/// ```
/// use cellfan::{Camera, ControlPoint, Dataset, Points, RenderOptions, Renderer, Scene, TetMesh, TransferFunction};
/// use glam::DVec3;
/// // One tetrahedron, one unit thick where the middle ray meets it, of constant extinction 2 per unit.
/// let mesh = TetMesh {
///     points: Points::F64(vec![[0.0, -1.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0], [2.0, 0.0, -0.25]]),
///     tets: vec![[0, 1, 2, 3]].into(),
///     file_from_tet: vec![0].into(),
///     arrays: vec![],
///     counts: Default::default(),
/// };
/// let dataset = Dataset::from_tets(mesh)?;
/// let field = dataset.homogeneous_field();
/// let transfer = TransferFunction::new(vec![ControlPoint { value: 0.0, color: [1.0; 3], extinction: 2.0 }])?;
/// let mut camera = Camera::looking_at(DVec3::new(5.0, 0.0, -0.25), DVec3::new(0.0, 0.0, -0.25), 33, 33);
/// camera.projection = cellfan::Projection::Orthographic { height_world: 3.0 };
/// let picture = Renderer::new(RenderOptions::default()).render(&Scene::new(dataset, field, &transfer), &camera)?;
/// // The middle ray runs through the apex at x = 2 down to the base at x = 0.
/// let alpha = picture.image.pixel(16, 16)[3];
/// assert!((alpha - (1.0 - (-2.0_f32 * 2.0).exp())).abs() < 1e-6);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Default)]
pub struct Renderer {
    options: RenderOptions,
    tiles: TileCompositor,
    fans: FanCompositor,
    rays: RayCompositor,
    topological: Topological,
    /// The last order by the graph of the mesh, and what it is of, where views stay as they are.
    last_order: Option<order::LastOrder>,
    control: Arc<Control>,
    still: Stillness,
    cubes: cubes::Cubes,
    #[cfg(feature = "gpu")]
    gpu: Option<GpuCompositor>,
    /// Pictures of so many bytes were found to fit into memory.
    checked_bytes: u64,
    /// The light that cells reflect.
    lighting: Option<Lighting>,
}

/// A picture, all its bands if it has bands of their own, and what was counted.
type Drawn = (Image, Option<BandImage>, Counts);

/// The picture and its tiles, 16 bytes each, and what 64 chunks count for each tile of 32×32 pixels.
const BYTES_PER_PIXEL: u64 = 16 + 16 + 1;

impl Renderer {
    /// A renderer with `options`.
    pub fn new(options: RenderOptions) -> Self {
        let mut tiles = TileCompositor::default();
        tiles.set_instruction_set(options.instruction_set);
        let cubes = cubes::Cubes::new(options.instruction_set);
        let mut rays = RayCompositor::default();
        rays.set_instruction_set(options.instruction_set);
        Self { options, tiles, rays, cubes, ..Self::default() }
    }

    /// Draws what follows with other options; what is kept between frames stays.
    pub fn set_options(&mut self, options: RenderOptions) {
        self.tiles.set_instruction_set(options.instruction_set);
        self.rays.set_instruction_set(options.instruction_set);
        self.options = options;
    }

    /// How frames are watched and ended: each thread looks at the token between pieces of less than 5 ms of work. Fans, and lists of opaque
    /// geometry, are made in steps that may take longer, between which it is looked at; a GPU looks before it draws.
    pub fn set_control(&mut self, control: Control) {
        self.control = Arc::new(control);
    }

    /// Keeps the order of a frame for the next.
    pub(crate) fn set_stillness(&mut self, still: Stillness) {
        self.still = still;
    }

    /// Draws one frame.
    ///
    /// # Errors
    /// [`Error::Cancelled`] where [`Renderer::set_control`] gave a token and this was set; [`Error::Camera`] where the camera is not
    /// valid, [`Error::Option`] where the options are not, [`Error::Memory`] where the memory budget is too small,
    /// [`Error::OutOfMemory`] where the picture is too large for the system's, [`Error::Changed`] where a file that is used in place
    /// has changed.
    pub fn render(&mut self, scene: &Scene, camera: &Camera) -> Result<Rendered> {
        self.run(scene, camera, |renderer, frame, profile| match &scene.bands {
            Some(bands) => renderer.draw_bands(scene, bands, frame, profile),
            None => renderer.draw(frame, profile).map(|(image, counts)| (image, None, counts)),
        })
    }

    /// Checks options and camera, and has the frame drawn.
    fn run(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        draw: impl FnOnce(&mut Self, &Frame, &mut Profile) -> Result<Drawn>,
    ) -> Result<Rendered> {
        self.check_options()?;
        self.check_lighting()?;
        self.check_bands(scene)?;
        self.options.geometry.check()?;
        self.check_cells(scene)?;
        let options = self.options;
        if let Some(backing) = &scene.dataset.backing {
            backing.check()?;
        }
        let start = Instant::now();
        let view = View::new(camera, &scene.dataset)?;
        self.check_memory(view.region.size_px(), scene.bands_of_picture(options.model))?;
        let control = Arc::clone(&self.control);
        control.begin();
        control.check()?;
        let cull_table = CullTable::new(&scene.pieces, options.model);
        let mut profile = Profile::default();
        // Both come back when the frame is finished.
        let mut topological = std::mem::take(&mut self.topological);
        let order = self.order_kept(scene, &view, &mut topological, &mut profile);
        let last_order = self.last_order.take();
        control.check()?;
        // After the order, which may have found the exterior faces.
        let opaque = self.opaque(scene, &view, &mut profile)?;
        control.check()?;
        let frame = Frame {
            dataset: &scene.dataset,
            cubes: None,
            field: &scene.field,
            vertices: &scene.vertices,
            pieces: &scene.pieces,
            bands: None,
            mates: self.mates(scene, opaque.is_some(), &mut profile),
            cull_table: &cull_table,
            view: &view,
            keys: KeyMaker::new(order.key, &view, topological.layer_from_cell()),
            is_exact: order.is_exact,
            tiles: None,
            faces: options.faces,
            stop_transmittance: options.stop_transmittance,
            memory_bytes: opaque::budget(&options, opaque.as_ref(), &view),
            control: &control,
            still: self.still.of(scene),
            opaque: opaque.as_ref(),
        };
        let drawn = draw(self, &frame, &mut profile).and_then(|drawn| control.check().map(|()| drawn));
        let (image, bands, counts) = drawn.map_err(|error| opaque::with_geometry(error, &options, &frame))?;
        let depth_world = self.depths_world(&frame)?;
        let frame_ms = start.elapsed().as_secs_f64() * 1e3;

        let misordered_pairs = options.check_order.then(|| order::misordered_pairs(&frame));
        (self.topological, self.last_order) = (topological, last_order);
        let cells = cell_stats(&scene.dataset, &counts, self.draws_fans());
        let order = self.order_stats(order, &counts, misordered_pairs);
        let geometry = opaque::stats(opaque.as_ref(), &counts);
        let triangles = counts.triangles;
        Ok(Rendered { image, bands, depth_world, cells, triangles, geometry, order, profile, frame_ms })
    }

    fn check_options(&self) -> Result<()> {
        let options = self.options;
        if !(0.0..1.0).contains(&options.stop_transmittance) {
            let problem = format!("{}; a transmittance from 0 (never stop) to below 1", options.stop_transmittance);
            return Err(Error::Option { option: "--stop", problem });
        }
        if options.sort == SortMethod::Exact && self.draws_fans() && !self.checks_order() {
            let problem =
                "exact checks every fragment, which fans on the processor do not; use footprints, or topological"
                    .to_owned();
            return Err(Error::Option { option: "--sort", problem });
        }
        if options.faces == Faces::Fan && !self.draws_fans() {
            let problem = "footprints have exact faces; fan is for --cpu-method fans and for GPUs".to_owned();
            return Err(Error::Option { option: "--faces", problem });
        }
        if options.output == Output::Depth && options.model != Model::Absorption {
            let problem = format!("depth is that of the absorption model, not of {}", options.model);
            return Err(Error::Option { option: "--output", problem });
        }
        if options.integral == Integral::Pcp {
            if !matches!(options.model, Model::Emission | Model::Mip) {
                let problem = format!("pcp has no order: choose --model emission or mip, not {}", options.model);
                return Err(Error::Option { option: "--integral", problem });
            }
            #[cfg(feature = "gpu")]
            if self.gpu.is_some() {
                let problem = "--integral pcp is the CPU's; say --backend cpu".to_owned();
                return Err(Error::Option { option: "--backend gpu", problem });
            }
            if self.draws_fans() {
                let problem = "pcp has no fans; use footprints".to_owned();
                return Err(Error::Option { option: "--cpu-method", problem });
            }
        }
        let takes_all_cells = self.draws_fans() || options.check_order || options.sort == SortMethod::Topological;
        if options.memory_bytes.is_some() && takes_all_cells {
            let problem = "fans (and GPUs), --check-order and --sort topological take all cells at once and keep no budget; \
                           leave one out";
            return Err(Error::Option { option: "--memory", problem: problem.to_owned() });
        }
        Ok(())
    }

    /// Whether all kinds of cells that the scene has can be drawn as it is asked for.
    fn check_cells(&self, scene: &Scene) -> Result<()> {
        if scene.dataset.polyhedra.is_empty() {
            return Ok(());
        }
        let refuse = |option, problem: &str| Err(Error::Option { option, problem: problem.to_owned() });
        if self.options.faces == Faces::Fan {
            return refuse(
                "--faces",
                "prisms and polyhedra have exact faces only; leave it out, or say --cells tetrahedra",
            );
        }
        if self.checks_order() && scene.dataset.polyhedra.most().corners > PolyFan::CORNERS_MAX {
            return refuse("--backend gpu", "a polyhedron has more than 32,768 corners; say --backend cpu");
        }
        if self.draws_fans() && !self.checks_order() {
            let problem = "prisms and polyhedra have no fans; use footprints, or --cells tetrahedra";
            return refuse("--cpu-method", problem);
        }
        if self.options.sort == SortMethod::Topological || self.options.check_order {
            let problem = "the order by shared faces is that of cells with four to eight corners; use --sort exact";
            return refuse(if self.options.check_order { "--check-order" } else { "--sort" }, problem);
        }
        Ok(())
    }

    /// Whether cells are drawn as triangle fans, which are classified and not checked.
    fn draws_fans(&self) -> bool {
        #[cfg(feature = "gpu")]
        if self.gpu.is_some() {
            return true;
        }
        self.options.cpu_method == CpuMethod::Fans
    }

    /// Whether fans that come too late are found and put right: on a GPU.
    #[cfg_attr(not(feature = "gpu"), expect(clippy::unused_self, reason = "the same method as with GPUs"))]
    fn checks_order(&self) -> bool {
        #[cfg(feature = "gpu")]
        return self.gpu.is_some();
        #[cfg(not(feature = "gpu"))]
        false
    }

    /// Pictures larger than any before have to fit into memory.
    fn check_memory(&mut self, [width, height]: [u32; 2], bands: usize) -> Result<()> {
        let pixels = u64::from(width) * u64::from(height);
        let bytes = pixels.saturating_mul(BYTES_PER_PIXEL + bands as u64 * 4);
        if bytes > self.checked_bytes {
            let of = if bands == 0 { String::new() } else { format!(" in {bands} bands") };
            memory::check(|| format!("drawing a picture of {width}x{height} pixels{of}"), Some(bytes))?;
            self.checked_bytes = bytes;
        }
        Ok(())
    }

    /// Chooses the optical model; everything below is compiled for it.
    fn draw(&mut self, frame: &Frame, profile: &mut Profile) -> Result<(Image, Counts)> {
        #[cfg(feature = "gpu")]
        if let Some(mut gpu) = self.gpu.take() {
            let RenderOptions { model, integral, output, .. } = self.options;
            let shading = Shading { model, integral, output, has_bands: frame.bands.is_some() };
            let redo = |tiles: &[bool], profile: &mut Profile| self.redo(frame, tiles, profile);
            let drawn = gpu.draw(frame, shading, redo, profile);
            self.gpu = Some(gpu);
            return drawn;
        }
        let (mut image, counts) = self.draw_on_cpu(frame, profile)?;
        self.put_behind(&mut image, frame);
        Ok((image, counts))
    }

    /// The same on the processor, without what opaque geometry looks like.
    fn draw_on_cpu(&mut self, frame: &Frame, profile: &mut Profile) -> Result<(Image, Counts)> {
        let pieces = frame.pieces;
        let RenderOptions { model, integral, output, .. } = self.options;
        match (model, integral) {
            (Model::Mip, _) => self.draw_with(frame, &Mip { pieces }, profile),
            (Model::Absorption, _) => match frame.bands {
                Some(pieces) => self.draw_with(frame, &BandDepths { pieces, output }, profile),
                None => self.draw_with(frame, &Absorption { pieces, output }, profile),
            },
            (Model::Emission, Integral::Pcp) => self.draw_with(frame, &NormalisedLengths { pieces }, profile),
            (Model::Emission, _) => self.draw_with(frame, &Emission { pieces }, profile),
            (Model::EmissionAbsorption, Integral::Exact | Integral::Pcp) => match frame.bands {
                Some(pieces) => self.draw_with(frame, &BandLight { pieces }, profile),
                None => self.draw_light(frame, EmissionAbsorption { pieces }, profile),
            },
            (Model::EmissionAbsorption, Integral::Average) => self.draw_with(frame, &Averaged { pieces }, profile),
            (Model::EmissionAbsorption, Integral::Texture) => {
                let textured = Textured::new(pieces, frame.dataset.diagonal_world())?;
                self.draw_with(frame, &textured, profile)
            }
        }
    }

    fn draw_with<O: Optics>(&mut self, frame: &Frame, optics: &O, profile: &mut Profile) -> Result<(Image, Counts)> {
        if let Some(opaque) = frame.opaque {
            // Before threads ask for it, who would wait for each other.
            profile.time("geometry", || opaque.picture(frame.view));
        }
        if let Some(mates) = frame.mates.filter(|_| frame.tiles.is_none())
            && let Some(followed) = self.rays.draw(frame, mates, optics, profile)
        {
            return self.with_overlaps(frame, optics, followed, profile);
        }
        match self.options.cpu_method {
            // Tiles are what footprints are drawn in.
            _ if frame.tiles.is_some() => self.tiles.draw(frame, optics, profile),
            CpuMethod::Fans => Ok(self.fans.draw(frame, optics, profile)),
            _ if frame.cubes.is_some() => Ok(self.cubes.draw(frame, optics, profile)),
            CpuMethod::Footprints | CpuMethod::Rays => self.tiles.draw(frame, optics, profile),
        }
    }
}

fn cell_stats(dataset: &Dataset, counts: &Counts, is_classified: bool) -> CellStats {
    let file = &dataset.counts;
    let skipped = file.lower_dimensional + file.ghost + file.unsupported;
    let by_class = if is_classified { counts.by_class.named() } else { Vec::new() };
    CellStats {
        total: (dataset.cells() - dataset.hexahedra.absent()) as u64 + file.degenerate + skipped,
        drawn: counts.drawn,
        culled_transparent: counts.culled_transparent,
        culled_outside: counts.culled_outside,
        degenerate: file.degenerate,
        invalid: counts.invalid,
        skipped,
        by_class,
    }
}
