//! Where pictures go: one file, or a sequence.

use std::path::{Path, PathBuf};

use cellfan::image::{Encoding, Format, FrameWriter, Picture, check_output, frame_path};
use cellfan::{Rendered, Result};

/// One picture under its own name, or numbered ones.
pub(in crate::cli) enum Pictures {
    /// Without `--frames`.
    One(PathBuf, Encoding),
    /// With `--frames`, even if it is one.
    Several { path: PathBuf, frames: u32, writer: Box<FrameWriter> },
}

impl Pictures {
    /// Finds out whether the pictures can be written.
    ///
    /// # Errors
    /// As [`check_output`].
    pub(in crate::cli) fn create(path: PathBuf, encoding: Encoding, frames: Option<u32>) -> Result<Self> {
        if check_output(&path, &encoding)? != Format::Png && encoding.background.is_some() {
            tracing::warn!("{} keeps the linear values: --background is ignored", path.display());
        }
        Ok(match frames {
            None => Self::One(path, encoding),
            Some(frames) => {
                Self::Several { writer: Box::new(FrameWriter::create(&path, encoding, frames)?), path, frames }
            }
        })
    }

    /// Writes the next picture: all its bands if it has bands of their own, of which a PNG shows the first three.
    pub(in crate::cli) fn push(&mut self, rendered: &Rendered) -> Result<()> {
        match &rendered.bands {
            Some(bands) if Format::from_path(self.path())? != Format::Png => self.push_picture(bands),
            _ => self.push_picture(&rendered.image),
        }
    }

    fn push_picture(&mut self, picture: &impl Picture) -> Result<()> {
        match self {
            Self::One(path, encoding) => picture.save(path, encoding),
            Self::Several { writer, .. } => writer.push(picture),
        }
    }

    fn path(&self) -> &Path {
        match self {
            Self::One(path, _) | Self::Several { path, .. } => path,
        }
    }

    /// Ends the sequence; what was written, in words.
    pub(in crate::cli) fn finish(self) -> Result<String> {
        match self {
            Self::One(path, _) => Ok(path.display().to_string()),
            Self::Several { path, frames, writer } => {
                writer.finish()?;
                Ok(match Format::from_path(&path)? {
                    Format::Npy => format!("{} ({frames} frames)", path.display()),
                    _ if frames == 1 => frame_path(&path, 0).display().to_string(),
                    _ => format!("{} to {}", frame_path(&path, 0).display(), frame_path(&path, frames - 1).display()),
                })
            }
        }
    }
}
