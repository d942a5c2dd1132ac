//! The fields of a time that have a value in each cell, as cell arrays.

use super::case::{self, Case};
use super::tokens::Foam;
use crate::columns::{Array, Association};
use crate::error::Result;
use crate::io::scratch::Scratch;
use crate::io::source::Source;

/// Classes of fields, and how many numbers a value has.
const CLASSES: [(&str, usize); 5] = [
    ("volScalarField", 1),
    ("volVectorField", 3),
    ("volSphericalTensorField", 1),
    ("volSymmTensorField", 6),
    ("volTensorField", 9),
];

/// Bytes in which a header stands: files without one are passed over, however long they are.
const HEADER_BYTES: usize = 4096;

/// The fields of the case's time, by name.
pub(super) fn read(case: &Case, cells: usize, scratch: &Scratch) -> Result<Vec<Array>> {
    let Some(folder) = case.time() else { return Ok(Vec::new()) };
    let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
    let mut files: Vec<_> = entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    files.sort();
    let mut arrays = Vec::new();
    for path in files {
        let bytes = case::read(&path)?;
        let source = Source { path: &path, scratch };
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEADER_BYTES)]);
        if !head.contains("FoamFile") {
            continue;
        }
        let mut file = Foam::open(&bytes, source)?;
        let Some(&(_, components)) = CLASSES.iter().find(|(class, _)| *class == file.class) else { continue };
        let Some(values) = internal(&mut file, components, cells)? else {
            tracing::warn!("{}: its internal field is not written out, left out", path.display());
            continue;
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        arrays.push(Array { name, association: Association::Cell, components, values: values.into() });
    }
    Ok(arrays)
}

/// The values in the cells; nothing where they are left to a rule.
fn internal(file: &mut Foam<'_>, components: usize, cells: usize) -> Result<Option<Vec<f64>>> {
    while let Some(key) = file.next_key()? {
        if key != "internalField" {
            file.skip_value()?;
            continue;
        }
        return match file.word()? {
            "uniform" => Ok(Some(file.tuple(components)?.repeat(cells))),
            "nonuniform" => file.scalars(components, Some(cells)).map(Some),
            _ => Ok(None),
        };
    }
    Ok(None)
}
