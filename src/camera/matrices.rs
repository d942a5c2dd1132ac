//! A camera as the two matrices of a z-buffer file (Amidon 1995, appendix A).

use glam::{DMat4, DVec4};

use super::{Camera, Frame};
use crate::error::{Error, Result, VolCondition};

impl Camera {
    /// The matrices from world to screen and from world to view, row by row, for points as rows from the left: p′ = p M.
    ///
    /// View axes run right, up and along the view (left-handed), from the eye. Screen x and y run from −1 to 1 over what the camera draws
    /// (its region, if it has one), y up; screen depth from 0 at `near` to 1 at `far`: f/(f − d) · (1 − d/w) in perspective.
    ///
    /// # Errors
    /// Those of [`Camera::frame`]; [`Error::Camera`] where the planes are equal (Vol's error 108).
    ///
    /// ```
    /// # use cellfan::Camera;
    /// # use glam::DVec3;
    /// let camera = Camera::looking_at(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, 64, 64);
    /// let [screen, view] = camera.matrices([4.0, 8.0])?;
    /// // The target lies 5 units along the view: 8/(8 − 4) · (1 − 4/5) of the way from near to far.
    /// assert_eq!(view[3], [0.0, 0.0, 5.0, 1.0]);
    /// assert!((screen[3][2] / screen[3][3] - 0.4).abs() < 1e-6);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn matrices(&self, [near, far]: [f64; 2]) -> Result<[[[f32; 4]; 4]; 2]> {
        let frame = self.frame()?;
        let range = far - near;
        if range == 0.0 || !range.is_finite() {
            let problem = VolCondition::PlanesEqual.said(&format!("near ({near}) and far ({far}) span no depths"));
            return Err(Error::Camera { problem });
        }
        let view_from_world = view_from_world(&frame);
        let screen_from_world = screen_from_view(&frame, [near, far]) * view_from_world;
        // Rows from the left: the transpose, whose rows are the columns here.
        Ok([screen_from_world, view_from_world].map(|matrix| matrix.as_mat4().to_cols_array_2d()))
    }
}

fn view_from_world(frame: &Frame) -> DMat4 {
    let axes = [frame.step_x.normalize(), -frame.step_y.normalize(), frame.forward];
    let [right, up, forward] = axes.map(|axis| axis.extend(-axis.dot(frame.eye)));
    DMat4::from_cols(right, up, forward, DVec4::W).transpose()
}

fn screen_from_view(frame: &Frame, [near, far]: [f64; 2]) -> DMat4 {
    let [width, height] = frame.size_px.map(f64::from);
    let [x0, y0, x1, y1] = <[u32; 4]>::from(frame.region).map(f64::from);
    // Of the picture's middle on the screen that the region is, and of a unit across.
    let aside = [(width - 2.0 * x0) / (x1 - x0) - 1.0, 1.0 - (height - 2.0 * y0) / (y1 - y0)];
    let scale = [2.0 / (frame.step_x.length() * (x1 - x0)), 2.0 / (frame.step_y.length() * (y1 - y0))];
    let per_depth = (far - near).recip();
    let rows = if frame.is_perspective {
        [
            DVec4::new(scale[0], 0.0, aside[0], 0.0),
            DVec4::new(0.0, scale[1], aside[1], 0.0),
            DVec4::new(0.0, 0.0, far * per_depth, -near * far * per_depth),
            DVec4::Z,
        ]
    } else {
        [
            DVec4::new(scale[0], 0.0, 0.0, aside[0]),
            DVec4::new(0.0, scale[1], 0.0, aside[1]),
            DVec4::new(0.0, 0.0, per_depth, -near * per_depth),
            DVec4::W,
        ]
    };
    DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::camera::{Projection, Region};

    #[test]
    fn a_pixel_lies_on_the_screen_where_its_ray_does() {
        let mut camera = Camera::looking_at(DVec3::new(3.0, -4.0, 2.0), DVec3::new(0.5, 0.0, 0.25), 640, 480);
        for projection in
            [Projection::Perspective { fov_degrees: 40.0 }, Projection::Orthographic { height_world: 3.0 }]
        {
            for region in [None, Some(Region { x0: 100, y0: 40, x1: 300, y1: 480 })] {
                (camera.projection, camera.region) = (projection, region);
                let [x0, y0, x1, y1] = <[u32; 4]>::from(region.unwrap_or(Region::whole([640, 480]))).map(f64::from);
                let [screen, view] = camera.matrices([2.0, 9.0]).unwrap();
                let by = |m: [[f32; 4]; 4], p: DVec3| {
                    let p = p.extend(1.0).to_array();
                    [0, 1, 2, 3].map(|k| (0..4).map(|i| p[i] * f64::from(m[i][k])).sum::<f64>())
                };
                for (x, y, w) in [(100.0, 50.0, 2.0), (299.0, 470.0, 9.0), (200.0, 200.0, 4.5)] {
                    let ray = camera.frame().unwrap().ray(x, y);
                    let p = ray.origin + ray.direction * w;
                    assert!((by(view, p)[2] - w).abs() < 1e-5);
                    let at = by(screen, p);
                    let expected = [2.0 * (x + 0.5 - x0) / (x1 - x0) - 1.0, 1.0 - 2.0 * (y + 0.5 - y0) / (y1 - y0)];
                    for k in 0..2 {
                        assert!((at[k] / at[3] - expected[k]).abs() < 1e-5, "{x}, {y}, {w}: {at:?} for {expected:?}");
                    }
                    let depth = match projection {
                        Projection::Perspective { .. } => 9.0 / 7.0 * (1.0 - 2.0 / w),
                        Projection::Orthographic { .. } => (w - 2.0) / 7.0,
                    };
                    assert!((at[2] / at[3] - depth).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn planes_that_are_equal_are_error_108() {
        let camera = Camera::looking_at(DVec3::X, DVec3::ZERO, 4, 4);
        assert!(camera.matrices([2.0, 2.0]).unwrap_err().to_string().contains("108"));
    }
}
