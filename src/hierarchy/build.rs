//! `build`: the octree of a field, from the samples up.
//!
//! In: a field of l×w×h samples, any numbers. Out: a [`Hierarchy`], level by level. No pointers: node (i, j, k) of a level has the
//! up to eight children (2i, 2j, 2k) to (2i + 1, 2j + 1, 2k + 1) of the level below, of which those at the field's end may be
//! missing. A node's value is the mean of the samples under it, so children count by how many samples they have; its error, the
//! largest difference of a sample under it from that mean, follows from the smallest and largest of them.
//! O(samples), each read once; 12 bytes for each node above the samples, a seventh of whose number there are.

use std::sync::Arc;

use rayon::prelude::*;

use super::leaves::Leaves;
use crate::columns::Cube;
use crate::columns::{Sample, SampleVisitor, Samples, VolumeField};
use crate::error::{Error, Result};

/// What is known of the samples under a node, as stored values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Their mean; NaN where one of them is not finite.
    pub mean: f32,
    /// The smallest that is finite; above `max` where none is.
    pub min: f32,
    /// The largest that is finite.
    pub max: f32,
}

impl Node {
    /// A sample; NaN where it is not finite.
    #[inline]
    pub(super) fn of_sample(value: f32) -> Self {
        if value.is_nan() {
            return Self { mean: value, min: f32::INFINITY, max: f32::NEG_INFINITY };
        }
        Self { mean: value, min: value, max: value }
    }

    /// The largest difference between the mean and a sample; NaN where a sample is not finite.
    #[inline]
    pub fn error(&self) -> f32 {
        let (above, below) = (self.max - self.mean, self.mean - self.min);
        if above > below { above } else { below }
    }
}

/// The nodes of one level, i fastest, then j, then k.
#[derive(Clone, Debug, Default)]
pub struct Level {
    /// Nodes along i, j and k.
    pub dims: [u32; 3],
    mean: Vec<f32>,
    min: Vec<f32>,
    max: Vec<f32>,
}

impl Level {
    /// Node `index`.
    ///
    /// # Panics
    /// If there is none.
    #[inline]
    pub fn node(&self, index: usize) -> Node {
        Node { mean: self.mean[index], min: self.min[index], max: self.max[index] }
    }

    /// Where node (i, j, k) stands.
    #[inline]
    pub fn index(&self, node: [u32; 3]) -> usize {
        index(self.dims, node)
    }

    /// How many nodes there are.
    pub fn len(&self) -> usize {
        self.mean.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.mean.is_empty()
    }
}

/// Where (i, j, k) stands among so many.
#[inline]
pub(super) fn index([nx, ny, _]: [u32; 3], [i, j, k]: [u32; 3]) -> usize {
    i as usize + nx as usize * (j as usize + ny as usize * k as usize)
}

/// The octree over the samples of a field, which stay where they are.
///
/// ```
/// use cellfan::columns::{Array, Association, Lattice, Volume};
/// use cellfan::hierarchy::Hierarchy;
/// use cellfan::FieldSelection;
/// let values: Vec<u8> = vec![0, 0, 0, 0, 0, 0, 0, 8, 3, 5, 3, 5];
/// let array = Array { name: "density".into(), association: Association::Point, components: 1, values: values.into() };
/// let volume = Volume::new([2, 2, 3], Lattice::default(), vec![array])?;
/// let hierarchy = Hierarchy::new(&volume.field(&FieldSelection::parse("density", &[]))?)?;
/// // Eight samples in the first node, the four that are left in the second, all twelve in the root.
/// let [first, root] = [hierarchy.levels()[0].node(0), hierarchy.levels()[1].node(0)];
/// assert_eq!((first.mean, first.error()), (1.0, 7.0));
/// assert_eq!((root.mean, root.error()), (2.0, 6.0));
/// # Ok::<(), cellfan::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Hierarchy {
    /// Samples along i, j and k.
    dims: [u32; 3],
    offset: f64,
    /// From that of nodes of two samples a side up to that of the root; none over a single sample.
    levels: Arc<[Level]>,
}

