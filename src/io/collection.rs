//! `.vtm` and `.pvd`: meshes of any formats in several files, which are named by one.
//!
//! In: a multi-block file, blocks in blocks to any depth, or a collection, whose first time step is taken. Out: all its meshes as
//! one ([`join`]). Blocks without a file are empty, and surfaces and tables hold no cell with a volume: both are passed over.
//! A multi-block file names meshes, a collection names meshes and multi-block files, and nothing names a collection: so no
//! reference leads back.

use std::path::Path;

use super::formats::Format;
use super::join::{Part, join};
use super::scratch::Scratch;
use super::source::{Source, quote};
use super::vtk_xml::{Element, NamedFiles, grid_of, parse, split_appended};
use super::{Mesh, open_mesh_of};
use crate::error::Result;

/// Extensions of files that hold nothing with a volume: they stand beside meshes as their boundaries.
const WITHOUT_VOLUME: [&str; 3] = ["vtp", "pvtp", "vtt"];

/// Reads a `.vtm` file that is in memory, and the blocks that it names relative to the folder of `path`.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) where a block cannot be read, those of [`open_mesh`](super::open_mesh) for each, and of
/// [`Mesh::join`].
pub fn read_vtm(bytes: &[u8], path: &Path) -> Result<Mesh> {
    read_vtm_in(bytes, path, &Scratch::memory())
}

/// Reads a `.pvd` file that is in memory, and the parts of its first time step, named relative to the folder of `path`.
///
/// # Errors
/// Those of [`read_vtm`].
pub fn read_pvd(bytes: &[u8], path: &Path) -> Result<Mesh> {
    read_pvd_in(bytes, path, &Scratch::memory())
}

/// As [`read_vtm`], the columns where `scratch` says.
pub(super) fn read_vtm_in(bytes: &[u8], path: &Path, scratch: &Scratch) -> Result<Mesh> {
    read(bytes, "vtkMultiBlockDataSet", &["vtm", "pvd"], Source { path, scratch }, |blocks, _| Ok(blocks))
}

/// As [`read_pvd`], the columns where `scratch` says.
pub(super) fn read_pvd_in(bytes: &[u8], path: &Path, scratch: &Scratch) -> Result<Mesh> {
    read(bytes, "Collection", &["pvd"], Source { path, scratch }, first_time_step)
}

/// Those of the `DataSet` elements of a file that are drawn.
type Choose = for<'e, 'a> fn(Vec<&'e Element<'a>>, Source<'_>) -> Result<Vec<&'e Element<'a>>>;

/// The meshes that a file of kind `kind` names, but for files of the formats `refused`, as one.
fn read(bytes: &[u8], kind: &str, refused: &[&str], source: Source<'_>, choose: Choose) -> Result<Mesh> {
    let (xml, _) = split_appended(bytes);
    let text = String::from_utf8_lossy(xml);
    let root = parse(&text, xml.len() < bytes.len(), source)?;
    let mut found = Vec::new();
    data_sets(grid_of(&root, kind, source)?, &mut found);
    let mut files = NamedFiles::new(source);
    let (mut parts, mut passed_over) = (Vec::new(), 0);
    for element in choose(found, source)? {
        let Some(path) = files.path(element, "file") else { continue };
        let path = path?;
        if path
            .extension()
            .is_some_and(|found| WITHOUT_VOLUME.iter().any(|without| found.eq_ignore_ascii_case(without)))
        {
            passed_over += 1;
            continue;
        }
        let check = |format: &Format| {
            if !refused.iter().any(|extension| format.extensions.contains(extension)) {
                return Ok(());
            }
            let what = format!("names {}, which names files itself: only meshes can stand here", path.display());
            Err(source.malformed(element.place(), what))
        };
        let mesh = open_mesh_of(&path, source.scratch, check)?;
        parts.push(Part { path, mesh });
    }
    if passed_over > 0 {
        let file = source.path.display();
        tracing::info!("{file}: surfaces and tables passed over, which have no volume: {passed_over}");
    }
    join(parts, source.scratch)
}

/// The `DataSet` elements of an element, those of its blocks included, in order. The document bounds the depth.
fn data_sets<'e, 'a>(element: &'e Element<'a>, found: &mut Vec<&'e Element<'a>>) {
    for child in &element.children {
        if child.name == "DataSet" {
            found.push(child);
        } else {
            data_sets(child, found);
        }
    }
}

/// Those of the earliest time; a data set without a time is of time 0.
fn first_time_step<'e, 'a>(all: Vec<&'e Element<'a>>, source: Source<'_>) -> Result<Vec<&'e Element<'a>>> {
    let time = |&element: &&Element<'a>| {
        let text = element.attribute("timestep").unwrap_or("0").trim();
        let time = text.parse().ok().filter(|time: &f64| time.is_finite());
        time.ok_or_else(|| {
            source.malformed(element.place(), format!("timestep={} is no number", quote(text.as_bytes())))
        })
    };
    let times: Vec<f64> = all.iter().map(time).collect::<Result<_>>()?;
    let first = times.iter().copied().fold(f64::INFINITY, f64::min);
    let is_later = |&time: &f64| time > first;
    if times.iter().any(is_later) {
        tracing::info!("{}: the first of several time steps, {first}", source.path.display());
    }
    Ok(all.into_iter().zip(&times).filter(|(_, time)| !is_later(time)).map(|(element, _)| element).collect())
}
