//! Depth planes: a regular grid sampled on planes across the view (Amidon, *Vol: a volumetric rendering module*, 1995).
//!
//! In: a [`Medium`] (a volume, its scalar, a transfer function), a camera, [`Options`], the depths at which rays end. Out: an
//! [`Image`](crate::image::Image). The way there: `planes` between limits that abut the data → `rays`, from the screen to the grid by one
//! matrix, sixteen pixels side by side → `march` from plane to plane, nearest first: `sample` (from the `source`, in the type of the file, or
//! through a wider `filter`), `classify`, light (`lighting`, through `shadows`), compositing; stretches in which nothing shows are
//! left out (`blocks`). Tiles in parallel (`draw`), each loop compiled for several instruction sets (`dispatch`), bytes fetched by `gather`.
//! To add a filter: a sampler in `filter` and a variant of [`Filter`]; a way of spacing planes: a line in `planes`.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

mod blocks;
mod classify;
mod dispatch;
mod draw;
mod enlarge;
mod filter;
mod gather;
mod lighting;
mod march;
mod options;
mod planes;
mod rays;
mod sample;
mod shadows;
mod source;
#[cfg(test)]
mod tests;

pub use blocks::ValueBlocks;
pub use draw::{Medium, draw};
pub use options::{Classification, Filter, Options, Samples};
pub use planes::Planes;

pub use crate::optics::lighting::{Light, Lighting};
