//! Cubes of a regular grid: the octree of its samples, of each frame the cubes that it needs, and their picture.
//!
//! Source: Schussman and Max 2001.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use super::{Rendered, Renderer};
use crate::backends::cpu::{CubeCompositor, InstructionSet};
use crate::backends::{Counts, Frame};
use crate::camera::Camera;
use crate::columns::{Association, CubeCorners, CubeGrid, CubeSlopes, Dataset, Field, Volume, VolumeField};
use crate::error::{Error, Result};
use crate::hierarchy::{
    Accept, CubeCounts, Hierarchy, Interpolation, SelectedCorners, Selection, Shows, Slopes, TimeBudget, WithinError,
    WithinPicture, longest_chord_world,
};
use crate::image::Image;
use crate::optics::{CullTable, Optics, Pieces, TransferFunction};
use crate::profile::{CellStats, Exactness, GeometryStats, OrderStats, Profile};
use crate::stages::sort::{KeyMaker, SortKey};
use crate::stages::{CubesInView, View};

/// A regular grid, the scalar drawn on it with the octree of its samples, and what the scalar looks like.
///
/// ```
/// use cellfan::columns::{Array, Association, Lattice, Volume};
/// use cellfan::render::{CubeScene, Detail};
/// use cellfan::{Camera, FieldSelection, Projection, RenderOptions, Renderer, TransferFunction};
/// // Eight cells of one unit a side, all of extinction 0.5: one cube, two units thick.
/// let values = vec![7_u8; 8];
/// let array = Array { name: "density".into(), association: Association::Cell, components: 1, values: values.into() };
/// let volume = Volume::new([3, 3, 3], Lattice::default(), vec![array])?;
/// let field = volume.field(&FieldSelection::parse("density", &volume.arrays))?;
/// let scene = CubeScene::new(&volume, field, &TransferFunction::constant([1.0; 3], 0.5)?)?;
/// let mut camera = Camera::looking_at([9.0, 1.0, 1.0].into(), [1.0; 3].into(), 33, 33);
/// camera.projection = Projection::Orthographic { height_world: 3.0 };
/// let mut renderer = Renderer::new(RenderOptions::default());
/// let (picture, stats) = renderer.render_cubes(&scene, Detail::Error(0.0), &camera)?;
/// assert_eq!(stats.cubes, 1);
/// assert!((picture.image.pixel(16, 16)[3] - (1.0 - (-1.0_f32).exp())).abs() < 1e-6);
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct CubeScene {
    /// A mesh without cells where the volume is.
    place: Dataset,
    /// Its field: the range and the offset of stored values.
    stored: Field,
    grid: CubeGrid,
    field: VolumeField,
    hierarchy: Hierarchy,
    pieces: Pieces,
    /// Made when a time budget first asks for them.
    counts: OnceLock<CubeCounts>,
}

impl CubeScene {
    /// Builds the octree of `field`, one of `volume`, and brings the transfer function into the form in which stages read it. Values
    /// of cells fill these, values of points the boxes around them.
    ///
    /// # Errors
    /// [`Error::TooLarge`] where a side has more samples than the octree numbers; [`Error::Option`] where the grid is flat.
    pub fn new(volume: &Volume, field: VolumeField, transfer: &TransferFunction) -> Result<Self> {
        let hierarchy = Hierarchy::new(&field)?;
        Self::with_hierarchy(volume, field, hierarchy, transfer)
    }

    /// The same of an octree that is there already, that of `field`: of constant boxes, or of boxes between points, in which values are
    /// trilinear.
    ///
    /// # Errors
    /// [`Error::Option`] where the grid is flat.
    pub fn with_hierarchy(
        volume: &Volume,
        field: VolumeField,
        hierarchy: Hierarchy,
        transfer: &TransferFunction,
    ) -> Result<Self> {
        if volume.lattice.volume_of_cell() <= 0.0 || !volume.lattice.is_finite() {
            let problem = "cubes: the steps of this grid lie in a plane; give it another --spacing".to_owned();
            return Err(Error::Option { option: "--method", problem });
        }
        let grid = match hierarchy.interpolation() {
            Interpolation::Constant => CubeGrid::new(volume, &field),
            Interpolation::Trilinear => CubeGrid::between_points(volume),
        };
        let offset = hierarchy.offset();
        let stored = |value: f64| (value - offset) as f32;
        let stored = Field {
            name: field.name.clone(),
            association: Association::Cell,
            offset,
            values: Vec::new().into(),
            range: field.range,
            block_ranges: vec![(stored(field.range.0), stored(field.range.1))],
            invalid: field.invalid,
        };
        let pieces = transfer.pieces(offset);
        let place = Dataset { backing: volume.backing.clone(), ..grid.place() };
        Ok(Self { place, stored, grid, field, hierarchy, pieces, counts: OnceLock::new() })
    }

    /// The scalar.
    pub fn field(&self) -> &VolumeField {
        &self.field
    }

    /// Its octree.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// Where the samples are.
    pub fn grid(&self) -> &CubeGrid {
        &self.grid
    }

