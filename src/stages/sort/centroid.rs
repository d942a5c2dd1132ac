//! `centroid`: the distance of a cell's centroid, the key of most projected-tetrahedra renderers; approximate.
//!
//! In perspective from the eye, not along the view axis: on a regular grid of split boxes that order is exact, and on a
//! jittered one it exchanges fewer neighbours than depth does.

use glam::Vec3;

use crate::stages::View;

/// Orders by the centroid's distance.
#[derive(Clone, Copy, Debug)]
pub struct Centroid {
    is_perspective: bool,
    eye: Vec3,
    forward: Vec3,
}

impl Centroid {
    /// For one view.
    pub fn new(view: &View) -> Self {
        let (eye, forward) = (view.eye.as_vec3(), view.forward.as_vec3());
        Self { is_perspective: view.is_perspective, eye, forward }
    }

    /// Distance of the centroid from the eye, or its depth along parallel rays.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "part of kernels that are compiled for wider vectors")]
    pub fn depth<const N: usize>(&self, corners: [Vec3; N]) -> f32 {
        let mut sum = corners[0];
        for &corner in &corners[1..] {
            sum += corner;
        }
        let from_eye = sum * (1.0 / N as f32) - self.eye;
        if self.is_perspective { from_eye.length() } else { from_eye.dot(self.forward) }
    }
}
