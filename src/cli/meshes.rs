//! The meshes that a verb is given: one, or several that are read as one.

use std::path::{Path, PathBuf};

use cellfan::Error;
use cellfan::io::container::is_container;
use cellfan::io::{self, Mesh, RawLayout, Scratch};
use clap::Args;

use super::arguments::{raw_layout, spacing};
use super::progress::Progress;

/// What help says of them.
pub(super) const FORMATS: &str = "\
The mesh: .cells, .vtu, .vts, .vtr, .vti or parallel (.pvtu …), multi-block (.vtm), the first time step of a .pvd, .vtk, PLOT3D \
(.xyz, .x, .p3d, .bin), NRRD (.nrrd, .nhdr), the folder or .foam of an OpenFOAM case or of one of its times or, with --raw, raw samples. Several become one, in one visibility order; arrays are matched by name, and containers \
among several are copied into memory";

/// What a file of raw samples does not say itself.
#[derive(Args, Clone, Copy, Debug, Default)]
pub(super) struct Raw {
    /// The one MESH is raw samples: how many along x, y and z, their type (u8, i16, f32 …; be for big-endian), and how many bytes
    /// stand before them: 256x256x110:u8, 64x64x64:i16be, 64x64x64:f32@512. A .gz is uncompressed first.
    #[arg(long, value_name = "SIZES:TYPE", help_heading = "Raw volumes", value_parser = raw_layout)]
    raw: Option<RawLayout>,
    /// From sample to sample of a raw volume, in world units [default: 1,1,1].
    #[arg(long, value_name = "X,Y,Z", help_heading = "Raw volumes", requires = "raw", value_parser = spacing, allow_hyphen_values = true)]
    spacing: Option<[f64; 3]>,
}

impl Raw {
    /// Whether the mesh is raw samples.
    pub(super) fn is_given(self) -> bool {
        self.raw.is_some()
    }

    fn layout(self) -> Option<RawLayout> {
        let mut layout = self.raw?;
        layout.spacing = self.spacing.unwrap_or(layout.spacing);
        Some(layout)
    }
}

/// Reads the meshes as one, their columns where `scratch` says.
pub(super) fn open(paths: &[PathBuf], raw: Raw, scratch: &Scratch) -> cellfan::Result<Mesh> {
    match (paths, raw.layout()) {
        (_, None) => io::open_meshes_in(paths, scratch),
        ([path], Some(layout)) => io::open_raw_in(path, &layout, scratch).map(Mesh::from),
        _ => {
            let problem = "says how one file is written; give that alone, or a NRRD header (.nhdr) for each".to_owned();
            Err(Error::Option { option: "--raw", problem })
        }
    }
}

/// Most meshes that messages list.
const MOST_SHOWN: usize = 3;

/// What messages call the meshes.
pub(super) fn label(paths: &[PathBuf]) -> PathBuf {
    match paths {
        [path] => path.clone(),
        [first, .., _] if paths.len() > MOST_SHOWN => {
            format!("{} and {} more meshes", first.display(), paths.len() - 1).into()
        }
        _ => paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ").into(),
    }
}

/// A bar while they are read.
pub(super) fn reading(paths: &[PathBuf]) -> Progress {
    Progress::running(format!("reading {}", label(paths).display()))
}

/// The one mesh, where it is a container: it is drawn in place.
pub(super) fn one_container(paths: &[PathBuf], raw: Raw) -> cellfan::Result<Option<&Path>> {
    match paths {
        [path] if !raw.is_given() && path.is_file() && is_container(path)? => Ok(Some(path)),
        _ => Ok(None),
    }
}

/// Refuses containers among several meshes where memory is counted: what is drawn in place alone is copied then.
pub(super) fn check_budget(paths: &[PathBuf]) -> cellfan::Result<()> {
    if paths.len() < 2 {
        return Ok(());
    }
    for path in paths.iter().filter(|path| path.is_file()) {
        if is_container(path)? {
            let problem = format!(
                "containers are drawn in place alone only, and \"{}\" is one of several meshes; make them one container \
                 (cellfan convert MESH… OUT.cells) and draw that",
                path.display()
            );
            return Err(Error::Option { option: "--memory", problem });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_name_few_meshes_and_count_many() {
        let names = ["a", "b", "c", "d"].map(PathBuf::from);
        let of = |count: usize| label(&names[..count]).display().to_string();
        assert_eq!([of(1), of(3), of(4)], ["a", "a, b, c", "a and 3 more meshes"]);
    }
}
