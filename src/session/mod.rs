//! `Session`: pictures of a mesh that another program holds in memory and changes between them.
//!
//! In: a [`MeshView`] of the program's own slices, then a camera, a transfer function and options for each picture. Out: a
//! [`Rendered`]. What survives between pictures (which cells there are and in which order, vertices as they are drawn, lists) stays;
//! docs/embedding.md says what each change costs. To add a layout: a variant in `view.rs`, how it becomes columns in `cells.rs`.
#![expect(unsafe_code, reason = "columns are lent for as long as the session may be used")]

mod cells;
mod loan;
#[cfg(all(test, unix))]
mod tests;
mod view;

use std::marker::PhantomData;
use std::sync::Arc;

use glam::DVec3;

use self::cells::cells_of;
use self::loan::lend;
pub use self::view::{Cells, Indices, MeshView, Scalars};
use crate::camera::Camera;
use crate::columns::{
    Array, Association, CellCounts, CellsInPlace, Component, Dataset, Field, NumericColumn, Positions, PositionsInPlace,
};
use crate::control::{CancelToken, Control, OnProgress};
use crate::error::{Error, Result};
use crate::optics::TransferFunction;
use crate::render::{RenderOptions, Rendered, Renderer, Scene, Stillness};

/// The threads that draw.
#[derive(Clone, Debug, Default)]
pub enum Threads {
    /// Those of the rayon pool in which the session is called; outside of any, those of rayon's own, one a core.
    #[default]
    OfCaller,
    /// So many of its own; 0 for one a core. They sleep while nothing is drawn.
    Count(usize),
    /// Those of a pool of the caller's.
    Pool(Arc<rayon::ThreadPool>),
}

/// Draws the mesh of another program, again and again. It holds no lock and shares nothing with other sessions.
///
/// Connectivity, and positions where [`MeshView`] says that they are not copied, are borrowed for `'a`. Scalars, and positions that
/// come with [`Session::update_positions`], are read once: the program may write to them as soon as the call returns.
///
/// ```
/// use cellfan::session::{Cells, Indices, MeshView, Scalars, Session};
/// use cellfan::{Camera, Positions, RenderOptions, TransferFunction, cells::TETRAHEDRON, columns::Association};
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0_f32]];
/// let (corners, mut pressure) = ([0, 1, 2, 3], [0.5_f32]);
/// let cells = Cells::OfKind { kind: &TETRAHEDRON, points: Indices::U32(&corners) };
/// let mesh = MeshView::new(Positions::F32(&points), cells).with_scalars(Association::Cell, Scalars::F32(&pressure));
/// let mut session = Session::new(&mesh)?;
/// let camera = Camera::framing(&session.corners_world(), 35.0, 20.0, 64, 64);
/// let transfer = TransferFunction::constant([1.0, 0.5, 0.0], 2.0)?;
/// for step in 0..3 {
///     pressure[0] += 0.25 * step as f32;
///     session.update_scalars(Association::Cell, Scalars::F32(&pressure))?;
///     let rendered = session.render(&camera, &transfer, &RenderOptions::default())?;
///     assert_eq!(rendered.cells.drawn, 1);
/// }
/// assert_eq!(session.value_range(), (1.25, 1.25));
/// # Ok::<(), cellfan::Error>(())
/// ```
pub struct Session<'a> {
    /// Its columns may be lent: nothing that shares them leaves the session.
    scene: Scene,
    cells: CellsInPlace,
    renderer: Renderer,
    cancel: CancelToken,
    threads: Threads,
    mesh: PhantomData<&'a ()>,
}

