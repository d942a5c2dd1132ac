//! `Backing`: the file behind a memory map, watched for change.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::error::{Error, Result};

/// A file whose bytes a dataset uses in place, as it was when it was opened.
#[derive(Debug)]
pub struct Backing {
    path: PathBuf,
    file: File,
    len: u64,
    modified: Option<SystemTime>,
}

impl Backing {
    /// Remembers what `file`, opened at `path`, is like now.
    ///
    /// # Errors
    /// [`Error::Io`] where the system does not say.
    pub fn new(path: &Path, file: File) -> Result<Self> {
        let metadata = file.metadata().map_err(|source| Error::Io { path: path.to_owned(), source })?;
        Ok(Self { path: path.to_owned(), file, len: metadata.len(), modified: metadata.modified().ok() })
    }

    /// The file's length when it was opened, in bytes.
    pub fn len(&self) -> u64 {
        self.len
    }

    /// Whether the file was empty.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The file is what it was: same length, same time of modification. A file that is replaced, as cellfan itself writes
    /// files, is another file and leaves this one whole.
    ///
    /// # Errors
    /// [`Error::Changed`] where it is not.
    pub fn check(&self) -> Result<()> {
        let metadata = self.file.metadata().map_err(|source| Error::Io { path: self.path.clone(), source })?;
        let problem = if metadata.len() < self.len {
            "was shortened"
        } else if metadata.len() > self.len || metadata.modified().ok() != self.modified {
            "was written to"
        } else {
            return Ok(());
        };
        Err(Error::Changed { path: self.path.clone(), problem })
    }
}
