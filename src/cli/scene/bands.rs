//! Wavelength bands with extinctions of their own (`--bands`): a table over the scalar, or an array each.

use std::path::{Path, PathBuf};

use cellfan::optics::BandTable;
use cellfan::{Dataset, Error, Field, FieldSelection, Model, Result, Scene};

use super::Arguments;
use crate::cli::numbers::count;

/// What comes before the names of arrays.
const ARRAYS: &str = "array:";

/// What the arguments say about bands.
pub(super) enum BandSource {
    None,
    Table { path: PathBuf, table: BandTable },
    Arrays(Vec<String>),
}

/// Bands whose extinctions were found in the mesh.
pub(super) enum Bands {
    None,
    Table(BandTable),
    Arrays(Vec<Field>),
}

impl BandSource {
    /// Reads what can be read before the mesh.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Bands`], [`Error::Option`] where other options have no use for bands.
    pub(super) fn load(arguments: &Arguments) -> Result<Self> {
        let Some(text) = arguments.bands.as_deref() else { return Ok(Self::None) };
        let refuse = |problem: String| Err(Error::Option { option: "--bands", problem });
        if arguments.model == Model::Mip {
            return refuse("mip has no bands; choose absorption, emission or emission-absorption".to_owned());
        }
        if arguments.model != Model::EmissionAbsorption && arguments.transfer.is_some() {
            tracing::warn!("bands have extinctions of their own: --transfer is ignored");
        }
        if let Some(names) = text.strip_prefix(ARRAYS) {
            if arguments.array.is_some() {
                return refuse("the bands are arrays themselves; leave out --array".to_owned());
            }
            return Ok(Self::Arrays(names.split(',').map(str::to_owned).collect()));
        }
        let path = PathBuf::from(text);
        if path.extension().is_none() && !path.exists() {
            return refuse(format!("there is no file {text:?}; give a .csv or .json table, or {ARRAYS}NAME,NAME"));
        }
        let contents = std::fs::read_to_string(&path).map_err(|source| Error::Io { path: path.clone(), source })?;
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        let table = BandTable::parse(&contents, &extension).map_err(|error| error.in_file(&path))?;
        Ok(Self::Table { path, table })
    }

    /// Finds the arrays in the mesh; what to call the bands.
    ///
    /// # Errors
    /// As [`Dataset::field`].
    pub(super) fn make(self, dataset: &Dataset) -> Result<(Bands, Option<String>)> {
        let note = |path: &Path, bands: usize| format!("{} of {}", count(bands as u64, "band"), path.display());
        Ok(match self {
            Self::None => (Bands::None, None),
            Self::Table { path, table } => {
                let note = note(&path, table.names().len());
                (Bands::Table(table), Some(note))
            }
            Self::Arrays(names) => {
                let fields = names.iter().map(|name| dataset.field(&FieldSelection::parse(name, &dataset.arrays)));
                let fields = fields.collect::<Result<_>>()?;
                (Bands::Arrays(fields), Some(format!("bands {}", names.join(", "))))
            }
        })
    }
}

impl Bands {
    /// Whether the bands are arrays, which have colours only where a transfer function is given.
    pub(super) fn are_arrays(&self) -> bool {
        matches!(self, Self::Arrays(_))
    }

    /// The array of the first band, where bands are arrays: the field of the scene.
    pub(super) fn first_array(&self) -> Option<&Field> {
        match self {
            Self::Arrays(fields) => fields.first(),
            Self::None | Self::Table(_) => None,
        }
    }

    /// The scene with these bands.
    ///
    /// # Errors
    /// As [`Scene::with_band_arrays`].
    pub(super) fn give_to(self, scene: Scene) -> Result<Scene> {
        match self {
            Self::None => Ok(scene),
            Self::Table(table) => Ok(scene.with_bands(table)),
            Self::Arrays(fields) => scene.with_band_arrays(fields),
        }
    }
}