impl Hierarchy {
    /// The octree of `field`.
    ///
    /// # Errors
    /// [`Error::TooLarge`] where a side has more than [`Cube::SIDE_MAX`] samples.
    pub fn new(field: &VolumeField) -> Result<Self> {
        if let Some(&len) = field.dims.iter().find(|&&side| side > Cube::SIDE_MAX) {
            return Err(Error::TooLarge {
                column: "samples along a side",
                len: len as u64,
                limit: Cube::SIDE_MAX as u64,
            });
        }
        let offset = offset_of(field.range);
        let dims = field.dims.map(|side| side as u32);
        Ok(field.visit(Build { dims, offset }))
    }

    /// Samples along i, j and k.
    pub fn dims(&self) -> [u32; 3] {
        self.dims
    }

    /// Added to a stored value, it gives the value.
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// The levels above the samples; level n − 1 here has nodes of 2^n samples a side.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// All nodes, samples included.
    pub fn nodes(&self) -> u64 {
        let samples: u64 = self.dims.iter().map(|&side| u64::from(side)).product();
        samples + self.levels.iter().map(|level| level.len() as u64).sum::<u64>()
    }

    /// Bytes of memory that it takes beside the field.
    pub fn owned_bytes(&self) -> u64 {
        self.levels.iter().map(|level| 3 * size_of_val(&level.mean[..]) as u64).sum()
    }
}

/// Zero, or the middle of a range that single precision would blur: one below 2^-8 of its values leaves fewer than 16 bits.
fn offset_of((low, high): (f64, f64)) -> f64 {
    let largest = low.abs().max(high.abs());
    if high - low < largest / 256.0 || largest > f64::from(f32::MAX) { low + (high - low) * 0.5 } else { 0.0 }
}

struct Build {
    dims: [u32; 3],
    offset: f64,
}

impl SampleVisitor for Build {
    type Output = Hierarchy;

    fn visit<T: Sample>(self, samples: Samples<'_, T>) -> Hierarchy {
        let Self { dims, offset } = self;
        let leaves = Leaves::new(samples, offset);
        let mut levels: Vec<Level> = Vec::new();
        while levels.last().map_or(dims, |level| level.dims) != [1; 3] {
            let level = match levels.last() {
                None => merged(dims, (0, dims), |i| Node::of_sample(leaves.get(i))),
                Some(below) => merged(dims, (levels.len() as u32, below.dims), |i| below.node(i)),
            };
            levels.push(level);
        }
        Hierarchy { dims, offset, levels: levels.into() }
    }
}

/// The level above a level `below` of `dims_below` nodes, over `dims` samples.
fn merged(dims: [u32; 3], (below, dims_below): (u32, [u32; 3]), node: impl Fn(usize) -> Node + Sync) -> Level {
    let above = dims_below.map(|side| side.div_ceil(2));
    let len = above.iter().map(|&side| side as usize).product();
    let mut level = Level { dims: above, mean: vec![0.0; len], min: vec![0.0; len], max: vec![0.0; len] };
    // Samples of node i of the level below, along an axis.
    let samples = |axis: usize, i: u32| f64::from(((i + 1) << below).min(dims[axis]) - (i << below));
    let children = |axis: usize, i: u32| 2 * i..(2 * i + 2).min(dims_below[axis]);
    let row = above[0] as usize;
    let rows = level.mean.par_chunks_mut(row).zip(level.min.par_chunks_mut(row)).zip(level.max.par_chunks_mut(row));
    rows.enumerate().with_min_len(16).for_each(|(number, ((mean, min), max))| {
        let (j, k) = (number as u32 % above[1], number as u32 / above[1]);
        for i in 0..above[0] {
            let (mut sum, mut weights) = (0.0, 0.0);
            let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
            for k in children(2, k) {
                for j in children(1, j) {
                    let weight_of_row = samples(1, j) * samples(2, k);
                    for i in children(0, i) {
                        let child = node(index(dims_below, [i, j, k]));
                        let weight = weight_of_row * samples(0, i);
                        sum += weight * f64::from(child.mean);
                        weights += weight;
                        low = if child.min < low { child.min } else { low };
                        high = if child.max > high { child.max } else { high };
                    }
                }
            }
            let i = i as usize;
            // Rounding may take the mean of equal samples beside them.
            let middle = (sum / weights) as f32;
            mean[i] = if low <= high { middle.clamp(low, high) } else { f32::NAN };
            (min[i], max[i]) = (low, high);
        }
    });
    level
}
