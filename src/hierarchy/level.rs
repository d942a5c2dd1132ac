//! `Level`: the nodes of the octree that are of one size, as three columns.

use rayon::prelude::*;

use crate::columns::Column;

/// What a box of the octree has between its corners.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// One value: that of its sample, or the mean of its samples.
    #[default]
    Constant,
    /// What lies between the points at its corners, linear along each axis.
    Trilinear,
}

/// What is known of the samples under a node, as stored values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Their mean; NaN where one of them is not finite. Of a box between points the middle of what they span.
    pub mean: f32,
    /// The smallest that is finite; above `max` where none is.
    pub min: f32,
    /// The largest that is finite.
    pub max: f32,
    error: f32,
}

impl Node {
    /// A sample; NaN where it is not finite.
    #[inline]
    pub(super) fn of_sample(value: f32) -> Self {
        let [min, max] = if value.is_nan() { [f32::INFINITY, f32::NEG_INFINITY] } else { [value; 2] };
        Self { mean: value, min, max, error: if value.is_finite() { 0.0 } else { f32::NAN } }
    }

    /// From what the columns have.
    #[inline]
    fn new(interpolation: Interpolation, [value, min, max]: [f32; 3]) -> Self {
        match interpolation {
            Interpolation::Constant => {
                let (above, below) = (max - value, value - min);
                Self { mean: value, min, max, error: if above > below { above } else { below } }
            }
            Interpolation::Trilinear => {
                let mean = if value.is_nan() { value } else { min + 0.5 * (max - min) };
                Self { mean, min, max, error: value }
            }
        }
    }

    /// The smallest box between points from `min` to `max`; that of one that is not finite is no box.
    #[inline]
    pub(super) fn of_points([min, max]: [f32; 2], is_finite: bool) -> Self {
        if !is_finite {
            return Self::of_sample(f32::NAN);
        }
        Self::new(Interpolation::Trilinear, [0.0, min, max])
    }

    /// The largest difference of a sample from what is drawn in its place, at most; NaN where a sample is not finite.
    #[inline]
    pub fn error(&self) -> f32 {
        self.error
    }
}

/// The nodes of one level, i fastest, then j, then k.
#[derive(Clone, Debug)]
pub struct Level {
    /// Nodes along i, j and k.
    pub dims: [u32; 3],
    interpolation: Interpolation,
    /// Mean of the samples, or error where boxes lie between points; least; greatest.
    columns: [Column<f32>; 3],
}

impl Level {
    /// The level of `dims` nodes of which each is what `of_node` says.
    pub(super) fn new(
        dims: [u32; 3],
        interpolation: Interpolation,
        of_node: impl Fn([u32; 3]) -> [f32; 3] + Sync,
    ) -> Self {
        let len = dims.iter().map(|&side| side as usize).product();
        let mut columns = [(); 3].map(|()| vec![0.0_f32; len]);
        let row = dims[0] as usize;
        let [value, min, max] = columns.each_mut().map(|column| column.par_chunks_mut(row));
        value.zip(min).zip(max).enumerate().with_min_len(16).for_each(|(number, ((value, min), max))| {
            let (j, k) = (number as u32 % dims[1], number as u32 / dims[1]);
            for i in 0..row {
                [value[i], min[i], max[i]] = of_node([i as u32, j, k]);
            }
        });
        Self { dims, interpolation, columns: columns.map(Column::from) }
    }

    /// A level whose columns stand in a file; `None` where one is not as long as it has nodes.
    pub fn from_columns(dims: [u32; 3], interpolation: Interpolation, columns: [Column<f32>; 3]) -> Option<Self> {
        let len: usize = dims.iter().map(|&side| side as usize).product();
        columns.iter().all(|column| column.len() == len).then_some(Self { dims, interpolation, columns })
    }

    /// Its columns: means, or errors of boxes between points; least values; greatest values.
    pub fn columns(&self) -> &[Column<f32>; 3] {
        &self.columns
    }

    /// Node `index`.
    ///
    /// # Panics
    /// If there is none.
    #[inline]
    pub fn node(&self, index: usize) -> Node {
        self.nodes().node(index)
    }

    /// Where node (i, j, k) stands.
    #[inline]
    pub fn index(&self, node: [u32; 3]) -> usize {
        index(self.dims, node)
    }

    /// How many nodes there are.
    pub fn len(&self) -> usize {
        self.columns[0].len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Its nodes, as hot loops read them.
    pub(super) fn nodes(&self) -> Nodes<'_> {
        let Self { dims, interpolation, columns } = self;
        Nodes { dims: *dims, interpolation: *interpolation, columns: columns.each_ref().map(|column| &column[..]) }
    }
}

/// The nodes of a level as slices.
#[derive(Clone, Copy)]
pub(super) struct Nodes<'a> {
    pub(super) dims: [u32; 3],
    interpolation: Interpolation,
    columns: [&'a [f32]; 3],
}

impl Nodes<'_> {
    #[inline]
    pub(super) fn node(&self, index: usize) -> Node {
        Node::new(self.interpolation, self.columns.map(|column| column[index]))
    }

    #[inline]
    pub(super) fn at(&self, node: [u32; 3]) -> Node {
        self.node(index(self.dims, node))
    }
}

/// Where (i, j, k) stands among so many.
#[inline]
pub(super) fn index([nx, ny, _]: [u32; 3], [i, j, k]: [u32; 3]) -> usize {
    i as usize + nx as usize * (j as usize + ny as usize * k as usize)
}
