//! The meshes that a verb is given: one, or several that are read as one.

use std::path::{Path, PathBuf};

use cellfan::Error;
use cellfan::io::container::is_container;

use super::progress::Progress;

/// What help says of them.
pub(super) const FORMATS: &str = "\
The mesh: .cells, .vtu, .vts, .vtr or parallel (.pvtu …), multi-block (.vtm), the first time step of a .pvd, .vtk, or PLOT3D \
(.xyz, .x, .p3d, .bin). Several become one, in one visibility order; arrays are matched by name, and containers \
among several are copied into memory";

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
pub(super) fn one_container(paths: &[PathBuf]) -> cellfan::Result<Option<&Path>> {
    match paths {
        [path] if path.is_file() && is_container(path)? => Ok(Some(path)),
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
