//! `Image`: a picture as a NumPy array, which a notebook shows.

use std::path::PathBuf;

use cellfan::image::Encoding;
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::error::{raised, refused};

/// A picture: `array` of shape (height, width, 4), linear red, green, blue, opacity in float32, premultiplied, rows from the top.
///
/// In the absorption model it holds transmitted intensities instead. `stats` says what became of the cells and how long it took.
/// `numpy.asarray(image)` is `image.array`.
#[pyclass(frozen, module = "cellfan")]
pub(crate) struct Image {
    /// The pixels: shape (height, width, 4), float32.
    #[pyo3(get)]
    array: Py<PyArray3<f32>>,
    /// What became of the cells, whether their order is exact, milliseconds in all and by stage.
    #[pyo3(get)]
    stats: Py<PyDict>,
    is_premultiplied: bool,
}

impl Image {
    /// Takes the pixels over.
    pub(crate) fn new(
        py: Python<'_>,
        image: cellfan::Image,
        stats: Py<PyDict>,
        is_premultiplied: bool,
    ) -> PyResult<Self> {
        let shape = [image.height as usize, image.width as usize, 4];
        let array = PyArray1::from_vec(py, image.pixels.into_flattened()).reshape(shape)?.unbind();
        Ok(Self { array, stats, is_premultiplied })
    }

    /// A copy that the library's writers take.
    fn picture(&self, py: Python<'_>) -> PyResult<cellfan::Image> {
        let array = self.array.bind(py);
        let [height, width, _] = *array.shape() else { return Err(refused("the picture has lost its shape")) };
        let values = array.try_readonly()?.as_array().iter().copied().collect::<Vec<f32>>();
        let side = |side: usize| u32::try_from(side).map_err(|_| refused("the picture has lost its shape"));
        Ok(cellfan::Image { width: side(width)?, height: side(height)?, pixels: values.as_chunks().0.to_vec() })
    }

    fn encoding(&self, background: Option<[f32; 3]>) -> Encoding {
        Encoding { background, premultiplied: self.is_premultiplied }
    }
}

#[pymethods]
impl Image {
    /// Width and height in pixels.
    #[getter]
    fn size(&self, py: Python<'_>) -> (usize, usize) {
        let array = self.array.bind(py);
        (array.shape()[1], array.shape()[0])
    }

    /// Writes a file by the extension of `path`: .png to look at, over `background` (sRGB, 0 to 1) or with straight alpha; .exr and .npy
    /// keep the linear values. It appears whole or not at all.
    #[pyo3(signature = (path, *, background = None))]
    fn save(&self, py: Python<'_>, path: PathBuf, background: Option<[f32; 3]>) -> PyResult<()> {
        let (picture, encoding) = (self.picture(py)?, self.encoding(background));
        py.detach(|| picture.save(path, &encoding)).map_err(raised)
    }

    /// The bytes of a PNG; see :meth:`save`.
    #[pyo3(signature = (*, background = None))]
    fn to_png<'py>(&self, py: Python<'py>, background: Option<[f32; 3]>) -> PyResult<Bound<'py, PyBytes>> {
        let (picture, encoding) = (self.picture(py)?, self.encoding(background));
        let bytes = py.detach(|| picture.to_png(&encoding)).map_err(raised)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The picture on black, for notebooks.
    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.to_png(py, Some([0.0; 3]))
    }

    #[pyo3(signature = (dtype = None, copy = None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let array = self.array.bind(py).as_any();
        let wanted = dtype
            .map_or_else(|| array.getattr("dtype"), |dtype| py.import("numpy")?.call_method1("dtype", (dtype,)))?;
        if !wanted.eq(array.getattr("dtype")?)? {
            if copy == Some(false) {
                return Err(PyValueError::new_err("the picture is float32: another dtype needs a copy"));
            }
            return array.call_method1("astype", (wanted,));
        }
        if copy == Some(true) { array.call_method0("copy") } else { Ok(array.clone()) }
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let (width, height) = self.size(py);
        format!("<cellfan.Image {width}x{height}>")
    }
}
