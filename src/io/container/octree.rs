//! Regular grids in a container: where the lattice is, and the octrees over its arrays.
//!
//! In: a [`Volume`]. Out: what a container of one structured block says beside it (`lattice` in the directory) and, for each array of one
//! component, the levels above its values as three columns each: means, least and greatest values. Read back, the points of the block
//! need not be read at all, and the octree is used in place.

use std::fs::File;
use std::path::Path;

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use super::directory::{ArrayEntry, ColumnSpan, Directory, Span};
use super::order::Tell;
use super::read::Columns;
use super::sink::Sink;
use super::structured;
use super::write::{Phase, Written};
use crate::columns::{Array, Association, Component, Cube, FieldSelection, Lattice, Volume, VolumeField};
use crate::error::{Error, Result};
use crate::hierarchy::{Hierarchy, Interpolation, Level};
use crate::io::volume::{Use, from_volume};
use crate::io::{Scratch, WholeCells};

/// A regular grid, beside the structured block that it is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct LatticeEntry {
    /// Points along i, j and k.
    dims: [u64; 3],
    /// The place of point (0, 0, 0), in the world.
    origin: [f64; 3],
    /// From a point to the next along i, j and k.
    steps: [[f64; 3]; 3],
    octrees: Vec<OctreeEntry>,
}

/// The octree over an array of one component.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct OctreeEntry {
    /// Which of the arrays.
    array: u64,
    /// Added to what its columns hold, it gives values.
    offset: f64,
    /// From that of two values a side up to the root: means, least and greatest values.
    levels: Vec<[Span; 3]>,
}

/// The one component of an array.
fn selection_of(array: &Array) -> FieldSelection {
    let (name, association) = (array.name.clone(), Some(array.association));
    FieldSelection { name, association, component: Component::Magnitude }
}

/// A regular grid of a container, its arrays in place, and the octrees that the file has.
#[derive(Clone, Debug)]
pub struct StoredVolume {
    /// The grid.
    pub volume: Volume,
    octrees: Vec<StoredOctree>,
}

#[derive(Clone, Debug)]
struct StoredOctree {
    array: usize,
    offset: f64,
    levels: Vec<Level>,
}

impl StoredVolume {
    /// The octree of constant boxes of a field of the volume, in place; none where the file has none.
    ///
    /// # Errors
    /// Those of [`Hierarchy::with`].
    pub fn hierarchy(&self, field: &VolumeField) -> Result<Option<Hierarchy>> {
        let is_of = |octree: &&StoredOctree| {
            let array = &self.volume.arrays[octree.array];
            (array.name == field.name || format!("{}[0]", array.name) == field.name)
                && array.association == field.association
                && field.components == 1
        };
        let Some(StoredOctree { offset, levels, .. }) = self.octrees.iter().find(is_of) else { return Ok(None) };
        Hierarchy::from_levels(field, Interpolation::Constant, *offset, levels.clone())
    }
}

/// Writes a regular grid to the container `path`: its cells as one structured block, where its lattice is, and the octree over each array of one
/// component, 12 bytes for each node above the values: 1.7 bytes a value.
///
/// # Errors
/// Those of [`write_structured`](super::write_structured) and of [`StructuredMesh::from_volume`](crate::io::StructuredMesh::from_volume).
///
/// ```
/// use cellfan::{columns::{Array, Association, Lattice, Volume}, hierarchy::Hierarchy, io::container, FieldSelection};
/// let array = Array { name: "v".into(), association: Association::Point, components: 1, values: vec![3_u8; 60].into() };
/// let volume = Volume::new([5, 4, 3], Lattice::default(), vec![array])?;
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("volume.cells");
/// container::write_volume(volume, &path, &|_, _, _| {})?;
/// let stored = container::open_volume(&path, true)?.expect("the file has a regular grid");
/// let field = stored.volume.field(&FieldSelection::parse("v", &[]))?;
/// let octree = stored.hierarchy(&field)?.expect("and its octree");
/// assert_eq!((octree.levels().len(), octree.owned_bytes()), (3, 0));
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn write_volume(volume: Volume, path: &Path, tell: Tell) -> Result<Written> {
    let grid = volume.clone();
    let cells = match from_volume(volume, Use::Whole)?.into_whole_in(&Scratch::memory())? {
        WholeCells::Structured(cells) => cells,
        // A grid one point thick has no cells that show, which is said there.
        WholeCells::Listed(cells) => return super::write(&cells, path, &super::WriteOptions::default(), tell),
    };
    structured::write(cells, Some(&grid), path, tell)
}

