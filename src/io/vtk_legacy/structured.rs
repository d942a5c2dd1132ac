//! `DATASET STRUCTURED_GRID`, `DATASET RECTILINEAR_GRID` and `DATASET STRUCTURED_POINTS`.

use super::super::assemble::{GHOST_TYPE, HIDDEN_POINT};
use super::super::expansion::Expansion;
use super::super::numbers::points_from;
use super::super::scratch::collect;
use super::super::structured::{cells_of, points_of};
use super::super::{StructuredMesh, rectilinear, volume};
use super::attributes::Attributes;
use super::cursor::Cursor;
use super::read_common;
use crate::columns::{Array, Association, Lattice, NumericColumn, Points, Volume};
use crate::error::Result;

/// Reads the sections of a structured grid after the head of the file.
pub(super) fn read_structured(cursor: &mut Cursor<'_>) -> Result<StructuredMesh> {
    let mut grid = Grid::default();
    let mut points = None;
    let mut blanked = None;
    while let Some(keyword) = cursor.next_keyword() {
        match keyword.as_str() {
            "DIMENSIONS" => grid.read_dims(cursor)?,
            "POINTS" => {
                let count = cursor.count("the number of points")?;
                let number = cursor.number_type()?;
                points = Some(points_from(&cursor.tuples(number, count, 3)?));
            }
            "BLANKING" => {
                let count = cursor.count("the number of points")?;
                let number = cursor.number_type()?;
                blanked = Some(hidden_points(&cursor.tuples(number, count, 1)?, cursor)?);
            }
            _ => read_common(&keyword, &mut grid.attributes, cursor)?,
        }
    }
    let points = points.ok_or_else(|| cursor.malformed("there are no POINTS: damaged or truncated"))?;
    grid.finish(points, blanked, cursor)
}

/// Reads the sections of a rectilinear grid after the head of a file of `file_len` bytes.
pub(super) fn read_rectilinear(cursor: &mut Cursor<'_>, file_len: usize) -> Result<StructuredMesh> {
    const KEYWORDS: [&str; 3] = ["X_COORDINATES", "Y_COORDINATES", "Z_COORDINATES"];
    let mut grid = Grid::default();
    let mut axes = [None, None, None];
    while let Some(keyword) = cursor.next_keyword() {
        match KEYWORDS.iter().position(|axis| *axis == keyword) {
            Some(axis) => {
                let count = cursor.count("the number of coordinates")?;
                let number = cursor.number_type()?;
                axes[axis] = Some(cursor.tuples(number, count, 1)?);
            }
            None if keyword == "DIMENSIONS" => grid.read_dims(cursor)?,
            None => read_common(&keyword, &mut grid.attributes, cursor)?,
        }
    }
    let [Some(x), Some(y), Some(z)] = &axes else {
        let missing = KEYWORDS.iter().zip(&axes).find(|(_, axis)| axis.is_none()).map_or("", |(keyword, _)| keyword);
        return Err(cursor.malformed(format!("there are no {missing}: damaged or truncated")));
    };
    let found = [x, y, z].map(NumericColumn::len);
    if found != grid.dims {
        let problem = format!("are {:?}, but there are {found:?} coordinates: damaged or truncated", grid.dims);
        return Err(cursor.source.malformed("DIMENSIONS", problem));
    }
    let points = rectilinear::points([x, y, z], &Expansion::of(file_len))
        .map_err(|problem| cursor.source.malformed("DIMENSIONS", problem))?;
    grid.finish(points, None, cursor)
}

/// Reads the sections of a regular grid after the head of a file of `file_len` bytes.
pub(super) fn read_points(cursor: &mut Cursor<'_>, file_len: usize) -> Result<Volume> {
    let mut grid = Grid::default();
    let (mut origin, mut spacing) = ([0.0; 3], [1.0; 3]);
    while let Some(keyword) = cursor.next_keyword() {
        match keyword.as_str() {
            "DIMENSIONS" => grid.read_dims(cursor)?,
            "ORIGIN" => origin = cursor.coordinates("the origin")?,
            // Its name in files of version 1.0.
            "SPACING" | "ASPECT_RATIO" => spacing = cursor.coordinates("the spacing")?,
            _ => read_common(&keyword, &mut grid.attributes, cursor)?,
        }
    }
    let (Grid { dims, attributes }, source) = (grid, cursor.source);
    let too_many = || source.malformed("DIMENSIONS", format!("{dims:?} points cannot be: damaged"));
    let points = points_of(dims).ok_or_else(too_many)?;
    let arrays = attributes.into_arrays(points, cells_of(dims), source)?;
    volume::check_bare(points, &arrays, &Expansion::of(file_len))
        .map_err(|problem| source.malformed("DIMENSIONS", problem))?;
    volume::of_file(dims, Lattice::new(origin.into(), spacing.into()), arrays, "DIMENSIONS, SPACING and ORIGIN", source)
}

/// What all kinds have.
#[derive(Default)]
struct Grid {
    dims: [usize; 3],
    attributes: Attributes,
}

impl Grid {
    fn read_dims(&mut self, cursor: &mut Cursor<'_>) -> Result<()> {
        for along in &mut self.dims {
            *along = cursor.count("the number of points along an axis")?;
        }
        Ok(())
    }

    fn finish(self, points: Points, blanked: Option<Array>, cursor: &Cursor<'_>) -> Result<StructuredMesh> {
        let Self { dims, attributes } = self;
        let source = cursor.source;
        if points_of(dims) != Some(points.len()) {
            let problem = format!("are {dims:?}, but there are {} points: damaged or truncated", points.len());
            return Err(source.malformed("DIMENSIONS", problem));
        }
        let mut arrays = attributes.into_arrays(points.len(), cells_of(dims), source)?;
        arrays.extend(blanked);
        StructuredMesh::new(&[dims], points, arrays).map_err(|error| error.in_file(source.path))
    }
}

/// `BLANKING` as the array that VTK makes of it: points of value 0 are hidden.
fn hidden_points(visible: &NumericColumn, cursor: &Cursor<'_>) -> Result<Array> {
    let types = (0..visible.len()).map(|i| Ok(if visible.get(i) == 0.0 { HIDDEN_POINT } else { 0 }));
    let values = collect(cursor.source.scratch, types)?.into();
    Ok(Array { name: GHOST_TYPE.to_owned(), association: Association::Point, components: 1, values })
}
