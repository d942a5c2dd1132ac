//! Files that appear whole or not at all: written under a temporary name in the same folder, renamed at the end.
//!
//! In: the path, and a function that writes. Out: the file with the permissions of any new file (`0666 & !umask`), or
//! those of the file it replaces; after an error, what was there before. A link is followed to the file it names.
//! A path that is no regular file (`/dev/stdout`, a named pipe) cannot be renamed over: it gets the bytes at the end.
//! Nothing is synced: after a power failure the file is as safe as any other new file. What a process that was killed
//! leaves of its temporary files is removed by the next one that writes into the same folder.

mod temporary;

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Seek};
use std::path::{Path, PathBuf};

use crate::{Error, Result};

/// Bytes gathered before each write: large enough that the number of system calls does not matter.
const BUFFER_BYTES: usize = 1 << 18;

/// Runs `write` on a temporary file that takes the name `path` if `write` succeeds and is removed otherwise.
///
/// # Errors
/// [`Error::Io`] where the system refuses; whatever `write` returns.
pub(crate) fn write_atomically<T>(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> Result<T>) -> Result<T> {
    let mut file = AtomicFile::create(path)?;
    let value = write(&mut file.writer)?;
    file.commit()?;
    Ok(value)
}

/// Writes `text` to the file `path`, which appears whole or not at all.
///
/// ```
/// # let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("record.json");
/// cellfan::io::write_text(&path, "{}\n")?;
/// assert_eq!(std::fs::read_to_string(&path).unwrap(), "{}\n");
/// # Ok::<(), cellfan::Error>(())
/// ```
///
/// # Errors
/// [`Error::Io`] where the system refuses.
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    write_atomically(path, |writer| io::Write::write_all(writer, text.as_bytes()).map_err(io_at(path)))
}

/// [`Error::Io`] at `path`, for `map_err`.
pub(crate) fn io_at(path: &Path) -> impl Fn(io::Error) -> Error {
    move |source| Error::Io { path: path.to_owned(), source }
}

/// The folder of `path` exists: found out before long work rather than after it.
///
/// # Errors
/// [`Error::Io`] where there is no such folder, or `path` is itself a folder.
pub fn check_target(path: &Path) -> Result<()> {
    let folder = folder_of(path);
    let problem = if path.is_dir() {
        io::Error::new(io::ErrorKind::IsADirectory, "this is a folder; name a file in it")
    } else if folder.is_dir() {
        return Ok(());
    } else {
        let problem = format!("there is no folder \"{}\"; create it first", folder.display());
        io::Error::new(io::ErrorKind::NotFound, problem)
    };
    Err(io_at(path)(problem))
}

/// A file that is being written and has no name yet; dropped before [`commit`](Self::commit), it leaves nothing.
pub(crate) struct AtomicFile {
    /// Where to write.
    pub(crate) writer: BufWriter<File>,
    path: PathBuf,
    end: End,
}

/// What happens at the end.
enum End {
    /// The temporary file is renamed to the path, links resolved.
    Rename { temporary: tempfile::TempPath, target: PathBuf },
    /// The nameless temporary file is copied into a device or pipe.
    Copy,
}

impl AtomicFile {
    /// Opens the temporary file.
    ///
    /// # Errors
    /// [`Error::Io`] where `path` or its folder cannot be written.
    pub(crate) fn create(path: &Path) -> Result<Self> {
        check_target(path)?;
        let at = io_at(path);
        let existing = path.metadata().ok();
        if existing.as_ref().is_some_and(|found| !found.is_file()) {
            let file = tempfile::tempfile().map_err(at)?;
            return Ok(Self {
                writer: BufWriter::with_capacity(BUFFER_BYTES, file),
                path: path.into(),
                end: End::Copy,
            });
        }
        let target = if existing.is_some() {
            // A file that may not be written may not be replaced either.
            OpenOptions::new().write(true).open(path).map_err(&at)?;
            path.canonicalize().map_err(&at)?
        } else {
            path.to_owned()
        };

        let folder = folder_of(&target);
        let (file, temporary) = temporary::create_in(folder)
            // The error names the temporary file, which means nothing to the reader.
            .map_err(|error| {
                let problem =
                    format!("no file can be created in the folder \"{}\": {}", folder.display(), error.kind());
                at(io::Error::new(error.kind(), problem))
            })?
            .into_parts();
        if let Some(found) = existing {
            file.set_permissions(found.permissions()).map_err(&at)?;
        }
        let writer = BufWriter::with_capacity(BUFFER_BYTES, file);
        Ok(Self { writer, path: path.into(), end: End::Rename { temporary, target } })
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// [`Error::Io`] where the last bytes cannot be written or the rename is refused.
    pub(crate) fn commit(self) -> Result<()> {
        let at = io_at(&self.path);
        let mut file = self.writer.into_inner().map_err(|error| at(error.into_error()))?;
        match self.end {
            // The file stays open and locked until it has its name.
            End::Rename { temporary, target } => temporary.persist(target).map_err(|error| at(error.error)),
            End::Copy => {
                file.rewind().map_err(&at)?;
                let mut device = OpenOptions::new().write(true).open(&self.path).map_err(&at)?;
                io::copy(&mut file, &mut device).map(drop).map_err(&at)
            }
        }
    }
}

/// The folder that holds `path`.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::io::Write;

    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn write(path: &Path, bytes: &[u8]) -> Result<()> {
        write_atomically(path, |w| w.write_all(bytes).map_err(io_at(path)))
    }

