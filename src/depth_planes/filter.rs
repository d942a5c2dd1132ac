//! `Cubic`: wider reconstruction filters, of the 4×4×4 points around a place.
//!
//! With t from the second of four points towards the third, the weights along an axis are those of the uniform cubic B-spline, or of the
//! spline of Catmull and Rom (Mitchell and Netravali's B = 1, C = 0 and B = 0, C = 1/2). Beyond the border the outermost points are repeated.

use super::Filter;
use super::sample::{Corners, Grid, Places, Sampler};
use super::source::Source;
use crate::columns::Sample;
use crate::optics::lanes::{LANES, Lanes};

/// How far beyond the values around it a Catmull-Rom sample can be, in parts of their range: the weights of an axis sum to 1 and, without
/// their signs, to 5/4 at most; (5/4)³ − 1 over 2.
pub(super) const OVERSHOOT: f32 = 0.476_562_5;

/// Point data through a cubic filter.
pub(super) struct Cubic<'a, S> {
    pub(super) grid: Grid,
    pub(super) source: &'a S,
    pub(super) filter: Filter,
}

impl<S> Cubic<'_, S> {
    fn weights(&self, t: f32) -> [f32; 4] {
        let s = 1.0 - t;
        match self.filter {
            Filter::Trilinear => [0.0, s, t, 0.0],
            Filter::BSpline => {
                let middle = |t: f32| (4.0 + t * t * (3.0 * t - 6.0)) / 6.0;
                [s * s * s / 6.0, middle(t), middle(s), t * t * t / 6.0]
            }
            Filter::CatmullRom => {
                let middle = |t: f32| 1.0 + t * t * (1.5 * t - 2.5);
                [-0.5 * t * s * s, middle(t), middle(s), -0.5 * s * t * t]
            }
        }
    }
}

impl<S: Source> Sampler for Cubic<'_, S> {
    fn sample(&self, at: &Places, out: &mut Lanes) {
        let strides = self.grid.strides();
        for l in 0..LANES {
            let mut place = [[0_usize; 4]; 3];
            let mut weight = [[0.0_f32; 4]; 3];
            for axis in 0..3 {
                let last = self.grid.dims[axis] - 1;
                let cell = (at[axis][l] as usize).min(last.saturating_sub(1));
                weight[axis] = self.weights(at[axis][l] - cell as f32);
                place[axis] = std::array::from_fn(|k| (cell + k).saturating_sub(1).min(last) * strides[axis]);
            }
            let [x, y, z] = place;
            let mut sum = 0.0;
            for k in 0..4 {
                let mut layer = 0.0;
                for j in 0..4 {
                    let mut row = 0.0;
                    for i in 0..4 {
                        row += weight[0][i] * self.source.get(x[i] + y[j] + z[k]).narrowed();
                    }
                    layer += weight[1][j] * row;
                }
                sum += weight[2][k] * layer;
            }
            out[l] = sum;
        }
    }

    /// The same value eight times: what is classified before is not filtered so.
    fn corners(&self, at: &Places, out: &mut Corners) {
        let mut value = [0.0; LANES];
        self.sample(at, &mut value);
        *out = Corners { values: [value; 8], fraction: [[0.0; LANES]; 3] };
    }
}
