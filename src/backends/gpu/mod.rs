//! The GPU backend: fans streamed through mapped buffers and blended in 32-bit float, with wgpu.
//!
//! In: a [`Frame`](super::Frame). Out: the same picture as the CPU's. The stages find the draw order and write fans into a ring
//! of buffers (`staging`) while a thread of its own submits the ones before (`draw`); blended sums are resolved into the
//! model's picture and read back (`readback`), or drawn into a caller's texture. `device` chooses what to draw on.
//! To add an optical model: a fragment shader in `shaders/` and its line in `shaders`.

mod accumulate;
mod device;
mod draw;
mod external;
mod geometry;
mod late;
mod layout;
mod pipelines;
mod readback;
mod shaders;
mod staging;
mod submit;
mod timestamps;

pub use device::{AdapterSummary, Gpu, adapters};
pub use draw::GpuCompositor;

#[cfg(test)]
mod tests;
