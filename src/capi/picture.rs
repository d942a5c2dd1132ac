//! Cameras, transfer functions, options, files.
#![expect(unsafe_code, reason = "C ABI: pointers come in")]

use std::ffi::c_char;

use glam::DVec3;

use super::guard::{CellfanStatus, Failure, argument, guarded};
use super::handles::{CellfanSession, get};
use super::slices::{check_out, slice, text, write};
use super::types::{CellfanCamera, CellfanControlPoint, CellfanOptions, model, sort};
use crate::camera::{Camera, Projection};
use crate::error::{Error, Result};
use crate::image::{Encoding, Image};
use crate::optics::presets::{OpacityProfile, preset};
use crate::optics::{ControlPoint, TransferFunction};
use crate::render::RenderOptions;

/// The version of cellfan, such as "0.1.0".
///
/// Threads: any.
#[unsafe(no_mangle)]
pub extern "C" fn cellfan_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// A camera that shows the whole mesh, from azimuth and elevation in degrees, +z up.
///
/// Threads: any, one at a time for a session.
///
/// # Safety
/// `camera` is null or has room for one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cellfan_camera_framing(
    session: *mut CellfanSession,
    azimuth_degrees: f64,
    elevation_degrees: f64,
    width: u32,
    height: u32,
    camera: *mut CellfanCamera,
) -> CellfanStatus {
    guarded(|| {
        let corners = get(session)?.session()?.corners_world();
        let Camera { eye, target, up, .. } =
            Camera::framing(&corners, azimuth_degrees, elevation_degrees, width, height);
        let found = CellfanCamera {
            eye: eye.to_array(),
            target: target.to_array(),
            up: up.to_array(),
            fov_degrees: Camera::FOV_DEGREES,
            height_world: 0.0,
            width,
            height,
            near: 0.0,
            far: 0.0,
        };
        camera_of(&found).frame()?;
        // SAFETY: the caller's obligation.
        unsafe { write(camera, found, "camera") }
    })
}

/// The control points of a colour map ("viridis", "inferno", "cool-warm", "x-ray") over the scalars of a session, more opaque where
/// they are larger; at most `capacity` of them into `points` (64 are enough), how many into `points_len`.
///
/// Threads: any, one at a time for a session.
///
/// # Safety
/// `name` is null or ends with 0, `points` has room for `capacity` of them, `points_len` is null or has room for a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cellfan_preset(
    session: *mut CellfanSession,
    name: *const c_char,
    points: *mut CellfanControlPoint,
    capacity: usize,
    points_len: *mut usize,
) -> CellfanStatus {
    guarded(|| {
        // SAFETY: here and below, the caller's obligation.
        let name = unsafe { text(name, "name") }?;
        check_out(points, "points")?;
        check_out(points_len, "points_len")?;
        let (range, diagonal) = {
            let held = get(session)?;
            let session = held.session()?;
            (session.value_range(), session.diagonal_world())
        };
        // One value everywhere is a range too.
        let range = if range.0 < range.1 { range } else { (range.0 - 0.5, range.0 + 0.5) };
        let transfer = preset(name, range, OpacityProfile::default(), diagonal / 100.0)?;
        let found = transfer.points();
        if found.len() > capacity {
            return Err(argument(format!("points: room for {capacity}, and there are {}", found.len())));
        }
        for (i, &ControlPoint { value, color, extinction }) in found.iter().enumerate() {
            // SAFETY: not null, aligned, and i is below the capacity.
            unsafe { points.add(i).write(CellfanControlPoint { value, color, extinction }) };
        }
        // SAFETY: as above.
        unsafe { write(points_len, found.len(), "points_len") }
    })
}

/// Writes a picture to a file: .png (straight alpha), .exr or .npy, by the extension of `path`. It appears whole or not at all.
///
/// Threads: any.
///
/// # Safety
/// `path` is null or ends with 0, `rgba` is null or has `rgba_len` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cellfan_save(
    path: *const c_char,
    width: u32,
    height: u32,
    rgba: *const f32,
    rgba_len: usize,
) -> CellfanStatus {
    guarded(|| {
        // SAFETY: the caller's obligation.
        let path = unsafe { text(path, "path") }?;
        // SAFETY: as above.
        let values = unsafe { slice(rgba, rgba_len, "rgba") }?;
        let expected = u64::from(width) * u64::from(height) * 4;
        if values.len() as u64 != expected || values.is_empty() {
            return Err(argument(format!("rgba: {rgba_len} values; a picture of {width}x{height} has {expected}")));
        }
        let image = Image { width, height, pixels: values.as_chunks().0.to_vec() };
        Ok(image.save(path, &Encoding::default())?)
    })
}

/// The camera; whether it can look at anything is seen when it does.
pub(super) fn camera_of(camera: &CellfanCamera) -> Camera {
    let CellfanCamera { eye, target, up, fov_degrees, height_world, width, height, near, far } = *camera;
    let projection = if fov_degrees == 0.0 {
        Projection::Orthographic { height_world }
    } else {
        Projection::Perspective { fov_degrees }
    };
    let some = |value: f64| (value != 0.0).then_some(value);
    Camera {
        eye: DVec3::from_array(eye),
        target: DVec3::from_array(target),
        up: DVec3::from_array(up),
        projection,
        width,
        height,
        near: some(near),
        far: some(far),
        region: None,
    }
}

pub(super) fn transfer_of(points: &[CellfanControlPoint]) -> Result<TransferFunction> {
    let point = |&CellfanControlPoint { value, color, extinction }: &CellfanControlPoint| ControlPoint {
        value,
        color,
        extinction,
    };
    if points.is_empty() {
        return Err(Error::TransferFunction { problem: "there are no control points".to_owned() });
    }
    TransferFunction::new(points.iter().map(point).collect())
}

pub(super) fn options_of(options: &CellfanOptions) -> std::result::Result<RenderOptions, Failure> {
    Ok(RenderOptions {
        model: model(options.model)?,
        sort: sort(options.sort)?,
        memory_bytes: (options.memory_bytes > 0).then_some(options.memory_bytes),
        ..RenderOptions::default()
    })
}