    #[test]
    fn file_appears_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        let large = vec![7; 3 * BUFFER_BYTES + 1];
        write_atomically(&path, |w| {
            w.write_all(&large).map_err(io_at(&path))?;
            assert!(!path.exists(), "the name appears at the end only");
            Ok(())
        })
        .unwrap();
        assert_eq!(fs::read(&path).unwrap(), large);
        assert_eq!(names_in(folder.path()), ["a.bin"]);
    }

    #[test]
    fn error_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        write(&path, b"before").unwrap();
        let error = write_atomically(&path, |w| {
            w.write_all(&vec![1; 2 * BUFFER_BYTES]).unwrap();
            Err::<(), _>(Error::Encode { path: path.clone(), problem: "stopped".into() })
        })
        .unwrap_err();
        assert!(error.to_string().ends_with("could not encode the picture: stopped"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"before");
        assert_eq!(names_in(folder.path()), ["a.bin"]);
    }

    #[test]
    fn missing_folder_and_folder_as_file() {
        let folder = tempfile::tempdir().unwrap();
        let error = write(&folder.path().join("no/a.bin"), b"x").unwrap_err().to_string();
        assert!(error.contains("there is no folder") && error.ends_with("create it first"), "{error}");
        let error = write(folder.path(), b"x").unwrap_err().to_string();
        assert!(error.ends_with("this is a folder; name a file in it"), "{error}");
        fs::write(folder.path().join("f"), "").unwrap();
        write(&folder.path().join("f/a.bin"), b"x").unwrap_err();
        assert_eq!(names_in(folder.path()), ["f"]);
    }

    #[cfg(unix)]
    mod unix {
        use std::os::unix::fs::{PermissionsExt, symlink};

        use super::*;

        fn mode(path: &Path) -> u32 {
            path.metadata().unwrap().permissions().mode() & 0o777
        }

        #[test]
        fn permissions_of_any_new_file_or_of_the_one_replaced() {
            let folder = tempfile::tempdir().unwrap();
            let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
            File::create(&plain).unwrap();
            write(&ours, b"x").unwrap();
            assert_eq!(mode(&ours), mode(&plain));
            fs::set_permissions(&ours, fs::Permissions::from_mode(0o640)).unwrap();
            write(&ours, b"y").unwrap();
            assert_eq!((mode(&ours), fs::read(&ours).unwrap()), (0o640, b"y".to_vec()));
        }

        #[test]
        fn link_is_followed() {
            let folder = tempfile::tempdir().unwrap();
            let (file, link) = (folder.path().join("file"), folder.path().join("link"));
            fs::write(&file, "before").unwrap();
            symlink(&file, &link).unwrap();
            write(&link, b"after").unwrap();
            assert!(link.is_symlink());
            assert_eq!(fs::read(&file).unwrap(), b"after");
        }

        #[test]
        fn device_is_written_not_replaced() {
            let null = Path::new("/dev/null");
            write(null, b"x").unwrap();
            assert!(!null.metadata().unwrap().is_file());
        }

        #[test]
        fn unwritable_folder() {
            let folder = tempfile::tempdir().unwrap();
            fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o555)).unwrap();
            // The superuser may write anywhere: nothing to see then.
            if File::create(folder.path().join("probe")).is_err() {
                let error = write(&folder.path().join("a.bin"), b"x").unwrap_err().to_string();
                assert!(error.contains("no file can be created in the folder"), "{error}");
                assert_eq!(names_in(folder.path()), [""; 0]);
            }
            fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o755)).unwrap();
        }
    }
}
