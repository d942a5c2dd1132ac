//! `Extent`: which points of a structured grid a piece holds.

use std::array;

use super::super::source::{Source, quote};
use super::document::Element;
use crate::error::Result;

/// The first and the last point along i, j and k, numbered as the whole grid does; none where the last comes before the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::io) struct Extent {
    first: [i64; 3],
    last: [i64; 3],
}

impl Extent {
    /// What attribute `name` says: `i0 i1 j0 j1 k0 k1`.
    pub(in crate::io) fn of(element: &Element<'_>, name: &str, source: Source<'_>) -> Result<Self> {
        let missing = || source.malformed(element.place(), format!("has no attribute {name:?}"));
        let text = element.attribute(name).ok_or_else(missing)?;
        let numbers: Option<Vec<i32>> = text.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
        let Some(&[i0, i1, j0, j1, k0, k1]) = numbers.as_deref() else {
            let problem = format!("{name}={} are not six whole numbers", quote(text.as_bytes()));
            return Err(source.malformed(element.place(), problem));
        };
        Ok(Self { first: [i0, j0, k0].map(i64::from), last: [i1, j1, k1].map(i64::from) })
    }

    /// Points along i, j and k.
    pub(in crate::io) fn dims(self) -> [usize; 3] {
        let along = |axis: usize| usize::try_from(self.last[axis] - self.first[axis] + 1).unwrap_or(0);
        let dims = array::from_fn(along);
        if dims.contains(&0) { [0; 3] } else { dims }
    }

    /// The smallest that contains both, which have points.
    pub(in crate::io) fn union(self, other: Self) -> Self {
        let lowest = |axis: usize| self.first[axis].min(other.first[axis]);
        let highest = |axis: usize| self.last[axis].max(other.last[axis]);
        Self { first: array::from_fn(lowest), last: array::from_fn(highest) }
    }

    /// The first point along an axis.
    pub(in crate::io) fn first(self, axis: usize) -> i64 {
        self.first[axis]
    }

    /// The last point along an axis.
    pub(in crate::io) fn last(self, axis: usize) -> i64 {
        self.last[axis]
    }

    /// Whether all points of `part`, which has some, are points of this one.
    pub(in crate::io) fn contains(self, part: Self) -> bool {
        (0..3).all(|axis| self.first[axis] <= part.first[axis] && part.last[axis] <= self.last[axis])
    }
}
