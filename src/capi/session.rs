//! Functions on sessions.
#![expect(unsafe_code, reason = "C ABI: pointers come in, and arrays are used for as long as the caller says")]

use std::ffi::c_void;

use super::guard::{CellfanStatus, Failure, argument, guarded};
use super::handles::{CellfanSession, get, put, remove};
use super::picture::{camera_of, options_of, transfer_of};
use super::slices::{association, check_out, mesh as mesh_at, positions, read, scalars, slice, write};
use super::types::{
    CellfanCamera, CellfanControlPoint, CellfanMesh, CellfanOptions, CellfanProgress, CellfanSlice, CellfanStats,
};
use crate::profile::Exactness;
use crate::session::{Session, Threads};

/// Makes a session that draws `mesh` on `threads` threads of its own, which sleep between pictures; 0 for one a core.
///
/// Positions of type float with x, y, z together and connectivity in 32 bits are used in place: they have to stay where they are,
/// unchanged, until the session is freed or the mesh replaced. Scalars are read before this returns.
///
/// Threads: any.
///
/// # Safety
/// `mesh` is null or points to a mesh whose slices have so many values; `session` is null or has room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cellfan_session_new(
    mesh: *const CellfanMesh,
    threads: usize,
    session: *mut *mut CellfanSession,
) -> CellfanStatus {
    guarded(|| {
        check_out(session, "session")?;
        // SAFETY: the caller's obligation.
        let view = unsafe { mesh_at(read(mesh, "mesh")?) }?;
        let handle = put(Session::on(Threads::Count(threads), &view)?);
        // SAFETY: the caller's obligation.
        unsafe { write(session, handle, "session") }
    })
}

/// Frees a session. A call of another thread that is using it goes on to its end; arrays have to stay until then.
///
/// Threads: any. Freeing twice is CELLFAN_STATUS_HANDLE, and so is null.
#[unsafe(no_mangle)]
pub extern "C" fn cellfan_session_free(session: *mut CellfanSession) -> CellfanStatus {
    guarded(|| remove(session))
}

/// Draws other values, one a point or one a cell (`of`, a CellfanAssociation); they are read before this returns. Cells with a value
/// that is not finite are left out. While the camera stays, the next picture needs no sort.
///
/// Threads: any, one at a time for a session (CELLFAN_STATUS_BUSY).
///
/// # Safety
/// The slice has so many values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cellfan_session_update_scalars(
    session: *mut CellfanSession,
    of: u32,
    values: CellfanSlice,
) -> CellfanStatus {
    guarded(|| {
        let held = get(session)?;
        // SAFETY: the caller's obligation.
        let values = unsafe { scalars(values) }?;
        let updated = held.session()?.update_scalars(association(of)?, values);
        updated.map_err(|error| Failure(CellfanStatus::Scalars, error.to_string()))
    })
}

/// Moves the points, as many as there were: x, y, z together, or an axis a slice (else clear `y` and `z`). They are copied before
/// this returns; those of the mesh are no longer used.
///
/// Threads: any, one at a time for a session.
///
/// # Safety
/// The slices have so many values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cellfan_session_update_positions(
    session: *mut CellfanSession,
    x: CellfanSlice,
    y: CellfanSlice,
    z: CellfanSlice,
) -> CellfanStatus {
    guarded(|| {
        let held = get(session)?;
        // SAFETY: the caller's obligation.
        let positions = unsafe { positions(x, y, z) }?;
        Ok(held.session()?.update_positions(positions)?)
    })
}

/// Draws another mesh, as cellfan_session_new() does; threads and memory for pictures stay. After an error the mesh is that of before.
///
/// Threads: any, one at a time for a session.
///
/// # Safety
/// That of cellfan_session_new().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cellfan_session_update_topology(
    session: *mut CellfanSession,
    mesh: *const CellfanMesh,
) -> CellfanStatus {
    guarded(|| {
        let held = get(session)?;
        // SAFETY: the caller's obligation.
        let view = unsafe { mesh_at(read(mesh, "mesh")?) }?;
        Ok(held.session()?.update_topology(&view)?)
    })
}

