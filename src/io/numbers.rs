//! `NumberType`: the numeric types of files, and how their bytes and their text become columns.

use crate::columns::{NumericColumn, Points};

/// The order of a number's bytes in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

macro_rules! number_types {
    ($($variant:ident $type:ty),*) => {
        /// A numeric type of a file.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum NumberType {
            $($variant),*
        }

        impl NumberType {
            /// Bytes a value.
            pub(super) fn size(self) -> usize {
                match self { $(Self::$variant => size_of::<$type>()),* }
            }

            /// All whole values in `bytes`.
            pub(super) fn decode(self, bytes: &[u8], order: ByteOrder) -> NumericColumn {
                match self {
                    $(Self::$variant => {
                        let values = bytes.chunks_exact(size_of::<$type>()).map(|value| {
                            let value = value.try_into().unwrap_or_default();
                            match order {
                                ByteOrder::Little => <$type>::from_le_bytes(value),
                                ByteOrder::Big => <$type>::from_be_bytes(value),
                            }
                        });
                        values.collect::<Vec<$type>>().into()
                    })*
                }
            }

            /// One value a token; the token that is none of this type is the error.
            pub(super) fn parse<'t>(self, tokens: impl Iterator<Item = &'t [u8]>) -> Result<NumericColumn, &'t [u8]> {
                match self {
                    $(Self::$variant => {
                        let values = tokens.map(|token| <$type as Token>::read(token).ok_or(token));
                        Ok(values.collect::<Result<Vec<$type>, _>>()?.into())
                    })*
                }
            }
        }

        /// The values of several columns one after the other: of their type where they share one, else widened.
        pub(super) fn concat(columns: &[&NumericColumn]) -> NumericColumn {
            match columns {
                $([NumericColumn::$variant(_), ..]
                    if columns.iter().all(|column| matches!(column, NumericColumn::$variant(_))) =>
                {
                    let parts = columns.iter().filter_map(|column| match column {
                        NumericColumn::$variant(values) => Some(&values[..]),
                        _ => None,
                    });
                    parts.flatten().copied().collect::<Vec<$type>>().into()
                })*
                _ => {
                    let values = columns.iter().flat_map(|column| (0..column.len()).map(|i| column.get(i)));
                    values.collect::<Vec<f64>>().into()
                }
            }
        }

        /// The tuples `tuples` of a column of `components` values each; what lies outside the column is left out.
        pub(super) fn gather(column: &NumericColumn, components: usize, tuples: &[u32]) -> NumericColumn {
            match column {
                $(NumericColumn::$variant(values) => {
                    let tuple = |&tuple: &u32| values.get(tuple as usize * components..)?.get(..components);
                    tuples.iter().filter_map(tuple).flatten().copied().collect::<Vec<$type>>().into()
                })*
            }
        }

        /// The bytes of the values `range` of a column, little-endian.
        ///
        /// # Panics
        /// If the range goes beyond the column.
        pub(super) fn little_endian(column: &NumericColumn, range: std::ops::Range<usize>) -> Vec<u8> {
            match column {
                $(NumericColumn::$variant(values) => values[range].iter().flat_map(|v| v.to_le_bytes()).collect()),*
            }
        }

        /// The type of a column's values.
        pub(super) fn type_of(column: &NumericColumn) -> NumberType {
            match column { $(NumericColumn::$variant(_) => NumberType::$variant),* }
        }
    };
}

number_types!(I8 i8, U8 u8, I16 i16, U16 u16, I32 i32, U32 u32, I64 i64, U64 u64, F32 f32, F64 f64);

/// Points out of a column of three coordinates each; single precision stays so.
pub(super) fn points_from(column: &NumericColumn) -> Points {
    match column {
        NumericColumn::F32(values) => Points::F32(values.as_chunks().0.to_vec()),
        NumericColumn::F64(values) => Points::F64(values.as_chunks().0.to_vec()),
        _ => Points::F64((0..column.len() / 3).map(|i| [0, 1, 2].map(|axis| column.get(3 * i + axis))).collect()),
    }
}

/// Whole numbers of type `T` out of a column that holds only such from 0 to `limit`; the first other one is the error.
pub(super) fn whole_numbers<T: TryFrom<u64>>(column: &NumericColumn, limit: u64) -> Result<Vec<T>, (usize, i64)> {
    // Of the size it will have (offsets get a 0 in front): what is collected while it may fail takes three times as much.
    let mut whole = Vec::with_capacity(column.len() + 1);
    for i in 0..column.len() {
        let (value, found) = match column {
            NumericColumn::I64(values) => (u64::try_from(values[i]).ok(), values[i]),
            NumericColumn::U64(values) => (Some(values[i]), i64::try_from(values[i]).unwrap_or(i64::MAX)),
            _ => {
                let value = column.get(i);
                ((value.fract() == 0.0 && value >= 0.0).then_some(value as u64), value as i64)
            }
        };
        let value = value.filter(|&value| value <= limit).and_then(|value| T::try_from(value).ok());
        whole.push(value.ok_or((i, found))?);
    }
    Ok(whole)
}

