//! What both benchmark files draw: generated meshes with one transfer function, seen from one side.

use cellfan::camera::Camera;
use cellfan::columns::{Association, Component, Dataset, Field, FieldSelection};
use cellfan::generate::{Kind, Settings, generate};
use cellfan::optics::{ControlPoint, TransferFunction};

/// A mesh and the field drawn on it.
pub(crate) struct Mesh {
    pub(crate) dataset: Dataset,
    pub(crate) field: Field,
}

impl Mesh {
    /// The mesh of this kind with about `cells` cells.
    pub(crate) fn generate(kind: Kind, cells: u64) -> Self {
        let mesh = generate(kind, &Settings { cells, ..Settings::default() }).expect("the settings are in range");
        let dataset = Dataset::from_tets(mesh).expect("a generated mesh is valid");
        let name = "value".to_owned();
        let selection = FieldSelection { name, association: Some(Association::Point), component: Component::Magnitude };
        let field = dataset.field(&selection).expect("generated meshes have this array");
        Self { dataset, field }
    }

    /// A view of the whole mesh, turned by `degrees`.
    pub(crate) fn camera(&self, degrees: f64, side_px: u32) -> Camera {
        framing(&self.dataset, degrees, side_px)
    }
}

/// A view of all of a mesh, turned by `degrees`.
pub(crate) fn framing(dataset: &Dataset, degrees: f64, side_px: u32) -> Camera {
    Camera::framing(&dataset.corners_world(), 30.0 + degrees, 20.0, side_px, side_px)
}

/// Below this value nothing shows.
pub(crate) const TRANSPARENT_BELOW: f64 = 0.4;

/// Eight pieces over the values 0 to 1 of the generated fields, transparent below [`TRANSPARENT_BELOW`].
pub(crate) fn transfer() -> TransferFunction {
    let point = |value: f64, extinction: f64| ControlPoint { value, color: [value, 0.5, 1.0 - value], extinction };
    let ramp = (0..7).map(|i| point(0.5 + 0.08 * f64::from(i), 2.0 + f64::from(i % 3)));
    TransferFunction::new([point(TRANSPARENT_BELOW, 0.0)].into_iter().chain(ramp).collect()).expect("it is valid")
}
