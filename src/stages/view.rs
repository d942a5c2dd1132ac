//! `View`: a camera in a dataset's own coordinates, in the precision of the stages.
//!
//! Depth along a ray is carried as the *inverse depth* v, so that nearer is larger and a plane of a cell is affine in
//! picture coordinates: v = 1/w in perspective, v = −w in an orthographic view.
//!
//! Scene units: world units times a power of two that brings the mesh's diagonal to 1..2, so that products of lengths stay
//! in the range of f32 for molecules and galaxies alike and no bit changes.

use glam::{DVec3, Vec3};

use crate::camera::{Camera, Frame, Region};
use crate::columns::Dataset;
use crate::error::Result;

/// A valid camera relative to [`Dataset::origin`], in scene units; pixel centres are at whole numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Whether rays leave the eye (otherwise they are parallel).
    pub is_perspective: bool,
    /// The eye, relative to the dataset's origin.
    pub eye: DVec3,
    /// Unit vector along the view axis.
    pub forward: DVec3,
    /// Change of the ray's direction (perspective) or origin (orthographic) per pixel to the right.
    pub step_x: DVec3,
    /// The same per pixel down.
    pub step_y: DVec3,
    /// Direction (perspective) or origin (orthographic) of the ray of pixel (0, 0), relative to `forward` or the eye.
    pub corner: DVec3,
    /// Width and height of the whole picture in pixels; its pixel (0, 0) is where positions count from.
    pub size_px: [u32; 2],
    /// The part of the picture that backends draw. Orders are those of the whole.
    pub region: Region,
    /// Smallest view depth drawn.
    pub near: f32,
    /// Largest view depth drawn; infinite if there is no far plane.
    pub far: f32,
    /// World length of a scene unit; a power of two.
    pub world_per_scene: f64,
}

/// Less than single precision resolves, and along no edge that a mesh is likely to have.
const BESIDE: DVec3 = DVec3::new(2.9e-8, 1.7e-8, 2.3e-8);

impl View {
    /// Default near plane, as a share of the scene's diagonal.
    pub const NEAR_SHARE: f64 = 1e-6;

    /// The same with rays that begin a hair aside: those from an eye on a corner or an edge of the mesh would be on no side of the
    /// edges there. Whoever asks for sides takes this view, for all cells, so that each ray near the eye is in one of them.
    #[must_use]
    pub fn beside(&self) -> Self {
        Self { eye: self.eye + BESIDE, ..*self }
    }

    /// The view of `camera` on `dataset`.
    ///
    /// # Errors
    /// Those of [`Camera::frame`].
    pub fn new(camera: &Camera, dataset: &Dataset) -> Result<Self> {
        Self::around(camera, dataset.origin, dataset.diagonal_world())
    }

    /// The view of `camera` on what is so large around `origin`.
    ///
    /// # Errors
    /// Those of [`Camera::frame`].
    pub fn around(camera: &Camera, origin: DVec3, diagonal_world: f64) -> Result<Self> {
        let Frame { eye, forward, step_x, step_y, is_perspective, size_px, region } = camera.frame()?;
        let [width, height] = size_px.map(f64::from);
        let near = camera.near.unwrap_or(Self::NEAR_SHARE * diagonal_world);
        let scene_per_world = scene_per_length(diagonal_world);
        // Parallel rays move by lengths, rays from the eye by directions.
        let step_scale = if is_perspective { 1.0 } else { scene_per_world };
        let (step_x, step_y) = (step_x * step_scale, step_y * step_scale);
        Ok(Self {
            is_perspective,
            eye: (eye - origin) * scene_per_world,
            forward,
            step_x,
            step_y,
            corner: step_x * (0.5 - 0.5 * width) + step_y * (0.5 - 0.5 * height),
            size_px,
            region,
            near: (near * scene_per_world) as f32,
            far: camera.far.map_or(f32::INFINITY, |far| (far * scene_per_world) as f32),
            world_per_scene: scene_per_world.recip(),
        })
    }

    /// Inverse depth of view depth `w`.
    #[inline]
    pub fn inverse_depth(&self, w: f32) -> f32 {
        if self.is_perspective { 1.0 / w } else { -w }
    }

    /// Inverse depths of the far and the near plane: the range that is drawn.
    pub fn inverse_depth_range(&self) -> (f32, f32) {
        (self.inverse_depth(self.far), self.inverse_depth(self.near))
    }

