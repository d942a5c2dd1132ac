//! From pointers and lengths to slices.
#![expect(unsafe_code, reason = "C ABI: a caller's word that a pointer has so many values")]

use std::ffi::{CStr, c_char};

use super::guard::{Failure, argument};
use super::types::{CellfanAssociation, CellfanMesh, CellfanSlice, CellfanType, one_of};
use crate::cells::{CellKind, KINDS};
use crate::columns::{Association, Positions};
use crate::session::{Cells, Indices, MeshView, Scalars};

/// `len` values from `data` on; null is none of them.
///
/// # Safety
/// `data` is null, or has so many initialised values that nobody writes to for `'a`.
pub(super) unsafe fn slice<'a, T>(data: *const T, len: usize, name: &str) -> Result<&'a [T], Failure> {
    if len == 0 {
        return Ok(&[]);
    }
    if data.is_null() {
        return Err(argument(format!("{name}: the pointer is null, the length {len}")));
    }
    if !data.is_aligned() {
        return Err(argument(format!("{name}: the pointer is not aligned to {} bytes", align_of::<T>())));
    }
    if len > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(argument(format!("{name}: {len} values are more than memory can hold")));
    }
    // SAFETY: not null, aligned, of a size that can be; the caller answers for the rest.
    Ok(unsafe { std::slice::from_raw_parts(data, len) })
}

/// The structure at `pointer`.
///
/// # Safety
/// `pointer` is null, not aligned, or points to one that nobody writes to for `'a`.
pub(super) unsafe fn read<'a, T>(pointer: *const T, name: &str) -> Result<&'a T, Failure> {
    if pointer.is_null() || !pointer.is_aligned() {
        return Err(argument(format!("{name}: the pointer is null or not aligned")));
    }
    // SAFETY: not null and aligned; the caller answers for the rest.
    Ok(unsafe { &*pointer })
}

/// Writes `value` to `pointer`.
///
/// # Safety
/// `pointer` is null, not aligned, or has room for one.
pub(super) unsafe fn write<T>(pointer: *mut T, value: T, name: &str) -> Result<(), Failure> {
    check_out(pointer, name)?;
    // SAFETY: not null and aligned; the caller answers for the rest.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Whether `pointer` can be written to.
pub(super) fn check_out<T>(pointer: *mut T, name: &str) -> Result<(), Failure> {
    if pointer.is_null() || !pointer.is_aligned() {
        return Err(argument(format!("{name}: the pointer is null or not aligned")));
    }
    Ok(())
}

/// A text that ends with 0.
///
/// # Safety
/// `text` is null, or ends with 0.
pub(super) unsafe fn text<'a>(text: *const c_char, name: &str) -> Result<&'a str, Failure> {
    if text.is_null() {
        return Err(argument(format!("{name}: the pointer is null")));
    }
    // SAFETY: not null; the caller answers for the end.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| argument(format!("{name}: the text is not UTF-8")))
}

/// Calls `$with` for the slice's type, if that is one of those listed.
macro_rules! typed {
    ($slice:expr, $name:expr, $into:ident, $($variant:ident $type:ty),*) => {{
        let CellfanSlice { data, len, r#type } = $slice;
        match r#type {
            $(
                // SAFETY: the caller's obligation.
                n if n == CellfanType::$variant as u32 => {
                    Ok($into::$variant(unsafe { slice(data.cast::<$type>(), len, $name) }?))
                }
            )*
            n => Err(argument(format!("{}: {n} is no type that it can have; one of {}", $name, stringify!($($variant),*)))),
        }
    }};
}

/// # Safety
/// As for [`slice()`].
unsafe fn indices<'a>(of: CellfanSlice, name: &str) -> Result<Indices<'a>, Failure> {
    typed!(of, name, Indices, U32 u32, I32 i32, U64 u64, I64 i64)
}

/// # Safety
/// As for [`slice()`].
pub(super) unsafe fn scalars<'a>(of: CellfanSlice) -> Result<Scalars<'a>, Failure> {
    typed!(of, "scalars", Scalars, I8 i8, U8 u8, I16 i16, U16 u16, I32 i32, U32 u32, I64 i64, U64 u64, F32 f32, F64 f64)
}

pub(super) fn association(number: u32) -> Result<Association, Failure> {
    one_of!(CellfanAssociation, number, "association", Points => Association::Point, Cells => Association::Cell)
}

/// Coordinates of one type.
enum Coordinates<'a> {
    F32(&'a [f32]),
    F64(&'a [f64]),
}

/// # Safety
/// As for [`slice()`].
unsafe fn coordinates<'a>(of: CellfanSlice, name: &str) -> Result<Coordinates<'a>, Failure> {
    typed!(of, name, Coordinates, F32 f32, F64 f64)
}

/// Points with their coordinates together in `x`, or an axis each.
///
/// # Safety
/// As for [`slice()`].
pub(super) unsafe fn positions<'a>(
    x: CellfanSlice,
    y: CellfanSlice,
    z: CellfanSlice,
) -> Result<Positions<'a>, Failure> {
    // SAFETY: the caller's obligation.
    let first = unsafe { coordinates(x, "positions") }?;
    if y.data.is_null() && z.data.is_null() {
        return Ok(match first {
            Coordinates::F32(all) => Positions::interleaved_f32(all)?,
            Coordinates::F64(all) => Positions::interleaved_f64(all)?,
        });
    }
    // SAFETY: the caller's obligation.
    match (first, unsafe { coordinates(y, "y") }?, unsafe { coordinates(z, "z") }?) {
        (Coordinates::F32(x), Coordinates::F32(y), Coordinates::F32(z)) => Ok(Positions::AxesF32([x, y, z])),
        (Coordinates::F64(x), Coordinates::F64(y), Coordinates::F64(z)) => Ok(Positions::AxesF64([x, y, z])),
        _ => Err(argument("positions, y and z: all have to be of one type")),
    }
}

