//! `Scene`: a mesh, the scalar drawn on it, and what the scalar looks like, in the form in which stages read it.

use std::sync::{Arc, OnceLock};

use super::band_arrays::BandArrays;
use super::opaque::Lists;
use crate::backends::cpu::Mates;
use crate::backends::scene_bytes;
use crate::columns::{Dataset, Field};
use crate::control::Control;
use crate::error::Result;
use crate::geometry::{Layer, SurfaceFaces, TriangleMesh, triangles};
use crate::image::DepthImage;
use crate::optics::{BandTable, Model, Pieces, TransferFunction};
use crate::profile::Profile;
use crate::stages::SceneVertex;
use crate::stages::project::scene_vertices;
use crate::stages::sort::SortKey;
use crate::stages::sort::adjacency::Adjacency;
use crate::stages::sort::delaunay::best_key_while;
use crate::stages::sort::overlaps::overlapping_faces;

/// A mesh, the scalar drawn on it, and what the scalar looks like.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(super) dataset: Dataset,
    pub(super) field: Field,
    pub(super) vertices: Vec<SceneVertex>,
    pub(super) pieces: Pieces,
    /// The colours of bands that glow.
    pub(super) transfer: TransferFunction,
    /// Found when an order first asks for it.
    pub(super) best_key: OnceLock<SortKey>,
    /// The same as long as the cells are where they are.
    pub(super) shape: Arc<()>,
    pub(super) bands: Option<SceneBands>,
    /// Taken from the dataset or made, when an order first asks for it.
    pub(super) adjacency: OnceLock<Adjacency>,
    /// Counted when an order first asks for it.
    pub(super) overlapping_faces: OnceLock<u64>,
    /// Found when rays are first followed; none where they cannot be.
    pub(super) mates: OnceLock<Option<Mates>>,
    /// Made when a frame first draws them.
    pub(super) lists: Lists,
    /// Triangles of other files.
    pub(super) triangles: Vec<Layer>,
    /// A picture that volumes are composited with.
    pub(super) external: Option<Arc<DepthImage>>,
}

/// Where the extinctions of bands come from.
#[derive(Clone, Debug)]
pub(super) enum SceneBands {
    /// Functions of the scene's scalar.
    Table(BandTable),
    /// An array each.
    Arrays(BandArrays),
}

impl SceneBands {
    /// How many bands there are.
    pub(super) fn count(&self) -> usize {
        match self {
            Self::Table(table) => table.names().len(),
            Self::Arrays(arrays) => arrays.each.len(),
        }
    }
}