    /// What a projected coordinate may be off by, in pixels: a few ulp of the picture's side, 1e-3 up to 1024.
    pub fn pad_px(&self) -> f32 {
        let [width, height] = self.size_px;
        1e-3 * (width.max(height) as f32 / 1024.0).max(1.0)
    }

    /// World length per scene unit of view depth along the ray of picture position (x, y).
    #[inline]
    pub fn length_world_per_depth(&self, x: f64, y: f64) -> f64 {
        let direction = if self.is_perspective {
            self.forward + self.corner + self.step_x * x + self.step_y * y
        } else {
            self.forward
        };
        direction.length() * self.world_per_scene
    }

    /// Picture position and view depth of positions; made once per frame, used per vertex.
    pub fn projection(&self) -> PixelProjection {
        let scale = |step: DVec3| step / step.length_squared();
        let (to_x, to_y) = (scale(self.step_x), scale(self.step_y));
        PixelProjection {
            is_perspective: self.is_perspective,
            eye: self.eye.as_vec3(),
            to_x: to_x.as_vec3(),
            to_y: to_y.as_vec3(),
            forward: self.forward.as_vec3(),
            center_x: -self.corner.dot(to_x) as f32,
            center_y: -self.corner.dot(to_y) as f32,
        }
    }
}

/// The power of two that brings the diagonal of `dataset` to 1..2.
pub fn scene_per_world(dataset: &Dataset) -> f64 {
    scene_per_length(dataset.diagonal_world())
}

/// The power of two that brings a length to 1..2.
pub fn scene_per_length(diagonal_world: f64) -> f64 {
    (-diagonal_world.log2().floor()).exp2()
}

/// The map from positions to picture positions and view depth, in f32.
#[derive(Clone, Copy, Debug)]
pub struct PixelProjection {
    is_perspective: bool,
    eye: Vec3,
    to_x: Vec3,
    to_y: Vec3,
    forward: Vec3,
    center_x: f32,
    center_y: f32,
}

impl PixelProjection {
    /// Pixels that a step across the view moves by at view depth 1 (parallel rays: at any depth).
    pub fn px_per_unit(&self) -> f32 {
        self.to_x.length()
    }

    /// (x, y) in pixels and view depth of `p`; x and y mean nothing where the depth is not positive in perspective.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "part of kernels that are compiled for wider vectors")]
    pub fn project(&self, p: Vec3) -> Vec3 {
        let v = p - self.eye;
        let w = v.dot(self.forward);
        let scale = if self.is_perspective { 1.0 / w } else { 1.0 };
        Vec3::new(v.dot(self.to_x) * scale + self.center_x, v.dot(self.to_y) * scale + self.center_y, w)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::camera::Projection;
    use crate::columns::{CellCounts, Points, TetMesh};

    #[test]
    fn projection_agrees_with_the_camera() {
        let points = vec![[10.0, 0.0, 0.0], [13.0, 0.0, 0.0], [10.0, 1.0, 0.0], [10.0, 0.0, 1.0]];
        let dataset = Dataset::from_tets(TetMesh {
            points: Points::F64(points),
            tets: vec![[0, 1, 2, 3]].into(),
            file_from_tet: vec![0].into(),
            arrays: Vec::new(),
            counts: CellCounts::default(),
        })
        .unwrap();
        let mut camera = Camera::looking_at(DVec3::new(7.0, -3.0, 1.0), DVec3::new(10.2, 0.2, 0.3), 300, 200);
        for projection in
            [Projection::Perspective { fov_degrees: 30.0 }, Projection::Orthographic { height_world: 2.0 }]
        {
            camera.projection = projection;
            let (view, frame) = (View::new(&camera, &dataset).unwrap(), camera.frame().unwrap());
            let p = DVec3::new(10.25, 0.5, 0.125);
            let scale = scene_per_world(&dataset);
            let projected = view.projection().project(((p - dataset.origin) * scale).as_vec3()).as_dvec3();
            assert!((projected.truncate() - frame.pixel(p)).length() < 1e-3);
            assert!((projected.z / scale - frame.depth(p)).abs() < 1e-6);
            let length = frame.ray(17.0, 33.0).direction.length() / scale;
            assert!((view.length_world_per_depth(17.0, 33.0) - length).abs() < 1e-12);
        }
    }
}