/// The mesh, in the caller's memory.
///
/// # Safety
/// As for [`slice()`], of all slices of the mesh.
pub(super) unsafe fn mesh<'a>(mesh: &CellfanMesh) -> Result<MeshView<'a, 'a>, Failure> {
    // SAFETY: here and below, the caller's obligation.
    let positions = unsafe { positions(mesh.positions, mesh.y, mesh.z) }?;
    let cells = if mesh.dims == [0; 3] {
        // SAFETY: as above.
        unsafe { listed(mesh) }?
    } else {
        Cells::Structured { dims: mesh.dims }
    };
    let view = MeshView::new(positions, cells);
    if mesh.scalars.data.is_null() && mesh.scalars.len == 0 {
        return Ok(view);
    }
    // SAFETY: as above.
    Ok(view.with_scalars(association(mesh.association)?, unsafe { scalars(mesh.scalars) }?))
}

/// Cells with connectivity.
///
/// # Safety
/// As for [`slice()`], of all slices of the mesh.
unsafe fn listed<'a>(mesh: &CellfanMesh) -> Result<Cells<'a>, Failure> {
    // SAFETY: here and below, the caller's obligation.
    let points = unsafe { indices(mesh.connectivity, "connectivity") }?;
    if mesh.types.len == 0 {
        return Ok(Cells::OfKind { kind: kind(mesh.kind)?, points });
    }
    let CellfanSlice { data, len, r#type } = mesh.types;
    if r#type != CellfanType::U8 as u32 {
        return Err(argument("types: they have to be uint8_t"));
    }
    // SAFETY: as above.
    let types = unsafe { slice(data.cast::<u8>(), len, "types") }?;
    // SAFETY: as above.
    Ok(Cells::Mixed { types, offsets: unsafe { indices(mesh.offsets, "offsets") }?, points })
}

fn kind(code: u32) -> Result<&'static CellKind, Failure> {
    let kind = KINDS.into_iter().find(|kind| u32::from(kind.code) == code);
    kind.ok_or_else(|| {
        argument(format!("kind: {code} is none of 10, 11, 12, 13, 14, VTK's codes of cells with a volume"))
    })
}
