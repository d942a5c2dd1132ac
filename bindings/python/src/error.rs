//! Exceptions: what cellfan's errors, and arguments that are none, become.

use std::any::Any;

use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::{PyErr, create_exception};

create_exception!(cellfan, Error, PyValueError, "What went wrong, where, and what to do about it.");
create_exception!(cellfan, Cancelled, Error, "The picture was cancelled; its session can be used on.");

/// The exception for an error of the library.
pub(crate) fn raised(error: cellfan::Error) -> PyErr {
    match error {
        cellfan::Error::Cancelled => Cancelled::new_err("cancelled"),
        error @ cellfan::Error::Io { .. } => PyOSError::new_err(error.to_string()),
        error => Error::new_err(error.to_string()),
    }
}

/// The exception for an argument that is none.
pub(crate) fn refused(problem: impl Into<String>) -> PyErr {
    Error::new_err(problem.into())
}

/// The exception for a fault of the library's own.
pub(crate) fn failed(panic: Box<dyn Any + Send>) -> PyErr {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
    // Dropping what was thrown may panic again.
    std::mem::forget(panic);
    Error::new_err(format!("cellfan failed: {text}; close the session"))
}
