//! `Scene`: a mesh, the scalar drawn on it, and what the scalar looks like, in the form in which stages read it.

use std::sync::OnceLock;

use crate::backends::scene_bytes;
use crate::columns::{Association, Dataset, Field};
use crate::error::{Error, Result};
use crate::optics::{BandPoint, BandTable, Model, Pieces, TransferFunction};
use crate::profile::Profile;
use crate::stages::SceneVertex;
use crate::stages::project::scene_vertices;
use crate::stages::sort::SortKey;
use crate::stages::sort::adjacency::Adjacency;
use crate::stages::sort::delaunay::best_key;

/// A mesh, the scalar drawn on it, and what the scalar looks like.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(super) dataset: Dataset,
    pub(super) field: Field,
    pub(super) vertices: Vec<SceneVertex>,
    pub(super) pieces: Pieces,
    /// The colours of bands that glow.
    pub(super) transfer: TransferFunction,
    pub(super) best_key: SortKey,
    pub(super) bands: Option<SceneBands>,
    /// Taken from the dataset or made, when an order first asks for it.
    adjacency: OnceLock<Adjacency>,
}

/// Where the extinctions of bands come from.
#[derive(Clone, Debug)]
pub(super) enum SceneBands {
    /// Functions of the scene's scalar.
    Table(BandTable),
    /// An array each.
    Arrays(Vec<BandArray>),
}

/// A band whose extinction is an array.
#[derive(Clone, Debug)]
pub(super) struct BandArray {
    pub(super) field: Field,
    /// Where the array is point data; cell data goes with the scene's own.
    pub(super) vertices: Option<Vec<SceneVertex>>,
    /// Extinction is the value.
    pub(super) table: BandTable,
}

impl SceneBands {
    /// How many bands there are.
    pub(super) fn count(&self) -> usize {
        match self {
            Self::Table(table) => table.names().len(),
            Self::Arrays(arrays) => arrays.len(),
        }
    }
}

impl Scene {
    /// Brings mesh, field and transfer function into the form in which the stages read them.
    pub fn new(dataset: Dataset, field: Field, transfer: &TransferFunction) -> Self {
        let vertices = scene_vertices(&dataset, &field);
        let pieces = transfer.pieces(field.offset);
        let best_key = best_key(&dataset);
        Self {
            dataset,
            field,
            vertices,
            pieces,
            transfer: transfer.clone(),
            best_key,
            bands: None,
            adjacency: OnceLock::new(),
        }
    }

    /// Gives wavelength bands extinctions of their own, as functions of the field's scalar.
    ///
    /// The absorption model then draws all of them, into [`Rendered::bands`](super::Rendered::bands), four at a time.
    /// Emission-absorption takes three or more. The first three are red, green and blue: each channel of the transfer function's colour
    /// is dimmed by its own band, and opacity is 1 less the mean transmittance of the three. Where there are more, the light of all goes
    /// into [`Rendered::bands`](super::Rendered::bands); those beyond blue have colour 1.
    ///
    /// ```
    /// use cellfan::optics::BandTable;
    /// use cellfan::{Camera, Dataset, Model, Projection, RenderOptions, Renderer, Scene, TransferFunction, generate};
    /// let dataset = Dataset::from_tets(generate::tets(&generate::Settings { cells: 1_000, ..Default::default() })?)?;
    /// let field = dataset.homogeneous_field();
    /// let bands = BandTable::constant(vec![0.1, 0.2, 0.5, 1.0, 2.0, 5.0])?;
    /// let scene = Scene::new(dataset, field, &TransferFunction::constant([1.0; 3], 0.0)?).with_bands(bands);
    /// // The unit cube, one unit thick along the axis.
    /// let mut camera = Camera::looking_at([3.0, 0.5, 0.5].into(), [0.5; 3].into(), 5, 5);
    /// camera.projection = Projection::Orthographic { height_world: 0.5 };
    /// let options = RenderOptions { model: Model::Absorption, ..RenderOptions::default() };
    /// let bands = Renderer::new(options).render(&scene, &camera)?.bands.expect("the scene has bands");
    /// assert!((bands.pixel(2, 2)[4] - (-2.0_f32).exp()).abs() < 1e-6);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    #[must_use]
    pub fn with_bands(self, bands: BandTable) -> Self {
        Self { bands: Some(SceneBands::Table(bands)), ..self }
    }

