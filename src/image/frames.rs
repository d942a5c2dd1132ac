//! Several frames under one name: numbered files, or one stacked .npy.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::{Encoding, Format, Picture, check_output, npy};
use crate::atomic::AtomicFile;
use crate::{Error, Result};

/// The file of frame `frame`: its number before the extension, four digits or more.
///
/// ```
/// # use cellfan::image::frame_path;
/// assert_eq!(frame_path("a/out.png", 12), std::path::Path::new("a/out.0012.png"));
/// ```
pub fn frame_path(path: impl AsRef<Path>, frame: u32) -> PathBuf {
    let path = path.as_ref();
    let mut name = path.file_stem().map_or_else(OsString::new, OsString::from);
    name.push(format!(".{frame:04}"));
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// Writes frames as they come: out.0000.png, out.0001.png …, or one .npy of shape `(n, height, width, channels)`.
///
/// A numbered file is there as soon as it is pushed; a stack appears with [`finish`](Self::finish), and not at all
/// without it.
///
/// ```
/// use cellfan::image::{Encoding, FrameWriter, Image};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("out.npy");
/// let mut frames = FrameWriter::create(&path, Encoding::default(), 2)?;
/// frames.push(&Image::filled(3, 1, [0.5; 4]))?;
/// frames.push(&Image::filled(3, 1, [1.0; 4]))?;
/// frames.finish()?;
/// let stack = npyz::NpyFile::new(std::fs::File::open(&path)?)?;
/// assert_eq!(stack.shape(), [2, 1, 3, 4]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct FrameWriter {
    path: PathBuf,
    encoding: Encoding,
    frames: u32,
    pushed: u32,
    /// Height, width and channels of the first frame.
    shape: Option<[u32; 3]>,
    stack: Option<AtomicFile>,
}

impl FrameWriter {
    /// Prepares to write `frames` frames as `path` says.
    ///
    /// # Errors
    /// As [`check_output`]; [`Error::Io`] where a stack cannot be created.
    pub fn create(path: impl AsRef<Path>, encoding: Encoding, frames: u32) -> Result<Self> {
        let path = path.as_ref();
        let stack = match check_output(path, &encoding)? {
            Format::Npy => Some(AtomicFile::create(path)?),
            Format::Png | Format::Exr => None,
        };
        Ok(Self { path: path.to_owned(), encoding, frames, pushed: 0, shape: None, stack })
    }

    /// Writes the next frame.
    ///
    /// # Errors
    /// As [`Picture::save`]; [`Error::Encode`] where there are more frames than were announced or where a frame of a
    /// stack has another size than the first.
    pub fn push(&mut self, image: &impl Picture) -> Result<()> {
        if self.pushed == self.frames {
            return Err(self.error(format!("there are more than the {} frames announced", self.frames)));
        }
        if let Some(stack) = &mut self.stack {
            image.check(&self.path)?;
            let [height, width, channels] = image.shape();
            let first = *self.shape.get_or_insert([height, width, channels]);
            if first != [height, width, channels] {
                let [b, a, c] = first;
                let more = if c == channels { String::new() } else { format!(" with {channels} channels, not {c}") };
                let problem = format!("frame {} is {width}x{height}{more}, the others {a}x{b}", self.pushed);
                return Err(self.error(problem));
            }
            if self.pushed == 0 {
                let shape = [self.frames, height, width, channels].map(u64::from);
                npy::write_header(&mut stack.writer, &shape, &self.path)?;
            }
            npy::write_pixels(&mut stack.writer, image, &self.path)?;
        } else {
            image.save(&frame_path(&self.path, self.pushed), &self.encoding)?;
        }
        self.pushed += 1;
        Ok(())
    }

    /// Ends the sequence.
    ///
    /// # Errors
    /// [`Error::Encode`] where frames are missing; [`Error::Io`] where the system refuses to write.
    pub fn finish(self) -> Result<()> {
        if self.pushed < self.frames {
            return Err(self.error(format!("only {} of {} frames were drawn", self.pushed, self.frames)));
        }
        self.stack.map_or(Ok(()), AtomicFile::commit)
    }

    fn error(&self, problem: String) -> Error {
        Error::Encode { path: self.path.clone(), problem }
    }
}
