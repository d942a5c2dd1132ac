//! `Slopes`: how the field changes over a box, to light it.

use super::build::Hierarchy;
use super::leaves::Leaves;
use super::level::Interpolation;
use crate::columns::{Cube, CubeSlopes, Sample, SampleVisitor, Samples, VolumeField};

/// The gradients of a field at the boxes of its octree.
#[derive(Clone, Copy, Debug)]
pub struct Slopes<'a> {
    hierarchy: &'a Hierarchy,
    field: &'a VolumeField,
}

impl<'a> Slopes<'a> {
    /// Those of `field`, whose octree `hierarchy` is.
    pub fn new((hierarchy, field): (&'a Hierarchy, &'a VolumeField)) -> Self {
        Self { hierarchy, field }
    }

    /// How much the stored value changes by a step of the grid along i, j and k.
    ///
    /// Of constant boxes the difference of the means of the two boxes of the same size on either side, of whatever size those are that
    /// are drawn there, over the distance of their middles; one-sided at the border of the grid and beside values that are not
    /// finite. Of boxes between points the mean difference of opposite corners.
    fn slope(&self, cube: &Cube) -> [f32; 3] {
        self.field.visit(Slope { of: *self, cube })
    }
}

impl CubeSlopes for Slopes<'_> {
    fn of(&self, cube: &Cube) -> [f32; 3] {
        self.slope(cube)
    }
}

struct Slope<'a> {
    of: Slopes<'a>,
    cube: &'a Cube,
}

impl SampleVisitor for Slope<'_> {
    type Output = [f32; 3];

    fn visit<T: Sample>(self, samples: Samples<'_, T>) -> [f32; 3] {
        let Self { of: Slopes { hierarchy, .. }, cube } = self;
        let dims = hierarchy.dims();
        let leaves = Leaves::new(samples, hierarchy.offset(), hierarchy.interpolation(), dims);
        match hierarchy.interpolation() {
            Interpolation::Trilinear => across(cube.samples(dims), |point| leaves.value(point)),
            Interpolation::Constant => {
                let above = usize::from(cube.level).checked_sub(1);
                let nodes = above.map(|above| hierarchy.levels()[above].nodes());
                let boxes = nodes.as_ref().map_or(dims, |nodes| nodes.dims);
                let mean = |node| nodes.as_ref().map_or_else(|| leaves.value(node), |nodes| nodes.at(node).mean);
                beside(cube, dims, boxes, mean)
            }
        }
    }
}

/// From the eight corners of a box.
fn across([first, end]: [[u32; 3]; 2], value: impl Fn([u32; 3]) -> f32) -> [f32; 3] {
    let mut slope = [0.0; 3];
    for corner in 0..8 {
        let is_upper = |axis: usize| corner >> axis & 1 == 1;
        let value = value([0, 1, 2].map(|axis| if is_upper(axis) { end[axis] } else { first[axis] }));
        for axis in 0..3 {
            let share = value / (4 * (end[axis] - first[axis])) as f32;
            slope[axis] += if is_upper(axis) { share } else { -share };
        }
    }
    slope
}

/// From the boxes of the same size on either side, of `boxes` along i, j and k.
fn beside(cube: &Cube, dims: [u32; 3], boxes: [u32; 3], mean: impl Fn([u32; 3]) -> f32) -> [f32; 3] {
    let node = cube.node.map(u32::from);
    std::array::from_fn(|axis| {
        // Where a box's middle is, and its mean.
        let at = |place: u32| {
            let mut node = node;
            node[axis] = place;
            let first = place << cube.level;
            let end = (first + (1 << cube.level)).min(dims[axis]);
            (0.5 * (first + end) as f32, mean(node))
        };
        let own = at(node[axis]);
        let is_finite = |found: &(f32, f32)| !found.1.is_nan();
        let before = node[axis].checked_sub(1).map(at).filter(is_finite).unwrap_or(own);
        let after = Some(node[axis] + 1).filter(|&place| place < boxes[axis]).map(at).filter(is_finite).unwrap_or(own);
        if after.0 > before.0 { (after.1 - before.1) / (after.0 - before.0) } else { 0.0 }
    })
}
