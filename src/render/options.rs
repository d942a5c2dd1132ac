//! `RenderOptions`: what to draw, beside the scene and the camera.

use crate::backends::cpu::InstructionSet;
use crate::geometry::GeometryOptions;
use crate::optics::{Integral, Model, Output};
use crate::stages::fans::Faces;
use crate::stages::sort::SortMethod;

/// How the CPU composites.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CpuMethod {
    /// Footprints in tiles: planes per pixel.
    #[default]
    Footprints,
    /// Rays followed from cell to cell: the fastest where a mesh is drawn from several places, after some time and 32 bytes a cell to find what
    /// lies across each face, once. For tetrahedra that do not overlap, all of them between the near and the far plane, without opaque
    /// geometry, a memory budget or values that are not finite: footprints draw what is otherwise.
    Rays,
    /// Triangle fans, as in the papers.
    Fans,
}

/// What to draw, beside the scene and the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderOptions {
    /// The optical model.
    pub model: Model,
    /// How a segment is integrated.
    pub integral: Integral,
    /// What an absorption picture holds.
    pub output: Output,
    /// How cells are put in order.
    pub sort: SortMethod,
    /// A ray ends below this transmittance, which bounds the error; 0 never ends one.
    pub stop_transmittance: f32,
    /// Footprints, rays or fans.
    pub cpu_method: CpuMethod,
    /// How fans draw faces of four corners; footprints are always exact.
    pub faces: Faces,
    /// Count the neighbouring cells that the order puts the wrong way round.
    pub check_order: bool,
    /// What scene, picture and all that a frame takes may hold in bytes, columns of mapped files aside. A frame that would
    /// exceed it is drawn in bands, to the same picture. Footprints only.
    pub memory_bytes: Option<u64>,
    /// Draw with this instruction set where the processor has it; the picture is the same.
    pub instruction_set: Option<InstructionSet>,
    /// Opaque geometry of the mesh in the volume.
    pub geometry: GeometryOptions,
    /// Also give how far away what is opaque is, in each pixel: [`Rendered::depth_world`](super::Rendered::depth_world).
    pub depth: bool,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            model: Model::EmissionAbsorption,
            integral: Integral::Exact,
            output: Output::Intensity,
            sort: SortMethod::Auto,
            stop_transmittance: 1e-5,
            cpu_method: CpuMethod::Footprints,
            faces: Faces::Exact,
            check_order: false,
            memory_bytes: None,
            instruction_set: None,
            geometry: GeometryOptions::default(),
            depth: false,
        }
    }
}