/// A number in text.
trait Token: Sized {
    fn read(token: &[u8]) -> Option<Self>;
}

macro_rules! integer_tokens {
    ($($type:ty),*) => {
        $(impl Token for $type {
            fn read(token: &[u8]) -> Option<Self> {
                let text = std::str::from_utf8(token).ok()?;
                text.parse().ok().or_else(|| {
                    // "3.0" and "1e3" are whole numbers too; beyond 2^53 they would not be exact.
                    let value: f64 = text.parse().ok()?;
                    let whole = value.fract() == 0.0 && value.abs() < 9.0e15;
                    if whole { Self::try_from(value as i64).ok() } else { None }
                })
            }
        })*
    };
}

integer_tokens!(i8, u8, i16, u16, i32, u32, i64, u64);

macro_rules! float_tokens {
    ($($type:ty),*) => {
        $(impl Token for $type {
            fn read(token: &[u8]) -> Option<Self> {
                let text = std::str::from_utf8(token).ok()?;
                text.parse().ok().or_else(|| unusual_float(text)?.parse().ok())
            }
        })*
    };
}

float_tokens!(f32, f64);

/// What C libraries and Fortran print and Rust does not read: `nan(ind)`, `1.#QNAN`, `-1.#INF`, `1.0D+03`.
fn unusual_float(text: &str) -> Option<String> {
    let lower = text.to_ascii_lowercase();
    let (sign, digits) = lower.strip_prefix('-').map_or(("", lower.as_str()), |rest| ("-", rest));
    let digits = digits.strip_prefix('+').unwrap_or(digits);
    if digits.starts_with("nan") || digits.starts_with("1.#qnan") || digits.starts_with("1.#ind") {
        return Some("nan".to_owned());
    }
    if digits.starts_with("1.#inf") {
        return Some(format!("{sign}inf"));
    }
    lower.contains('d').then(|| lower.replace('d', "e"))
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "values are read bit for bit")]
mod tests {
    use super::*;

    fn floats(text: &str) -> Vec<f64> {
        let column = NumberType::F64.parse(text.as_bytes().split(u8::is_ascii_whitespace)).unwrap();
        (0..column.len()).map(|i| column.get(i)).collect()
    }

    #[test]
    fn text_of_other_libraries_is_read() {
        let values = floats("1.5 -inf NaN nan(ind) -1.#INF 1.#QNAN 1.5D+03 +2");
        assert_eq!(
            [values[0], values[1], values[4], values[6], values[7]],
            [1.5, -f64::INFINITY, -f64::INFINITY, 1500.0, 2.0]
        );
        assert!(values[2].is_nan() && values[3].is_nan() && values[5].is_nan());
    }

    #[test]
    fn integers_out_of_range_are_refused_and_whole_floats_read() {
        assert_eq!(NumberType::U8.parse([&b"256"[..]].into_iter()).unwrap_err(), b"256");
        assert_eq!(NumberType::U8.parse([&b"-1"[..]].into_iter()).unwrap_err(), b"-1");
        assert_eq!(NumberType::I32.parse([&b"1.5"[..]].into_iter()).unwrap_err(), b"1.5");
        assert_eq!(NumberType::I32.parse([&b"3.0"[..]].into_iter()).unwrap().get(0), 3.0);
        assert!(
            matches!(&NumberType::U64.parse([&b"18446744073709551615"[..]].into_iter()).unwrap(), NumericColumn::U64(v) if v[0] == u64::MAX)
        );
    }

    #[test]
    fn both_byte_orders_decode() {
        assert_eq!(NumberType::I16.decode(&[1, 2, 3], ByteOrder::Big).get(0), 258.0);
        assert_eq!(NumberType::I16.decode(&[1, 2, 3], ByteOrder::Little).get(0), 513.0);
    }

    #[test]
    fn columns_of_different_types_concatenate_widened() {
        let (a, b) = (NumericColumn::from(vec![1_u8]), NumericColumn::from(vec![2.5_f32]));
        assert_eq!(concat(&[&a, &a]).type_name(), "u8");
        assert_eq!(concat(&[&a, &b]).get(1), 2.5);
    }

    #[test]
    fn negative_indices_are_found() {
        let whole = |column: NumericColumn| whole_numbers::<u8>(&column, 300);
        assert_eq!(whole(vec![0_i32, -1].into()), Err((1, -1)));
        assert_eq!(whole(vec![301_u64].into()), Err((0, 301)));
        assert_eq!(whole(vec![256_u64].into()), Err((0, 256)), "beyond the type");
        assert_eq!(whole(vec![0.5_f32].into()), Err((0, 0)));
        assert_eq!(whole(vec![3_u8].into()), Ok(vec![3]));
    }
}
