//! `Layer`: a list with its looks, as backends draw it.

use std::sync::Arc;

use super::{List, SurfaceFaces};

/// Primitives and how they look. Layers are drawn one after the other, the later one over the former where both are as near.
#[derive(Clone, Debug)]
pub struct Layer {
    /// What is drawn; the same list stays in a GPU's buffers between frames.
    pub list: Arc<List>,
    /// Linear RGB.
    pub color: [f32; 3],
    /// Which sides of triangles.
    pub faces: SurfaceFaces,
    /// Width of lines, side of points, in pixels.
    pub width_px: f32,
}

/// What a surface reflects of light from elsewhere, as a share of what it reflects of a lamp's.
pub(crate) const AMBIENT: f32 = 0.25;

/// How bright a surface is in the light of a lamp at the eye: `cos` is that of the angle between its normal and the ray. Lambert, and
/// some light from everywhere, so that walls seen at a flat angle are not black.
#[inline]
pub fn headlight(cos: f32) -> f32 {
    AMBIENT + (1.0 - AMBIENT) * cos.abs().min(1.0)
}
