//! What is drawn: a mesh with its field and a transfer function that culls a share of its cells.

use std::path::Path;

use cellfan::columns::{Association, Component};
use cellfan::generate::{Kind, Settings, generate};
use cellfan::io::{container, open_mesh};
use cellfan::optics::presets::{OpacityProfile, preset};
use cellfan::{ControlPoint, Dataset, Error, Field, FieldSelection, Result, TransferFunction};

/// Optical depth over the mesh's diagonal at the largest value: no ray ends early, so every cell is drawn.
const DEPTH: f64 = 3.0;
/// Linear pieces of the transfer function over the values that show.
const PIECES: u32 = 8;

/// A mesh, ready to draw.
pub(super) struct Subject {
    pub(super) name: String,
    pub(super) dataset: Dataset,
    pub(super) field: Field,
}

impl Subject {
    /// A generated mesh of about `cells` cells.
    pub(super) fn generated(kind: Kind, cells: u64) -> Result<Self> {
        let mut dataset = Dataset::from_tets(generate(kind, &Settings { cells, ..Settings::default() })?)?;
        let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays))?;
        dataset.arrays = Vec::new();
        Ok(Self { name: format!("generated {kind}"), dataset, field })
    }

    /// The mesh of a file, its cells whole, with the array `array` or the first that varies.
    pub(super) fn read(path: &Path, array: Option<&str>) -> Result<Self> {
        let mut dataset = if path.is_file() && container::is_container(path)? {
            container::open(path, true)?
        } else {
            open_mesh(path)?.into_whole_dataset().map_err(|error| error.in_file(path))?
        };
        let field = match array {
            Some(array) => dataset.field(&FieldSelection::parse(array, &dataset.arrays)),
            None => Ok(first_varying(&dataset)),
        };
        let field = field.map_err(|error| error.in_file(path))?;
        dataset.arrays = Vec::new();
        let name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        Ok(Self { name, dataset, field })
    }

    /// Colours and extinctions over the field's values: none up to the value below which `culled` (0 to 1) of the cells lie whole,
    /// then rising.
    pub(super) fn ramp(&self, culled: f64) -> Result<TransferFunction> {
        let densest = DEPTH / self.dataset.diagonal_world();
        let (low, high) = self.field.range;
        if low >= high {
            return TransferFunction::constant([0.75, 0.85, 1.0], densest);
        }
        let point = |value: f64, extinction: f64, share: f64| ControlPoint {
            value,
            color: [share, 0.5, 1.0 - share],
            extinction,
        };
        let clear = (culled > 0.0).then(|| self.value_above(culled).clamp(low, high));
        let (start, least) = clear.map_or((low, 0.1 * densest), |clear| (clear, 0.0));
        if start >= high {
            let problem =
                format!("{:.0} % of the cells cannot be left out: too many have the largest value", 100.0 * culled);
            return Err(Error::Option { option: "--culled", problem });
        }
        let rising = (0..=PIECES).map(|i| {
            let share = f64::from(i) / f64::from(PIECES);
            point(start + (high - start) * share, least + (densest - least) * share, share)
        });
        let clear = clear.filter(|&clear| clear > low).map(|_| point(low, 0.0, 0.0));
        TransferFunction::new(clear.into_iter().chain(rising).collect())
    }

    /// A preset or a file, stretched as `render` does.
    pub(super) fn transfer(&self, name: &str) -> Result<TransferFunction> {
        let unit_distance = self.dataset.diagonal_world() / 100.0;
        let path = Path::new(name);
        let Some(extension) = path.extension() else {
            return preset(name, self.field.range, OpacityProfile::default(), unit_distance);
        };
        let text = std::fs::read_to_string(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
        TransferFunction::parse(&text, &extension.to_string_lossy(), unit_distance, self.field.range)
            .map_err(|error| error.in_file(path))
    }

    /// A value that the largest values of this share of the cells lie below, between two that occur.
    fn value_above(&self, share: f64) -> f64 {
        let mut largest: Vec<f32> = (0..self.dataset.cells()).map(|cell| self.largest(cell)).collect();
        let place = ((largest.len() - 1) as f64 * share) as usize;
        let (_, &mut value, above) = largest.select_nth_unstable_by(place, f32::total_cmp);
        let next = above.iter().copied().filter(|&next| next > value).fold(f32::INFINITY, f32::min);
        let between = if next.is_finite() { f64::midpoint(value.into(), next.into()) } else { value.into() };
        self.field.offset + between
    }

    /// The largest stored value of a cell.
    fn largest(&self, cell: usize) -> f32 {
        let value = |v: usize| self.field.values[v];
        match self.field.association {
            Association::Cell => value(cell),
            Association::Point => {
                self.dataset.corners(cell).iter().map(|&v| value(v as usize)).fold(f32::MIN, f32::max)
            }
        }
    }
}

/// The first array that varies, those of points before those of cells; a homogeneous mesh where there is none.
fn first_varying(dataset: &Dataset) -> Field {
    let of = |association| dataset.arrays.iter().filter(move |array| array.association == association);
    let varying = of(Association::Point).chain(of(Association::Cell)).find_map(|array| {
        let association = Some(array.association);
        let selection = FieldSelection { name: array.name.clone(), association, component: Component::Magnitude };
        dataset.field(&selection).ok().filter(|field| field.range.0 < field.range.1)
    });
    varying.unwrap_or_else(|| dataset.homogeneous_field())
}
