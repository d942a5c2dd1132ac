//! `SessionCore`: what `cellfan.Session` stands on.
#![expect(unsafe_code, reason = "a session that borrows from arrays beside it, which no lifetime can say")]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, TryLockError};

use cellfan::columns::Association;
use cellfan::profile::Exactness;
use cellfan::session::{MeshView, Session, Threads};
use cellfan::{Model, RenderOptions, Rendered, SortMethod};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{LentPositions, LentScalars};
use crate::camera::Camera;
use crate::error::{failed, raised, refused};
use crate::image::Image;
use crate::mesh::{LentMesh, Parts};
use crate::transfer::Transfer;
use crate::watch::watched;

/// A session, and the arrays that it borrows. Fields are dropped in this order.
struct Open {
    session: Session<'static>,
    /// Read by the session alone.
    mesh: Box<LentMesh>,
}

/// Scalars and what they belong to.
type Values = Option<(Association, LentScalars)>;

impl Open {
    fn new(mesh: LentMesh, values: &Values, threads: usize) -> cellfan::Result<Self> {
        let mesh = Box::new(mesh);
        // SAFETY: the mesh is kept beside the session and dropped after it.
        let view = unsafe { forever(&mesh) }?;
        Ok(Self { session: Session::on(Threads::Count(threads), &with_values(view, values))?, mesh })
    }

    fn replace(&mut self, mesh: LentMesh, values: &Values) -> cellfan::Result<()> {
        let mesh = Box::new(mesh);
        // SAFETY: the mesh is kept beside the session from here on; where it is refused, the session keeps nothing of it.
        let view = unsafe { forever(&mesh) }?;
        self.session.update_topology(&with_values(view, values))?;
        self.mesh = mesh;
        Ok(())
    }
}

/// The slices of `mesh`.
///
/// # Safety
/// They are not read once `mesh` is dropped.
unsafe fn forever(mesh: &LentMesh) -> cellfan::Result<MeshView<'static, 'static>> {
    // SAFETY: the caller answers for the lifetime.
    let mesh: &'static LentMesh = unsafe { &*std::ptr::from_ref(mesh) };
    mesh.view()
}

fn with_values<'s>(view: MeshView<'static, 's>, values: &'s Values) -> MeshView<'static, 's> {
    match values {
        Some((association, values)) => view.with_scalars(*association, values.get()),
        None => view,
    }
}

fn values_of(association: Option<&str>, scalars: Option<&Bound<'_, PyAny>>) -> PyResult<Values> {
    let Some(scalars) = scalars else { return Ok(None) };
    let association = match association {
        Some("points") => Association::Point,
        Some("cells") => Association::Cell,
        other => return Err(refused(format!("scalars on {:?}: say \"points\" or \"cells\"", other.unwrap_or("")))),
    };
    Ok(Some((association, LentScalars::new("scalars", scalars)?)))
}

/// Ends the picture that a session draws, or its next, from any thread.
#[pyclass(frozen, module = "cellfan")]
pub(crate) struct CancelToken {
    inner: cellfan::CancelToken,
}

#[pymethods]
impl CancelToken {
    /// Asks for the end: :meth:`Session.render` raises :class:`Cancelled` within milliseconds.
    fn cancel(&self) {
        self.inner.cancel();
    }

    /// Whether the end was asked for.
    #[getter]
    fn is_cancelled(&self) -> bool {
        self.inner.is_cancelled()
    }

    /// Takes it back.
    fn reset(&self) {
        self.inner.reset();
    }
}

/// What `cellfan.Session` stands on.
#[pyclass(frozen, module = "cellfan._cellfan")]
pub(crate) struct SessionCore {
    open: Mutex<Option<Open>>,
    token: cellfan::CancelToken,
}

impl SessionCore {
    /// Does `work` with the session, without the interpreter's lock.
    fn with<T: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut Open) -> PyResult<T> + Send) -> PyResult<T> {
        py.detach(|| {
            let mut open = match self.open.try_lock() {
                Ok(open) => open,
                // What a panic left half done is made anew by the next picture.
                Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
                Err(TryLockError::WouldBlock) => {
                    return Err(refused(
                        "the session is in use, by another thread or by the call whose progress this is",
                    ));
                }
            };
            let Some(open) = &mut *open else { return Err(refused("the session is closed")) };
            catch_unwind(AssertUnwindSafe(|| work(open))).unwrap_or_else(|panic| Err(failed(panic)))
        })
    }
}

#[pymethods]
impl SessionCore {
    #[new]
    fn new(
        py: Python<'_>,
        mesh: Parts<'_>,
        association: Option<&str>,
        scalars: Option<Bound<'_, PyAny>>,
        threads: usize,
    ) -> PyResult<Self> {
        let (mesh, values) = (LentMesh::new(&mesh)?, values_of(association, scalars.as_ref())?);
        let open = py.detach(|| catch_unwind(AssertUnwindSafe(|| Open::new(mesh, &values, threads))));
        let open = open.map_err(failed)?.map_err(raised)?;
        Ok(Self { token: open.session.cancel_token(), open: Mutex::new(Some(open)) })
    }

