//! `FogRenderer`: pictures of a terrain in its fog, each at the level of detail that its camera needs.
//!
//! In: a [`Terrain`], a [`Camera`], a [`FogLook`]. Out: a [`Rendered`]. The prisms are a mesh made anew for each view, each drawn as three
//! tetrahedra; the ground is opaque and cuts them by depth, as geometry does; the eye may be in the fog, and nothing is lost at the near plane.

mod check;

pub use check::{FlightCheck, FrameCheck};

use super::{RenderOptions, Rendered, Renderer, Scene};
use crate::camera::{Camera, Projection};
use crate::columns::{CellMesh, Dataset, Field, FieldSelection};
use crate::error::{Error, Result};
use crate::fog::{Detail, Landscape, Profile, Terrain};
use crate::image::Image;
use crate::optics::{ControlPoint, Model, TransferFunction};

/// What fog looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FogLook {
    /// Emission or maximum intensity, as in the paper, or emission-absorption, which dims the ground as fog does.
    pub model: Model,
    /// Linear RGB.
    pub color: [f64; 3],
    /// Light per unit length where fog is densest; its extinction in emission-absorption.
    pub extinction_per_unit: f64,
    /// Pixels by which ground and fog may be off without a point; none for all points.
    pub tolerance_px: Option<f64>,
}

impl FogLook {
    /// The look of a model on a terrain: bright, but not white, where a ray runs along a valley.
    ///
    /// # Errors
    /// [`Error::Option`] where the model is absorption, which emits nothing.
    pub fn new(model: Model, terrain: &Terrain) -> Result<Self> {
        let per_side = match model {
            Model::Emission => 24.0,
            Model::EmissionAbsorption => 60.0,
            Model::Mip => 1.0,
            Model::Absorption => {
                let problem = "fog is drawn by emission, emission-absorption or mip".to_owned();
                return Err(Error::Option { option: "--model", problem });
            }
        };
        let extinction_per_unit = per_side / terrain.side_world();
        Ok(Self { model, color: [0.86, 0.88, 0.92], extinction_per_unit, tolerance_px: Some(0.5) })
    }

    /// How dense fog is between ground and top, as the model needs it.
    fn profile(&self) -> Profile {
        if self.model == Model::Mip { Profile::Maximum } else { Profile::Emission }
    }
}

/// Draws terrains in fog, on the processor or on a GPU.
#[derive(Default)]
pub struct FogRenderer {
    renderer: Renderer,
}

impl From<Renderer> for FogRenderer {
    fn from(renderer: Renderer) -> Self {
        Self::new(renderer)
    }
}

impl FogRenderer {
    /// Draws with a renderer for whose frames [`FogRenderer::options`] hold.
    pub fn new(renderer: Renderer) -> Self {
        Self { renderer }
    }

    /// What a renderer of fog draws.
    pub fn options(look: &FogLook) -> RenderOptions {
        RenderOptions { model: look.model, ..RenderOptions::default() }
    }

    /// The landscape that a view needs.
    pub fn landscape(terrain: &Terrain, camera: &Camera, look: &FogLook) -> Landscape {
        let height_px = f64::from(camera.height);
        let detail = match (look.tolerance_px, camera.projection) {
            (Some(tolerance_px), Projection::Perspective { fov_degrees }) => {
                let px_per_unit = 0.5 * height_px / (0.5 * fov_degrees.to_radians()).tan();
                Detail::Tolerance { eye: camera.eye, px_per_unit, tolerance_px }
            }
            // Parallel rays see all points at one size: as from afar, enlarged.
            (Some(tolerance_px), Projection::Orthographic { height_world }) => {
                let away = 1e6 * terrain.side_world();
                let eye = camera.eye + (camera.eye - camera.target).normalize_or_zero() * away;
                Detail::Tolerance { eye, px_per_unit: height_px / height_world * away, tolerance_px }
            }
            (None, _) => Detail::Full,
        };
        terrain.landscape(&detail, look.profile())
    }

    /// Draws a frame: the ground, and the fog over it. In maximum intensity a channel is the larger one of both, as in the paper.
    ///
    /// # Errors
    /// Those of [`Renderer::render`].
    pub fn render(&mut self, terrain: &Terrain, camera: &Camera, look: &FogLook) -> Result<Rendered> {
        camera.frame()?;
        self.draw(&FogScene::new(Self::landscape(terrain, camera, look))?, camera, look)
    }

    /// Draws a landscape, whose profile is that of the look.
    ///
    /// # Errors
    /// Those of [`Renderer::render`].
    pub fn draw(&mut self, fog: &FogScene, camera: &Camera, look: &FogLook) -> Result<Rendered> {
        let mut scene = fog.scene(camera, &transfer(look)?)?;
        let mut rendered = self.renderer.render(&scene, camera)?;
        if look.model == Model::Mip {
            scene.set_transfer(&nothing()?);
            let behind = without_fog(&scene, camera)?;
            for (pixel, behind) in rendered.image.pixels.iter_mut().zip(behind.pixels) {
                *pixel = std::array::from_fn(|k| pixel[k].max(behind[k]));
            }
        }
        Ok(rendered)
    }
}

/// A landscape, ready to be drawn from anywhere.
pub struct FogScene {
    /// Without its fog.
    ground: Landscape,
    dataset: Dataset,
    field: Field,
}

impl FogScene {
    /// Takes a landscape.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn new(mut landscape: Landscape) -> Result<Self> {
        let fog = std::mem::replace(&mut landscape.fog, CellMesh::empty());
        // Linear density in tetrahedra: many times as fast as whole prisms where the eye is among them.
        let dataset = Dataset::from_cells(fog)?.into_tetrahedra()?;
        let field = dataset.field(&FieldSelection::parse("density", &dataset.arrays))?;
        Ok(Self { ground: landscape, dataset, field })
    }

    /// The ground as it is without fog: opaque where there is any.
    ///
    /// # Errors
    /// Those of [`Renderer::render`].
    pub fn bare(&self, camera: &Camera) -> Result<Image> {
        without_fog(&self.scene(camera, &nothing()?)?, camera)
    }

    /// Fog and ground, as lit for a camera.
    fn scene(&self, camera: &Camera, transfer: &TransferFunction) -> Result<Scene> {
        let mut scene = Scene::new(self.dataset.clone(), self.field.clone(), transfer);
        scene.add_triangles(&self.ground.ground(camera.eye), None)?;
        Ok(scene)
    }
}

/// Fog that does not show.
fn nothing() -> Result<TransferFunction> {
    TransferFunction::constant([0.0; 3], 0.0)
}

/// A scene whose fog does not show.
fn without_fog(scene: &Scene, camera: &Camera) -> Result<Image> {
    Ok(Renderer::new(RenderOptions { model: Model::Emission, ..RenderOptions::default() }).render(scene, camera)?.image)
}

/// Light in proportion to density; in maximum intensity colour in proportion to it.
fn transfer(look: &FogLook) -> Result<TransferFunction> {
    let dark = if look.model == Model::Mip { [0.0; 3] } else { look.color };
    TransferFunction::new(vec![
        ControlPoint { value: 0.0, color: dark, extinction: 0.0 },
        ControlPoint { value: 1.0, color: look.color, extinction: look.extinction_per_unit },
    ])
}
