//! `Sampler`: the scalar at sixteen places of the grid.
//!
//! In: places in grid coordinates, inside the grid. Out: the scalar there. Point data: of the eight points around a place, linear along each
//! axis: four interpolations along i, two along j, one along k. Cell data: that of the cell, constant.
//! Fetching is a loop over lanes of two values at a time, which lie side by side, in their own type; the rest is vector code.

use super::Filter;
use super::dispatch::{Dispatch, Kernel};
use super::filter::Cubic;
use super::source::{Source, SourceVisitor, visit};
use crate::columns::{Association, Sample, VolumeField};
use crate::optics::lanes::{LANES, Lanes, max, min};

/// Places in grid coordinates.
pub(super) type Places = [Lanes; 3];

/// The eight points around sixteen places, i fastest, and how far each place is from the first towards the others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners {
    pub(super) values: [Lanes; 8],
    pub(super) fraction: [Lanes; 3],
}

impl Corners {
    pub(super) const NONE: Self = Self { values: [[0.0; LANES]; 8], fraction: [[0.0; LANES]; 3] };

    /// The scalar between them.
    #[inline(always)]
    pub(super) fn between(&self, out: &mut Lanes) {
        let Self { values: v, fraction: [x, y, z] } = self;
        for l in 0..LANES {
            let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
            let bottom = mix(mix(v[0][l], v[1][l], x[l]), mix(v[2][l], v[3][l], x[l]), y[l]);
            let top = mix(mix(v[4][l], v[5][l], x[l]), mix(v[6][l], v[7][l], x[l]), y[l]);
            out[l] = mix(bottom, top, z[l]);
        }
    }
}

/// What a field is sampled by.
pub(super) trait Sampler: Sync {
    /// The scalar at `at`.
    fn sample(&self, at: &Places, out: &mut Lanes);

    /// The points around `at`.
    fn corners(&self, at: &Places, out: &mut Corners);
}

/// What a sampler needs to know of the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// Values along each axis.
    pub(super) dims: [usize; 3],
    /// The last place along each axis: that of the last point.
    pub(super) upper: [f32; 3],
    /// Half a cell where values are those of cells: how far the outermost values are from the border.
    pub(super) half: f32,
}

impl Grid {
    pub(super) fn of(field: &VolumeField) -> Self {
        let is_cell = field.association == Association::Cell;
        let last = |values: usize| if is_cell { values as f32 } else { (values - 1) as f32 };
        Self { dims: field.dims, upper: field.dims.map(last), half: if is_cell { 0.5 } else { 0.0 } }
    }

    /// What lies between neighbours along i, j and k.
    pub(super) fn strides(&self) -> [usize; 3] {
        [1, self.dims[0], self.dims[0] * self.dims[1]]
    }
}

/// Runs `work` with the sampler for a field.
pub(super) fn with_sampler<R>(
    field: &VolumeField,
    filter: Filter,
    dispatch: Dispatch,
    work: impl FnOnce(&dyn Sampler) -> R,
) -> R {
    visit(field, With { grid: Grid::of(field), association: field.association, filter, dispatch, work })
}

struct With<F> {
    grid: Grid,
    association: Association,
    filter: Filter,
    dispatch: Dispatch,
    work: F,
}

impl<R, F: FnOnce(&dyn Sampler) -> R> SourceVisitor for With<F> {
    type Output = R;

    fn visit<S: Source>(self, source: &S) -> R {
        let Self { grid, dispatch, .. } = self;
        match (self.association, self.filter) {
            (Association::Cell, _) => (self.work)(&Constant { grid, source }),
            (Association::Point, Filter::Trilinear) => (self.work)(&Trilinear { grid, source, dispatch }),
            (Association::Point, filter) => (self.work)(&Cubic { grid, source, filter }),
        }
    }
}

/// Point data, linear along each axis.
struct Trilinear<'a, S> {
    grid: Grid,
    source: &'a S,
    dispatch: Dispatch,
}

impl<S: Source> Sampler for Trilinear<'_, S> {
    fn sample(&self, at: &Places, out: &mut Lanes) {
        self.dispatch.run(Interpolate { sampler: self, at, out });
    }

    fn corners(&self, at: &Places, out: &mut Corners) {
        self.dispatch.run(Fetch { sampler: self, at, out });
    }
}

struct Fetch<'a, S> {
    sampler: &'a Trilinear<'a, S>,
    at: &'a Places,
    out: &'a mut Corners,
}

impl<S: Source> Kernel for Fetch<'_, S> {
    #[inline(always)]
    fn run(self) {
        self.sampler.fetch(self.at, self.out);
    }
}

struct Interpolate<'a, S> {
    sampler: &'a Trilinear<'a, S>,
    at: &'a Places,
    out: &'a mut Lanes,
}

impl<S: Source> Kernel for Interpolate<'_, S> {
    #[inline(always)]
    fn run(self) {
        let mut corners = Corners::NONE;
        self.sampler.fetch(self.at, &mut corners);
        corners.between(self.out);
    }
}