    fn update_scalars(&self, py: Python<'_>, association: &str, scalars: Bound<'_, PyAny>) -> PyResult<()> {
        let Some((association, values)) = values_of(Some(association), Some(&scalars))? else { return Ok(()) };
        self.with(py, |open| open.session.update_scalars(association, values.get()).map_err(raised))
    }

    fn update_positions(&self, py: Python<'_>, points: Bound<'_, PyAny>) -> PyResult<()> {
        let points = LentPositions::new(&points)?;
        self.with(py, |open| points.get().and_then(|points| open.session.update_positions(points)).map_err(raised))
    }

    fn update_topology(
        &self,
        py: Python<'_>,
        mesh: Parts<'_>,
        association: Option<&str>,
        scalars: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let (mesh, values) = (LentMesh::new(&mesh)?, values_of(association, scalars.as_ref())?);
        self.with(py, |open| open.replace(mesh, &values).map_err(raised))
    }

    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn render(
        &self,
        py: Python<'_>,
        camera: &Camera,
        transfer: &Transfer,
        model: &str,
        sort: &str,
        memory_bytes: Option<u64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Image> {
        let model: Model = model.parse().map_err(raised)?;
        let sort: SortMethod = sort.parse().map_err(raised)?;
        let options = RenderOptions { model, sort, memory_bytes, ..RenderOptions::default() };
        let what = (&camera.inner, &transfer.inner, &options);
        let rendered = self.with(py, |open| watched(&mut open.session, progress.as_ref(), what))?;
        let stats = stats_of(py, &rendered)?.unbind();
        Image::new(py, rendered.image, stats, model != Model::Absorption)
    }

    #[getter]
    fn cancel_token(&self) -> CancelToken {
        CancelToken { inner: self.token.clone() }
    }

    /// Smallest x, y, z, then largest.
    #[getter]
    fn bounds(&self, py: Python<'_>) -> PyResult<(f64, f64, f64, f64, f64, f64)> {
        let corners = self.with(py, |open| Ok(open.session.corners_world()))?;
        let ([x0, y0, z0], [x1, y1, z1]) = (corners[0].to_array(), corners[7].to_array());
        Ok((x0, y0, z0, x1, y1, z1))
    }

    #[getter]
    fn diagonal(&self, py: Python<'_>) -> PyResult<f64> {
        self.with(py, |open| Ok(open.session.diagonal_world()))
    }

    #[getter]
    fn value_range(&self, py: Python<'_>) -> PyResult<(f64, f64)> {
        self.with(py, |open| Ok(open.session.value_range()))
    }

    #[getter]
    fn owned_bytes(&self, py: Python<'_>) -> PyResult<u64> {
        self.with(py, |open| Ok(open.session.owned_bytes()))
    }

    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let counts = self.with(py, |open| Ok(open.session.counts()))?;
        let dict = PyDict::new(py);
        dict.set_item("cells", counts.in_file)?;
        dict.set_item("degenerate", counts.degenerate)?;
        dict.set_item("inverted", counts.inverted)?;
        dict.set_item("unsupported", counts.unsupported)?;
        dict.set_item("lower_dimensional", counts.lower_dimensional)?;
        Ok(dict)
    }

    /// Frees mesh and memory; twice does no harm.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| match self.open.try_lock() {
            Ok(mut open) => {
                *open = None;
                Ok(())
            }
            Err(TryLockError::Poisoned(poisoned)) => {
                *poisoned.into_inner() = None;
                Ok(())
            }
            Err(TryLockError::WouldBlock) => Err(refused("the session is in use: cancel its picture first")),
        })
    }

    #[getter]
    fn is_closed(&self) -> bool {
        matches!(self.open.try_lock().as_deref(), Ok(None))
    }
}

fn stats_of<'py>(py: Python<'py>, rendered: &Rendered) -> PyResult<Bound<'py, PyDict>> {
    let (dict, stages) = (PyDict::new(py), PyDict::new(py));
    let cells = &rendered.cells;
    dict.set_item("drawn", cells.drawn)?;
    dict.set_item("culled_transparent", cells.culled_transparent)?;
    dict.set_item("culled_outside", cells.culled_outside)?;
    dict.set_item("invalid", cells.invalid)?;
    dict.set_item("degenerate", cells.degenerate)?;
    dict.set_item("is_exact", rendered.order.exactness == Exactness::Exact)?;
    dict.set_item("frame_ms", rendered.frame_ms)?;
    for stage in rendered.profile.stages() {
        stages.set_item(stage.name, stage.duration_ms)?;
    }
    dict.set_item("stages_ms", stages)?;
    Ok(dict)
}
