//! `Layout`: how a PLOT3D file is written, which nothing in it says.
//!
//! Every way there is (text or binary, byte order, with Fortran's record marks or without, one block or several, precision,
//! with or without visibility) reads other dimensions from the first bytes and asks for another length. The way whose length
//! is the file's is taken. Lengths are bytes, in text words.

use super::super::numbers::{ByteOrder, NumberType};
use super::super::source::Source;
use super::words::{self, Survey, Words};
use super::{CONDITIONS, SOLUTION_VALUES};
use crate::error::Result;

/// Bytes of a record mark: the record's length, before and after it.
const MARK: usize = 4;
/// Bytes of an integer.
const INTEGER: usize = 4;
/// The bits of a number in single precision are those of a smaller integer only where it is denormal.
const DENORMAL_BELOW: usize = 1 << 23;
/// Most blocks that a message lists.
const MOST_SHOWN: usize = 4;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Text,
    Binary { order: ByteOrder, has_marks: bool },
}

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    Grid,
    Solution,
}

/// How a file is written, and its blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) form: Form,
    pub(super) content: Content,
    /// Whether a number of blocks comes first.
    pub(super) is_multi: bool,
    /// 3, or 2 for what is refused.
    axes: usize,
    /// Points along i, j and k of each block.
    pub(super) dims: Vec<[usize; 3]>,
    /// `F32` or `F64`.
    pub(super) real: NumberType,
    /// Whether the coordinates of a block are followed by an integer a point.
    pub(super) has_iblank: bool,
}

impl Layout {
    /// How many points each block has.
    pub(super) fn points(&self) -> impl Iterator<Item = usize> {
        self.dims.iter().map(|dims| dims.iter().product())
    }

    /// Values before those of the blocks: numbers of blocks and points.
    pub(super) fn header_values(&self) -> usize {
        usize::from(self.is_multi) + self.axes * self.dims.len()
    }

    /// Records before those of the blocks.
    pub(super) fn header_records(&self) -> usize {
        1 + usize::from(self.is_multi)
    }

    /// Bytes of a binary record with the values of `points` points.
    pub(super) fn block_bytes(&self, points: usize) -> usize {
        let visible = if self.has_iblank { INTEGER } else { 0 };
        match self.content {
            Content::Grid => points * (self.axes * self.real.size() + visible),
            Content::Solution => points * SOLUTION_VALUES * self.real.size(),
        }
    }

    /// The length of a whole file; none where there is no such number, or where a record is too long for its mark.
    fn length(&self) -> Option<u64> {
        let mut values = self.header_values() as u64;
        let (has_marks, real, integer) = match self.form {
            Form::Text => (false, 1, 1),
            Form::Binary { has_marks, .. } => (has_marks, self.real.size() as u64, INTEGER as u64),
        };
        values *= integer;
        let mut records = self.header_records();
        for dims in &self.dims {
            let points = dims.iter().try_fold(1_u64, |points, &along| points.checked_mul(along as u64))?;
            let visible = if self.has_iblank { integer } else { 0 };
            let point = match self.content {
                Content::Grid => self.axes as u64 * real + visible,
                Content::Solution => SOLUTION_VALUES as u64 * real,
            };
            let block = points.checked_mul(point)?;
            if has_marks && u32::try_from(block).is_err() {
                return None;
            }
            let conditions = if self.content == Content::Solution { CONDITIONS as u64 * real } else { 0 };
            values = values.checked_add(block)?.checked_add(conditions)?;
            records += if self.content == Content::Solution { 2 } else { 1 };
        }
        Some(if has_marks { values.checked_add((2 * MARK * records) as u64)? } else { values })
    }

    /// The layout, for a message.
    fn describe(&self) -> String {
        let visible = if self.has_iblank { ", IBlank" } else { "" };
        let precision = if self.real == NumberType::F64 { "double" } else { "single" };
        let form = match self.form {
            Form::Text => "text".to_owned(),
            Form::Binary { order, has_marks } => {
                let order = if order == ByteOrder::Big { "big" } else { "little" };
                let marks = if has_marks { "with" } else { "without" };
                format!("{order}-endian, {precision} precision, {marks} record marks")
            }
        };
        format!("{} ({form}{visible})", describe(&self.dims))
    }
}