    /// Bytes of memory that the scene takes; samples that are used in place count nothing.
    pub fn owned_bytes(&self) -> u64 {
        self.field.values.owned_bytes() + self.hierarchy.owned_bytes()
    }

    /// Shows the field with another transfer function.
    pub fn set_transfer(&mut self, transfer: &TransferFunction) {
        self.pieces = transfer.pieces(self.hierarchy.offset());
        self.counts = OnceLock::new();
    }

    fn tree(&self) -> (&Hierarchy, &VolumeField) {
        (&self.hierarchy, &self.field)
    }
}

/// How fine a picture of cubes is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// No sample differs from its cube by more than this share of the range of values; from the interpolation in a cube between points
    /// before its corners follow a larger one beside it, which may take as much again.
    Error(f64),
    /// No channel of a pixel differs by more than this from that of all samples: see [`WithinPicture`].
    PictureError(f64),
    /// At most so many cubes (or the one of the root).
    Cubes(u64),
    /// Frames of about so many milliseconds, the first one included, which is drawn several times to learn what it takes. While the view
    /// stays the same, each frame is finer than the last.
    BudgetMs(f64),
}

/// The cubes of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CubeStats {
    /// How many there are.
    pub cubes: u64,
    /// Nodes of the octree that were looked at, samples included.
    pub visited: u64,
    /// What selecting them took.
    pub select_ms: f64,
    /// What drawing them took.
    pub draw_ms: f64,
    /// The largest difference of a sample from its cube that was allowed, as a share of the range of values; `None` where pixels
    /// were the measure.
    pub error: Option<f64>,
}

/// What the renderer keeps for cubes between frames.
#[derive(Default)]
pub(super) struct Cubes {
    selection: Selection,
    compositor: CubeCompositor,
    budget: Option<TimeBudget>,
    last_view: Option<View>,
}

impl Cubes {
    pub(super) fn new(instruction_set: Option<InstructionSet>) -> Self {
        let mut cubes = Self::default();
        cubes.compositor.set_instruction_set(instruction_set);
        cubes
    }

    pub(super) fn draw<O: Optics>(&mut self, frame: &Frame, optics: &O, profile: &mut Profile) -> (Image, Counts) {
        self.compositor.draw(frame, optics, profile)
    }
}

/// Frames that are drawn at most until the first one fits its budget.
const TRIES: usize = 10;
/// A frame fills its budget from this share on.
const FILLED: f64 = 0.7;

impl Renderer {
    /// Draws one frame of cubes, in an order that is exact by construction.
    ///
    /// # Errors
    /// As [`Renderer::render`]; [`Error::Option`] where `detail` is negative or not a number, or a memory budget is given.
    pub fn render_cubes(
        &mut self,
        scene: &CubeScene,
        detail: Detail,
        camera: &Camera,
    ) -> Result<(Rendered, CubeStats)> {
        self.check_cubes(detail)?;
        self.check_lighting()?;
        if scene.hierarchy.interpolation() == Interpolation::Trilinear {
            self.check_trilinear(detail)?;
        }
        if let Some(backing) = &scene.place.backing {
            backing.check()?;
        }
        let view = View::new(camera, &scene.place)?;
        self.check_memory(view.region.size_px(), 0)?;
        let table = CullTable::new(&scene.pieces, self.options.model);
        let shows = Shows { intervals: &scene.pieces, table: &table };
        let (low, high) = scene.field.range;
        let draw = |renderer: &mut Self, rule: WithinError| {
            let (rendered, stats) = renderer.draw_selected(scene, &rule, &table, &view)?;
            Ok((rendered, CubeStats { error: Some(f64::from(rule.0) / (high - low).max(f64::MIN_POSITIVE)), ..stats }))
        };
        let counts = || scene.counts.get_or_init(|| CubeCounts::new(scene.tree(), shows));
        match detail {
            // Rounded up, so that a share of 1 is everything.
            Detail::Error(share) => draw(self, WithinError(((high - low) * share * (1.0 + 1e-6)) as f32)),
            Detail::PictureError(error) => {
                let longest = longest_chord_world(&scene.grid, &camera.frame()?);
                let rule = WithinPicture::new(&scene.pieces, self.options.model, error, longest);
                self.draw_selected(scene, &rule, &table, &view)
            }
            Detail::Cubes(cubes) => draw(self, counts().within(cubes)),
            Detail::BudgetMs(budget_ms) => {
                let counts = counts();
                let kept = self.cubes.budget.filter(|kept| kept.budget_ms().total_cmp(&budget_ms).is_eq());
                let mut budget = kept.unwrap_or(TimeBudget::new(budget_ms));
                let is_first = !budget.is_known();
                let is_same = self.cubes.last_view.replace(view) == Some(view);
                let is_still = is_same && !is_first;
                let mut tries = 0;
                loop {
                    tries += 1;
                    let wanted = budget.cubes(is_still).min(counts.finest()).max(1);
                    let drawn = draw(self, counts.within(wanted))?;
                    let frame_ms = drawn.0.frame_ms;
                    budget.drawn(wanted, frame_ms);
                    let is_full = frame_ms >= FILLED * budget_ms || wanted == counts.finest();
                    if !is_first || tries == TRIES || (is_full && frame_ms <= budget_ms) {
                        self.cubes.budget = Some(budget);
                        return Ok(drawn);
                    }
                }
            }
        }
    }