impl LatticeEntry {
    /// Builds the octrees of `volume`, one after the other, and writes them.
    pub(super) fn write(volume: &Volume, arrays: &[ArrayEntry], sink: &mut Sink, tell: Tell) -> Result<Self> {
        let mut octrees = Vec::new();
        let count = volume.arrays.len() as u64;
        for (number, array) in volume.arrays.iter().enumerate() {
            tell(Phase::Octrees, number as u64, count);
            if array.components != 1 || volume.dims.iter().any(|&side| side > Cube::SIDE_MAX) {
                continue;
            }
            let is_it = |entry: &ArrayEntry| entry.name == array.name && entry.association == array.association;
            let Some(place) = arrays.iter().position(is_it) else { continue };
            // One without a finite value cannot be drawn.
            let Ok(field) = volume.field(&selection_of(array)) else { continue };
            let hierarchy = Hierarchy::new(&field)?;
            let mut levels = Vec::with_capacity(hierarchy.levels().len());
            for level in hierarchy.levels() {
                let [mean, min, max] =
                    level.columns().each_ref().map(|column| sink.whole(bytemuck::cast_slice(column)));
                levels.push([mean?, min?, max?]);
            }
            octrees.push(OctreeEntry { array: place as u64, offset: hierarchy.offset(), levels });
        }
        tell(Phase::Octrees, count, count);
        let steps = volume.lattice.steps();
        Ok(Self {
            dims: volume.dims.map(|side| side as u64),
            origin: volume.lattice.origin().to_array(),
            steps: [steps.x_axis, steps.y_axis, steps.z_axis].map(|step| step.to_array()),
            octrees,
        })
    }

    fn lattice(&self) -> Lattice {
        Lattice::sheared(DVec3::from(self.origin), DMat3::from_cols_array_2d(&self.steps))
    }

    /// Its columns, in a file of so many vertices, cells and arrays.
    pub(super) fn spans(&self, directory: &Directory) -> std::result::Result<Vec<ColumnSpan>, (String, String)> {
        let wrong = |problem: &str| Err(("lattice".to_owned(), problem.to_owned()));
        let product = |sides: [u64; 3]| sides.iter().try_fold(1_u64, |all, &side| all.checked_mul(side));
        let is_block =
            directory.hexahedra.as_ref().is_some_and(|entry| entry.blocks.is_some_and(|blocks| blocks.bytes == 20));
        if !is_block || self.dims.contains(&0) || product(self.dims) != Some(directory.vertices) {
            return wrong("it is for one structured block, of as many points");
        }
        if !self.lattice().is_finite() {
            return wrong("it is not at a finite place");
        }
        let mut spans = Vec::new();
        for (number, octree) in self.octrees.iter().enumerate() {
            let wrong = |problem: &str| Err((format!("octree {number}"), problem.to_owned()));
            let Some(array) = usize::try_from(octree.array).ok().and_then(|array| directory.arrays.get(array)) else {
                return wrong("there is no such array");
            };
            let more = u64::from(array.association == Association::Cell);
            let values = self.dims.map(|points| (points - more).max(1));
            if array.components != 1 || values.iter().any(|&side| side > Cube::SIDE_MAX as u64) {
                return wrong("its array has several components, or a side of too many values");
            }
            let mut sides = Hierarchy::sides_above(values.map(|side| side as u32));
            for (i, columns) in octree.levels.iter().enumerate() {
                let Some(nodes) = sides.next() else { return wrong("it has levels above its root") };
                let bytes = product(nodes.map(u64::from)).and_then(|nodes| nodes.checked_mul(4));
                let name = |of: &str| format!("{of} of level {} of octree {number}", i + 1);
                let names = ["means", "least values", "greatest values"];
                spans.extend(names.iter().zip(columns).map(|(of, &span)| (name(of), span, bytes)));
            }
            if sides.next().is_some() || !octree.offset.is_finite() {
                return wrong("levels are missing below its root, or its offset is not finite");
            }
        }
        Ok(spans)
    }
}

