//! What the grids of all kinds have in common: the way to their element, points and arrays of a piece.

use super::super::MOST_ARRAYS;
use super::super::mapping::Mapped;
use super::super::numbers::points_from;
use super::super::source::Source;
use super::document::{Element, parse, split_appended};
use super::encoding::{Encoding, is_numeric};
use crate::columns::{Array, Association, Points};
use crate::error::{Result, without_controls};

/// Hands the element of the grid of kind `kind` in a file to `read`, and how the file's arrays are encoded.
pub(in crate::io) fn read_grid<T>(
    bytes: &[u8],
    kind: &str,
    source: Source<'_>,
    read: impl FnOnce(&Element<'_>, &Encoding<'_>) -> Result<T>,
) -> Result<T> {
    read_mapped(bytes, None, kind, source, read)
}

/// As [`read_grid`]; arrays may be used in place of `mapped`, whose bytes these are.
pub(in crate::io) fn read_mapped<T>(
    bytes: &[u8],
    mapped: Option<&Mapped>,
    kind: &str,
    source: Source<'_>,
    read: impl FnOnce(&Element<'_>, &Encoding<'_>) -> Result<T>,
) -> Result<T> {
    let (xml, appended) = split_appended(bytes);
    let text = String::from_utf8_lossy(xml);
    let root = parse(&text, xml.len() < bytes.len(), source)?;
    let grid = grid_of(&root, kind, source)?;
    read(grid, &Encoding::new(&root, appended, bytes.len(), source)?.in_place(mapped))
}

/// The element `kind` in the root of a file of that kind.
pub(in crate::io) fn grid_of<'e, 'a>(root: &'e Element<'a>, kind: &str, source: Source<'_>) -> Result<&'e Element<'a>> {
    super::check_root(root, kind, source)?;
    let missing = || source.malformed(root.place(), format!("holds no <{kind}>: damaged or truncated"));
    root.child(kind).ok_or_else(missing)
}

/// The child element of that name.
pub(in crate::io) fn child<'e, 'a>(
    element: &'e Element<'a>,
    name: &str,
    source: Source<'_>,
) -> Result<&'e Element<'a>> {
    element.child(name).ok_or_else(|| source.malformed(element.place(), format!("holds no <{name}>")))
}

/// `tuples` times `components`, where the product exists.
fn values_of(array: &Element<'_>, tuples: usize, components: usize, source: Source<'_>) -> Result<usize> {
    tuples
        .checked_mul(components)
        .ok_or_else(|| source.malformed(array.place(), format!("{tuples} tuples of {components} values cannot be")))
}

/// The points of a piece that has them one by one.
pub(in crate::io) fn points(
    piece: &Element<'_>,
    point_count: usize,
    encoding: &Encoding<'_>,
    source: Source<'_>,
) -> Result<Points> {
    let array = child(child(piece, "Points", source)?, "DataArray", source)?;
    let components = array.count("NumberOfComponents", Some(3), source)?;
    if components != 3 {
        return Err(source.malformed(array.place(), format!("points have {components} coordinates, not 3")));
    }
    Ok(points_from(&encoding.values(array, Some(values_of(array, point_count, 3, source)?))?))
}

/// All arrays of a piece.
pub(in crate::io) fn arrays(
    piece: &Element<'_>,
    points: usize,
    cells: usize,
    encoding: &Encoding<'_>,
    source: Source<'_>,
) -> Result<Vec<Array>> {
    let mut arrays = Vec::new();
    for (name, association, tuples) in
        [("PointData", Association::Point, points), ("CellData", Association::Cell, cells)]
    {
        if let Some(data) = piece.child(name) {
            arrays.extend(read_arrays(data, association, tuples, encoding, source)?);
        }
    }
    Ok(arrays)
}

fn read_arrays(
    data: &Element<'_>,
    association: Association,
    tuples: usize,
    encoding: &Encoding<'_>,
    source: Source<'_>,
) -> Result<Vec<Array>> {
    let mut arrays: Vec<Array> = Vec::new();
    for element in data.children_named("DataArray") {
        let name = without_controls(element.attribute("Name").unwrap_or("unnamed").to_owned());
        if !is_numeric(element) {
            tracing::debug!(name, "the array holds no numbers, left out");
            continue;
        }
        if arrays.iter().any(|array| array.name == name) {
            tracing::warn!(name, "there are several arrays of this name, the first is used");
            continue;
        }
        if arrays.len() == MOST_ARRAYS {
            return Err(source.malformed(data.place(), format!("holds more than {MOST_ARRAYS} arrays; leave some out")));
        }
        let components = element.count("NumberOfComponents", Some(1), source)?.max(1);
        let values = encoding.values(element, Some(values_of(element, tuples, components, source)?))?;
        arrays.push(Array { name, association, components, values });
    }
    Ok(arrays)
}
