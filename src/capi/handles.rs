//! Handles: numbers that are never used twice, so that one that was freed is told.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

use super::guard::{CellfanStatus, Failure};
use crate::control::CancelToken;
use crate::session::Session;

/// A session; only ever behind a pointer, which is a number and points nowhere.
pub struct CellfanSession {
    _private: [u8; 0],
}

/// What a handle stands for.
pub(super) struct Held {
    session: Mutex<Session<'static>>,
    pub(super) cancel: CancelToken,
}

impl Held {
    /// The session, unless a call is using it.
    pub(super) fn session(&self) -> Result<MutexGuard<'_, Session<'static>>, Failure> {
        match self.session.try_lock() {
            Ok(session) => Ok(session),
            // After a fault the session is as whole as `guard.rs` says.
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                Err(Failure(CellfanStatus::Busy, "the session is in use by another call".to_owned()))
            }
        }
    }
}

/// All sessions that were not freed, and the number of the last.
static SESSIONS: Mutex<Option<HashMap<usize, Arc<Held>>>> = Mutex::new(None);
static LAST: AtomicUsize = AtomicUsize::new(0);

fn sessions() -> MutexGuard<'static, Option<HashMap<usize, Arc<Held>>>> {
    SESSIONS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A handle for `session`.
pub(super) fn put(session: Session<'static>) -> *mut CellfanSession {
    let number = LAST.fetch_add(1, Ordering::Relaxed) + 1;
    let held = Held { cancel: session.cancel_token(), session: Mutex::new(session) };
    sessions().get_or_insert_default().insert(number, Arc::new(held));
    std::ptr::without_provenance_mut(number)
}

/// What `handle` stands for.
pub(super) fn get(handle: *const CellfanSession) -> Result<Arc<Held>, Failure> {
    let held = sessions().as_ref().and_then(|sessions| sessions.get(&handle.addr()).cloned());
    held.ok_or_else(|| {
        let what = if handle.is_null() { "null" } else { "freed, or never was one" };
        Failure(CellfanStatus::Handle, format!("the session is {what}"))
    })
}

/// Forgets `handle`; a call that uses it goes on to its end.
pub(super) fn remove(handle: *const CellfanSession) -> Result<(), Failure> {
    let held = get(handle)?;
    sessions().as_mut().and_then(|sessions| sessions.remove(&handle.addr()));
    // Dropped here, the lock given back, unless a call still has it.
    drop(held);
    Ok(())
}