/// The regular grid that a container holds, in place through a memory map, or (`use_map` false) read whole; none where it holds another mesh.
///
/// # Errors
/// As [`open`](super::open()).
pub fn open_volume(path: &Path, use_map: bool) -> Result<Option<StoredVolume>> {
    let file = File::open(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
    let (bytes, backing) = crate::io::mapping::bytes_of(path, file, use_map)?;
    let directory = Directory::read((*bytes).as_ref(), path)?;
    let Some(entry) = directory.lattice.clone() else { return Ok(None) };
    let columns = Columns { bytes, path };
    let (arrays, _) = columns.arrays(&directory)?;
    let dims = entry.dims.map(|side| side as usize);
    let volume = Volume::new(dims, entry.lattice(), arrays).map_err(|error| error.in_file(path))?;
    let mut octrees = Vec::with_capacity(entry.octrees.len());
    for octree in entry.octrees {
        let more = u64::from(directory.arrays[octree.array as usize].association == Association::Cell);
        let values = entry.dims.map(|points| (points - more).max(1) as u32);
        let mut levels = Vec::with_capacity(octree.levels.len());
        for (dims, [mean, min, max]) in Hierarchy::sides_above(values).zip(octree.levels) {
            let of = |name, span| columns.of::<f32>(name, span);
            let level = [of("means", mean)?, of("least values", min)?, of("greatest values", max)?];
            let level = Level::from_columns(dims, Interpolation::Constant, level);
            levels.push(level.ok_or_else(|| columns.malformed("octree", "a level is too short".to_owned()))?);
        }
        octrees.push(StoredOctree { array: octree.array as usize, offset: octree.offset, levels });
    }
    Ok(Some(StoredVolume { volume: Volume { backing, ..volume }, octrees }))
}

/// What is wrong with the lattice and the octrees of a container whose columns are as they were written: their place and the problem.
pub(super) fn problem_of(path: &Path, use_map: bool, dataset: &crate::Dataset) -> Result<Option<(String, String)>> {
    let Some(StoredVolume { volume, octrees }) = open_volume(path, use_map)? else { return Ok(None) };
    let [ni, nj, _] = volume.dims;
    let size =
        dataset.diagonal_world().max(volume.corners_world().iter().map(|corner| corner.length()).fold(0.0, f64::max));
    for (vertex, position) in dataset.positions.iter().enumerate() {
        let point = [vertex % ni, vertex / ni % nj, vertex / (ni * nj)].map(|along| along as f64);
        let stored = dataset.origin + glam::Vec3::from(*position).as_dvec3();
        // A NaN is no distance either.
        let is_there = stored.distance(volume.lattice.world(point.into())) <= 1e-5 * size;
        if !is_there {
            return Ok(Some(("lattice".to_owned(), format!("vertex {vertex} is not where it says"))));
        }
    }
    for (number, octree) in octrees.iter().enumerate() {
        let array = &volume.arrays[octree.array];
        let wrong = |problem: String| Ok(Some((format!("octree {number}"), problem)));
        let Ok(field) = volume.field(&selection_of(array)) else {
            return wrong("no value of its array is finite".to_owned());
        };
        let expected = Hierarchy::new(&field)?;
        if expected.offset().to_bits() != octree.offset.to_bits() {
            return wrong("its offset is not that of its array".to_owned());
        }
        for (i, (stored, expected)) in octree.levels.iter().zip(expected.levels()).enumerate() {
            let bits = |level: &Level| {
                level.columns().iter().flat_map(|column| column.iter().map(|x| x.to_bits())).collect::<Vec<_>>()
            };
            let (stored, expected) = (bits(stored), bits(expected));
            if let Some(at) = stored.iter().zip(&expected).position(|(stored, expected)| stored != expected) {
                let node = at % (stored.len() / 3);
                return wrong(format!("node {node} of level {} is not that of its array", i + 1));
            }
        }
    }
    Ok(None)
}