impl Scene {
    /// Brings mesh, field and transfer function into the form in which the stages read them.
    pub fn new(dataset: Dataset, field: Field, transfer: &TransferFunction) -> Self {
        let vertices = scene_vertices(&dataset, &field);
        let pieces = transfer.pieces(field.offset);
        Self {
            dataset,
            field,
            vertices,
            pieces,
            transfer: transfer.clone(),
            best_key: OnceLock::new(),
            shape: Arc::new(()),
            bands: None,
            adjacency: OnceLock::new(),
            overlapping_faces: OnceLock::new(),
            mates: OnceLock::new(),
            lists: Lists::default(),
            triangles: Vec::new(),
            external: None,
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

    /// Takes each band's extinction per world unit length from an array: constant in cells, or linear where it is point data.
    ///
    /// On the CPU up to four arrays of cell data without a value that is not finite take one pass of the absorption model; others,
    /// all on GPUs, with fans and in emission-absorption, take a pass each. In emission-absorption bands have the colours that
    /// [`Scene::with_bands`] says, of the array's value: a transfer function of colour 1 makes the light of a band its opacity.
    ///
    /// # Errors
    /// [`Error::Bands`](crate::Error::Bands) where there is none or two have one name,
    /// [`Error::UnusableArray`](crate::Error::UnusableArray) where a value is negative.
    pub fn with_band_arrays(self, fields: Vec<Field>) -> Result<Self> {
        let bands = SceneBands::Arrays(BandArrays::new(&self.dataset, fields)?);
        Ok(Self { bands: Some(bands), ..self })
    }

    /// Draws the triangles of `mesh` opaque into the volume, from both sides, lit by a lamp at the eye; in `color` (linear RGB), or in the colours
    /// of its positions, or, where it has none, in [`TriangleMesh::COLOR`].
    ///
    /// Their list is kept, and sent to a GPU once. Every cell is cut at their depth, as
    /// [`GeometryOptions`](crate::geometry::GeometryOptions) says.
    ///
    /// # Errors
    /// Those of [`triangles`](crate::geometry::triangles).
    ///
    /// ```
    /// use cellfan::geometry::TriangleMesh;
    /// use cellfan::{Camera, Dataset, Projection, RenderOptions, Renderer, Scene, TransferFunction, generate};
    /// let dataset = Dataset::from_tets(generate::tets(&generate::Settings { cells: 6, ..Default::default() })?)?;
    /// let field = dataset.homogeneous_field();
    /// let mut scene = Scene::new(dataset, field, &TransferFunction::constant([1.0; 3], 2.0)?);
    /// // A wall across the unit cube, half a unit behind its front side.
    /// let positions = vec![[0.5, -9.0, -9.0], [0.5, 9.0, -9.0], [0.5, 0.0, 9.0]];
    /// let wall = TriangleMesh { positions, triangles: vec![[0, 1, 2]], ..Default::default() };
    /// scene.add_triangles(&wall, Some([0.0; 3]))?;
    /// let mut camera = Camera::looking_at([3.0, 0.5, 0.5].into(), [0.5; 3].into(), 5, 5);
    /// camera.projection = Projection::Orthographic { height_world: 0.5 };
    /// let image = Renderer::new(RenderOptions::default()).render(&scene, &camera)?.image;
    /// assert!((image.pixel(2, 2)[0] - (1.0 - (-2.0_f32 * 0.5).exp())).abs() < 1e-5);
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn add_triangles(&mut self, mesh: &TriangleMesh, color: Option<[f32; 3]>) -> Result<()> {
        let plain =
            color.filter(|_| !mesh.colors.is_empty()).map(|_| TriangleMesh { colors: Vec::new(), ..mesh.clone() });
        let list = Arc::new(triangles(&self.dataset, plain.as_ref().unwrap_or(mesh))?);
        let color = color.unwrap_or(TriangleMesh::COLOR);
        self.triangles.push(Layer { list, color, faces: SurfaceFaces::All, width_px: 0.0 });
        Ok(())
    }

    /// How many triangles were added.
    pub fn added_triangles(&self) -> u64 {
        self.triangles.iter().map(|layer| layer.list.len() as u64).sum()
    }

    /// Composites the volume with a picture that another program drew from the same place: each ray ends at the depth of its pixel, and the
    /// colour shows behind the volume in front of it, as that of geometry does. It must have the size of the whole picture, or of the region
    /// that is drawn. Light that lies behind everything, where the picture has no depth, is dimmed by the whole volume.
    pub fn set_external(&mut self, picture: Option<Arc<DepthImage>>) {
        self.external = picture;
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
            Some(SceneBands::Arrays(arrays)) => arrays.each.iter().map(|array| array.field.name.clone()).collect(),
        }
    }

    /// Bytes of memory that the scene takes; columns that are used in place, as those of a mapped file, count nothing.
    pub fn owned_bytes(&self) -> u64 {
        let adjacency = self.adjacency.get().map_or(0, Adjacency::owned_bytes);
        let scene = scene_bytes(&self.dataset, &self.field, &self.vertices);
        let external = self.external.as_ref().map_or(0, |external| 20 * external.depth_world.len() as u64);
        let triangles: u64 = self.triangles.iter().map(|layer| layer.list.bytes()).sum();
        scene + self.band_bytes() + adjacency + self.lists.bytes() + triangles + external
    }

    /// The key that orders the mesh best; found at the first call. None where the end is asked for before.
    pub(super) fn best_key(&self, control: &Control) -> Option<SortKey> {
        found(&self.best_key, control, || best_key_while(control, &self.dataset)).copied()
    }

    /// Which cells share a face; taken from the dataset or made at the first call. None where the end is asked for before.
    pub(super) fn adjacency(&self, control: &Control, profile: &mut Profile) -> Option<&Adjacency> {
        let make = || profile.time("adjacency", || Adjacency::new_while(control, &self.dataset));
        found(&self.adjacency, control, make)
    }

    /// The same where it is there already.
    pub(super) fn known_adjacency(&self) -> Option<&Adjacency> {
        self.adjacency.get()
    }

    /// Faces at which cells overlap; counted at the first call.
    pub(super) fn overlapping_faces(&self, adjacency: &Adjacency, profile: &mut Profile) -> u64 {
        let count = || profile.time("adjacency", || overlapping_faces(&self.dataset, adjacency));
        *self.overlapping_faces.get_or_init(count)
    }

    /// What lies across each face, found at the first call; none where rays cannot be followed through the mesh: it has other cells than
    /// tetrahedra, too many of them, or such that overlap.
    pub(super) fn mates(&self, control: &Control, profile: &mut Profile) -> Option<&Mates> {
        if let Some(mates) = self.mates.get() {
            return mates.as_ref();
        }
        let is_all_tets = self.dataset.tets.len() == self.dataset.cells();
        if !is_all_tets || !(1..=Mates::MAX_CELLS).contains(&self.dataset.cells()) {
            return None;
        }
        // Where the end is asked for there are none yet.
        let adjacency = self.adjacency(control, profile)?;
        let overlap = self.overlapping_faces(adjacency, profile) > 0;
        let find = || (!overlap).then(|| profile.time("mates", || Mates::new(&self.dataset, adjacency)));
        self.mates.get_or_init(find).as_ref()
    }

    /// What the arrays of bands take of that.
    pub(super) fn band_bytes(&self) -> u64 {
        match &self.bands {
            Some(SceneBands::Arrays(arrays)) => arrays.owned_bytes(),
            Some(SceneBands::Table(_)) | None => 0,
        }
    }

    /// Bands that a picture is gathered from beside its four channels.
    pub(super) fn bands_of_picture(&self, model: Model) -> usize {
        self.bands.as_ref().filter(|_| model != Model::Mip).map_or(0, SceneBands::count)
    }

    /// Shows the field with another transfer function.
    pub fn set_transfer(&mut self, transfer: &TransferFunction) {
        self.pieces = transfer.pieces(self.field.offset);
        self.transfer = transfer.clone();
    }
}

/// What `cell` holds, made where it holds nothing; what was made in part, since the end was asked for meanwhile, is not kept.
fn found<'a, T>(cell: &'a OnceLock<T>, control: &Control, make: impl FnOnce() -> T) -> Option<&'a T> {
    if let Some(found) = cell.get() {
        return Some(found);
    }
    let made = make();
    (!control.is_cancelled()).then(|| cell.get_or_init(|| made))
}
