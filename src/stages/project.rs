//! `project`: vertices to picture positions.
//!
//! In: [`SceneVertex`] records (position and scalar, built once per field). Out: [`ScreenVertex`] per vertex.
//! O(vertices), 16 bytes read and 16 written each; a cell then gathers four records instead of four transforms.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayon::prelude::*;

use super::{View, scene_per_world};
use crate::columns::{Association, Dataset, Field};
use crate::control::Control;

/// A vertex with its scalar in one record, so that a cell's gather touches one cache line per vertex.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SceneVertex {
    /// Position relative to the dataset's origin, in scene units.
    pub position: [f32; 3],
    /// The field's stored value; 0 for cell data.
    pub scalar: f32,
}

/// Where a vertex appears in the picture.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ScreenVertex {
    /// Column in pixels, pixel centres at whole numbers.
    pub x_px: f32,
    /// Row in pixels.
    pub y_px: f32,
    /// View depth in scene units; x and y are valid only from the near plane on.
    pub depth: f32,
    /// The field's stored value; 0 for cell data.
    pub scalar: f32,
}

impl ScreenVertex {
    /// The picture position.
    #[inline]
    pub fn xy(&self) -> glam::Vec2 {
        glam::Vec2::new(self.x_px, self.y_px)
    }
}

/// The records of all vertices of `dataset` with the values of `field`.
pub fn scene_vertices(dataset: &Dataset, field: &Field) -> Vec<SceneVertex> {
    let scale = scene_per_world(dataset);
    let scaled = |p: [f32; 3]| p.map(|x| (f64::from(x) * scale) as f32);
    let positions = dataset.positions.par_iter();
    match field.association {
        Association::Point => positions
            .zip(&field.values[..])
            .map(|(&position, &scalar)| SceneVertex { position: scaled(position), scalar })
            .collect(),
        Association::Cell => {
            positions.map(|&position| SceneVertex { position: scaled(position), scalar: 0.0 }).collect()
        }
    }
}

/// Projects every vertex into `screen`, which is resized to fit.
pub fn project(view: &View, vertices: &[SceneVertex], screen: &mut Vec<ScreenVertex>) {
    project_while(&Control::default(), view, vertices, screen);
}

/// Vertices between two looks at the token.
const SLAB: usize = 1 << 17;

/// The same until the end is asked for; then vertices are missing.
pub(crate) fn project_while(control: &Control, view: &View, vertices: &[SceneVertex], screen: &mut Vec<ScreenVertex>) {
    let _span = tracing::trace_span!("project").entered();
    let projection = view.projection();
    let to_screen = |vertex: &SceneVertex| {
        let p = projection.project(Vec3::from_array(vertex.position));
        ScreenVertex { x_px: p.x, y_px: p.y, depth: p.z, scalar: vertex.scalar }
    };
    screen.clear();
    // At once as much as is needed: a list that grows is held twice for a moment.
    screen.reserve_exact(vertices.len());
    for slab in vertices.chunks(SLAB) {
        if control.is_cancelled() {
            return;
        }
        screen.par_extend(slab.par_iter().with_min_len(4096).map(to_screen));
    }
}
