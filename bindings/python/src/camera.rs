//! `Camera`: where the eye is.

use cellfan::Projection;
use glam::DVec3;
use pyo3::prelude::*;

use crate::error::raised;

/// Where the eye is, in world coordinates; pixel (x, y) runs right and down.
///
/// Nothing nearer than the view depth `near` is drawn (by default a millionth of the mesh's diagonal), nothing farther than `far` (no
/// limit). With `orthographic_height`, rays are parallel and the picture's height covers so much.
///
/// >>> camera = cellfan.Camera((0, -5, 0), (0, 0, 0), size=(512, 512), fov=30)
/// >>> camera.size
/// (512, 512)
#[pyclass(frozen, eq, module = "cellfan")]
#[derive(Clone, PartialEq)]
pub(crate) struct Camera {
    pub(crate) inner: cellfan::Camera,
}

impl Camera {
    fn checked(inner: cellfan::Camera) -> PyResult<Self> {
        inner.frame().map_err(raised)?;
        Ok(Self { inner })
    }
}

#[pymethods]
impl Camera {
    #[new]
    #[pyo3(signature = (eye, target, *, up = None, size = (1024, 768), fov = cellfan::Camera::FOV_DEGREES, orthographic_height = None,
        near = None, far = None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn new(
        eye: [f64; 3],
        target: [f64; 3],
        up: Option<[f64; 3]>,
        size: (u32, u32),
        fov: f64,
        orthographic_height: Option<f64>,
        near: Option<f64>,
        far: Option<f64>,
    ) -> PyResult<Self> {
        let mut camera = cellfan::Camera::looking_at(eye.into(), target.into(), size.0, size.1);
        camera.up = up.map_or(camera.up, DVec3::from_array);
        camera.projection = match orthographic_height {
            Some(height_world) => Projection::Orthographic { height_world },
            None => Projection::Perspective { fov_degrees: fov },
        };
        (camera.near, camera.far) = (near, far);
        Self::checked(camera)
    }

    /// A camera that shows all of a box (smallest x, y, z, then largest) from azimuth and elevation in degrees, +z up.
    ///
    /// >>> cellfan.Camera.framing((0, 0, 0, 1, 1, 1), azimuth=0, elevation=0).target
    /// (0.5, 0.5, 0.5)
    #[staticmethod]
    #[pyo3(signature = (bounds, azimuth = 35.0, elevation = 20.0, size = (1024, 768)))]
    fn framing(bounds: [f64; 6], azimuth: f64, elevation: f64, size: (u32, u32)) -> PyResult<Self> {
        let corner = |i: usize| DVec3::from_array(std::array::from_fn(|axis| bounds[axis + 3 * (i >> axis & 1)]));
        let corners: [DVec3; 8] = std::array::from_fn(corner);
        Self::checked(cellfan::Camera::framing(&corners, azimuth, elevation, size.0, size.1))
    }

    /// The eye turned by `degrees` about the axis through the target along `up`, right-handed.
    fn orbited(&self, degrees: f64) -> PyResult<Self> {
        Self::checked(self.inner.orbited(degrees))
    }

    /// Where the eye is.
    #[getter]
    fn eye(&self) -> (f64, f64, f64) {
        self.inner.eye.into()
    }

    /// The point in the middle of the picture.
    #[getter]
    fn target(&self) -> (f64, f64, f64) {
        self.inner.target.into()
    }

    /// A direction that is up in the picture.
    #[getter]
    fn up(&self) -> (f64, f64, f64) {
        self.inner.up.into()
    }

    /// Width and height in pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.inner.width, self.inner.height)
    }

    /// Vertical field of view in degrees; None for parallel rays.
    #[getter]
    fn fov(&self) -> Option<f64> {
        match self.inner.projection {
            Projection::Perspective { fov_degrees } => Some(fov_degrees),
            Projection::Orthographic { .. } => None,
        }
    }

    /// What the picture's height covers with parallel rays; None in perspective.
    #[getter]
    fn orthographic_height(&self) -> Option<f64> {
        match self.inner.projection {
            Projection::Perspective { .. } => None,
            Projection::Orthographic { height_world } => Some(height_world),
        }
    }

    /// Nothing nearer is drawn; None for the default.
    #[getter]
    fn near(&self) -> Option<f64> {
        self.inner.near
    }

    /// Nothing farther is drawn; None for no limit.
    #[getter]
    fn far(&self) -> Option<f64> {
        self.inner.far
    }

    fn __repr__(&self) -> String {
        let (eye, target) = (self.inner.eye, self.inner.target);
        format!("Camera({:?}, {:?}, size={:?})", eye.to_array(), target.to_array(), self.size())
    }
}
