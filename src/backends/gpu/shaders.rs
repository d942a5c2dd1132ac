//! The shaders of each model, put together from the files in `shaders/`.
//!
//! In: model, integral, what may stand among the fans. Out: WGSL text; a module of it. Release builds leave out the run-time checks of bounds and loops.
#![expect(unsafe_code, reason = "shader modules without run-time checks")]

use crate::backends::cpu::geometry::{LINE_SLACK_PX, SETBACK};
use crate::backends::tiles::TILE_PX;
use crate::geometry::AMBIENT;
use crate::optics::{Integral, Model, Output, Shading, wgsl};
use crate::stages::fans::{Contents, PlanesFor};

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
    /// The same with a transmittance for each channel, from a second source.
    OverByChannel,
    Add,
    Max,
}

/// What a model needs of the GPU.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModelShaders {
    pieces: &'static str,
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
pub(super) fn of(Shading { model, integral, output, has_bands }: Shading) -> ModelShaders {
    let sums: &[&str] = &[shader!("totals"), shader!("ramp"), shader!("sums")];
    let depths: &[&str] = if has_bands { &[shader!("totals"), shader!("ramp"), shader!("band_depths")] } else { sums };
    let (fragment, blend, resolve): (&[&str], _, _) = match (model, integral) {
        (Model::EmissionAbsorption, Integral::Exact) if has_bands => {
            (&[shader!("ramp"), shader!("band_light")], Blend::OverByChannel, "as_it_is")
        }
        // `Pcp` is refused before.
        (Model::EmissionAbsorption, Integral::Exact | Integral::Pcp) => {
            (&[shader!("light"), shader!("ramp"), shader!("emission_absorption")], Blend::Over, "light")
        }
        (Model::EmissionAbsorption, Integral::Average) => {
            (&[shader!("light"), shader!("averaged"), shader!("ends")], Blend::Over, "light")
        }
        (Model::EmissionAbsorption, Integral::Texture) => {
            (&[shader!("light"), shader!("textured"), shader!("ends")], Blend::Over, "light")
        }
        (Model::Absorption, _) => match output {
            Output::Intensity => (depths, Blend::Add, "absorption"),
            Output::Depth => (depths, Blend::Add, "as_it_is"),
        },
        (Model::Emission, _) => (sums, Blend::Add, "emission"),
        (Model::Mip, _) => (&[shader!("mip")], Blend::Max, "mip"),
    };
    let clear = if blend == Blend::Max { [f64::from(-f32::MAX), 0.0, 0.0, 0.0] } else { [0.0; 4] };
    let planes_for = match model {
        // Optical depths to be measured, not looked at, are sums like light.
        Model::Absorption if has_bands || output == Output::Depth => PlanesFor::AllCells,
        Model::EmissionAbsorption | Model::Absorption => PlanesFor::NearCells,
        Model::Emission | Model::Mip => PlanesFor::AllCells,
    };
    let pieces = if has_bands { shader!("band_pieces") } else { shader!("pieces") };
    ModelShaders { pieces, fragment, blend, planes_for, resolve, clear }
}

impl ModelShaders {
    /// The shader that draws fans, and what `contents` says may stand among them; whether opaque geometry ends rays.
    pub(super) fn draw_text(&self, contents: Contents, is_ended: bool) -> String {
        let requirements = if self.blend == Blend::OverByChannel { "enable dual_source_blending;" } else { "" };
        let constants = wgsl::constants();
        let tile = format!("const TILE_PX: u32 = {TILE_PX}u;");
        let common = [
            requirements,
            &constants,
            &tile,
            shader!("frame"),
            if is_ended { shader!("ended") } else { shader!("open") },
            self.pieces,
            shader!("intervals"),
            shader!("integral"),
            shader!("fans"),
            shader!("cases"),
            shader!("order"),
        ];
        let of_cell: &[&str] = if contents.has_only_fans() {
            &[shader!("only_fans")]
        } else {
            &[shader!("records"), shader!("planes"), shader!("hexahedra"), shader!("polyhedra")]
        };
        common
            .into_iter()
            .chain(of_cell.iter().copied())
            .chain(self.fragment.iter().copied())
            .collect::<Vec<_>>()
            .join("\n")
    }
}

/// The shader that makes the picture, opaque geometry behind it or not.
pub(super) fn resolve_text(has_behind: bool) -> String {
    let behind = if has_behind { shader!("behind") } else { shader!("nothing_behind") };
    let common =
        [shader!("frame"), shader!("pieces"), shader!("intervals"), shader!("integral"), behind, shader!("resolve")];
    [wgsl::constants(), common.join("\n")].join("\n")
}

/// The shader that draws opaque geometry, and the external picture before it.
pub(super) fn geometry_text() -> String {
    let constants = [("AMBIENT", AMBIENT), ("SETBACK", SETBACK), ("LINE_SLACK_PX", LINE_SLACK_PX)];
    let constants = constants.map(|(name, value)| format!("const {name}: f32 = {value:e};")).join("\n");
    [&wgsl::constants(), &constants, shader!("geometry"), shader!("strokes"), shader!("external")].join("\n")
}

/// A module of `text`.
pub(super) fn module(device: &wgpu::Device, label: &str, text: String) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(text.into());
    let descriptor = wgpu::ShaderModuleDescriptor { label: Some(label), source };
    if cfg!(debug_assertions) {
        return device.create_shader_module(descriptor);
    }
    // SAFETY: the text is this crate's own. Every index into `fans` comes from an index list and a base vertex made for the
    // bound buffer, or from a list that was counted before its record was written; pieces and texels are found by searches that `piece_count` and `texels` bound, and every loop ends; the same
    // shaders run with all checks in tests.
    unsafe { device.create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked()) }
}
