//! The shaders of each model, put together from the files in `shaders/`.
//!
//! In: model and integral. Out: WGSL text; a module of it. Release builds leave out the run-time checks of bounds and loops.
#![expect(unsafe_code, reason = "shader modules without run-time checks")]

use crate::optics::{Integral, Model, wgsl};
use crate::stages::fans::PlanesFor;

macro_rules! shader {
    ($name:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $name, ".wgsl"))
    };
}

/// How a model's fragments combine in the accumulated picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Blend {
    /// Premultiplied, over what lies behind.
    Over,
    Add,
    Max,
}

/// What a model needs of the GPU.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModelShaders {
    fragment: &'static [&'static str],
    pub(super) blend: Blend,
    /// Light that nothing dims shows every rounding, a maximum every pixel of the outline.
    pub(super) planes_for: PlanesFor,
    /// The fragment of `resolve.wgsl` that makes the picture.
    pub(super) resolve: &'static str,
    /// What the accumulated picture begins with.
    pub(super) clear: [f64; 4],
}

/// The table of models.
pub(super) fn of(model: Model, integral: Integral) -> ModelShaders {
    let sums: &[&str] = &[shader!("ramp"), shader!("sums")];
    let (fragment, blend, resolve): (&[&str], _, _) = match (model, integral) {
        (Model::EmissionAbsorption, Integral::Exact) => {
            (&[shader!("ramp"), shader!("emission_absorption")], Blend::Over, "emission_absorption")
        }
        (Model::EmissionAbsorption, Integral::Average) => {
            (&[shader!("averaged"), shader!("ends")], Blend::Over, "emission_absorption")
        }
        (Model::EmissionAbsorption, Integral::Texture) => {
            (&[shader!("textured"), shader!("ends")], Blend::Over, "emission_absorption")
        }
        (Model::Absorption, _) => (sums, Blend::Add, "absorption"),
        (Model::Emission, _) => (sums, Blend::Add, "emission"),
        (Model::Mip, _) => (&[shader!("mip")], Blend::Max, "mip"),
    };
    let clear = if blend == Blend::Max { [f64::from(-f32::MAX), 0.0, 0.0, 0.0] } else { [0.0; 4] };
    let planes_for = match model {
        Model::EmissionAbsorption | Model::Absorption => PlanesFor::NearCells,
        Model::Emission | Model::Mip => PlanesFor::AllCells,
    };
    ModelShaders { fragment, blend, planes_for, resolve, clear }
}

impl ModelShaders {
    /// The shader that draws fans.
    pub(super) fn draw_text(&self) -> String {
        let common = [&wgsl::constants(), shader!("frame"), shader!("pieces"), shader!("integral"), shader!("fans")];
        common.into_iter().chain(self.fragment.iter().copied()).collect::<Vec<_>>().join("\n")
    }
}

/// The shader that makes the picture.
pub(super) fn resolve_text() -> String {
    [&wgsl::constants(), shader!("frame"), shader!("pieces"), shader!("integral"), shader!("resolve")].join("\n")
}

/// A module of `text`.
pub(super) fn module(device: &wgpu::Device, label: &str, text: String) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(text.into());
    let descriptor = wgpu::ShaderModuleDescriptor { label: Some(label), source };
    if cfg!(debug_assertions) {
        return device.create_shader_module(descriptor);
    }
    // SAFETY: the text is this crate's own. Every index into `fans` comes from an index list and a base vertex made for the
    // bound buffer, pieces and texels are found by searches that `piece_count` and `texels` bound, and every loop ends; the same
    // shaders run with all checks in tests.
    unsafe { device.create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked()) }
}