impl<'a> Session<'a> {
    /// A session on the threads of whoever calls it.
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`], [`Error::NonFinitePosition`], [`Error::LengthMismatch`], [`Error::TooLarge`], [`Error::NoCells`]
    /// where no cell has a volume, [`Error::UnusableArray`] where no scalar is finite.
    pub fn new(mesh: &MeshView<'a, '_>) -> Result<Self> {
        Self::on(Threads::OfCaller, mesh)
    }

    /// A session on `threads`.
    ///
    /// # Errors
    /// Those of [`Session::new`], and [`Error::Option`] where threads cannot be had.
    pub fn on(threads: Threads, mesh: &MeshView<'a, '_>) -> Result<Self> {
        let threads = match threads {
            Threads::Count(count) => Threads::Pool(Arc::new(pool(count)?)),
            other => other,
        };
        let (cells, scene) = threads.run(|| Self::scene(mesh))?;
        let cancel = CancelToken::default();
        let mut session = Self { scene, cells, renderer: Renderer::default(), cancel, threads, mesh: PhantomData };
        session.renderer.set_stillness(Stillness::Still);
        session.set_control(None);
        Ok(session)
    }

    fn scene(mesh: &MeshView<'a, '_>) -> Result<(CellsInPlace, Scene)> {
        // SAFETY: cells and scene are kept by the session alone, whose type ends with 'a; nothing that it gives away shares them.
        let cells = unsafe { cells_of(mesh) }?;
        let lent = match mesh.positions {
            // SAFETY: as above.
            Positions::F32(points) => Some(unsafe { lend(points) }),
            _ => None,
        };
        let dataset = Dataset::in_place(&cells, PositionsInPlace { read: mesh.positions, lent }, None)?;
        let field = match mesh.scalars {
            Some((association, scalars)) => field_of(&dataset, association, scalars)?,
            None => dataset.homogeneous_field(),
        };
        let transfer = TransferFunction::constant([1.0; 3], 1.0)?;
        Ok((cells, Scene::new(dataset, field, &transfer)))
    }

    /// Draws other values, one for each point or each cell; those that are not finite leave out their cells. Where the view stays as it is,
    /// the next picture needs no sort.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`]; [`Error::UnusableArray`] where none is finite. Then the values are those of before.
    pub fn update_scalars(&mut self, association: Association, scalars: Scalars<'_>) -> Result<()> {
        let Self { scene, threads, .. } = self;
        threads.run(|| {
            scene.set_field(field_of(scene.dataset(), association, scalars)?);
            Ok(())
        })?;
        self.renderer.set_stillness(Stillness::Live);
        Ok(())
    }

    /// Moves the points, as many as there were. Positions are copied, 12 bytes a point, and no longer those of the mesh view; cells keep
    /// their order. One that had no volume before and has one now shows with the next [`Session::update_scalars`] of cell data.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NonFinitePosition`], [`Error::NoCells`]. Then positions are those of before.
    pub fn update_positions(&mut self, positions: Positions<'_>) -> Result<()> {
        positions.check()?;
        let Self { scene, cells, threads, .. } = self;
        let (len, expected) = (positions.len() as u64, scene.dataset().positions.len() as u64);
        if len != expected {
            return Err(Error::LengthMismatch { column: "points".to_owned(), len, expected });
        }
        threads.run(|| {
            let before = scene.dataset();
            let dataset = Dataset::in_place(cells, PositionsInPlace { read: positions, lent: None }, Some(before))?;
            let field = dataset.field_from(before, scene.field());
            scene.set_shape(dataset, field);
            Ok(())
        })
    }

    /// Draws another mesh; the threads, the token and the memory of pictures stay.
    ///
    /// # Errors
    /// Those of [`Session::new`]. Then the mesh is that of before.
    pub fn update_topology(&mut self, mesh: &MeshView<'a, '_>) -> Result<()> {
        (self.cells, self.scene) = self.threads.run(|| Self::scene(mesh))?;
        Ok(())
    }

    /// Draws one picture, with what was counted and what each stage took.
    ///
    /// # Errors
    /// Those of [`Renderer::render`]; after [`Error::Cancelled`] the token is reset.
    pub fn render(
        &mut self,
        camera: &Camera,
        transfer: &TransferFunction,
        options: &RenderOptions,
    ) -> Result<Rendered> {
        let Self { scene, renderer, threads, .. } = self;
        renderer.set_options(*options);
        scene.set_transfer(transfer);
        let rendered = threads.run(|| renderer.render(scene, camera));
        if let Err(Error::Cancelled) = rendered {
            self.cancel.reset();
        }
        rendered
    }

    /// Ends the picture that is being drawn, or the next, with [`Error::Cancelled`]; the session can be used on.
    pub fn cancel_token(&self) -> CancelToken {
        self.cancel.clone()
    }

    /// Calls `call` with the share of each picture that is done: see [`Control::on_progress`].
    pub fn on_progress(&mut self, call: Box<OnProgress>) {
        self.set_control(Some(call));
    }

    fn set_control(&mut self, progress: Option<Box<OnProgress>>) {
        let mut control = Control::default();
        control.cancel = self.cancel.clone();
        if let Some(call) = progress {
            control.on_progress(call);
        }
        self.renderer.set_control(control);
    }

    /// The eight corners of the box around the mesh, in world coordinates.
    pub fn corners_world(&self) -> [DVec3; 8] {
        self.scene.dataset().corners_world()
    }

    /// Length of the diagonal of that box.
    pub fn diagonal_world(&self) -> f64 {
        self.scene.dataset().diagonal_world()
    }

    /// Smallest and largest finite value of the scalars.
    pub fn value_range(&self) -> (f64, f64) {
        self.scene.field().range
    }

    /// What became of the cells.
    pub fn counts(&self) -> CellCounts {
        self.scene.dataset().counts
    }

    /// Bytes of memory that the session holds between pictures beside what pictures were drawn with; columns of the caller's count nothing.
    pub fn owned_bytes(&self) -> u64 {
        self.scene.owned_bytes()
    }
}

impl Threads {
    fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match self {
            Self::Pool(pool) => pool.install(work),
            Self::OfCaller | Self::Count(_) => work(),
        }
    }
}

fn pool(count: usize) -> Result<rayon::ThreadPool> {
    let named = rayon::ThreadPoolBuilder::new().num_threads(count).thread_name(|i| format!("cellfan {i}"));
    named.build().map_err(|error| Error::Option { option: "threads", problem: error.to_string() })
}

/// The scalars, one a point or cell of the caller's, in the order of `dataset`.
fn field_of(dataset: &Dataset, association: Association, scalars: Scalars<'_>) -> Result<Field> {
    let expected = match association {
        Association::Point => dataset.positions.len() as u64,
        Association::Cell => dataset.counts.in_file,
    };
    if scalars.len() as u64 != expected {
        return Err(Error::LengthMismatch { column: "scalars".to_owned(), len: scalars.len() as u64, expected });
    }
    macro_rules! lent {
        ($($variant:ident),*) => {
            match scalars {
                // SAFETY: the array is gone when this function returns, and a field that is made of it shares nothing with it.
                $(Scalars::$variant(values) => NumericColumn::$variant(unsafe { lend(values) })),*
            }
        };
    }
    let values = lent!(I8, U8, I16, U16, I32, U32, I64, U64, F32, F64);
    dataset
        .field_of_lent(&Array { name: "scalars".to_owned(), association, components: 1, values }, Component::Magnitude)
}
