//! How long a thread works between two looks at the token, for tests: in time of its own, which other threads and programs do not lengthen.

use std::cell::Cell;
use std::panic::Location;
use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

/// What a thread has seen of itself.
#[derive(Clone, Copy)]
struct Watch {
    /// When it looked last.
    last: Duration,
    /// The longest time between two looks, and where the later one is.
    longest: (Duration, &'static Location<'static>),
}

thread_local! {
    /// None on threads that nobody watches: they read no clock.
    static WATCH: Cell<Option<Watch>> = const { Cell::new(None) };
}

/// Time that this thread has worked.
fn now() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// From here on this thread is watched.
#[track_caller]
pub(crate) fn watch() {
    WATCH.set(Some(Watch { last: now(), longest: (Duration::ZERO, Location::caller()) }));
}

/// This thread looks at the token.
#[track_caller]
pub(super) fn look() {
    if let Some(watch) = WATCH.get() {
        let (last, between) = (now(), now().saturating_sub(watch.last));
        let longest = if between > watch.longest.0 { (between, Location::caller()) } else { watch.longest };
        WATCH.set(Some(Watch { last, longest }));
    }
}

/// Ends the watch: the longest time between two looks, the end being one, and where the later one is.
#[track_caller]
pub(crate) fn longest() -> (Duration, &'static Location<'static>) {
    look();
    let watch = WATCH.take();
    watch.map_or((Duration::ZERO, Location::caller()), |watch| watch.longest)
}
