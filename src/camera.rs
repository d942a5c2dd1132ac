//! The camera: where the eye is, and the ray through each pixel.

mod matrices;
mod region;

pub use region::Region;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result, VolCondition, presentable};

/// How rays leave the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// All rays through the eye; the vertical field of view in degrees.
    Perspective {
        /// Between the centres of the upper and lower edges, in degrees, below 180.
        fov_degrees: f64,
    },
    /// Parallel rays; the height of the view in world units.
    Orthographic {
        /// What the picture's height covers.
        height_world: f64,
    },
}

/// A camera in world coordinates (right-handed); pixel (x, y) runs right and down and is sampled at its centre.
///
/// ```
/// # use cellfan::camera::{Camera, Projection};
/// # use glam::DVec3;
/// let camera = Camera::looking_at(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, 512, 512);
/// let frame = camera.frame().unwrap();
/// let ray = frame.ray(255.5, 255.5); // the middle of the picture
/// assert!((ray.direction - DVec3::Y).length() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Position of the eye.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub target: DVec3,
    /// A direction that is up in the picture; not along the view.
    pub up: DVec3,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Nothing nearer than this view depth is drawn; default 1e-6 of the scene's diagonal.
    pub near: Option<f64>,
    /// Nothing farther than this view depth is drawn; default none.
    pub far: Option<f64>,
    /// The pixels of the picture that are drawn; default all. The image has their size, and in all else `width` and `height` count.
    pub region: Option<Region>,
}

/// A ray: `origin + w · direction` has view depth w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at view depth 0, in world coordinates.
    pub origin: DVec3,
    /// The change per unit of view depth; its length is the world length per unit of depth.
    pub direction: DVec3,
}

/// An orthonormal view frame with its pixel steps, derived from a valid [`Camera`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Position of the eye.
    pub eye: DVec3,
    /// Unit vector along the view axis.
    pub forward: DVec3,
    /// Change of the ray per pixel to the right: of its direction in perspective, of its origin otherwise.
    pub step_x: DVec3,
    /// Change of the ray per pixel down.
    pub step_y: DVec3,
    /// Whether all rays leave the eye.
    pub is_perspective: bool,
    /// Width and height of the whole picture in pixels.
    pub size_px: [u32; 2],
    /// The part of it that is drawn.
    pub region: Region,
}

impl Frame {
    /// The ray through picture position (x, y) in pixels, where pixel centres are whole numbers.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let [width, height] = self.size_px.map(f64::from);
        let aside = self.step_x * (x + 0.5 - 0.5 * width) + self.step_y * (y + 0.5 - 0.5 * height);
        if self.is_perspective {
            Ray { origin: self.eye, direction: self.forward + aside }
        } else {
            Ray { origin: self.eye + aside, direction: self.forward }
        }
    }

    /// View depth of a world position.
    pub fn depth(&self, p: DVec3) -> f64 {
        (p - self.eye).dot(self.forward)
    }

    /// Picture position (x, y) in pixels of a world position, pixel centres at whole numbers; meaningless behind the eye.
    pub fn pixel(&self, p: DVec3) -> DVec2 {
        let v = p - self.eye;
        let scale = if self.is_perspective { 1.0 / v.dot(self.forward) } else { 1.0 };
        let [width, height] = self.size_px.map(f64::from);
        DVec2::new(
            v.dot(self.step_x) / self.step_x.length_squared() * scale + 0.5 * width - 0.5,
            v.dot(self.step_y) / self.step_y.length_squared() * scale + 0.5 * height - 0.5,
        )
    }
}

impl Camera {
    /// Default vertical field of view, in degrees.
    pub const FOV_DEGREES: f64 = 30.0;
    /// Largest side of a whole picture, in pixels.
    pub const MAX_SIDE: u32 = 32_768;
    /// No coordinate of a camera reaches this.
    pub const FARTHEST: f64 = 1e100;

