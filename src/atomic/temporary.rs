//! Temporary files that say whether their process lives: it holds a lock on each, which the kernel releases at its death.
//!
//! In: a folder. Out: an open file there, `.cellfan-PROCESS-RANDOM.partial`, locked. What runs that were killed have left
//! in the folder is removed first: files of that name, and only those, whose lock is free. The number of the process is
//! for people; numbers come again, locks do not lie.

use std::collections::HashSet;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::NamedTempFile;

const PREFIX: &str = ".cellfan-";
const SUFFIX: &str = ".partial";

/// How often a file may be taken for one of the dead before it is locked; once is rare.
const ATTEMPTS: usize = 8;

/// A new locked file in `folder`.
///
/// # Errors
/// Where the system refuses.
pub(super) fn create_in(folder: &Path) -> io::Result<NamedTempFile> {
    remove_leftovers_once(folder);
    for _ in 0..ATTEMPTS {
        let temporary = named(&format!("{PREFIX}{}-", std::process::id()), folder)?;
        match temporary.as_file().lock() {
            Ok(()) if is_at(temporary.as_file(), temporary.path()) => return Ok(temporary),
            // Another process found it before it was locked.
            Ok(()) => {}
            // A file system without locks.
            Err(_) => break,
        }
    }
    // Not of the form that is ever removed.
    named(PREFIX, folder)
}

fn named(prefix: &str, folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix).suffix(SUFFIX);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// Removes leftovers from `folder` at the first call for it: a folder of many pictures is not listed for each.
fn remove_leftovers_once(folder: &Path) {
    static SEEN: Mutex<Option<HashSet<PathBuf>>> = Mutex::new(None);
    let Ok(folder) = folder.canonicalize() else { return };
    let mut seen = SEEN.lock().unwrap_or_else(PoisonError::into_inner);
    if seen.get_or_insert_default().insert(folder.clone()) {
        drop(seen);
        remove_leftovers(&folder);
    }
}

/// Removes what the dead left in `folder`; what cannot be looked at or removed stays.
fn remove_leftovers(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        if entry.file_name().to_str().is_some_and(is_ours) {
            let path = entry.path();
            match remove_if_dead(&path) {
                Ok(true) => tracing::debug!("removed {}, which a run that was killed left", path.display()),
                Ok(false) => {}
                Err(error) => tracing::debug!("{} stays: {error}", path.display()),
            }
        }
    }
}

/// Whether [`create_in`] makes such names.
fn is_ours(name: &str) -> bool {
    let inner = name.strip_prefix(PREFIX).and_then(|rest| rest.strip_suffix(SUFFIX));
    inner.and_then(|inner| inner.split_once('-')).is_some_and(|(process, random)| {
        let all = |text: &str, is: fn(&u8) -> bool| !text.is_empty() && text.bytes().all(|byte| is(&byte));
        all(process, u8::is_ascii_digit) && all(random, u8::is_ascii_alphanumeric)
    })
}

/// Removes the file if nobody holds its lock; whether it did.
fn remove_if_dead(path: &Path) -> io::Result<bool> {
    // A link or a pipe is none of ours, whatever it is called.
    if !path.symlink_metadata()?.is_file() {
        return Ok(false);
    }
    let file = OpenOptions::new().read(true).write(true).open(path)?;
    // Who makes a file locks it and then looks whether it is still there: with the lock held here, it is not in use.
    if file.try_lock().is_err() || !is_at(&file, path) {
        return Ok(false);
    }
    fs::remove_file(path)?;
    Ok(true)
}

/// Whether `path` still names the open file.
fn is_at(file: &File, path: &Path) -> bool {
    let (Ok(open), Ok(named)) = (file.metadata(), path.symlink_metadata()) else { return false };
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        (open.dev(), open.ino()) == (named.dev(), named.ino())
    }
    #[cfg(not(unix))]
    {
        open.is_file() && named.is_file()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn names_that_are_made_are_known_and_no_others() {
        let folder = tempfile::tempdir().unwrap();
        let temporary = create_in(folder.path()).unwrap();
        assert!(is_ours(temporary.path().file_name().unwrap().to_str().unwrap()));
        assert!(is_ours(".cellfan-1-aB3.partial"));
        for other in [
            ".cellfan-aB3dEf.partial",
            ".cellfan-1-.partial",
            ".cellfan--a.partial",
            ".cellfan-1x-a.partial",
            ".cellfan-1-a.b.partial",
            ".cellfan-1-a.partial.png",
            "cellfan-1-a.partial",
            ".cellfan-.partial",
            ".cellfan-1-a-b.partial",
        ] {
            assert!(!is_ours(other), "{other}");
        }
    }

    #[test]
    fn only_files_without_a_holder_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let living = create_in(folder.path()).unwrap();
        let other = folder.path().join(".cellfan-1-other.txt");
        fs::write(&other, "x").unwrap();
        let inner = folder.path().join(".cellfan-1-folder.partial");
        fs::create_dir(&inner).unwrap();
        let mut expected = names_in(folder.path());
        // What the dead leave: a file of that name that nobody has open.
        fs::write(folder.path().join(".cellfan-1-dead.partial"), "x").unwrap();
        // The number of a process that lives protects nothing that is not locked.
        fs::write(folder.path().join(format!(".cellfan-{}-dead.partial", std::process::id())), "x").unwrap();
        remove_leftovers(folder.path());
        assert_eq!(names_in(folder.path()), expected);
        let gone = living.path().file_name().unwrap().to_str().unwrap().to_owned();
        drop(living);
        expected.retain(|name| *name != gone);
        assert_eq!(names_in(folder.path()), expected);
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_with_what_they_name() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join(".cellfan-1-link.partial"));
        fs::write(&file, "x").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        remove_leftovers(folder.path());
        assert!(link.is_symlink() && file.exists());
    }

    #[test]
    fn makers_and_removers_do_not_meet() {
        let folder = tempfile::tempdir().unwrap();
        std::thread::scope(|scope| {
            let makers: Vec<_> = (0..2)
                .map(|_| {
                    scope.spawn(|| {
                        for _ in 0..200 {
                            let temporary = create_in(folder.path()).unwrap();
                            std::thread::yield_now();
                            assert!(temporary.path().exists(), "removed while it was in use");
                        }
                    })
                })
                .collect();
            while !makers.iter().all(std::thread::ScopedJoinHandle::is_finished) {
                remove_leftovers(folder.path());
            }
        });
        assert_eq!(names_in(folder.path()), [""; 0]);
    }
}
