//! [`Lent`]: the values of a NumPy array, in place, for as long as the array is held.
//!
//! In: an array of one of the types that are asked for, its values one after the other. Out: a slice. Anything else is refused with what
//! would do: `python/cellfan/_mesh.py` converts, and says what it copies.
#![expect(unsafe_code, reason = "a slice that lives as long as the array it holds, which no lifetime can say")]

use cellfan::Positions;
use cellfan::session::{Indices, Scalars};
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error::refused;

/// The values of an array, which is held.
pub(crate) struct Lent<T: 'static> {
    values: &'static [T],
    _array: Py<PyAny>,
}

impl<T> Lent<T> {
    /// The values.
    pub(crate) fn get(&self) -> &[T] {
        self.values
    }
}

/// The values of `array`, if they are of type `T`.
fn lend<T: Element>(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Option<Lent<T>>> {
    let Ok(array) = array.cast::<PyArrayDyn<T>>() else { return Ok(None) };
    let refuse = || {
        refused(format!("{name}: the array has to be C-contiguous and aligned; numpy.ascontiguousarray makes it so"))
    };
    if !array.is_c_contiguous() {
        // Columns one after the other are a slice too, and other values.
        return Err(refuse());
    }
    // SAFETY: nothing in Rust writes to an array; that Python code does not while it is read is what the documentation asks for. Values
    // that change all the same are numbers still, and the library checks each number of a point before it reads that point.
    let values = unsafe { array.as_slice() };
    let values = values.map_err(|_| refuse())?;
    // SAFETY: pointer and length are those of a slice. The array is held beside it, and NumPy does not resize an array of which another
    // reference is held, unless it is told to disregard that (`refcheck=False`).
    let values = unsafe { std::slice::from_raw_parts(values.as_ptr(), values.len()) };
    Ok(Some(Lent { values, _array: array.clone().into_any().unbind() }))
}

/// What `array` is, for a message.
fn described(array: &Bound<'_, PyAny>) -> String {
    match array.cast::<PyUntypedArray>() {
        Ok(array) => format!("an array of {} of shape {:?}", array.dtype(), array.shape()),
        Err(_) => format!("{}, which is no NumPy array", array.get_type()),
    }
}

macro_rules! values {
    ($(#[$doc:meta])* $name:ident: $of:ident, $dtypes:literal, $($variant:ident $type:ty),*) => {
        $(#[$doc])*
        pub(crate) enum $name {
            $($variant(Lent<$type>)),*
        }

        impl $name {
            /// The values of `array`, which is called `name`.
            pub(crate) fn new(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Self> {
                $(if let Some(values) = lend::<$type>(name, array)? {
                    return Ok(Self::$variant(values));
                })*
                Err(refused(format!("{name}: {}; it has to be an array of {}", described(array), $dtypes)))
            }

            /// The same as a slice.
            pub(crate) fn get(&self) -> $of<'_> {
                match self { $(Self::$variant(values) => $of::$variant(values.get())),* }
            }
        }
    };
}

values!(
    /// Numbers of points or places.
    LentIndices: Indices, "uint32, int32, uint64 or int64", U32 u32, I32 i32, U64 u64, I64 i64
);
values!(
    /// Scalars.
    LentScalars: Scalars, "integers of 8 to 64 bits, float32 or float64",
    I8 i8, U8 u8, I16 i16, U16 u16, I32 i32, U32 u32, I64 i64, U64 u64, F32 f32, F64 f64
);

/// VTK's codes of cells.
pub(crate) fn lent_types(array: &Bound<'_, PyAny>) -> PyResult<Lent<u8>> {
    lend("types", array)?.ok_or_else(|| refused(format!("types: {}; it has to be an array of uint8", described(array))))
}

/// Positions: x, y, z of one point after the other, or an axis an array.
pub(crate) enum LentPositions {
    F32(Lent<f32>),
    F64(Lent<f64>),
    AxesF32([Lent<f32>; 3]),
    AxesF64([Lent<f64>; 3]),
}

impl LentPositions {
    /// The positions in `points`, an array of three columns or three arrays.
    pub(crate) fn new(points: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok([x, y, z]) = points.extract::<[Bound<'_, PyAny>; 3]>()
            && points.cast::<PyUntypedArray>().is_err()
        {
            let single = (lend("x", &x)?, lend("y", &y)?, lend("z", &z)?);
            if let (Some(x), Some(y), Some(z)) = single {
                return Ok(Self::AxesF32([x, y, z]));
            }
            if let (Some(x), Some(y), Some(z)) = (lend("x", &x)?, lend("y", &y)?, lend("z", &z)?) {
                return Ok(Self::AxesF64([x, y, z]));
            }
            return Err(refused("points: x, y and z have to be arrays of float32, or all of float64"));
        }
        if let Ok(array) = points.cast::<PyUntypedArray>()
            && !matches!(array.shape(), [_, 3])
        {
            return Err(refused(format!("points: {}; it needs three columns: x, y, z", described(points))));
        }
        if let Some(values) = lend("points", points)? {
            return Ok(Self::F32(values));
        }
        match lend("points", points)? {
            Some(values) => Ok(Self::F64(values)),
            None => Err(refused(format!("points: {}; it has to be float32 or float64", described(points)))),
        }
    }

    /// The same as slices.
    pub(crate) fn get(&self) -> cellfan::Result<Positions<'_>> {
        match self {
            Self::F32(values) => Positions::interleaved_f32(values.get()),
            Self::F64(values) => Positions::interleaved_f64(values.get()),
            Self::AxesF32(axes) => Ok(Positions::AxesF32(axes.each_ref().map(Lent::get))),
            Self::AxesF64(axes) => Ok(Positions::AxesF64(axes.each_ref().map(Lent::get))),
        }
    }
}
