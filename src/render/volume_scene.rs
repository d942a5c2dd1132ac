//! `VolumeScene`: a regular grid, the scalar drawn on it, and what the scalar looks like.

use std::sync::{Arc, OnceLock};

use glam::DVec3;

use super::CubeScene;
use crate::columns::{Volume, VolumeField};
use crate::depth_planes::ValueBlocks;
use crate::error::Result;
use crate::geometry::{Layer, SurfaceFaces, TriangleMesh, triangles_around};
use crate::hierarchy::{Hierarchy, Interpolation};
use crate::image::DepthImage;
use crate::optics::TransferFunction;
use crate::stages::scene_per_length;

/// A regular grid, the scalar drawn on it, and what the scalar looks like. Arrays are used in place.
#[derive(Clone, Debug)]
pub struct VolumeScene {
    pub(super) volume: Volume,
    pub(super) field: VolumeField,
    pub(super) transfer: TransferFunction,
    /// Made when a frame first asks for them.
    pub(super) blocks: OnceLock<ValueBlocks>,
    /// Of other files.
    pub(super) triangles: Vec<Layer>,
    /// Another program's picture.
    pub(super) external: Option<Arc<DepthImage>>,
}

impl VolumeScene {
    /// A volume, one of its fields, and colour and extinction of that.
    pub fn new(volume: Volume, field: VolumeField, transfer: &TransferFunction) -> Self {
        let blocks = OnceLock::new();
        Self { volume, field, transfer: transfer.clone(), blocks, triangles: Vec::new(), external: None }
    }

    /// Draws the triangles of `mesh` opaque into the volume, as [`Scene::add_triangles`](super::Scene::add_triangles).
    ///
    /// # Errors
    /// Those of [`triangles`](crate::geometry::triangles).
    pub fn add_triangles(&mut self, mesh: &TriangleMesh, color: Option<[f32; 3]>) -> Result<()> {
        let plain =
            color.filter(|_| !mesh.colors.is_empty()).map(|_| TriangleMesh { colors: Vec::new(), ..mesh.clone() });
        let [center, diagonal] = self.extent();
        let scale = scene_per_length(diagonal.length());
        let list = Arc::new(triangles_around(center, scale, plain.as_ref().unwrap_or(mesh))?);
        let color = color.unwrap_or(TriangleMesh::COLOR);
        self.triangles.push(Layer { list, color, faces: SurfaceFaces::All, width_px: 0.0 });
        Ok(())
    }

    /// How many triangles were added.
    pub fn added_triangles(&self) -> u64 {
        self.triangles.iter().map(|layer| layer.list.len() as u64).sum()
    }

    /// Composites the volume with a picture that another program drew from the same place, as
    /// [`Scene::set_external`](super::Scene::set_external).
    pub fn set_external(&mut self, picture: Option<Arc<DepthImage>>) {
        self.external = picture;
    }

    /// The middle of the volume, and from its lowest to its highest coordinates.
    pub(super) fn extent(&self) -> [DVec3; 2] {
        let corners = self.volume.corners_world();
        let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        [0.5 * low + 0.5 * high, high - low]
    }

    /// The grid.
    pub fn volume(&self) -> &Volume {
        &self.volume
    }

    /// The scalar.
    pub fn field(&self) -> &VolumeField {
        &self.field
    }

    /// The same as cubes, with the octree of its samples: one that is there already, or one that is built.
    ///
    /// # Errors
    /// Those of [`Hierarchy::with`] and [`CubeScene::with_hierarchy`].
    pub fn into_cubes(self, interpolation: Interpolation, stored: Option<Hierarchy>) -> Result<CubeScene> {
        let hierarchy = match stored {
            Some(hierarchy) => hierarchy,
            None => Hierarchy::with(&self.field, interpolation)?,
        };
        CubeScene::with_hierarchy(&self.volume, self.field, hierarchy, &self.transfer)
    }

    /// Shows the field with another transfer function.
    pub fn set_transfer(&mut self, transfer: &TransferFunction) {
        self.transfer = transfer.clone();
    }
}
