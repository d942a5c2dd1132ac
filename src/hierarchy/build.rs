//! `build`: the octree of a field, from its smallest boxes up.
//!
//! In: a field of l×w×h samples, any numbers. Out: a [`Hierarchy`], level by level. No pointers: node (i, j, k) of a level has the
//! up to eight children (2i, 2j, 2k) to (2i + 1, 2j + 1, 2k + 1) of the level below, of which those at the field's end may be
//! missing. Of constant boxes, one a sample, a node's value is the mean of the samples under it, so children count by how many samples
//! they have; its error, the largest difference of a sample under it from that mean, follows from the smallest and largest of them.
//! Of boxes between eight points a node has no value but those of its corners; its error is found in [`linear`](super::linear).
//! O(samples), each read once (eight times by boxes between points); 12 bytes for each node above them, a seventh of whose number there are.

use std::sync::Arc;

use super::leaves::Leaves;
use super::level::{Interpolation, Level, Node};
use super::linear::error_of;
use crate::columns::{Association, Cube, Sample, SampleVisitor, Samples, VolumeField};
use crate::error::{Error, Result};

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
    /// Smallest boxes along i, j and k: samples, or what lies between points.
    dims: [u32; 3],
    interpolation: Interpolation,
    offset: f64,
    /// From that of nodes of two samples a side up to that of the root; none over a single sample.
    levels: Arc<[Level]>,
}

impl Hierarchy {
    /// The octree of boxes of one value each, one a sample.
    ///
    /// # Errors
    /// [`Error::TooLarge`] where a side has more than [`Cube::SIDE_MAX`] samples.
    pub fn new(field: &VolumeField) -> Result<Self> {
        Self::with(field, Interpolation::Constant)
    }

    /// The octree of constant or trilinear boxes.
    ///
    /// # Errors
    /// As [`Hierarchy::new`]; [`Error::Option`] where values of cells, or of points of which a side has only one, are to be interpolated.
    pub fn with(field: &VolumeField, interpolation: Interpolation) -> Result<Self> {
        let (dims, offset) = (Self::dims_of(field, interpolation)?, offset_of(field.range));
        Ok(field.visit(Build { dims, offset, interpolation }))
    }

    /// The octree of which `levels` were stored; `None` where these are not those of the field's sides.
    ///
    /// # Errors
    /// Those of [`Hierarchy::with`].
    pub fn from_levels(
        field: &VolumeField,
        interpolation: Interpolation,
        offset: f64,
        levels: Vec<Level>,
    ) -> Result<Option<Self>> {
        let dims = Self::dims_of(field, interpolation)?;
        let is_offset = offset.to_bits() == offset_of(field.range).to_bits();
        let sides = levels.iter().map(|level| level.dims);
        let fits = is_offset && sides.eq(Self::sides_above(dims));
        Ok(fits.then(|| Self { dims, interpolation, offset, levels: levels.into() }))
    }

    /// How many nodes the levels above `dims` smallest boxes have along i, j and k.
    pub fn sides_above(dims: [u32; 3]) -> impl Iterator<Item = [u32; 3]> {
        std::iter::successors(Some(dims), |below| (*below != [1; 3]).then(|| below.map(|side| side.div_ceil(2))))
            .skip(1)
    }

    /// Smallest boxes along i, j and k.
    fn dims_of(field: &VolumeField, interpolation: Interpolation) -> Result<[u32; 3]> {
        if let Some(&len) = field.dims.iter().find(|&&side| side > Cube::SIDE_MAX) {
            return Err(Error::TooLarge {
                column: "samples along a side",
                len: len as u64,
                limit: Cube::SIDE_MAX as u64,
            });
        }
        if interpolation == Interpolation::Constant {
            return Ok(field.dims.map(|side| side as u32));
        }
        let problem = match field.association {
            Association::Point if field.dims.iter().all(|&side| side > 1) => {
                return Ok(field.dims.map(|side| side as u32 - 1));
            }
            Association::Point => "trilinear needs two points along each side of the grid",
            Association::Cell => "trilinear interpolates values of points, and these are values of cells; leave it out",
        };
        Err(Error::Option { option: "--filter", problem: problem.to_owned() })
    }