/// Blocks, for a message.
pub(super) fn describe(dims: &[[usize; 3]]) -> String {
    let shown: Vec<String> = dims.iter().take(MOST_SHOWN).map(|dims| dims.map(|n| n.to_string()).join("x")).collect();
    let more = if dims.len() > MOST_SHOWN { ", …" } else { "" };
    let blocks = if dims.len() == 1 { "1 block".to_owned() } else { format!("{} blocks", dims.len()) };
    format!("{blocks} of {}{more} points", shown.join(", "))
}

/// The layout of a grid with three dimensions.
pub(super) fn of_grid(bytes: &[u8], source: Source<'_>) -> Result<Layout> {
    match find(bytes, Content::Grid, source) {
        Ok(layout) if layout.axes == 2 => {
            Err(source.unsupported("a two-dimensional PLOT3D grid", "cellfan draws cells with a volume"))
        }
        Ok(layout) => Ok(layout),
        Err(_) if find(bytes, Content::Solution, source).is_ok() => {
            let advice = "name its grid: a solution beside it is found by its name";
            Err(source.unsupported("a PLOT3D solution", advice))
        }
        Err(error) => Err(error),
    }
}

/// The layout of the solution of `grid`. Bytes may follow it if it is written as its grid is: real files have some.
pub(super) fn of_solution(bytes: &[u8], grid: &Layout, source: Source<'_>) -> Result<Layout> {
    let error = match find(bytes, Content::Solution, source) {
        Ok(layout) => return Ok(layout),
        Err(error) => error,
    };
    let extent = Extent::of(bytes);
    let real = extent.reals.iter().copied().find(|&real| real == grid.real).unwrap_or(extent.reals[0]);
    let layout = Layout { content: Content::Solution, has_iblank: false, real, ..grid.clone() };
    let left = layout.length().and_then(|needed| extent.length.checked_sub(needed));
    let is_of_grid = dims(bytes, grid.form, grid.is_multi, 3).is_some_and(|dims| dims == grid.dims);
    match left.filter(|_| is_of_grid && (grid.form == Form::Text) == extent.is_text) {
        Some(left) => {
            tracing::warn!(file = %source.path.display(), "{left} {} follow the solution, ignored", extent.unit());
            Ok(layout)
        }
        None => Err(error),
    }
}

/// How long a file is.
struct Extent {
    is_text: bool,
    /// In bytes; in words where it is text.
    length: u64,
    /// The precisions that it may have.
    reals: &'static [NumberType],
}

impl Extent {
    fn of(bytes: &[u8]) -> Self {
        if !words::is_text(bytes) {
            let reals = &[NumberType::F32, NumberType::F64];
            return Self { is_text: false, length: bytes.len() as u64, reals };
        }
        let Survey { words: length, needs_double } = words::survey(bytes);
        let reals = if needs_double { &[NumberType::F64] } else { &[NumberType::F32] };
        Self { is_text: true, length, reals }
    }

    fn unit(&self) -> &'static str {
        if self.is_text { "numbers" } else { "bytes" }
    }
}

/// The layout that gives the length of the file.
fn find(bytes: &[u8], content: Content, source: Source<'_>) -> Result<Layout> {
    let extent = Extent::of(bytes);
    let Extent { length, reals, .. } = extent;
    let mut nearest: Option<(u64, Layout)> = None;
    for header in headers(bytes, extent.is_text, content) {
        for &real in reals {
            for has_iblank in [false, true] {
                let layout = Layout { real, has_iblank, ..header.clone() };
                if has_iblank && content == Content::Solution {
                    continue;
                }
                let Some(needed) = layout.length() else { continue };
                if needed == length {
                    return Ok(layout);
                }
                let off = needed.abs_diff(length);
                if off <= length && nearest.as_ref().is_none_or(|(least, _)| off < *least) {
                    nearest = Some((off, layout));
                }
            }
        }
    }
    let what = if content == Content::Grid { "grid" } else { "solution" };
    let unit = extent.unit();
    let problem = match nearest.and_then(|(_, layout)| Some((layout.length()?, layout.describe()))) {
        Some((needed, layout)) => format!(
            "no PLOT3D {what} has this length; the nearest, {layout}, takes {needed} {unit}, the file has {length}: damaged, \
             truncated, or followed by something else"
        ),
        None => format!("its first numbers are no dimensions of a PLOT3D {what} of this length"),
    };
    Err(source.malformed(format!("its {length} {unit}"), problem))
}

