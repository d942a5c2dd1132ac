//! Pictures against closed forms, against a reference in f64, against each other, and against ones a person looked at.
#![expect(clippy::float_cmp, reason = "misses and equal bytes are exact")]

mod accuracy;
mod analytic;
mod band_arrays;
mod bands;
mod budget;
mod check;
#[path = "../common/mod.rs"]
mod common;
mod cubes;
mod depth_planes;
mod determinism;
mod external;
mod fog;
mod geometry;
mod golden;
#[cfg(feature = "gpu")]
mod gpu;
#[cfg(feature = "gpu")]
mod gpu_bands;
#[cfg(feature = "gpu")]
mod gpu_external;
#[cfg(feature = "gpu")]
mod gpu_geometry;
#[cfg(feature = "gpu")]
mod gpu_order;
#[cfg(feature = "gpu")]
mod gpu_polyhedra;
#[cfg(feature = "gpu")]
mod gpu_region;
#[cfg(feature = "gpu")]
#[path = "../common/gpus.rs"]
mod gpus;
mod hexahedra;
mod hostile;
mod kinds;
mod linear_cubes;
mod lit;
mod meshes;
mod monoid;
mod opaque;
mod order;
mod parity;
mod polyhedra;
mod polyhedron;
mod real;
mod real_volumes;
mod reference;
mod region;
mod session;
mod several;
mod topological;
#[cfg(feature = "gpu")]
mod whole;
mod whole_order;
