//! `cellfan._cellfan`: the compiled part of the Python package; `python/cellfan` is what programs import.
//!
//! In: NumPy arrays, which are borrowed where cellfan draws from them in place. Out: pictures as NumPy arrays. Everything that is not as
//! it has to be is an exception: nothing here panics, and what panics below becomes one. To add a setting: a parameter of
//! [`session::SessionCore::render`], and of `Session.render` and `render` in Python.

mod arrays;
mod camera;
mod error;
mod image;
mod mesh;
mod session;
mod transfer;
mod watch;

use pyo3::prelude::*;

/// Draws volumetric simulation data by projecting its cells.
#[pymodule]
mod _cellfan {
    #[pymodule_export]
    use super::camera::Camera;
    #[pymodule_export]
    use super::error::{Cancelled, Error};
    #[pymodule_export]
    use super::image::Image;
    #[pymodule_export]
    use super::session::{CancelToken, SessionCore};
    #[pymodule_export]
    use super::transfer::Transfer;

    /// The version of cellfan.
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
