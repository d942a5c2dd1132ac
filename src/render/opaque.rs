//! Opaque geometry of a frame: lists of the mesh that are made once, what a memory budget leaves beside them, and where they show.
//!
//! In: a scene, with its external picture and triangles, and [`GeometryOptions`]. Out: an [`Opaque`] for the backends, the picture of the volume
//! with the geometry behind it, and its depths.

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use super::{RenderOptions, Renderer, Scene};
use crate::backends::{Counts, Frame, Opaque, OpaquePicture};
use crate::columns::Dataset;
use crate::error::{Error, Result};
use crate::geometry::{GeometryOptions, Layer, List, Primitive, edges, points, surface};
use crate::image::Image;
use crate::memory;
use crate::optics::Model;
use crate::profile::{GeometryStats, Profile};
use crate::stages::View;
use crate::stages::sort::adjacency::Adjacency;

/// The lists of a mesh, each made when it is first drawn.
#[derive(Clone, Debug, Default)]
pub(super) struct Lists {
    surface: OnceLock<Arc<List>>,
    edges: OnceLock<Arc<List>>,
    points: OnceLock<Arc<List>>,
}

impl Lists {
    fn all(&self) -> impl Iterator<Item = &Arc<List>> {
        [&self.surface, &self.edges, &self.points].into_iter().filter_map(OnceLock::get)
    }

    /// Bytes of memory that they take.
    pub(super) fn bytes(&self) -> u64 {
        self.all().map(|list| list.bytes()).sum()
    }
}

/// What making the lists takes at most beside the mesh, in bytes: sides of faces or names of edges, and the lists. A tetrahedron has 4
/// faces and adds 1.2 edges, in its block 1.8; a hexahedron 6 faces, 3 and 5. Vertices under one number: 20.
fn bytes_to_make(dataset: &Dataset, options: &GeometryOptions) -> u64 {
    let (tets, hexahedra, vertices) =
        (dataset.tets.len() as u64, dataset.hexahedra.len() as u64, dataset.positions.len() as u64);
    let canonical = if tets == dataset.cells() as u64 { 0 } else { 20 * vertices };
    let faces = dataset.polyhedra.faces() as u64;
    let surface = 20 * tets + 30 * hexahedra + 2 * faces + canonical;
    let edges = tets * (2 * 8 + 24 * 5 / 4) + hexahedra * (5 * 8 + 24 * 3) + 100 * faces + canonical;
    let points = 13 * vertices + canonical;
    let taken = [(options.surface, surface), (options.edges, edges), (options.points, points)];
    taken.into_iter().filter(|(color, _)| color.is_some()).map(|(_, bytes)| bytes).max().unwrap_or(0)
}

impl Scene {
    /// The layers that are drawn, surface first.
    fn layers(&self, options: &GeometryOptions) -> Vec<Layer> {
        let GeometryOptions { surface_faces: faces, line_px, point_px, .. } = *options;
        let dataset = self.dataset();
        let of_surface = || match self.known_adjacency() {
            Some(adjacency) => surface(dataset, adjacency.exterior()),
            // An order would keep it; the surface is all that is needed of it.
            None => surface(dataset, Adjacency::new(dataset).exterior()),
        };
        let mut layers = Vec::new();
        let mut add = |color: Option<[f32; 3]>, list: &OnceLock<Arc<List>>, make: &dyn Fn() -> List, width_px| {
            if let Some(color) = color {
                layers.push(Layer { list: list.get_or_init(|| Arc::new(make())).clone(), color, faces, width_px });
            }
        };
        add(options.surface, &self.lists.surface, &of_surface, 0.0);
        add(options.edges, &self.lists.edges, &|| edges(dataset), line_px);
        add(options.points, &self.lists.points, &|| points(dataset), point_px);
        // Lines and points over all that they lie on.
        let surfaces = usize::from(options.surface.is_some());
        layers.splice(surfaces..surfaces, self.triangles.iter().cloned());
        layers
    }

    /// Whether all that is drawn has been made.
    fn has_lists(&self, options: &GeometryOptions) -> bool {
        let Lists { surface, edges, points } = &self.lists;
        let all = [(options.surface, surface), (options.edges, edges), (options.points, points)];
        all.into_iter().all(|(color, list)| color.is_none() || list.get().is_some())
    }
}

