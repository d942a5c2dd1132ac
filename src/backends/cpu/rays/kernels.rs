//! The kernels of rays for each instruction set: how a packet advances, compiled once for all models, and a tile for each model.
#![expect(
    unsafe_code,
    reason = "a function compiled for more than the baseline may run only where the processor has it"
)]

use super::packet::Packet;
use super::{RayMesh, RayTile};
use crate::backends::cpu::dispatch::{InstructionSet, Kernels};
#[cfg(target_arch = "x86_64")]
use crate::backends::cpu::simd::{ByAvx2, ByAvx512};
use crate::backends::cpu::simd::{ByLane, Simd};
use crate::optics::Optics;

/// What is done for rays whatever the optical model.
pub(super) trait RayKernels: Simd {
    /// [`Packet::advance`].
    fn advance(self, packet: &mut Packet, mesh: &RayMesh);
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "each caller compiles it for another instruction set")]
fn advance(packet: &mut Packet, mesh: &RayMesh, simd: impl Simd) {
    match (mesh.frame.view.is_perspective, mesh.is_large()) {
        (true, false) => packet.advance::<true, false>(mesh, simd),
        (true, true) => packet.advance::<true, true>(mesh, simd),
        (false, _) => packet.advance::<false, true>(mesh, simd),
    }
}

impl RayKernels for ByLane {
    #[inline(never)]
    fn advance(self, packet: &mut Packet, mesh: &RayMesh) {
        advance(packet, mesh, self);
    }
}

#[cfg(target_arch = "x86_64")]
impl RayKernels for ByAvx2 {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "each caller compiles it for another instruction set")]
    fn advance(self, packet: &mut Packet, mesh: &RayMesh) {
        // SAFETY: whoever made `self` vouched for the processor.
        unsafe { advance_avx2(packet, mesh, self) }
    }
}

#[cfg(target_arch = "x86_64")]
impl RayKernels for ByAvx512 {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "each caller compiles it for another instruction set")]
    fn advance(self, packet: &mut Packet, mesh: &RayMesh) {
        // SAFETY: whoever made `self` vouched for the processor.
        unsafe { advance_avx512(packet, mesh, self) }
    }
}

#[cfg(target_arch = "x86_64")]
#[inline(never)]
#[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
fn advance_avx2(packet: &mut Packet, mesh: &RayMesh, by: ByAvx2) {
    advance(packet, mesh, by);
}

#[cfg(target_arch = "x86_64")]
#[inline(never)]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2")]
fn advance_avx512(packet: &mut Packet, mesh: &RayMesh, by: ByAvx512) {
    advance(packet, mesh, by);
}

impl Kernels {
    /// [`RayTile::follow`] for this instruction set.
    pub(super) fn rays<O: Optics>(self, tile: &mut RayTile, mesh: &RayMesh, optics: &O, origin_px: [u32; 2]) {
        match self.set {
            InstructionSet::Baseline => tile.follow(mesh, optics, origin_px, ByLane),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `Kernels::new`, the only constructor, keeps a set only if `available` detected its features.
            InstructionSet::Avx2 => unsafe { rays_avx2(tile, mesh, optics, origin_px) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            InstructionSet::Avx512 => unsafe { rays_avx512(tile, mesh, optics, origin_px) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
fn rays_avx2<O: Optics>(tile: &mut RayTile, mesh: &RayMesh, optics: &O, origin_px: [u32; 2]) {
    // SAFETY: this function itself may run only where the processor has AVX2.
    tile.follow(mesh, optics, origin_px, unsafe { ByAvx2::new() });
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2")]
fn rays_avx512<O: Optics>(tile: &mut RayTile, mesh: &RayMesh, optics: &O, origin_px: [u32; 2]) {
    // SAFETY: this function itself may run only where the processor has AVX-512 F.
    tile.follow(mesh, optics, origin_px, unsafe { ByAvx512::new() });
}