impl<S: Source> Trilinear<'_, S> {
    #[inline(always)]
    fn fetch(&self, at: &Places, out: &mut Corners) {
        let [_, row, layer] = self.grid.strides();
        let mut first = [[0_i32; LANES]; 3];
        for axis in 0..3 {
            // The last cell has its end as well.
            let last = self.grid.dims[axis] as i32 - 2;
            for l in 0..LANES {
                let cell = (at[axis][l] as i32).min(last);
                first[axis][l] = cell;
                out.fraction[axis][l] = at[axis][l] - cell as f32;
            }
        }
        let mut pairs = [[<S::Pair as bytemuck::Zeroable>::zeroed(); LANES]; 4];
        let offsets = [0, row, layer, layer + row];
        // A copy, so that what is written here cannot change it.
        let source = *self.source;
        let mut fetch = |l: usize, start: usize| {
            let found = source.pairs(start, offsets);
            for pair in 0..4 {
                pairs[pair][l] = found[pair];
            }
        };
        if u32::try_from(layer * self.grid.dims[2]).is_ok() {
            // Vector code, and right where the grid is small.
            let mut start = [0_u32; LANES];
            let (rows_a_layer, row) = (self.grid.dims[1] as u32, row as u32);
            for l in 0..LANES {
                let rows = (first[2][l] as u32).wrapping_mul(rows_a_layer).wrapping_add(first[1][l] as u32);
                start[l] = rows.wrapping_mul(row).wrapping_add(first[0][l] as u32);
            }
            if let Some(words) = source.gathered(self.dispatch, &start, offsets) {
                for pair in 0..4 {
                    for l in 0..LANES {
                        out.values[2 * pair][l] = (words[pair][l] & 0xff) as f32;
                        out.values[2 * pair + 1][l] = (words[pair][l] >> 8 & 0xff) as f32;
                    }
                }
                return;
            }
            for l in 0..LANES {
                fetch(l, start[l] as usize);
            }
        } else {
            for l in 0..LANES {
                fetch(l, first[0][l] as usize + row * first[1][l] as usize + layer * first[2][l] as usize);
            }
        }
        for pair in 0..4 {
            for l in 0..LANES {
                let [a, b] = S::halves(pairs[pair][l]);
                (out.values[2 * pair][l], out.values[2 * pair + 1][l]) = (a, b);
            }
        }
    }
}

/// Cell data.
struct Constant<'a, S> {
    grid: Grid,
    source: &'a S,
}

impl<S: Source> Sampler for Constant<'_, S> {
    fn sample(&self, at: &Places, out: &mut Lanes) {
        let strides = self.grid.strides();
        for l in 0..LANES {
            let along = |axis: usize| (at[axis][l] as usize).min(self.grid.dims[axis] - 1) * strides[axis];
            out[l] = self.source.get(along(0) + along(1) + along(2)).narrowed();
        }
    }

    fn corners(&self, at: &Places, out: &mut Corners) {
        let mut value = [0.0; LANES];
        self.sample(at, &mut value);
        *out = Corners { values: [value; 8], fraction: [[0.0; LANES]; 3] };
    }
}

/// How the field changes along each axis at sixteen places, by a step of the grid: half the difference of the samples a step on either side,
/// which is the interpolation of the central differences at the points. Beyond the border the field goes on as it does within, so that the
/// differences at the outermost points are one-sided.
#[inline(always)]
pub(super) fn gradient(sampler: &dyn Sampler, grid: &Grid, at: &Places, out: &mut [Lanes; 3]) {
    for axis in 0..3 {
        let (mut before, mut after) = ([0.0; LANES], [0.0; LANES]);
        beyond(sampler, grid, at, axis, -1.0, &mut before);
        beyond(sampler, grid, at, axis, 1.0, &mut after);
        for l in 0..LANES {
            out[axis][l] = if grid.dims[axis] > 1 { 0.5 * (after[l] - before[l]) } else { 0.0 };
        }
    }
}

/// The field a step aside; outside by reflection in the outermost value: 2 s(border) − s(mirrored).
#[inline(always)]
fn beyond(sampler: &dyn Sampler, grid: &Grid, at: &Places, axis: usize, step: f32, out: &mut Lanes) {
    let (upper, half) = (grid.upper[axis], grid.half);
    let (mut inside, mut mirrored) = (*at, *at);
    let mut is_outside = false;
    for l in 0..LANES {
        let place = at[axis][l] + step;
        let border = min(max(place, 0.0), upper);
        let reflected = if place < 0.0 { 2.0 * half - place } else { 2.0 * (upper - half) - place };
        let is_inside = 0.0 <= place && place <= upper;
        is_outside |= !is_inside;
        inside[axis][l] = border;
        mirrored[axis][l] = if is_inside { place } else { min(max(reflected, 0.0), upper) };
    }
    sampler.sample(&inside, out);
    if is_outside {
        let mut reflected = [0.0; LANES];
        sampler.sample(&mirrored, &mut reflected);
        for l in 0..LANES {
            // Inside, both are the same and twice the one less the other is exact.
            out[l] = 2.0 * out[l] - reflected[l];
        }
    }
}
