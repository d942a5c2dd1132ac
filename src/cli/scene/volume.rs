//! From a regular grid to what is drawn of it: its array, transfer function and view, chosen as those of a mesh.

use std::path::{Path, PathBuf};
use std::time::Instant;

use cellfan::columns::{CellCounts, Volume, VolumeField};
use cellfan::io::container::{self, StoredVolume};
use cellfan::io::{Mesh, Scratch};
use cellfan::profile::Profile;
use cellfan::render::VolumeScene;
use cellfan::{Camera, Error, Model, Result};

use super::Arguments;
use super::array;
use super::summary::Summary;
use super::transfer::TransferSource;
use super::view::ViewSource;
use crate::cli::meshes;

/// A volume with what was chosen for it.
pub(super) struct Chosen {
    pub(super) scene: VolumeScene,
    pub(super) camera: Camera,
    pub(super) summary: Summary,
    pub(super) transfer_note: String,
}

/// Reads the one volume that `paths` are; with its octrees where it is a container.
pub(super) fn read(
    paths: &[PathBuf],
    arguments: &Arguments,
    profile: &mut Profile,
) -> Result<(Volume, Option<StoredVolume>)> {
    let _progress = meshes::reading(paths);
    let start = Instant::now();
    let scratch = if arguments.no_mmap { Scratch::unmapped() } else { Scratch::memory() };
    let found = match meshes::one_container(paths, arguments.raw)? {
        Some(path) => {
            container::open_volume(path, !arguments.no_mmap)?.map(|stored| (stored.volume.clone(), Some(stored)))
        }
        None => match meshes::open(paths, arguments.raw, &scratch)? {
            Mesh::Volume(volume) => Some((volume, None)),
            _ => None,
        },
    };
    let Some((volume, stored)) = found else {
        let problem = format!(
            "it draws one regular grid (.vti, NRRD, structured points, raw samples, a container of one), which {} is not",
            meshes::label(paths).display()
        );
        return Err(Error::Option { option: "--method", problem });
    };
    let bytes = if volume.backing.is_some() { 0 } else { volume.owned_bytes() };
    profile.add("read", start.elapsed(), bytes);
    profile.sample_memory();
    Ok((volume, stored))
}

/// Chooses array, transfer function and view.
pub(super) fn choose(
    volume: Volume,
    arguments: &Arguments,
    transfer: &TransferSource,
    view: ViewSource,
    model: Model,
    label: &Path,
) -> Result<Chosen> {
    let field = array::choose_of_volume(&volume, arguments.array.as_deref()).map_err(|error| error.in_file(label))?;
    let (transfer, transfer_note) = transfer.make_for_volume(&volume, &field, model)?;
    let (camera, view_note) = view.make(&volume.corners_world())?;
    let counts = CellCounts { in_file: volume.cells() as u64, ..CellCounts::default() };
    let VolumeField { name, association, range, .. } = &field;
    let notes = (view_note.as_str(), transfer_note.as_str());
    let summary = Summary::new(label, counts, !volume.arrays.is_empty(), (name, *association, *range), notes);
    let mut scene_volume = volume;
    // The field shares its array's values; the others are not needed any more.
    scene_volume.arrays = Vec::new();
    Ok(Chosen { scene: VolumeScene::new(scene_volume, field, &transfer), camera, summary, transfer_note })
}