    /// A perspective camera with the default field of view and +z up (+y where the view is along z).
    pub fn looking_at(eye: DVec3, target: DVec3, width: u32, height: u32) -> Self {
        let view = (target - eye).normalize_or_zero();
        let up = if view.z.abs() > 0.999 { DVec3::Y } else { DVec3::Z };
        let projection = Projection::Perspective { fov_degrees: Self::FOV_DEGREES };
        Self { eye, target, up, projection, width, height, near: None, far: None, region: None }
    }

    /// A camera that shows all `corners` from azimuth and elevation in degrees: the eye lies in direction
    /// (cos e cos a, cos e sin a, sin e) of their centre, +z is up.
    ///
    /// The sphere around the corners just fits, so that an orbit about the centre keeps all of them in view.
    pub fn framing(corners: &[DVec3], azimuth_degrees: f64, elevation_degrees: f64, width: u32, height: u32) -> Self {
        let count = corners.len().max(1) as f64;
        let center = corners.iter().sum::<DVec3>() / count;
        let radius = corners.iter().map(|corner| corner.distance(center)).fold(f64::MIN_POSITIVE, f64::max);
        let (a, e) = (azimuth_degrees.to_radians(), elevation_degrees.to_radians());
        let outward = DVec3::new(e.cos() * a.cos(), e.cos() * a.sin(), e.sin());
        // Half the angle across the shorter side: tangents are in the ratio of the sides.
        let aspect = f64::from(width.max(1)) / f64::from(height.max(1));
        let half_angle = ((Self::FOV_DEGREES.to_radians() * 0.5).tan() * aspect.min(1.0)).atan();
        Self::looking_at(center + outward * (radius / half_angle.sin()), center, width, height)
    }

    /// The eye turned about the axis through the target along `up` by `degrees`, right-handed.
    #[must_use]
    pub fn orbited(&self, degrees: f64) -> Self {
        let turn = glam::DQuat::from_axis_angle(self.up.normalize_or(DVec3::Z), degrees.to_radians());
        Self { eye: self.target + turn * (self.eye - self.target), ..self.clone() }
    }

    /// The view frame.
    ///
    /// # Errors
    /// [`Error::Camera`] where the eye is the target, `up` runs along the view, or a number is out of range; [`Error::Option`] where
    /// the region is no part of the picture.
    pub fn frame(&self) -> Result<Frame> {
        let bad = |problem: String| Error::Camera { problem };
        let side = 1..=Self::MAX_SIDE;
        if !side.contains(&self.width) || !side.contains(&self.height) {
            let (w, h, max) = (self.width, self.height, Self::MAX_SIDE);
            return Err(bad(format!("a picture of {w}x{h} pixels; each side must be 1 to {max}")));
        }
        let size_px = [self.width, self.height];
        let region = self.region.unwrap_or(Region::whole(size_px));
        region.check(size_px)?;
        // Beyond, squares of lengths are no numbers any more; nothing in f32 is so far away.
        let is_near = |p: DVec3| p.abs().cmplt(DVec3::splat(Self::FARTHEST)).all();
        if !(is_near(self.eye) && is_near(self.target) && is_near(self.up)) {
            return Err(bad(format!("eye, target and up must be finite, each coordinate below {:e}", Self::FARTHEST)));
        }
        let view = self.target - self.eye;
        if view.length() <= f64::EPSILON * self.eye.length() || view == DVec3::ZERO {
            return Err(bad(VolCondition::NoViewDirection.said("eye and target are the same point")));
        }
        let forward = view.normalize();
        let right = forward.cross(self.up.normalize_or_zero());
        if right.length() < 1e-9 {
            return Err(bad(VolCondition::NoUp.said("up is zero or runs along the view; choose another up")));
        }
        let right = right.normalize();
        let up = right.cross(forward);
        let (height_at_unit_depth, is_perspective) = match self.projection {
            Projection::Perspective { fov_degrees } if fov_degrees > 0.0 && fov_degrees < 180.0 => {
                (2.0 * (fov_degrees.to_radians() * 0.5).tan(), true)
            }
            Projection::Perspective { fov_degrees } => {
                let problem = format!("fov is {fov_degrees} degrees; it must be above 0 and below 180");
                return Err(bad(if fov_degrees == 0.0 { VolCondition::NoAngle.said(&problem) } else { problem }));
            }
            Projection::Orthographic { height_world } if height_world > 0.0 && height_world.is_finite() => {
                (height_world, false)
            }
            Projection::Orthographic { height_world } => {
                return Err(bad(format!("orthographic_height is {height_world}; it must be positive")));
            }
        };
        for (name, plane) in [("near", self.near), ("far", self.far)] {
            if let Some(depth) = plane
                && (!depth.is_finite() || (is_perspective && depth <= 0.0))
            {
                return Err(bad(format!("{name} is {depth}; it must be a positive depth along the view")));
            }
        }
        if let (Some(near), Some(far)) = (self.near, self.far)
            && near >= far
        {
            let problem = format!("near ({near}) must be less than far ({far})");
            return Err(bad(if near > far { problem } else { VolCondition::PlanesEqual.said(&problem) }));
        }
        let pixel = height_at_unit_depth / f64::from(self.height);
        if !(pixel * pixel).is_normal() {
            let problem = format!("a pixel is {pixel:e} wide; choose another fov or orthographic_height");
            return Err(bad(VolCondition::NoIncrement.said(&problem)));
        }
        Ok(Frame {
            eye: self.eye,
            forward,
            step_x: right * pixel,
            step_y: up * -pixel,
            is_perspective,
            size_px,
            region,
        })
    }