impl Renderer {
    /// What is opaque in a frame, lists made in its first; none where there is nothing.
    pub(super) fn opaque(&self, scene: &Scene, view: &View, profile: &mut Profile) -> Result<Option<Opaque>> {
        let RenderOptions { geometry, memory_bytes, .. } = &self.options;
        if !geometry.is_any() && scene.triangles.is_empty() && scene.external.is_none() {
            return Ok(None);
        }
        if !scene.has_lists(geometry) {
            let needed_bytes = scene.owned_bytes() + bytes_to_make(scene.dataset(), geometry);
            if let Some(budget_bytes) = memory_bytes.filter(|&budget| budget < needed_bytes) {
                let (what, advice) = ("the mesh with its surface, edges or points", "a picture without them");
                return Err(Error::Memory { budget_bytes, needed_bytes, what, advice });
            }
            memory::check(
                || "surface, edges and points of the mesh".to_owned(),
                Some(bytes_to_make(scene.dataset(), geometry)),
            )?;
        }
        let external = match &scene.external {
            Some(external) => Some(external.part(view.size_px, view.region)?),
            None => None,
        };
        let layers = profile.time("geometry", || scene.layers(geometry));
        profile.sample_memory();
        let mut opaque = Opaque::new(layers);
        if let Some(part) = external {
            opaque = opaque.with_external(profile.time("geometry", || OpaquePicture::of_external(&part, view)));
        }
        memory::check(|| "surface, edges and points in the picture".to_owned(), Some(opaque.bytes(view)))?;
        Ok(Some(opaque))
    }

    /// What is opaque in a frame that was drawn, as what drew it saw it; none where there is nothing.
    #[cfg_attr(
        not(feature = "gpu"),
        expect(clippy::unused_self, clippy::unnecessary_wraps, reason = "the same method as with GPUs")
    )]
    pub(super) fn opaque_picture<'a>(&self, frame: &Frame<'a>) -> Result<Option<Cow<'a, OpaquePicture>>> {
        let Some(opaque) = frame.opaque else { return Ok(None) };
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &self.gpu {
            return Ok(Some(Cow::Owned(gpu.opaque_picture(frame.view)?)));
        }
        Ok(Some(Cow::Borrowed(opaque.picture(frame.view))))
    }

    /// View depths in world units of the pixels of a frame that was drawn, where they are asked for.
    pub(super) fn depths_world(&self, frame: &Frame) -> Result<Option<Vec<f32>>> {
        if !self.options.depth {
            return Ok(None);
        }
        let region = frame.view.region;
        let [width, height] = region.size_px().map(|side| side as usize);
        let picture = self.opaque_picture(frame)?;
        let nothing = || vec![f32::INFINITY; width * height];
        Ok(Some(picture.map_or_else(nothing, |picture| picture.depths_world(frame.view, region))))
    }

    /// Puts what is opaque behind a pass of bands of light, which are those at `places`.
    pub(super) fn put_behind_light(&self, image: &mut Image, frame: &Frame, places: &[usize]) -> Result<()> {
        if self.options.model == Model::EmissionAbsorption
            && let Some(picture) = self.opaque_picture(frame)?
        {
            picture.put_behind_bands(image, frame.view.region, places);
        }
        Ok(())
    }

    /// Puts opaque geometry behind a picture of the volume that the processor drew.
    pub(super) fn put_behind(&self, image: &mut Image, frame: &Frame) {
        // Bands of light do not know here which ones they are.
        let is_light_of_bands = frame.bands.is_some() && self.options.model == Model::EmissionAbsorption;
        if let Some(opaque) = frame.opaque.filter(|_| !is_light_of_bands) {
            opaque.picture(frame.view).put_behind(image, frame.view.region, self.options.model, self.options.output);
        }
    }
}

/// What a memory budget leaves beside the geometry.
pub(super) fn budget(options: &RenderOptions, opaque: Option<&Opaque>, view: &View) -> Option<u64> {
    let taken = opaque.map_or(0, |opaque| opaque.bytes(view));
    options.memory_bytes.map(|bytes| bytes.saturating_sub(taken))
}

/// A budget that was too small for the rest of a frame, in terms of the frame.
pub(super) fn with_geometry(error: Error, options: &RenderOptions, frame: &Frame) -> Error {
    let taken = frame.opaque.map_or(0, |opaque| opaque.bytes(frame.view));
    match (error, options.memory_bytes) {
        (Error::Memory { needed_bytes, what, advice, .. }, Some(budget_bytes)) => {
            Error::Memory { budget_bytes, needed_bytes: needed_bytes + taken, what, advice }
        }
        (other, _) => other,
    }
}

/// What was drawn of it.
pub(super) fn stats(opaque: Option<&Opaque>, counts: &Counts) -> GeometryStats {
    let Some(opaque) = opaque else { return GeometryStats::default() };
    GeometryStats {
        triangles: opaque.count(Primitive::Triangles),
        lines: opaque.count(Primitive::Lines),
        points: opaque.count(Primitive::Points),
        bytes: opaque.layers().iter().map(|layer| layer.list.bytes()).sum(),
        uploaded_bytes: counts.uploaded_bytes,
    }
}
