//! Which transfer function shows the array: a file, a preset, or one made for it ([`automatic`](super::automatic)).

use std::path::{Path, PathBuf};

use cellfan::columns::{Volume, VolumeField};
use cellfan::optics::presets::{ColorMap, OpacityProfile, preset};
use cellfan::{Dataset, Error, Field, Model, Result, TransferFunction};

use super::Arguments;
use super::automatic::{automatic, automatic_of_volume};

/// What the arguments say about the transfer function.
pub(super) struct TransferSource {
    kind: Kind,
    unit_distance: Option<f64>,
}

enum Kind {
    Automatic,
    Preset(ColorMap),
    File { path: PathBuf, text: String },
}

impl TransferSource {
    /// Reads what can be read before the mesh, and finds the errors that a file has for any mesh.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::TransferFunction`].
    pub(super) fn load(arguments: &Arguments) -> Result<Self> {
        let unit_distance = arguments.unit_distance;
        let kind = match arguments.transfer.as_deref() {
            None => Kind::Automatic,
            Some(name) => match name.parse() {
                Ok(map) => Kind::Preset(map),
                // No name of a preset and no file either: the message lists the presets.
                Err(error) if Path::new(name).extension().is_none() && !Path::new(name).exists() => return Err(error),
                Err(_) => {
                    let path = PathBuf::from(name);
                    let text =
                        std::fs::read_to_string(&path).map_err(|source| Error::Io { path: path.clone(), source })?;
                    parse(&path, &text, unit_distance.unwrap_or(1.0), (0.0, 1.0))?;
                    Kind::File { path, text }
                }
            },
        };
        Ok(Self { kind, unit_distance })
    }

    /// The transfer function, and what to call it.
    ///
    /// # Errors
    /// [`Error::TransferFunction`].
    pub(super) fn make(&self, dataset: &Dataset, field: &Field, model: Model) -> Result<(TransferFunction, String)> {
        self.over(field.range, dataset.diagonal_world(), || automatic(dataset, field, model))
    }

    /// The same for a volume.
    ///
    /// # Errors
    /// [`Error::TransferFunction`].
    pub(super) fn make_for_volume(
        &self,
        volume: &Volume,
        field: &VolumeField,
        model: Model,
    ) -> Result<(TransferFunction, String)> {
        let corners = volume.corners_world();
        let low = corners.iter().fold(corners[0], |low, &corner| low.min(corner));
        let high = corners.iter().fold(corners[0], |high, &corner| high.max(corner));
        self.over(field.range, low.distance(high), || automatic_of_volume(volume, field, model))
    }

    fn over(
        &self,
        range: (f64, f64),
        diagonal_world: f64,
        automatic: impl FnOnce() -> Result<(TransferFunction, String)>,
    ) -> Result<(TransferFunction, String)> {
        let unit_distance = self.unit_distance.unwrap_or(diagonal_world / 100.0);
        match &self.kind {
            Kind::Automatic => automatic(),
            Kind::Preset(map) => {
                let transfer = preset(map.name(), range, OpacityProfile::default(), unit_distance)?;
                Ok((transfer, map.name().to_owned()))
            }
            Kind::File { path, text } => {
                Ok((parse(path, text, unit_distance, range)?, format!("transfer function {}", path.display())))
            }
        }
    }
}

fn parse(path: &Path, text: &str, unit_distance: f64, range: (f64, f64)) -> Result<TransferFunction> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    TransferFunction::parse(text, &extension, unit_distance, range).map_err(|error| error.in_file(path))
}