    /// Smallest boxes along i, j and k: samples, or what lies between points.
    pub fn dims(&self) -> [u32; 3] {
        self.dims
    }

    /// What boxes have between their corners.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// Added to a stored value, it gives the value.
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// The levels above the smallest boxes; level n − 1 here has nodes of 2^n boxes a side.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// All nodes, smallest boxes included.
    pub fn nodes(&self) -> u64 {
        let boxes: u64 = self.dims.iter().map(|&side| u64::from(side)).product();
        boxes + self.levels.iter().map(|level| level.len() as u64).sum::<u64>()
    }

    /// Bytes of memory that it takes beside the field; columns that are used in place count nothing.
    pub fn owned_bytes(&self) -> u64 {
        self.levels.iter().flat_map(Level::columns).map(crate::columns::Column::owned_bytes).sum()
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
    interpolation: Interpolation,
}

impl SampleVisitor for Build {
    type Output = Hierarchy;

    fn visit<T: Sample>(self, samples: Samples<'_, T>) -> Hierarchy {
        let Self { dims, offset, interpolation } = self;
        let leaves = Leaves::new(samples, offset, interpolation, dims);
        let mut levels: Vec<Level> = Vec::new();
        while levels.last().map_or(dims, |level| level.dims) != [1; 3] {
            let level = match levels.last() {
                None => merged(&leaves, dims, (0, dims), |at| leaves.node(at)),
                Some(below) => {
                    let nodes = below.nodes();
                    merged(&leaves, dims, (levels.len() as u32, below.dims), |at| nodes.at(at))
                }
            };
            levels.push(level);
        }
        Hierarchy { dims, interpolation, offset, levels: levels.into() }
    }
}

/// The level above a level `below` of `dims_below` nodes, over `dims` smallest boxes.
fn merged<T: Sample>(
    leaves: &Leaves<T>,
    dims: [u32; 3],
    (below, dims_below): (u32, [u32; 3]),
    node: impl Fn([u32; 3]) -> Node + Sync,
) -> Level {
    let above = dims_below.map(|side| side.div_ceil(2));
    // Where node i of the level below begins, along an axis.
    let place = |axis: usize, i: u32| (i << below).min(dims[axis]);
    let samples = |axis: usize, i: u32| f64::from(place(axis, i + 1) - place(axis, i));
    let children = |axis: usize, i: u32| 2 * i..(2 * i + 2).min(dims_below[axis]);
    Level::new(above, leaves.interpolation(), |parent| {
        let [i, j, k] = parent;
        let (mut sum, mut weights) = (0.0, 0.0);
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for k in children(2, k) {
            for j in children(1, j) {
                let weight_of_row = samples(1, j) * samples(2, k);
                for i in children(0, i) {
                    let child = node([i, j, k]);
                    let weight = weight_of_row * samples(0, i);
                    sum += weight * f64::from(child.mean);
                    weights += weight;
                    low = if child.min < low { child.min } else { low };
                    high = if child.max > high { child.max } else { high };
                }
            }
        }
        let value = match leaves.interpolation() {
            _ if low > high => f32::NAN,
            // Rounding may take the mean of equal samples beside them.
            Interpolation::Constant => ((sum / weights) as f32).clamp(low, high),
            Interpolation::Trilinear => {
                let ends = [0, 1, 2].map(|end| [0, 1, 2].map(|axis| place(axis, 2 * parent[axis] + end)));
                let octants = (0..8).filter_map(|octant| {
                    let child = [0, 1, 2].map(|axis| 2 * parent[axis] + (octant as u32 >> axis & 1));
                    (0..3).all(|axis| child[axis] < dims_below[axis]).then(|| (octant, node(child)))
                });
                error_of(leaves, ends, octants)
            }
        };
        [value, low, high]
    })
}