    /// What values between points cannot be drawn by.
    fn check_trilinear(&self, detail: Detail) -> Result<()> {
        let refuse = |option, problem: &str| Err(Error::Option { option, problem: problem.to_owned() });
        if self.draws_fans() {
            let problem = "cubes with values between points are for the CPU's footprints; say --backend cpu \
                           --cpu-method footprints, or leave --filter out";
            return refuse("--filter", problem);
        }
        if matches!(detail, Detail::PictureError(_)) {
            return refuse(
                "--error-image",
                "bounds cubes of one value; leave --filter out, or use --error or --budget-ms",
            );
        }
        Ok(())
    }

    fn check_cubes(&self, detail: Detail) -> Result<()> {
        let (option, number) = match detail {
            Detail::Error(share) => ("--error", share),
            Detail::PictureError(error) => ("--error-image", error),
            Detail::Cubes(_) => return Ok(()),
            Detail::BudgetMs(budget_ms) => ("--budget-ms", budget_ms),
        };
        // Not a number is neither.
        if !(number >= 0.0 && number.is_finite()) || (option == "--budget-ms" && number == 0.0) {
            return Err(Error::Option {
                option,
                problem: format!("{number}; a number that is not negative, and some time"),
            });
        }
        if self.options.memory_bytes.is_some() {
            let problem = "cubes keep no budget; leave it out, or let --error be larger".to_owned();
            return Err(Error::Option { option: "--memory", problem });
        }
        if !(0.0..1.0).contains(&self.options.stop_transmittance) {
            let problem =
                format!("{}; a transmittance from 0 (never stop) to below 1", self.options.stop_transmittance);
            return Err(Error::Option { option: "--stop", problem });
        }
        Ok(())
    }

    /// Selects the cubes that the rule accepts, and draws them.
    fn draw_selected(
        &mut self,
        scene: &CubeScene,
        rule: &impl Accept,
        table: &CullTable,
        view: &View,
    ) -> Result<(Rendered, CubeStats)> {
        let start = Instant::now();
        let control = Arc::clone(&self.control);
        let mut profile = Profile::default();
        let mut selection = std::mem::take(&mut self.cubes.selection);
        let in_view = CubesInView::new(&[], &scene.grid, scene.place.origin, view);
        let is_trilinear = scene.hierarchy.interpolation() == Interpolation::Trilinear;
        let shows = Shows { intervals: &scene.pieces, table };
        selection.select(scene.tree(), rule, shows, in_view.eye, rayon::current_num_threads() > 1);
        let corners = is_trilinear.then(|| SelectedCorners::new(scene.tree(), &selection.cubes));
        let slopes = self.lighting.is_some().then(|| Slopes::new(scene.tree()));
        let selecting = start.elapsed();
        profile.add("select", selecting, selection.visited * 12);

        let frame = Frame {
            dataset: &scene.place,
            cubes: Some(in_view.with(
                &selection.cubes,
                corners.as_ref().map(|corners| corners as &dyn CubeCorners),
                slopes.as_ref().map(|slopes| slopes as &dyn CubeSlopes),
            )),
            field: &scene.stored,
            vertices: &[],
            pieces: &scene.pieces,
            bands: None,
            cull_table: table,
            view,
            keys: KeyMaker::new(SortKey::None, view, &[]),
            is_exact: false,
            tiles: None,
            faces: self.options.faces,
            stop_transmittance: self.options.stop_transmittance,
            memory_bytes: None,
            control: &control,
            mates: None,
            still: None,
            opaque: None,
        };
        let drawn = self.draw(&frame, &mut profile).and_then(|drawn| control.check().map(|()| drawn));
        let frame_ms = start.elapsed().as_secs_f64() * 1e3;
        let select_ms = selecting.as_secs_f64() * 1e3;
        let Selection { visited, transparent, invalid, .. } = selection;
        let cubes = selection.cubes.len() as u64;
        self.cubes.selection = selection;
        let (image, counts) = drawn?;
        let stats = CubeStats { cubes, visited, select_ms, draw_ms: frame_ms - select_ms, error: None };
        let cells = CellStats {
            // Samples that show count by their cubes.
            total: cubes + transparent + invalid,
            drawn: counts.drawn,
            culled_transparent: transparent,
            culled_outside: counts.culled_outside,
            degenerate: 0,
            invalid,
            skipped: 0,
            by_class: if self.draws_fans() { counts.by_class.named() } else { Vec::new() },
        };
        let order = OrderStats {
            kind: "octree",
            exactness: Exactness::Exact,
            misordered_pairs: None,
            cycles: None,
            layers: None,
            adjacency: None,
            violations: None,
            tiles_redone: 0,
        };
        let rendered = Rendered {
            image,
            bands: None,
            depth_world: None,
            cells,
            triangles: counts.triangles,
            geometry: GeometryStats::default(),
            order,
            profile,
            frame_ms,
        };
        Ok((rendered, stats))
    }
}
