//! `NumberType`: the numeric types of files, and how their bytes and their text become columns.

use bytemuck::Pod;

use super::scratch::{Growing, Scratch, collect};
use crate::columns::{Column, NumericColumn, Points};
use crate::error::{Error, Result};

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

            /// Its name, as in Rust.
            pub(super) fn name(self) -> &'static str {
                match self { $(Self::$variant => stringify!($type)),* }
            }

            /// The type of that name.
            pub(super) fn by_name(name: &str) -> Option<Self> {
                match name { $(stringify!($type) => Some(Self::$variant),)* _ => None }
            }

            /// All whole values in the `bytes` bytes of `chunks`, one after the other.
            ///
            /// # Errors
            /// The first error of a chunk, or of the scratch.
            pub(super) fn decode<B: AsRef<[u8]>>(
                self,
                bytes: usize,
                chunks: impl IntoIterator<Item = Result<B>>,
                order: ByteOrder,
                scratch: &Scratch,
            ) -> Result<NumericColumn> {
                match self {
                    $(Self::$variant => {
                        let mut column = scratch.column::<$type>();
                        column.reserve(bytes / size_of::<$type>());
                        for_each_value(chunks, |value| {
                            column.push(match order {
                                ByteOrder::Little => <$type>::from_le_bytes(value),
                                ByteOrder::Big => <$type>::from_be_bytes(value),
                            })
                        })?;
                        Ok(NumericColumn::$variant(column.finish()?))
                    })*
                }
            }

            /// One value a token; `error` is told place and text of a token that is none of this type.
            pub(super) fn parse<'t>(
                self,
                tokens: impl Iterator<Item = &'t [u8]>,
                scratch: &Scratch,
                error: impl Fn(usize, &'t [u8]) -> Error,
            ) -> Result<NumericColumn> {
                match self {
                    $(Self::$variant => {
                        let value = |(i, token)| <$type as Token>::read(token).ok_or_else(|| error(i, token));
                        Ok(NumericColumn::$variant(collect(scratch, tokens.enumerate().map(value))?))
                    })*
                }
            }
        }

        /// The values of several columns one after the other: of their type where they share one, else widened.
        pub(super) fn concat(columns: &[&NumericColumn], scratch: &Scratch) -> Result<NumericColumn> {
            match columns {
                $([NumericColumn::$variant(_), ..]
                    if columns.iter().all(|column| matches!(column, NumericColumn::$variant(_))) =>
                {
                    let parts = columns.iter().filter_map(|column| match column {
                        NumericColumn::$variant(values) => Some(&values[..]),
                        _ => None,
                    });
                    let mut all = scratch.column::<$type>();
                    for part in parts {
                        all.extend(part.iter().copied())?;
                    }
                    Ok(NumericColumn::$variant(all.finish()?))
                })*
                _ => {
                    let mut all = scratch.column::<f64>();
                    for column in columns {
                        all.extend((0..column.len()).map(|i| column.get(i)))?;
                    }
                    Ok(NumericColumn::F64(all.finish()?))
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

/// Calls `each` with the bytes of every value, which may lie in two chunks; bytes that are no whole value are left out.
fn for_each_value<const SIZE: usize, B: AsRef<[u8]>>(
    chunks: impl IntoIterator<Item = Result<B>>,
    mut each: impl FnMut([u8; SIZE]) -> Result<()>,
) -> Result<()> {
    let (mut begun, mut begun_bytes) = ([0; SIZE], 0);
    for chunk in chunks {
        let chunk = chunk?;
        let mut bytes = chunk.as_ref();
        if begun_bytes > 0 {
            let missing = (SIZE - begun_bytes).min(bytes.len());
            begun[begun_bytes..][..missing].copy_from_slice(&bytes[..missing]);
            begun_bytes += missing;
            bytes = &bytes[missing..];
            if begun_bytes < SIZE {
                continue;
            }
            each(begun)?;
        }
        let (values, rest) = bytes.as_chunks();
        for &value in values {
            each(value)?;
        }
        begun[..rest.len()].copy_from_slice(rest);
        begun_bytes = rest.len();
    }
    Ok(())
}

/// Appends the whole numbers of type `T` of a column that holds only such from 0 to `limit`; `error` is told place and value of
/// another one.
pub(super) fn push_whole_numbers<T: TryFrom<u64> + Pod>(
    column: &NumericColumn,
    limit: u64,
    whole: &mut Growing<'_, T>,
    error: impl Fn(usize, i64) -> Error,
) -> Result<()> {
    whole.reserve(column.len());
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
        whole.push(value.ok_or_else(|| error(i, found))?)?;
    }
    Ok(())
}

/// [`push_whole_numbers`] as a column.
pub(super) fn whole_numbers<T: TryFrom<u64> + Pod>(
    column: &NumericColumn,
    limit: u64,
    scratch: &Scratch,
    error: impl Fn(usize, i64) -> Error,
) -> Result<Column<T>> {
    let mut whole = scratch.column();
    push_whole_numbers(column, limit, &mut whole, error)?;
    whole.finish()
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

    fn parse<'t>(number: NumberType, tokens: impl Iterator<Item = &'t [u8]>) -> Result<NumericColumn> {
        let error = |_, token: &[u8]| Error::NoCells { found: String::from_utf8_lossy(token).into_owned() };
        number.parse(tokens, &Scratch::memory(), error)
    }

    fn floats(text: &str) -> Vec<f64> {
        let column = parse(NumberType::F64, text.as_bytes().split(u8::is_ascii_whitespace)).unwrap();
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
        let one = |number, token: &'static str| parse(number, [token.as_bytes()].into_iter());
        for (number, token) in [(NumberType::U8, "256"), (NumberType::U8, "-1"), (NumberType::I32, "1.5")] {
            assert!(matches!(one(number, token), Err(Error::NoCells { found }) if found == token));
        }
        assert_eq!(one(NumberType::I32, "3.0").unwrap().get(0), 3.0);
        assert!(
            matches!(one(NumberType::U64, "18446744073709551615").unwrap(), NumericColumn::U64(v) if v[0] == u64::MAX)
        );
    }

    #[test]
    fn both_byte_orders_decode_wherever_the_bytes_are_cut() {
        let bytes = [0, 1, 2, 3, 4, 5, 6, 7, 8];
        for cut in 0..=bytes.len() {
            let (a, b) = bytes.split_at(cut);
            for (order, expected) in
                [(ByteOrder::Big, [0x0001_0203, 0x0405_0607]), (ByteOrder::Little, [0x0302_0100, 0x0706_0504])]
            {
                let chunks = [a, &[], b].map(Ok);
                let column = NumberType::I32.decode(bytes.len(), chunks, order, &Scratch::memory()).unwrap();
                assert!(matches!(&column, NumericColumn::I32(v) if v[..] == expected), "cut at {cut}");
            }
        }
    }

    #[test]
    fn columns_of_different_types_concatenate_widened() {
        let (a, b) = (NumericColumn::from(vec![1_u8]), NumericColumn::from(vec![2.5_f32]));
        let memory = Scratch::memory();
        assert_eq!(concat(&[&a, &a], &memory).unwrap().type_name(), "u8");
        assert_eq!(concat(&[&a, &b], &memory).unwrap().get(1), 2.5);
    }

    #[test]
    fn negative_indices_are_found() {
        let whole = |column: NumericColumn| {
            let error = |i, found| Error::NoCells { found: format!("{i}: {found}") };
            let whole = whole_numbers::<u8>(&column, 300, &Scratch::memory(), error);
            whole.map(|values| values.to_vec()).map_err(|error| match error {
                Error::NoCells { found } => found,
                other => other.to_string(),
            })
        };
        let is = |text: &str| Err(text.to_owned());
        assert_eq!(whole(vec![0_i32, -1].into()), is("1: -1"));
        assert_eq!(whole(vec![301_u64].into()), is("0: 301"));
        assert_eq!(whole(vec![256_u64].into()), is("0: 256"), "beyond the type");
        assert_eq!(whole(vec![0.5_f32].into()), is("0: 0"));
        assert_eq!(whole(vec![3_u8].into()), Ok(vec![3]));
    }
}