    /// Reads a camera as JSON (`eye`, `target`, `up`, `fov`, `width`, `height`, `near`, `far`, `orthographic_height`,
    /// `region` as \[X0, Y0, X1, Y1\]).
    ///
    /// # Errors
    /// [`Error::Camera`] where the text is not such a camera, with the line, or the camera is not valid; [`Error::Option`] where the
    /// region is no part of the picture.
    pub fn from_json(text: &str) -> Result<Self> {
        let parsed: CameraJson =
            serde_json::from_str(text).map_err(|error| Error::Camera { problem: presentable(error.to_string()) })?;
        let projection = match (parsed.orthographic_height, parsed.fov) {
            (Some(height_world), _) => Projection::Orthographic { height_world },
            (None, fov) => Projection::Perspective { fov_degrees: fov.unwrap_or(Self::FOV_DEGREES) },
        };
        let (eye, target) = (DVec3::from_array(parsed.eye), DVec3::from_array(parsed.target));
        let mut camera = Self::looking_at(eye, target, parsed.width, parsed.height);
        camera.up = parsed.up.map_or(camera.up, DVec3::from_array);
        camera.projection = projection;
        (camera.near, camera.far, camera.region) = (parsed.near, parsed.far, parsed.region);
        camera.frame()?;
        Ok(camera)
    }

