//! Optics: what a scalar value looks like, and what a ray through it shows.
//!
//! In: control points from a file ([`read`]), a preset ([`presets`]) or a histogram ([`histogram`]); optical depths of ray segments.
//! Out: colour and extinction for a value ([`transfer`], in f32 pieces for stages: [`pieces`]), which intervals show nothing
//! ([`cull_table`]), the weights of a segment's end colours ([`integral`]), and the models as compositors use them ([`Optics`]).
//!
//! Wavelength bands with extinctions of their own: [`bands`]. Light that is reflected: [`lighting`].
//!
//! To add a preset, a line in [`presets::ColorMap`]; a file format, a file in `read/` and a line in
//! [`TransferFunction::parse`](transfer::TransferFunction::parse); a model or an integral, a variant in [`model`] and a file
//! beside [`Emission`]'s. Kernels are branch-free, use no fused multiply-add and no library call, and have a slow twin in f64.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]
#![cfg_attr(test, expect(clippy::float_cmp, reason = "tests state exact results"))]

mod absorption;
pub mod attenuation;
mod averaged;
mod band_cells;
mod band_depths;
mod band_light;
pub mod band_pieces;
pub mod bands;
pub mod color;
mod compositing;
pub mod cull_table;
mod emission;
mod emission_absorption;
pub mod exp;
pub mod histogram;
pub mod integral;
pub mod intervals;
pub mod lanes;
pub mod lighting;
pub mod materials;
mod mip;
pub mod model;
mod pcp;
pub mod pieces;
pub mod presets;
#[cfg(test)]
mod quadrature;
pub mod read;
pub mod texture;
mod thin_points;
pub mod transfer;
#[cfg(feature = "gpu")]
pub(crate) mod wgsl;

pub use absorption::Absorption;
pub use averaged::{Averaged, Textured};
pub use band_cells::{BandCells, BandColumn};
pub use band_depths::BandDepths;
pub use band_light::BandLight;
pub use band_pieces::{BandPasses, BandPiece};
pub use bands::{BandPoint, BandTable};
pub use compositing::{CellSpan, Optics};
pub use cull_table::CullTable;
pub use emission::Emission;
pub use emission_absorption::EmissionAbsorption;
pub use integral::{SegmentWeights, segment_weights, segment_weights_thin};
pub use intervals::Intervals;
pub use lanes::{Contribution, LANES, Lanes, Mask, Segments};
pub use mip::Mip;
pub use model::{Integral, Model, Output, Shading};
pub use pcp::NormalisedLengths;
pub use pieces::{LinearPiece, Piece, Pieces};
pub use transfer::{ControlPoint, TransferFunction};
