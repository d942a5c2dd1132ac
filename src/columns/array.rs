//! Named arrays as the file holds them: any numeric type, any number of components, in file order.

use bytemuck::Pod;

use super::{Column, SharedBytes};
use crate::error::Result;

/// Whether an array has one tuple per point or per cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Association {
    /// One tuple per point of the file.
    Point,
    /// One tuple per cell of the file.
    Cell,
}

/// A named array in file order, tuples of `components` values one after the other.
#[derive(Clone, Debug)]
pub struct Array {
    /// Its name in the file.
    pub name: String,
    /// What it is attached to.
    pub association: Association,
    /// Values per tuple; 1 for a scalar.
    pub components: usize,
    /// The values.
    pub values: NumericColumn,
}

/// A number of any of the types that files use.
pub trait Sample: Pod + Send + Sync {
    /// In double precision.
    fn widened(self) -> f64;

    /// In single precision, rounded once.
    fn narrowed(self) -> f32;
}

/// Work on the values of a column, compiled for each numeric type.
pub trait SliceVisitor {
    /// What it gives.
    type Output;

    /// Does it.
    fn visit<T: Sample>(self, values: &[T]) -> Self::Output;
}

macro_rules! numeric_column {
    ($($variant:ident $type:ty),*) => {
        /// A column of any of the numeric types that files use.
        #[derive(Clone, Debug)]
        pub enum NumericColumn {
            $(#[doc = concat!("`", stringify!($type), "` values.")] $variant(Column<$type>)),*
        }

        impl NumericColumn {
            /// How many values there are.
            pub fn len(&self) -> usize {
                match self { $(Self::$variant(values) => values.len()),* }
            }

            /// The name of the type, as in Rust.
            pub fn type_name(&self) -> &'static str {
                match self { $(Self::$variant(_) => stringify!($type)),* }
            }

            /// Appends the values of some tuples of `components` values each, little-endian.
            ///
            /// # Panics
            /// If there is no such tuple.
            pub fn append_tuples(&self, components: usize, tuples: &[u32], bytes: &mut Vec<u8>) {
                match self {
                    $(Self::$variant(values) => {
                        let values = &values[..];
                        for &tuple in tuples {
                            for value in &values[tuple as usize * components..][..components] {
                                bytes.extend_from_slice(&value.to_le_bytes());
                            }
                        }
                    })*
                }
            }

            /// `len` values of the type called `type_name` from byte `offset` of a file's bytes, in place; none where there is
            /// no such type.
            ///
            /// # Errors
            /// As [`Column::shared`].
            pub fn shared(
                type_name: &str,
                name: &str,
                bytes: SharedBytes,
                offset: usize,
                len: usize,
            ) -> Result<Option<Self>> {
                $(if type_name == stringify!($type) {
                    return Ok(Some(Self::$variant(Column::shared(name, bytes, offset, len)?)));
                })*
                Ok(None)
            }

            /// Bytes of memory that the values take; none where they are used in place.
            pub fn owned_bytes(&self) -> u64 {
                match self { $(Self::$variant(values) => values.owned_bytes()),* }
            }

            /// Does `visitor`'s work on the values in their own type.
            pub fn visit<V: SliceVisitor>(&self, visitor: V) -> V::Output {
                match self { $(Self::$variant(values) => visitor.visit(&values[..])),* }
            }

            /// Value `i`, widened.
            ///
            /// # Panics
            /// If `i` is not below the length.
            #[inline]
            #[expect(clippy::cast_lossless, reason = "one body for every numeric type")]
            pub fn get(&self, i: usize) -> f64 {
                match self { $(Self::$variant(values) => values[i] as f64),* }
            }
        }

        $(impl Sample for $type {
            #[inline]
            #[expect(clippy::allow_attributes, reason = "not every type is cast alike")]
            #[allow(clippy::cast_lossless, reason = "one body for every numeric type")]
            fn widened(self) -> f64 {
                self as f64
            }

            #[inline]
            #[expect(clippy::allow_attributes, reason = "not every type is cast alike")]
            #[allow(clippy::cast_lossless, reason = "one body for every numeric type")]
            fn narrowed(self) -> f32 {
                self as f32
            }
        }

        impl From<Vec<$type>> for NumericColumn {
            fn from(values: Vec<$type>) -> Self {
                Self::$variant(values.into())
            }
        }

        impl From<Column<$type>> for NumericColumn {
            fn from(values: Column<$type>) -> Self {
                Self::$variant(values)
            }
        })*
    };
}

numeric_column!(I8 i8, U8 u8, I16 i16, U16 u16, I32 i32, U32 u32, I64 i64, U64 u64, F32 f32, F64 f64);

impl NumericColumn {
    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Array {
    /// Appends the values of some tuples, little-endian.
    ///
    /// # Panics
    /// If there is no such tuple.
    pub fn append_tuples(&self, tuples: &[u32], bytes: &mut Vec<u8>) {
        self.values.append_tuples(self.components, tuples, bytes);
    }

    /// How many tuples there are.
    pub fn tuples(&self) -> usize {
        self.values.len() / self.components.max(1)
    }
}