    /// The camera as JSON that [`Camera::from_json`] reads back.
    pub fn to_json(&self) -> String {
        let (fov, orthographic_height) = match self.projection {
            Projection::Perspective { fov_degrees } => (Some(fov_degrees), None),
            Projection::Orthographic { height_world } => (None, Some(height_world)),
        };
        let json = CameraJson {
            eye: self.eye.to_array(),
            target: self.target.to_array(),
            up: Some(self.up.to_array()),
            fov,
            width: self.width,
            height: self.height,
            near: self.near,
            far: self.far,
            orthographic_height,
            region: self.region,
        };
        serde_json::to_string_pretty(&json).unwrap_or_default()
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraJson {
    eye: [f64; 3],
    target: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    up: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fov: Option<f64>,
    #[serde(default = "default_side")]
    width: u32,
    #[serde(default = "default_side")]
    height: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    near: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    far: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    orthographic_height: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    region: Option<Region>,
}

fn default_side() -> u32 {
    512
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::looking_at(DVec3::new(3.0, -4.0, 2.0), DVec3::new(0.5, 0.0, 0.25), 640, 480)
    }

    #[test]
    fn pixel_of_a_point_on_a_ray_is_the_rays_pixel() {
        let mut camera = camera();
        for projection in
            [Projection::Perspective { fov_degrees: 40.0 }, Projection::Orthographic { height_world: 3.0 }]
        {
            camera.projection = projection;
            let frame = camera.frame().unwrap();
            for (x, y) in [(0.0, 0.0), (320.25, 17.5), (639.0, 479.0)] {
                let ray = frame.ray(x, y);
                let p = ray.origin + ray.direction * 2.5;
                assert!((frame.pixel(p) - DVec2::new(x, y)).length() < 1e-9);
                assert!((frame.depth(p) - 2.5).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn framing_holds_every_corner_for_every_view() {
        let corners = [DVec3::new(-1.0, 2.0, 3.0), DVec3::new(4.0, 2.5, 3.0), DVec3::new(0.0, 9.0, 5.0)];
        for (azimuth, elevation) in [(0.0, 0.0), (35.0, 25.0), (200.0, -89.9), (10.0, 90.0)] {
            let frame = Camera::framing(&corners, azimuth, elevation, 300, 100).orbited(77.0).frame().unwrap();
            for corner in corners {
                let p = frame.pixel(corner);
                assert!(frame.depth(corner) > 0.0 && p.x > -0.5 && p.x < 299.5 && p.y > -0.5 && p.y < 99.5);
            }
        }
    }

    #[test]
    fn a_place_of_which_a_coordinate_is_no_number_is_refused() {
        for axis in 0..3 {
            let (mut eye, mut target) = (camera(), camera());
            eye.eye[axis] = f64::NAN;
            target.target[axis] = f64::NAN;
            assert!(eye.frame().is_err() && target.frame().is_err());
        }
    }

    #[test]
    fn json_round_trip_and_errors() {
        let mut before = camera();
        assert_eq!(Camera::from_json(&before.to_json()).unwrap(), before);
        before.region = Some(Region { x0: 600, y0: 0, x1: 640, y1: 480 });
        assert_eq!(Camera::from_json(&before.to_json()).unwrap(), before);
        before.height = 479;
        assert!(matches!(Camera::from_json(&before.to_json()), Err(Error::Option { option: "--region", .. })));
        for bad in [
            "{",
            r#"{"eye":[0,0,0],"target":[0,0,0]}"#,
            r#"{"eye":[0,0,0],"target":[0,0,1],"up":[0,0,2]}"#,
            r#"{"eye":[0,0,0],"target":[0,0,1],"fov":180}"#,
            r#"{"eye":[0,0,0],"target":[0,0,1],"near":2,"far":1}"#,
            r#"{"eye":[0,0,0],"target":[0,0,1],"width":0}"#,
            r#"{"eye":[0,0,0],"target":[0,0,1],"typo":0}"#,
        ] {
            assert!(matches!(Camera::from_json(bad), Err(Error::Camera { .. })), "{bad}");
        }
    }

    #[test]
    fn what_vol_refuses_has_its_number() {
        let number = |number: u16, change: fn(&mut Camera)| {
            let mut camera = camera();
            change(&mut camera);
            let message = camera.frame().unwrap_err().to_string();
            assert!(message.ends_with(&format!("(Vol's error {number})")), "{message}");
        };
        number(108, |camera| (camera.near, camera.far) = (Some(2.0), Some(2.0)));
        number(109, |camera| camera.projection = Projection::Perspective { fov_degrees: 0.0 });
        number(110, |camera| camera.projection = Projection::Perspective { fov_degrees: 1e-170 });
        number(111, |camera| camera.target = camera.eye);
        number(112, |camera| camera.up = DVec3::ZERO);
        let mut other = camera();
        (other.near, other.far) = (Some(3.0), Some(2.0));
        assert!(!other.frame().unwrap_err().to_string().contains("Vol"));
    }

    #[test]
    fn an_orbit_of_90_degrees_is_right_handed() {
        let camera = Camera::looking_at(DVec3::new(1.0, 0.0, 0.0), DVec3::ZERO, 1, 1);
        assert!((camera.orbited(90.0).eye - DVec3::Y).length() < 1e-12);
    }
}
