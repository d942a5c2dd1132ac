//! `POINT_DATA` and `CELL_DATA`: the arrays of a legacy file.

use super::super::MOST_ARRAYS;
use super::super::numbers::NumberType;
use super::super::source::Source;
use super::cursor::{Cursor, DataType};
use crate::columns::{Array, Association, NumericColumn};
use crate::error::Result;

/// The arrays read so far, and what the next ones belong to.
#[derive(Debug, Default)]
pub(super) struct Attributes {
    arrays: Vec<Array>,
    /// What each `POINT_DATA` and `CELL_DATA` section declared.
    declared: Vec<(Association, usize)>,
}

impl Attributes {
    /// Whether no `POINT_DATA` or `CELL_DATA` section has begun.
    pub(super) fn is_outside(&self) -> bool {
        self.declared.is_empty()
    }

    /// Reads the section that `keyword` begins.
    pub(super) fn read(&mut self, keyword: &str, cursor: &mut Cursor<'_>) -> Result<()> {
        match keyword {
            "POINT_DATA" => self.declared.push((Association::Point, cursor.count("the number of points")?)),
            "CELL_DATA" => self.declared.push((Association::Cell, cursor.count("the number of cells")?)),
            _ => {
                let Some(&(association, tuples)) = self.declared.last() else {
                    let problem = format!("{keyword:?} is no section of this kind of dataset; the file may be damaged");
                    return Err(cursor.malformed(problem));
                };
                self.read_array(keyword, association, tuples, cursor)?;
            }
        }
        Ok(())
    }

    fn read_array(
        &mut self,
        keyword: &str,
        association: Association,
        tuples: usize,
        cursor: &mut Cursor<'_>,
    ) -> Result<()> {
        match keyword {
            "FIELD" => return self.read_field(association, tuples, cursor),
            "LOOKUP_TABLE" => {
                cursor.name()?;
                let entries = cursor.count("the size of the lookup table")?;
                return colors(cursor, entries, 4).map(drop);
            }
            _ => {}
        }
        let fixed = match keyword {
            "SCALARS" | "COLOR_SCALARS" | "TEXTURE_COORDINATES" => None,
            "VECTORS" | "NORMALS" => Some(3),
            "TENSORS" => Some(9),
            "TENSORS6" => Some(6),
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => Some(1),
            _ => return Err(cursor.malformed(format!("{keyword:?} is no kind of array; the file may be damaged"))),
        };
        let name = cursor.name()?;
        let (components, values) = match (keyword, fixed) {
            ("COLOR_SCALARS", _) => {
                let components = cursor.count("the number of components")?;
                (components, colors(cursor, tuples, components)?)
            }
            ("TEXTURE_COORDINATES", _) => {
                let components = cursor.count("the number of components")?;
                let data = cursor.number_type()?;
                (components, cursor.tuples(data, tuples, components)?)
            }
            ("SCALARS", _) => {
                let data = cursor.number_type()?;
                let components = scalar_components(cursor)?;
                if cursor.next_is("LOOKUP_TABLE") {
                    cursor.next_keyword();
                    cursor.name()?;
                }
                (components, cursor.tuples(data, tuples, components)?)
            }
            (_, fixed) => {
                let components = fixed.unwrap_or(1);
                let data = cursor.data_type()?;
                if data == DataType::Text {
                    return cursor.skip_strings(tuples);
                }
                (components, cursor.tuples(data, tuples, components)?)
            }
        };
        self.add(Array { name, association, components, values }, tuples, cursor)
    }

    fn read_field(&mut self, association: Association, tuples: usize, cursor: &mut Cursor<'_>) -> Result<()> {
        for_each_field_array(cursor, |name, components, values, cursor| {
            self.add(Array { name, association, components, values }, tuples, cursor)
        })
    }

    fn add(&mut self, array: Array, tuples: usize, cursor: &Cursor<'_>) -> Result<()> {
        let Array { name, association, components, values } = &array;
        if *components == 0 || values.len() != tuples.saturating_mul(*components) {
            tracing::warn!(name, "the field's array has not one tuple for each point or cell, left out");
        } else if self.arrays.iter().any(|other| other.name == *name && other.association == *association) {
            tracing::warn!(name, "there are several arrays of this name, the first is used");
        } else if self.arrays.len() == MOST_ARRAYS {
            return Err(cursor.malformed(format!("the file holds more than {MOST_ARRAYS} arrays; leave some out")));
        } else {
            self.arrays.push(array);
        }
        Ok(())
    }

    /// The arrays, once the number of points and cells is known.
    pub(super) fn into_arrays(self, points: usize, cells: usize, source: Source<'_>) -> Result<Vec<Array>> {
        for (association, declared) in self.declared {
            let (section, expected) = match association {
                Association::Point => ("POINT_DATA", points),
                Association::Cell => ("CELL_DATA", cells),
            };
            if declared != expected {
                let problem = format!("is for {declared}, but the mesh has {expected}: damaged or truncated");
                return Err(source.malformed(section, problem));
            }
        }
        Ok(self.arrays)
    }
}

/// The number after a scalar's type: 1 where there is none.
fn scalar_components(cursor: &mut Cursor<'_>) -> Result<usize> {
    let Some(word) = cursor.word_of_line() else { return Ok(1) };
    let count = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
    count.ok_or_else(|| cursor.malformed("the number of components of SCALARS is no number"))
}

/// Colours: bytes where binary, else numbers from 0 to 1.
fn colors(cursor: &mut Cursor<'_>, tuples: usize, components: usize) -> Result<NumericColumn> {
    let number = if cursor.binary { NumberType::U8 } else { NumberType::F32 };
    cursor.tuples(DataType::Number(number), tuples, components)
}

/// Reads over a field that belongs to the dataset as a whole.
pub(super) fn skip_field(cursor: &mut Cursor<'_>) -> Result<()> {
    for_each_field_array(cursor, |_, _, _, _| Ok(()))
}

/// Hands name, components and values of each array of a FIELD to `visit`; text is skipped.
fn for_each_field_array(
    cursor: &mut Cursor<'_>,
    mut visit: impl FnMut(String, usize, NumericColumn, &Cursor<'_>) -> Result<()>,
) -> Result<()> {
    cursor.name()?;
    let count = cursor.count("the number of arrays of the field")?;
    for _ in 0..count {
        if cursor.next_is("METADATA") {
            cursor.next_keyword();
            cursor.skip_metadata();
        }
        let name = cursor.name()?;
        if name == "NULL_ARRAY" {
            continue;
        }
        let components = cursor.count("the number of components")?;
        let tuples = cursor.count("the number of tuples")?;
        match cursor.data_type()? {
            DataType::Text => {
                let strings = tuples.checked_mul(components);
                cursor.skip_strings(strings.ok_or_else(|| cursor.malformed("a field of text is too large"))?)?;
            }
            data => visit(name, components, cursor.tuples(data, tuples, components)?, cursor)?,
        }
    }
    Ok(())
}
