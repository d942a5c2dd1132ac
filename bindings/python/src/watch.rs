//! [`watched`]: a picture drawn while its caller tells how far it is and listens to signals.
//!
//! The picture is drawn on another thread, without the lock of the interpreter. The calling thread waits, passes progress on to Python, and
//! looks for signals a few times a second, so that Ctrl-C ends a long picture.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use cellfan::session::Session;
use cellfan::{Camera, CancelToken, RenderOptions, Rendered, TransferFunction};
use pyo3::prelude::*;

use crate::error::{failed, raised};

/// Between two looks for signals.
const LOOK: Duration = Duration::from_millis(50);

/// What the drawing thread tells.
enum Told {
    Share(f64),
    Done,
}

/// Draws a picture; `progress` is called with the share that is done. Not to be called with the interpreter's lock held.
pub(crate) fn watched(
    session: &mut Session<'static>,
    progress: Option<&Py<PyAny>>,
    (camera, transfer, options): (&Camera, &TransferFunction, &RenderOptions),
) -> PyResult<Rendered> {
    let (tell, told) = channel();
    let token = session.cancel_token();
    let of_picture = tell.clone();
    let is_told = progress.is_some();
    session.on_progress(Box::new(move |share| {
        if is_told {
            // Nobody listens once the picture is done.
            let _ = of_picture.send(Told::Share(share));
        }
    }));
    let (drawn, stopped) = std::thread::scope(|scope| {
        let drawing = scope.spawn(|| {
            let drawn = catch_unwind(AssertUnwindSafe(|| session.render(camera, transfer, options)));
            let _ = tell.send(Told::Done);
            drawn
        });
        let stopped = listen(&told, progress, &token);
        (drawing.join(), stopped)
    });
    session.on_progress(Box::new(|_| ()));
    let drawn = drawn.and_then(|drawn| drawn).map_err(failed)?;
    if let Err(stopped) = stopped {
        // The picture may have been done all the same: then nobody has taken the token back.
        token.reset();
        return Err(stopped);
    }
    drawn.map_err(raised)
}

/// Until the picture is done: passes shares on, and looks for signals. An exception, of a signal or of `progress`, ends the picture.
fn listen(told: &Receiver<Told>, progress: Option<&Py<PyAny>>, token: &CancelToken) -> PyResult<()> {
    let (mut stopped, mut looked) = (Ok(()), Instant::now());
    loop {
        let next = told.recv_timeout(LOOK);
        // Of many shares that came meanwhile only the last is of interest.
        let waiting = told.try_iter();
        let (mut share, mut is_done) = (None, false);
        for news in next.iter().chain(waiting.collect::<Vec<_>>().iter()) {
            match news {
                Told::Share(of_picture) => share = Some(*of_picture),
                Told::Done => is_done = true,
            }
        }
        if stopped.is_ok() {
            let is_time = looked.elapsed() >= LOOK;
            stopped = Python::attach(|py| {
                if let (Some(progress), Some(share)) = (progress, share) {
                    progress.call1(py, (share,))?;
                }
                if is_time { py.check_signals() } else { Ok(()) }
            });
            if is_time {
                looked = Instant::now();
            }
            if stopped.is_err() {
                token.cancel();
            }
        }
        if is_done || matches!(next, Err(RecvTimeoutError::Disconnected)) {
            return stopped;
        }
    }
}
