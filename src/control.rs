//! `Control`: how whoever asked for a picture is told how far it is, and ends it before it is done.
//!
//! In: a [`CancelToken`] that any thread may set, a callback. Out: [`Error::Cancelled`]; calls with the share that is done. Loops over
//! chunks of cells, tiles and cells of a tile look at the token, less than 5 ms of work apart; what they leave undone is thrown away by
//! whoever called them: functions that are called `…_while` end early.

#[cfg(all(test, unix))]
pub(crate) mod looks;

use std::fmt;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::{Error, Result};

/// Ends a picture that is being drawn, from any thread; clones are one token.
///
/// ```
/// use cellfan::CancelToken;
/// let token = CancelToken::default();
/// let other = token.clone();
/// std::thread::spawn(move || other.cancel()).join().unwrap();
/// assert!(token.is_cancelled());
/// ```
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Asks for the end. Takes no lock and allocates nothing: a signal handler may call it.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the end was asked for.
    #[inline]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Takes it back.
    pub fn reset(&self) {
        self.0.store(false, Ordering::Relaxed);
    }
}

/// What is called with the share of a picture that is done.
pub type OnProgress = dyn Fn(f64) + Send + Sync;

/// How a picture is watched and ended; by default neither.
#[derive(Default)]
pub struct Control {
    /// Ends it.
    pub cancel: CancelToken,
    /// The picture at hand was found to be cancelled, and stays so if the token is reset meanwhile: something is missing in it.
    is_ending: AtomicBool,
    progress: Option<Progress>,
}

struct Progress {
    call: Box<OnProgress>,
    /// The last share that was told.
    told: Mutex<f64>,
}

/// Steps in which progress is told.
const STEP: f64 = 1.0 / 256.0;

impl Control {
    /// Calls `call` with the share of the picture that is done, from 0 to 1, ascending: by one thread at a time, which need not be the
    /// one that draws. It should return soon, since a thread draws nothing while it runs.
    pub fn on_progress(&mut self, call: Box<OnProgress>) {
        self.progress = Some(Progress { call, told: Mutex::new(0.0) });
    }

    /// Goes on unless the end was asked for.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    #[cfg_attr(all(test, unix), track_caller)]
    pub fn check(&self) -> Result<()> {
        if self.is_cancelled() { Err(Error::Cancelled) } else { Ok(()) }
    }

    /// Whether the picture at hand is to end.
    #[inline]
    #[cfg_attr(all(test, unix), track_caller)]
    pub(crate) fn is_cancelled(&self) -> bool {
        #[cfg(all(test, unix))]
        looks::look();
        if self.cancel.is_cancelled() {
            self.is_ending.store(true, Ordering::Relaxed);
        }
        self.is_ending.load(Ordering::Relaxed)
    }

    /// A picture begins.
    pub(crate) fn begin(&self) {
        self.is_ending.store(false, Ordering::Relaxed);
        if let Some(Progress { call, told }) = &self.progress {
            *told.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = 0.0;
            call(0.0);
        }
    }

    /// So much of it is done. While one thread tells, others do not wait.
    #[inline]
    pub(crate) fn tell(&self, share: f64) {
        if let Some(progress) = &self.progress {
            progress.tell(share);
        }
    }
}

impl Progress {
    fn tell(&self, share: f64) {
        let Ok(mut told) = self.told.try_lock() else { return };
        if share >= *told + STEP || (share >= 1.0 && *told < 1.0) {
            *told = share;
            (self.call)(share);
        }
    }
}

impl fmt::Debug for Control {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Control {{ cancel: {:?}, progress: {} }}", self.cancel, self.progress.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_told_in_steps_and_ascend() {
        let shares = Arc::new(Mutex::new(Vec::new()));
        let mut control = Control::default();
        let told = Arc::clone(&shares);
        control.on_progress(Box::new(move |share| told.lock().unwrap().push(share)));
        for _ in 0..2 {
            control.begin();
            for share in [0.001, 0.5, 0.4, 0.501, 0.75, 1.0, 1.0] {
                control.tell(share);
            }
        }
        assert_eq!(*shares.lock().unwrap(), [0.0, 0.5, 0.75, 1.0].repeat(2));
        assert!(control.check().is_ok());
        control.cancel.cancel();
        assert!(matches!(control.check(), Err(Error::Cancelled)));
        control.cancel.reset();
        assert!(control.check().is_err(), "what was seen counts for the picture at hand");
        control.begin();
        assert!(control.check().is_ok());
    }
}
