//! `lend`: a slice of the caller's as a [`Column`], without a copy.
#![expect(unsafe_code, reason = "columns have no lifetime; whoever lends one sees to it that it is not read later")]

use crate::columns::Column;

/// `slice` as a column.
///
/// # Safety
/// The column, what it becomes part of and all clones are not read once the slice's lifetime has ended.
pub(super) unsafe fn lend<T>(slice: &[T]) -> Column<T> {
    // SAFETY: pointer and length are those of a slice; the caller answers for the lifetime.
    let forever: &'static [T] = unsafe { std::slice::from_raw_parts(slice.as_ptr(), slice.len()) };
    Column::from(forever)
}
