//! Machine output: the only place that writes to stdout, where a closed pipe is an error and not a panic.

use std::io::{self, Write};

use super::{Failure, Outcome};

/// Writes `text` to stdout.
pub(super) fn write(text: &str) -> Outcome {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(Failure::Stdout)
}
