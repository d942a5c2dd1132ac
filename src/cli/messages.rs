//! Messages on stderr: `tracing` events as plain lines, by level.
//!
//! Shown are notes and warnings; with `-v` what is done, with `-vv` everything, with `-q` only errors (which end the
//! program and are printed by `failure`). A filter in `RUST_LOG` goes before all of them.

use std::fmt;
use std::io::{self, Write};

use cellfan::profile::trace::Recorder;
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::EnvFilter;
use tracing_subscriber::Layer;
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt;

use super::progress;

/// From here on events appear on stderr, and spans go to `recorder`.
pub(super) fn start(verbose: u8, quiet: bool, recorder: Option<&Recorder>) {
    let level = match verbose {
        _ if quiet => "error",
        0 => "info",
        1 => "debug",
        _ => "trace",
    };
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(format!("cellfan={level}")));
    let lines = tracing_subscriber::fmt::layer().with_ansi(false).event_format(Line).with_writer(|| Stderr);
    let registry = tracing_subscriber::registry().with(lines.with_filter(filter));
    match recorder {
        Some(recorder) => registry.with(recorder.layer()).init(),
        None => registry.init(),
    }
}

/// A note is its text; other levels are named.
struct Line;

impl<S, N> FormatEvent<S, N> for Line
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(&self, context: &FmtContext<'_, S, N>, mut line: Writer<'_>, event: &Event<'_>) -> fmt::Result {
        line.write_str(match *event.metadata().level() {
            Level::INFO => "",
            Level::ERROR => "error: ",
            Level::WARN => "warning: ",
            Level::DEBUG => "debug: ",
            Level::TRACE => "trace: ",
        })?;
        context.field_format().format_fields(line.by_ref(), event)?;
        writeln!(line)
    }
}

/// Stderr, with the progress bar out of the way; that it is closed is nothing to end over.
struct Stderr;

impl Write for Stderr {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let _ = progress::aside(|| io::stderr().write_all(bytes));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
