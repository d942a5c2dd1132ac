//! `Source`: the file that a reader is in, for its messages, and where what is read goes.

use std::path::Path;

use super::scratch::Scratch;
use crate::error::{Error, presentable};

/// The name under which errors are reported, and where columns go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'a> {
    pub(super) path: &'a Path,
    pub(super) scratch: &'a Scratch,
}

impl Source<'_> {
    /// The file breaks its format's rules at `place`.
    pub(super) fn malformed(self, place: impl Into<String>, problem: impl Into<String>) -> Error {
        let (place, problem) = (presentable(place.into()), presentable(problem.into()));
        Error::Malformed { path: self.path.to_owned(), place, problem }
    }

    /// The file holds something that is not read.
    pub(super) fn unsupported(self, what: impl Into<String>, advice: impl Into<String>) -> Error {
        Error::Unsupported { path: self.path.to_owned(), what: presentable(what.into()), advice: advice.into() }
    }
}

/// At most 40 characters of a piece of the file, quoted for a message.
pub(super) fn quote(text: &[u8]) -> String {
    let shown = String::from_utf8_lossy(&text[..text.len().min(160)]);
    let short: String = shown.chars().take(40).collect();
    if short.len() < text.len() { format!("{short:?}…") } else { format!("{short:?}") }
}
