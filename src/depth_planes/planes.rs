//! `Planes`: at which view depths a volume is sampled, and how far each sample reaches.
//!
//! The limits abut the data (the paper's `auto_limits`): nearest and farthest corner, within the camera's near and far. Each plane stands
//! for the slab around it, whose thickness is the step that opacity is corrected for.
//! Evenly in view depth a plane is the middle of its slab, the midpoint rule. The paper's planes are even in screen depth z, from 0 at the
//! near limit d to 1 at the far limit f, with view depth w = −d f/(z (f − d) − f); their slabs reach half way to the next.

use glam::DVec3;

use super::{Options, Samples};
use crate::camera::{Camera, Frame};
use crate::columns::Volume;
use crate::error::{Error, Result};
use crate::stages::View;

/// More planes than this are refused.
const MOST: f64 = 1e6;

/// View depths in world units, nearest first.
#[derive(Clone, Debug, PartialEq)]
pub struct Planes {
    /// Where the data begins and ends; the same where nothing of it can be seen.
    pub limits: [f64; 2],
    /// Where samples are taken.
    pub depths: Vec<f64>,
    /// Between the slabs of the planes, and at both ends: one more.
    pub edges: Vec<f64>,
}

impl Planes {
    /// The planes of a view.
    ///
    /// # Errors
    /// Those of [`Camera::frame`]; [`Error::Option`] where there would be more than a million.
    ///
    /// ```
    /// use cellfan::columns::{Lattice, Volume};
    /// use cellfan::depth_planes::{Options, Planes};
    /// // 8 steps of half a unit, seen along x from 10 units before the first point.
    /// let volume = Volume::new([9, 5, 5], Lattice::new([0.0; 3].into(), [0.5; 3].into()), vec![])?;
    /// let camera = cellfan::Camera::looking_at([-10.0, 1.0, 1.0].into(), [0.0, 1.0, 1.0].into(), 8, 8);
    /// let planes = Planes::new(&volume, &camera, &Options::default())?;
    /// assert_eq!((planes.limits, planes.depths.len(), planes.depths[1]), ([10.0, 14.0], 8, 10.75));
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn new(volume: &Volume, camera: &Camera, options: &Options) -> Result<Self> {
        let frame = camera.frame()?;
        let limits @ [near, far] = auto_limits(volume, camera, &frame);
        if near >= far {
            return Ok(Self { limits: [near, near], depths: Vec::new(), edges: vec![near] });
        }
        let wanted = match options.samples[2] {
            Samples::Count(count) => f64::from(count),
            Samples::Nyquist | Samples::Pixels => {
                // A billionth less: 8 steps of 0.1 are 8, whatever rounding makes of them.
                ((far - near) / largest_step(volume, frame.forward) * options.sample_rate * (1.0 - 1e-9)).ceil()
            }
        };
        if wanted.is_nan() || wanted > MOST {
            let problem = format!("{wanted} planes; a million is the most");
            return Err(Error::Option { option: "--samples", problem });
        }
        let count = wanted.max(1.0) as usize;
        let between = |share: f64| near + (far - near) * share;
        if !options.is_vol_compatible || count == 1 {
            let edges: Vec<f64> = (0..=count).map(|k| between(k as f64 / count as f64)).collect();
            return Ok(Self {
                limits,
                depths: edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect(),
                edges,
            });
        }
        let depth = |k: usize| match k {
            0 => near,
            _ if k == count - 1 => far,
            _ if frame.is_perspective => -near * far / (k as f64 / (count - 1) as f64 * (far - near) - far),
            _ => between(k as f64 / (count - 1) as f64),
        };
        let depths: Vec<f64> = (0..count).map(depth).collect();
        let middles = depths.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let edges = std::iter::once(near).chain(middles).chain([far]).collect();
        Ok(Self { limits, depths, edges })
    }
}

/// View depths of the nearest and the farthest corner, within what the camera draws.
fn auto_limits(volume: &Volume, camera: &Camera, frame: &Frame) -> [f64; 2] {
    let depths = volume.corners_world().map(|corner| frame.depth(corner));
    let (near, far) = depths.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &w| (a.min(w), b.max(w)));
    let diagonal = volume.lattice.steps().mul_vec3(volume.dims.map(|side| (side - 1) as f64).into()).length();
    let default_near = if frame.is_perspective { View::NEAR_SHARE * diagonal } else { f64::NEG_INFINITY };
    [near.max(camera.near.unwrap_or(default_near)), far.min(camera.far.unwrap_or(f64::INFINITY))]
}

/// The greatest distance along a direction from a point of the grid to the next.
pub(super) fn largest_step(volume: &Volume, along: DVec3) -> f64 {
    let steps = volume.lattice.steps();
    [steps.x_axis, steps.y_axis, steps.z_axis].into_iter().map(|step| step.dot(along).abs()).fold(0.0, f64::max)
}
