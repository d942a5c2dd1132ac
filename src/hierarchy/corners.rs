//! `SelectedCorners`: values at the corners of selected boxes, such that the field has no jump where boxes of different size meet.
//!
//! In: a [`Hierarchy`] of boxes between points, its field, the cubes that are drawn. Out: eight stored values for each of them.
//! A corner that lies on a larger box that is drawn, and is none of its corners, takes the value that the largest such box has there;
//! the value of any other corner is its sample. So a box that lies against a larger one has, on all of the face, edge or corner that
//! they share, what that has: on a face both are bilinear and agree in the four corners of the smaller. Between any two drawn boxes the field
//! is continuous. Boxes that are left out, since nothing in them shows, ask for nothing.
//! Which boxes are drawn is a bit a node; boxes of the smallest size need none.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::build::Hierarchy;
use super::leaves::Leaves;
use super::level::index;
use super::linear::between;
use crate::columns::{Cube, CubeCorners, Sample, SampleVisitor, Samples, VolumeField};

/// The corner values of the boxes of one selection.
#[derive(Debug)]
pub struct SelectedCorners<'a> {
    hierarchy: &'a Hierarchy,
    field: &'a VolumeField,
    /// A bit for each node of the levels above the smallest boxes: whether it is drawn. Empty for levels of which none is.
    drawn: Vec<Vec<AtomicU64>>,
}

impl<'a> SelectedCorners<'a> {
    /// Those of `cubes`, selected from `hierarchy`, that of `field`, by trilinear interpolation.
    pub fn new((hierarchy, field): (&'a Hierarchy, &'a VolumeField), cubes: &[Cube]) -> Self {
        let has_level: Vec<bool> = {
            let levels = hierarchy.levels().len();
            let nothing = || vec![false; levels + 1];
            let seen = cubes.par_iter().with_min_len(1 << 14).fold(nothing, |mut seen, cube| {
                seen[usize::from(cube.level)] = true;
                seen
            });
            seen.reduce(nothing, |a, b| a.iter().zip(&b).map(|(a, b)| a | b).collect())
        };
        let words = |(level, &has): (&super::Level, &bool)| {
            let words = if has { level.len().div_ceil(64) } else { 0 };
            (0..words).map(|_| AtomicU64::new(0)).collect()
        };
        let drawn: Vec<Vec<AtomicU64>> = hierarchy.levels().iter().zip(&has_level[1..]).map(words).collect();
        cubes.par_iter().with_min_len(1 << 14).filter(|cube| cube.level > 0).for_each(|cube| {
            let above = usize::from(cube.level) - 1;
            let bit = index(hierarchy.levels()[above].dims, cube.node.map(u32::from));
            drawn[above][bit / 64].fetch_or(1 << (bit % 64), Ordering::Relaxed);
        });
        Self { hierarchy, field, drawn }
    }
}

impl CubeCorners for SelectedCorners<'_> {
    fn of(&self, cube: &Cube) -> [f32; 8] {
        self.field.visit(Corners { of: self, cube })
    }
}

struct Corners<'a> {
    of: &'a SelectedCorners<'a>,
    cube: &'a Cube,
}

impl SampleVisitor for Corners<'_> {
    type Output = [f32; 8];

    fn visit<T: Sample>(self, samples: Samples<'_, T>) -> [f32; 8] {
        let SelectedCorners { hierarchy, drawn, .. } = self.of;
        let dims = hierarchy.dims();
        let leaves = Leaves::new(samples, hierarchy.offset(), hierarchy.interpolation(), dims);
        Drawn { leaves, dims, hierarchy, bits: drawn }.corners(self.cube.level, self.cube.node.map(u32::from))
    }
}

/// What is drawn, and the samples that it is made of.
struct Drawn<'a, T> {
    leaves: Leaves<'a, T>,
    /// Smallest boxes along i, j and k.
    dims: [u32; 3],
    hierarchy: &'a Hierarchy,
    bits: &'a [Vec<AtomicU64>],
}

impl<T: Sample> Drawn<'_, T> {
    fn corners(&self, level: u16, node: [u32; 3]) -> [f32; 8] {
        let [first, end] = self.ends(level, node);
        std::array::from_fn(|corner| {
            let at = |axis: usize| if corner >> axis & 1 == 1 { end[axis] } else { first[axis] };
            self.value([at(0), at(1), at(2)], level)
        })
    }

    /// The first point and the last of a box.
    fn ends(&self, level: u16, node: [u32; 3]) -> [[u32; 3]; 2] {
        let first = node.map(|node| node << level);
        [first, [0, 1, 2].map(|axis| (first[axis] + (1 << level)).min(self.dims[axis]))]
    }

    /// The value at a point that is a corner of a drawn box of `level`.
    fn value(&self, point: [u32; 3], level: u16) -> f32 {
        for above in (usize::from(level)..self.bits.len()).rev().filter(|&above| !self.bits[above].is_empty()) {
            let level = above as u16 + 1;
            let Some(node) = self.drawn_at(point, above) else { continue };
            let [first, end] = self.ends(level, node);
            if (0..3).all(|axis| point[axis] == first[axis] || point[axis] == end[axis]) {
                break;
            }
            let share = |axis: usize| (point[axis] - first[axis]) as f32 / (end[axis] - first[axis]) as f32;
            return between(&self.corners(level, node), [share(0), share(1), share(2)]);
        }
        self.leaves.value(point)
    }

    /// A drawn node of the level `above` that a point lies in or on.
    fn drawn_at(&self, point: [u32; 3], above: usize) -> Option<[u32; 3]> {
        let (level, dims) = (above + 1, self.hierarchy.levels()[above].dims);
        // The box before the point, and that after it: two where it lies between them.
        let sides = [0, 1, 2].map(|axis| {
            let (before, after) = (point[axis].saturating_sub(1) >> level, point[axis] >> level);
            [before, after.min(dims[axis] - 1)]
        });
        let number = |axis: usize| 1 + usize::from(sides[axis][0] != sides[axis][1]);
        for k in &sides[2][..number(2)] {
            for j in &sides[1][..number(1)] {
                for i in &sides[0][..number(0)] {
                    let bit = index(dims, [*i, *j, *k]);
                    if self.bits[above][bit / 64].load(Ordering::Relaxed) >> (bit % 64) & 1 == 1 {
                        return Some([*i, *j, *k]);
                    }
                }
            }
        }
        None
    }
}
