//! The folder of a case: its times, and the files that a time has.

use std::path::{Path, PathBuf};

use crate::atomic::io_at;
use crate::error::{Error, Result};

/// A case at one of its times.
pub(super) struct Case {
    folder: PathBuf,
    /// Names of the folders of times, ascending, to the one that is read.
    times: Vec<(f64, String)>,
}

impl Case {
    /// The case in `folder` at its last time, or at the time whose folder this is.
    pub(super) fn at(folder: &Path) -> Option<Self> {
        let has_mesh = |folder: &Path| folder.join("constant/polyMesh/faces").is_file();
        if has_mesh(folder) {
            return Some(Self { folder: folder.to_owned(), times: times_of(folder) });
        }
        let name = folder.file_name()?.to_str()?;
        let (time, case) = (name.parse::<f64>().ok()?, folder.parent()?);
        let mut times = times_of(case);
        times.retain(|&(other, _)| other <= time);
        has_mesh(case).then(|| Self { folder: case.to_owned(), times })
    }

    /// The folder of the time nearest to `time` within a millionth of it.
    pub(super) fn folder_of(&self, time: f64) -> Result<PathBuf> {
        let is_near = |(other, _): &&(f64, String)| (other - time).abs() <= 1e-6 * time.abs().max(1e-9);
        self.times.iter().find(is_near).map(|(_, name)| self.folder.join(name)).ok_or_else(|| {
            let names = self.times.iter().map(|(_, name)| name.as_str()).collect::<Vec<_>>();
            let shown = if names.len() > 12 {
                format!("{} to {}, {} in all", names[0], names[names.len() - 1], names.len())
            } else {
                names.join(", ")
            };
            let problem = format!("\"{}\" has no time {time}; it has {shown}", self.folder.display());
            Error::Option { option: "--time", problem }
        })
    }

    /// The folder of the time that is read, if there is any.
    pub(super) fn time(&self) -> Option<PathBuf> {
        self.times.last().map(|(_, name)| self.folder.join(name))
    }

    /// The file `name` of the mesh: of the latest time that has one of its own, else the constant one.
    pub(super) fn mesh_file(&self, name: &str) -> Result<PathBuf> {
        let of = |folder: &str| self.folder.join(folder).join("polyMesh").join(name);
        let of_times = self.times.iter().rev().map(|(_, folder)| of(folder));
        if let Some(path) = of_times.chain([of("constant")]).find(|path| path.is_file()) {
            return Ok(path);
        }
        let path = of("constant");
        if path.with_extension("gz").is_file() {
            let (what, advice) = ("a compressed OpenFOAM mesh".to_owned(), "uncompress it first (gunzip)".to_owned());
            return Err(Error::Unsupported { path: path.with_extension("gz"), what, advice });
        }
        Err(io_at(&path)(std::io::ErrorKind::NotFound.into()))
    }
}

/// The folders of `case` whose names are numbers, ascending.
fn times_of(case: &Path) -> Vec<(f64, String)> {
    let entries = std::fs::read_dir(case).into_iter().flatten().flatten();
    let mut times: Vec<(f64, String)> = entries
        .filter(|entry| entry.path().is_dir())
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter_map(|name| name.parse().ok().filter(|time: &f64| time.is_finite()).map(|time| (time, name)))
        .collect();
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    times
}

/// All bytes of a file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(io_at(path))
}