    /// Takes each band's extinction per world unit length from an array: constant in cells, or linear where it is point data. A
    /// pass each. In emission-absorption bands have the colours that [`Scene::with_bands`] says, of the array's value: a transfer
    /// function of colour 1 makes the light of a band its opacity.
    ///
    /// # Errors
    /// [`Error::Bands`] where there is none or two have one name, [`Error::UnusableArray`] where a value is negative.
    pub fn with_band_arrays(self, fields: Vec<Field>) -> Result<Self> {
        let names: Vec<String> = fields.iter().map(|field| field.name.clone()).collect();
        BandTable::new(names, vec![BandPoint { value: 0.0, extinctions: vec![0.0; fields.len()] }])?;
        let of_field = |field: Field| {
            let vertices = (field.association == Association::Point).then(|| scene_vertices(&self.dataset, &field));
            Ok(BandArray { table: identity(&field)?, vertices, field })
        };
        let arrays = fields.into_iter().map(of_field).collect::<Result<_>>()?;
        Ok(Self { bands: Some(SceneBands::Arrays(arrays)), ..self })
    }

    /// The mesh.
    pub fn dataset(&self) -> &Dataset {
        &self.dataset
    }

    /// The scalar field.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// Names of the bands that have extinctions of their own; none where there are no such bands.
    pub fn band_names(&self) -> Vec<String> {
        match &self.bands {
            None => Vec::new(),
            Some(SceneBands::Table(table)) => table.names().to_vec(),
            Some(SceneBands::Arrays(arrays)) => arrays.iter().map(|array| array.field.name.clone()).collect(),
        }
    }

    /// Bytes of memory that the scene takes; columns that are used in place, as those of a mapped file, count nothing.
    pub fn owned_bytes(&self) -> u64 {
        let adjacency = self.adjacency.get().map_or(0, Adjacency::owned_bytes);
        scene_bytes(&self.dataset, &self.field, &self.vertices) + self.band_bytes() + adjacency
    }

    /// Which cells share a face; taken from the dataset or made at the first call.
    pub(super) fn adjacency(&self, profile: &mut Profile) -> &Adjacency {
        self.adjacency.get_or_init(|| profile.time("adjacency", || Adjacency::new(&self.dataset)))
    }

    /// What the arrays of bands take of that.
    pub(super) fn band_bytes(&self) -> u64 {
        let Some(SceneBands::Arrays(arrays)) = &self.bands else { return 0 };
        let of_array = |BandArray { field, vertices, .. }: &BandArray| {
            let vertices = vertices.as_deref().unwrap_or_default();
            size_of_val(&field.values[..]) + size_of_val(&field.block_ranges[..]) + size_of_val(vertices)
        };
        arrays.iter().map(|array| of_array(array) as u64).sum()
    }

    /// Bands that a picture is gathered from beside its four channels.
    pub(super) fn bands_of_picture(&self, model: Model) -> usize {
        let has_bands = matches!(model, Model::Absorption | Model::EmissionAbsorption);
        self.bands.as_ref().filter(|_| has_bands).map_or(0, SceneBands::count)
    }

    /// Shows the field with another transfer function.
    pub fn set_transfer(&mut self, transfer: &TransferFunction) {
        self.pieces = transfer.pieces(self.field.offset);
        self.transfer = transfer.clone();
    }
}

/// Extinction that is the value itself.
fn identity(field: &Field) -> Result<BandTable> {
    let (low, high) = field.range;
    if low < 0.0 || high > f64::from(f32::MAX) {
        let problem = format!("its values run from {low} to {high}; an extinction must be 0 or more, and finite");
        return Err(Error::UnusableArray { name: field.name.clone(), problem });
    }
    let point = |value: f64| BandPoint { value, extinctions: vec![value] };
    BandTable::new(vec![field.name.clone()], vec![point(0.0), point(high)])
}
