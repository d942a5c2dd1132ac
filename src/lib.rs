//! cellfan renders volumetric simulation data by projecting its cells.
//!
//! ```text
//!  file ─▶ io ─▶ columns ─▶ cull ▶ classify ▶ sort ─┬▶ fans ───────▶ backends ─┬▶ image
//!                (SoA)      └──────── stages ───────┴▶ footprints ─▶           ┘  profile
//!                  ▲             ▲            ▲
//!                cells         optics       camera
//! ```
//!
//! One direction, no way back. In the words of data-oriented design an entity is a cell index, a component is a column, a
//! system is a stage and the world is a dataset in blocks; below, the field's own words are used.
//!
//! | room | holds |
//! | --- | --- |
//! | [`io`] | files to meshes: one file per format |
//! | [`columns`] | [`Dataset`]: a mesh as validated columns in spatial order; [`Field`]: the scalar drawn on it |
//! | [`cells`] | one file per cell kind: faces, orientation, splits |
//! | [`optics`] | transfer functions, ray integrals, one file per optical model |
//! | [`camera`] | [`Camera`]: the ray through each pixel |
//! | [`stages`] | cull, classify, sort, fans, footprints, in that order |
//! | [`fog`] | ground fog: prisms on a terrain at a level of detail that follows the eye |
//! | [`hierarchy`] | regular grids: the octree of their samples, and the cubes of it that a picture needs |
//! | [`geometry`] | boundary surface, edges and points as opaque primitives in the volume |
//! | [`backends`] | compositors: cells in order to pixels, on the CPU or (feature `gpu`) a GPU |
//! | [`depth_planes`] | regular grids sampled on planes across the view |
//! | [`render`](mod@render) | [`Renderer`]: runs the stages and feeds a backend |
//! | [`control`] | progress, and the end of a picture before it is done |
//! | [`session`] | [`Session`]: pictures of a mesh in another program's memory |
//! | [`image`](mod@image), [`profile`] | [`Image`] and where its time went |
//! | [`generate`] | analytic and procedural meshes |
//!
//! # A first picture
//!
//! ```
//! use cellfan::{Camera, Dataset, FieldSelection, RenderOptions, Renderer, Scene, generate, optics::presets};
//!
//! let mesh = generate::orbital(&generate::Settings { cells: 2_000, ..Default::default() })?;
//! let dataset = Dataset::from_tets(mesh)?;
//! let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays))?;
//! let transfer = presets::preset("viridis", field.range, Default::default(), dataset.diagonal_world() / 100.0)?;
//! let camera = Camera::framing(&dataset.corners_world(), 35.0, 20.0, 64, 64);
//! let rendered = Renderer::new(RenderOptions::default()).render(&Scene::new(dataset, field, &transfer), &camera)?;
//! assert!(rendered.image.pixel(32, 32)[3] > 0.0);
//! assert_eq!(rendered.order.exactness, cellfan::profile::Exactness::Exact);
//! # Ok::<(), cellfan::Error>(())
//! ```

mod atomic;
pub mod backends;
pub mod camera;
#[cfg(feature = "capi")]
pub mod capi;
pub mod cells;
pub mod columns;
pub mod control;
pub mod depth_planes;
pub mod error;
pub mod fog;
pub mod generate;
pub mod geometry;
pub mod hierarchy;
pub mod image;
pub mod io;
mod memory;
pub mod optics;
pub mod profile;
pub mod render;
pub mod session;
pub mod stages;

pub use camera::{Camera, Projection, Region};
pub use columns::{Dataset, Field, FieldSelection, Points, Positions, TetMesh};
pub use control::CancelToken;
pub use error::{Error, Result};
pub use image::Image;
pub use optics::{ControlPoint, Integral, Model, TransferFunction};
pub use render::{CpuMethod, RenderOptions, Rendered, Renderer, Scene};
pub use session::{MeshView, Session};
pub use stages::sort::SortMethod;
