//! Progress on stderr, where it is a terminal: a line for work of unknown length, a bar for frames.

use std::borrow::Cow;
use std::sync::LazyLock;
use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

/// All bars; hidden by itself where stderr is no terminal.
static BARS: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);

/// Does `write` while no bar is on the screen.
pub(super) fn aside<T>(write: impl FnOnce() -> T) -> T {
    BARS.suspend(write)
}

/// A bar that disappears when it is dropped.
pub(super) struct Progress(ProgressBar);

impl Progress {
    /// Shows that `what` is going on.
    pub(super) fn running(what: impl Into<Cow<'static, str>>) -> Self {
        Self::start(ProgressBar::new_spinner(), "{spinner} {msg} {elapsed}", what)
    }

    /// Shows how many of `count` are done.
    pub(super) fn counting(what: impl Into<Cow<'static, str>>, count: u64) -> Self {
        Self::start(ProgressBar::new(count), "{msg} {wide_bar} {pos}/{len} {eta}", what)
    }

    fn start(bar: ProgressBar, template: &str, what: impl Into<Cow<'static, str>>) -> Self {
        let bar = BARS.add(bar);
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message(what);
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    /// So many are done.
    pub(super) fn reach(&self, done: u64) {
        self.0.set_position(done);
    }

    /// One more is done.
    pub(super) fn step(&self) {
        self.0.inc(1);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
        BARS.remove(&self.0);
    }
}