/// What the file's first numbers say if it is written in each of the ways, three dimensions before two; precision and
/// visibility are still open.
fn headers(bytes: &[u8], is_text: bool, content: Content) -> Vec<Layout> {
    let orders = [ByteOrder::Little, ByteOrder::Big];
    let binary = |has_marks: bool| orders.map(|order| Form::Binary { order, has_marks });
    let forms = if is_text { vec![Form::Text] } else { [binary(true), binary(false)].concat() };
    let axes = if content == Content::Grid { &[3, 2][..] } else { &[3] };
    let mut headers = Vec::new();
    for &axes in axes {
        for &form in &forms {
            for is_multi in [false, true] {
                if let Some(dims) = dims(bytes, form, is_multi, axes) {
                    let (real, has_iblank) = (NumberType::F32, false);
                    headers.push(Layout { form, content, is_multi, axes, dims, real, has_iblank });
                }
            }
        }
    }
    // A part of one file could pass for a whole one that is written in another way. But none begins by chance with record
    // marks that are right, or with as many numbers of points as it has blocks: as coordinates these would be denormal.
    let is_marked = |layout: &Layout| matches!(layout.form, Form::Binary { has_marks: true, .. });
    let is_multi = |layout: &Layout| layout.is_multi && layout.dims.as_flattened().iter().all(|&n| n < DENORMAL_BELOW);
    if headers.iter().any(is_marked) {
        headers.retain(is_marked);
    } else if headers.iter().any(is_multi) {
        headers.retain(is_multi);
    }
    headers
}

/// The dimensions of all blocks; none where a number is not positive or a record mark is wrong.
fn dims(bytes: &[u8], form: Form, is_multi: bool, axes: usize) -> Option<Vec<[usize; 3]>> {
    let mut integers = Integers { bytes, form, position: 0, words: Words::new(bytes) };
    let mut blocks = 1;
    if is_multi {
        integers.mark(INTEGER)?;
        blocks = integers.next()?;
        integers.mark(INTEGER)?;
    }
    // Each has a byte at least.
    if blocks > bytes.len() / axes {
        return None;
    }
    integers.mark(axes * blocks * INTEGER)?;
    let mut dims = Vec::new();
    for _ in 0..blocks {
        let mut along = [1; 3];
        for along in &mut along[..axes] {
            *along = integers.next()?;
        }
        dims.push(along);
    }
    integers.mark(axes * blocks * INTEGER)?;
    Some(dims)
}

/// The integers at the beginning of a file.
struct Integers<'a> {
    bytes: &'a [u8],
    form: Form,
    position: usize,
    words: Words<'a>,
}

impl Integers<'_> {
    /// The next number, which is positive.
    fn next(&mut self) -> Option<usize> {
        let number = match self.form {
            Form::Text => std::str::from_utf8(self.words.next()?.1).ok()?.parse().ok()?,
            Form::Binary { order, .. } => self.binary(order)?,
        };
        usize::try_from(number).ok().filter(|&number| number > 0)
    }

    /// Goes over a mark of a record of `bytes` bytes, where there are marks.
    fn mark(&mut self, bytes: usize) -> Option<()> {
        match self.form {
            Form::Binary { order, has_marks: true } => {
                let found = self.binary(order)?;
                (usize::try_from(found) == Ok(bytes)).then_some(())
            }
            _ => Some(()),
        }
    }

    fn binary(&mut self, order: ByteOrder) -> Option<i32> {
        let bytes: [u8; INTEGER] = *self.bytes.get(self.position..)?.first_chunk()?;
        self.position += INTEGER;
        Some(if order == ByteOrder::Big { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) })
    }
}