/// Draws a picture into `rgba`: red, green, blue, opacity of each pixel, linear and premultiplied, row by row from the top;
/// `rgba_len` is 4 * width * height.
///
/// `options` may be null for the default, `stats` where nobody asks.
///
/// Threads: any, one at a time for a session.
///
/// # Safety
/// Pointers are null or have what they say: `points_len` control points, `rgba_len` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cellfan_session_render(
    session: *mut CellfanSession,
    camera: *const CellfanCamera,
    points: *const CellfanControlPoint,
    points_len: usize,
    options: *const CellfanOptions,
    rgba: *mut f32,
    rgba_len: usize,
    stats: *mut CellfanStats,
) -> CellfanStatus {
    guarded(|| {
        let held = get(session)?;
        // SAFETY: here and below, the caller's obligation.
        let camera = camera_of(unsafe { read(camera, "camera") }?);
        // SAFETY: as above.
        let transfer = transfer_of(unsafe { slice(points, points_len, "points") }?)?;
        let options = if options.is_null() {
            CellfanOptions::default()
        } else {
            // SAFETY: as above.
            *unsafe { read(options, "options") }?
        };
        check_out(rgba, "rgba")?;
        let expected = u64::from(camera.width) * u64::from(camera.height) * 4;
        if rgba_len as u64 != expected {
            let problem =
                format!("rgba: {rgba_len} values; a picture of {}x{} has {expected}", camera.width, camera.height);
            return Err(argument(problem));
        }
        let rendered = held.session()?.render(&camera, &transfer, &options_of(&options)?)?;
        let values = rendered.image.pixels.as_flattened();
        // SAFETY: not null, aligned and, as the caller says, of this length, which a picture of that size has.
        unsafe { std::ptr::copy_nonoverlapping(values.as_ptr(), rgba, values.len()) };
        if stats.is_null() {
            return Ok(());
        }
        let found = CellfanStats {
            drawn: rendered.cells.drawn,
            culled_transparent: rendered.cells.culled_transparent,
            culled_outside: rendered.cells.culled_outside,
            invalid: rendered.cells.invalid,
            degenerate: rendered.cells.degenerate,
            is_exact: u32::from(rendered.order.exactness == Exactness::Exact),
            frame_ms: rendered.frame_ms,
        };
        // SAFETY: as above.
        unsafe { write(stats, found, "stats") }
    })
}

/// Ends the picture that is being drawn, or the next, within milliseconds: its call returns CELLFAN_STATUS_CANCELLED.
///
/// Threads: any, at any time.
#[unsafe(no_mangle)]
pub extern "C" fn cellfan_session_cancel(session: *mut CellfanSession) -> CellfanStatus {
    guarded(|| {
        get(session)?.cancel.cancel();
        Ok(())
    })
}

/// A pointer of the caller's, for the caller's function alone.
struct User(*mut c_void);

// SAFETY: nothing here reads it; the caller's function gets it on threads of which the header speaks.
unsafe impl Send for User {}
// SAFETY: as above.
unsafe impl Sync for User {}

impl User {
    fn pointer(&self) -> *mut c_void {
        self.0
    }
}

/// Has `call` called while pictures are drawn; a null function ends it.
///
/// Threads: any, one at a time for a session.
#[unsafe(no_mangle)]
pub extern "C" fn cellfan_session_on_progress(
    session: *mut CellfanSession,
    call: CellfanProgress,
    user: *mut c_void,
) -> CellfanStatus {
    guarded(|| {
        let (held, user) = (get(session)?, User(user));
        held.session()?.on_progress(Box::new(move |share| {
            if let Some(call) = call {
                call(share, user.pointer());
            }
        }));
        Ok(())
    })
}

/// Smallest and largest finite scalar, into two values.
///
/// Threads: any, one at a time for a session.
///
/// # Safety
/// `range` is null or has room for two values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cellfan_session_value_range(session: *mut CellfanSession, range: *mut f64) -> CellfanStatus {
    guarded(|| {
        let (low, high) = get(session)?.session()?.value_range();
        // SAFETY: the caller's obligation.
        unsafe { write(range.cast(), [low, high], "range") }
    })
}

/// The box around the mesh, smallest x, y, z, then largest, into six values.
///
/// Threads: any, one at a time for a session.
///
/// # Safety
/// `bounds` is null or has room for six values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cellfan_session_bounds(session: *mut CellfanSession, bounds: *mut f64) -> CellfanStatus {
    guarded(|| {
        let corners = get(session)?.session()?.corners_world();
        // SAFETY: the caller's obligation.
        unsafe { write(bounds.cast(), [corners[0].to_array(), corners[7].to_array()], "bounds") }
    })
}
