//! The border: what goes wrong becomes a status and a message, and no panic crosses.
#![expect(unsafe_code, reason = "C ABI: functions are exported by name")]

use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::error::Error;

/// What became of a call. Every function that returns one leaves a message in cellfan_last_error() unless it is CELLFAN_STATUS_OK,
/// and leaves what it would have written as it was.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellfanStatus {
    /// It was done.
    Ok = 0,
    /// A pointer is null or not aligned, a number is none of its enumeration, a text is not UTF-8.
    Argument = 1,
    /// The mesh: lengths that do not fit, numbers of points that do not exist, coordinates that are not finite, no cell with a volume.
    Mesh = 2,
    /// The scalars: of another length, or none of them finite.
    Scalars = 3,
    /// The camera cannot look at anything.
    Camera = 4,
    /// The transfer function: values that do not ascend, extinction below 0.
    Transfer = 5,
    /// Options that contradict each other or lie out of range.
    Option = 6,
    /// The memory budget, or the system's memory, is too small.
    Memory = 7,
    /// cellfan_session_cancel() was called.
    Cancelled = 8,
    /// A file could not be written.
    File = 9,
    /// The session was freed, or never was one.
    Handle = 10,
    /// The session is in use by another thread, or by the call whose callback this is.
    Busy = 11,
    /// A fault of cellfan's own; the session is best freed.
    Fault = 12,
}

/// A status and what it says.
pub(super) struct Failure(pub(super) CellfanStatus, pub(super) String);

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let status = match &error {
            Error::IndexOutOfRange { .. }
            | Error::LengthMismatch { .. }
            | Error::NonFinitePosition { .. }
            | Error::TooLarge { .. }
            | Error::NoCells { .. } => CellfanStatus::Mesh,
            Error::UnknownArray { .. } | Error::UnusableArray { .. } => CellfanStatus::Scalars,
            Error::Camera { .. } | Error::ImageSize { .. } => CellfanStatus::Camera,
            Error::TransferFunction { .. } => CellfanStatus::Transfer,
            Error::Memory { .. } | Error::OutOfMemory { .. } => CellfanStatus::Memory,
            Error::Cancelled => CellfanStatus::Cancelled,
            Error::Io { .. } | Error::Encode { .. } => CellfanStatus::File,
            _ => CellfanStatus::Option,
        };
        Self(status, error.to_string())
    }
}

/// An argument that is none.
pub(super) fn argument(problem: impl Into<String>) -> Failure {
    Failure(CellfanStatus::Argument, problem.into())
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

/// Runs what a function does.
pub(super) fn guarded(work: impl FnOnce() -> Result<(), Failure>) -> CellfanStatus {
    // What a panic leaves half done is made anew by the next picture; sessions say so in `Renderer`.
    let result = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        // Dropping what was thrown may panic again.
        std::mem::forget(panic);
        Err(Failure(CellfanStatus::Fault, format!("cellfan failed: {}", text.unwrap_or_default())))
    });
    let Err(Failure(status, message)) = result else { return CellfanStatus::Ok };
    let message = CString::new(message.replace('\0', " ")).unwrap_or_default();
    LAST.with(|last| *last.borrow_mut() = message);
    status
}

/// What went wrong last in a call on this thread; empty if nothing did. Good until the next call on this thread. Never null.
///
/// Threads: any; each has its own.
#[unsafe(no_mangle)]
pub extern "C" fn cellfan_last_error() -> *const c_char {
    LAST.with(|last| last.borrow().as_ptr())
}
