//! `Column<T>`: a typed slice that is owned, shared with the bytes of a file, or lent.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Deref, Range};
use std::sync::Arc;

use bytemuck::Pod;

use crate::error::{Error, Result};

/// Bytes that several columns share: a memory map, or a file read whole.
pub type SharedBytes = Arc<dyn AsRef<[u8]> + Send + Sync>;

/// A column of plain values; alignment and length are checked once, at construction, and then it is a slice.
///
/// ```
/// # use cellfan::columns::Column;
/// let column = Column::from(vec![1.0_f32, 2.0]);
/// assert_eq!(column[1], 2.0);
/// ```
pub struct Column<T: 'static> {
    storage: Storage<T>,
}

enum Storage<T: 'static> {
    Owned(Arc<Vec<T>>),
    Shared { bytes: SharedBytes, range: Range<usize>, values: PhantomData<T> },
    Lent(&'static [T]),
}

impl<T: Pod> Column<T> {
    /// A column of `len` values that starts at byte `offset` of `bytes`, used in place.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] where the bytes end too early or are not aligned for `T`.
    pub fn shared(name: &str, bytes: SharedBytes, offset: usize, len: usize) -> Result<Self> {
        let all = (*bytes).as_ref();
        let mismatch =
            || Error::LengthMismatch { column: name.to_owned(), len: all.len() as u64, expected: len as u64 };
        let end = len.checked_mul(size_of::<T>()).and_then(|size| size.checked_add(offset)).ok_or_else(mismatch)?;
        let part = all.get(offset..end).ok_or_else(mismatch)?;
        bytemuck::try_cast_slice::<u8, T>(part).map_err(|_| mismatch())?;
        Ok(Self { storage: Storage::Shared { bytes, range: offset..end, values: PhantomData } })
    }
}

impl<T: Pod> Column<T> {
    /// Bytes of memory that the values take; none where they are used in place.
    pub fn owned_bytes(&self) -> u64 {
        match &self.storage {
            Storage::Owned(values) => size_of_val(&values[..]) as u64,
            Storage::Shared { .. } | Storage::Lent(_) => 0,
        }
    }
}

impl<T: Pod> Column<T> {
    /// The values to be changed; copied first where they are used in place or shared with another column.
    pub fn to_mut(&mut self) -> &mut Vec<T> {
        if let Storage::Shared { .. } | Storage::Lent(_) = self.storage {
            *self = self.to_vec().into();
        }
        match &mut self.storage {
            Storage::Owned(values) => Arc::make_mut(values),
            Storage::Shared { .. } | Storage::Lent(_) => unreachable!("owned since the line above"),
        }
    }
}

impl<T: Pod> Deref for Column<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match &self.storage {
            Storage::Owned(values) => values,
            Storage::Shared { bytes, range, .. } => bytemuck::cast_slice(&(**bytes).as_ref()[range.clone()]),
            Storage::Lent(values) => values,
        }
    }
}

impl<T: 'static> From<Vec<T>> for Column<T> {
    fn from(values: Vec<T>) -> Self {
        Self { storage: Storage::Owned(Arc::new(values)) }
    }
}

impl<T: 'static> From<&'static [T]> for Column<T> {
    /// The values in place.
    fn from(values: &'static [T]) -> Self {
        Self { storage: Storage::Lent(values) }
    }
}

impl<T: 'static> FromIterator<T> for Column<T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        Self { storage: Storage::Owned(Arc::new(values.into_iter().collect())) }
    }
}

impl<T: 'static> Clone for Column<T> {
    /// Shares the values; nothing is copied.
    fn clone(&self) -> Self {
        let storage = match &self.storage {
            Storage::Owned(values) => Storage::Owned(Arc::clone(values)),
            Storage::Shared { bytes, range, .. } => {
                Storage::Shared { bytes: Arc::clone(bytes), range: range.clone(), values: PhantomData }
            }
            Storage::Lent(values) => Storage::Lent(values),
        };
        Self { storage }
    }
}

impl<T: Pod + PartialEq> PartialEq for Column<T> {
    fn eq(&self, other: &Self) -> bool {
        self[..] == other[..]
    }
}

impl<T: Pod + fmt::Debug> fmt::Debug for Column<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Column({} values)", self.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shared_column_reads_in_place() {
        let words: Vec<u64> = vec![0, 0x0000_0002_0000_0001];
        let bytes: SharedBytes = Arc::new(bytemuck::cast_slice::<u64, u8>(&words).to_vec().into_boxed_slice());
        let base = (*bytes).as_ref().as_ptr() as usize;
        if base.is_multiple_of(4) {
            let column = Column::<u32>::shared("ids", Arc::clone(&bytes), 8, 2).unwrap();
            assert_eq!(&column[..], &[1, 2]);
        }
    }

    #[test]
    fn lent_column_is_copied_when_it_is_changed() {
        static VALUES: [u32; 3] = [4, 5, 6];
        let mut column = Column::from(&VALUES[..]);
        assert_eq!((column.as_ptr(), column.owned_bytes()), (VALUES.as_ptr(), 0));
        column.to_mut()[0] = 1;
        assert_eq!((&column[..], column.owned_bytes()), (&[1, 5, 6][..], 12));
    }

    #[test]
    fn shared_column_that_ends_too_early_is_refused() {
        let bytes: SharedBytes = Arc::new(vec![0_u8; 8]);
        assert!(matches!(Column::<u32>::shared("ids", bytes.clone(), 4, 2), Err(Error::LengthMismatch { .. })));
        assert!(Column::<u32>::shared("ids", bytes, usize::MAX, 2).is_err());
    }
}
