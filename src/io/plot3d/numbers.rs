//! `Numbers`: the numbers behind the header of a PLOT3D file, in sequence.

use bytemuck::Pod;

use super::super::numbers::NumberType;
use super::super::source::{Source, quote};
use super::layout::{Form, Layout};
use super::words::Words;
use crate::columns::{Column, NumericColumn};
use crate::error::Result;

/// A type of the numbers.
pub(super) trait Number: Pod {
    const TYPE: NumberType;
    /// The values of a column that was read as this type.
    fn of(column: NumericColumn) -> Column<Self>;
}

macro_rules! numbers {
    ($($type:ty, $variant:ident);*) => {
        $(impl Number for $type {
            const TYPE: NumberType = NumberType::$variant;

            fn of(column: NumericColumn) -> Column<Self> {
                match column {
                    NumericColumn::$variant(values) => values,
                    _ => unreachable!("columns have the type they are read as"),
                }
            }
        })*
    };
}

numbers!(i32, I32; f32, F32; f64, F64);

/// Where the reader is in a file.
pub(super) struct Numbers<'a> {
    bytes: &'a [u8],
    form: Form,
    position: usize,
    words: Words<'a>,
    source: Source<'a>,
}

impl<'a> Numbers<'a> {
    /// The numbers of a file with this layout, from the first block on.
    pub(super) fn after_header(bytes: &'a [u8], layout: &Layout, source: Source<'a>) -> Self {
        let mut words = Words::new(bytes);
        let mut position = 0;
        match layout.form {
            Form::Text => drop(words.by_ref().take(layout.header_values()).last()),
            Form::Binary { has_marks, .. } => {
                let marks = if has_marks { 2 * layout.header_records() } else { 0 };
                position = 4 * (layout.header_values() + marks);
            }
        }
        Self { bytes, form: layout.form, position, words, source }
    }

    /// The next `count` numbers.
    pub(super) fn take<T: Number>(&mut self, count: usize) -> Result<Column<T>> {
        self.numbers(T::TYPE, count).map(T::of)
    }

    /// Goes over the mark before or after a record of `bytes` bytes, where there are marks.
    pub(super) fn mark(&mut self, bytes: usize) -> Result<()> {
        if !matches!(self.form, Form::Binary { has_marks: true, .. }) {
            return Ok(());
        }
        let place = format!("byte {}", self.position);
        let found = self.take::<i32>(1)?[0];
        if u32::try_from(bytes) == Ok(found as u32) {
            return Ok(());
        }
        Err(self
            .source
            .malformed(place, format!("a record mark says {found} bytes where the record has {bytes}: damaged")))
    }

    fn numbers(&mut self, number: NumberType, count: usize) -> Result<NumericColumn> {
        let source = self.source;
        match self.form {
            Form::Text => {
                // Whoever counts the words has found these; where one is no number, the place is that of the word.
                let ahead = self.words.clone();
                let words = self.words.by_ref().take(count).map(|(_, word)| word);
                number.parse(words, source.scratch, |i, word| {
                    let byte = ahead.clone().nth(i).map_or(0, |(byte, _)| byte);
                    source.malformed(format!("byte {byte}"), format!("{} where a number is expected", quote(word)))
                })
            }
            Form::Binary { order, .. } => {
                let size = count * number.size();
                let rest = self.bytes.get(self.position..).unwrap_or_default();
                let taken = rest.get(..size).ok_or_else(|| {
                    source.malformed(format!("byte {}", self.position), format!("{size} bytes are needed: truncated"))
                })?;
                self.position += size;
                number.decode(size, [Ok(taken)], order, source.scratch)
            }
        }
    }
}
