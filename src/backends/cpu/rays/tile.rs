//! A tile of rays: some packets at a time, each as far as its rays go.
//!
//! In: the entrances of a tile. Out: what each ray met. Every packet takes one step in turn, so that one waits for memory while others
//! compute.
#![expect(
    clippy::inline_always,
    reason = "kernels must inline into the function compiled for wider vectors, and their loops over lanes become vector code"
)]

use super::RayMesh;
use super::entrances::Entrances;
use super::kernels::RayKernels;
use super::packet::{BACK, Packet};
use crate::backends::cpu::tile::{BLOCK, BLOCKS, BLOCKS_A_SIDE, PIXELS};
use crate::optics::{LANES, Lanes, Optics};
use crate::stages::View;

/// Packets on their way at once.
const PACKETS: usize = 4;
/// Steps between two looks at whether the frame is still wanted: well below 5 ms.
const LOOK: u32 = 1 << 12;

/// One thread's tile.
pub(super) struct RayTile {
    pub(super) entrances: Entrances,
    /// Block by block, lane by lane.
    pub(super) contributions: Box<[[f32; 4]; PIXELS]>,
    /// Rays of the tile that came in again before they left, went back or ran in a circle: they may have met cells out of order.
    pub(super) violations: u64,
}

impl Default for RayTile {
    fn default() -> Self {
        Self { entrances: Entrances::default(), contributions: Box::new([[0.0; 4]; PIXELS]), violations: 0 }
    }
}

/// A packet, its block, and how often each ray has come in.
struct Walker {
    packet: Packet,
    block: usize,
    entered: [usize; LANES],
}

impl RayTile {
    /// Follows all rays of the tile with its first pixel at `origin_px`, whose entrances are found.
    #[inline(always)]
    pub(super) fn follow<O: Optics>(
        &mut self,
        mesh: &RayMesh,
        optics: &O,
        origin_px: [u32; 2],
        kernels: impl RayKernels,
    ) {
        self.violations = 0;
        let mut blocks = 0..BLOCKS;
        let mut walkers: [Option<Walker>; PACKETS] = [const { None }; PACKETS];
        let mut steps = 0;
        loop {
            let mut is_any = false;
            for place in &mut walkers {
                if place.is_none() {
                    *place = self.begin::<O>(mesh, origin_px, &mut blocks);
                }
                let Some(walker) = place else { continue };
                is_any = true;
                let packet = &mut walker.packet;
                kernels.advance(packet, mesh);
                if packet.is_full() {
                    packet.shade(mesh, optics);
                }
                if kernels.bits(&packet.has_left) | kernels.bits(&packet.is_lost) != 0 {
                    self.come_in_again(walker, mesh);
                }
                if kernels.bits(&walker.packet.is_inside) == 0 {
                    walker.packet.shade(mesh, optics);
                    for lane in 0..LANES {
                        self.violations += u64::from(walker.packet.went_back[lane] & 1);
                        self.contributions[walker.block * LANES + lane] = walker.packet.contribution(lane);
                    }
                    *place = None;
                }
            }
            steps += 1;
            if !is_any || (steps % LOOK == 0 && mesh.frame.control.is_cancelled()) {
                return;
            }
        }
    }

    /// The next block into which a ray comes; the others show nothing.
    #[inline(never)]
    fn begin<O: Optics>(
        &mut self,
        mesh: &RayMesh,
        origin_px: [u32; 2],
        blocks: &mut std::ops::Range<usize>,
    ) -> Option<Walker> {
        let is_perspective = mesh.frame.view.is_perspective;
        for nth in blocks {
            let block = in_curve(nth);
            let places = block * LANES..(block + 1) * LANES;
            self.contributions[places.clone()].fill(O::CLEAR);
            if places.clone().all(|place| self.entrances.count(place) == 0) {
                continue;
            }
            let (x, y, lengths) = rays_of(mesh.frame.view, origin_px, block);
            let mut walker = Walker { packet: Packet::new::<O>(x, y, lengths), block, entered: [0; LANES] };
            for (lane, place) in places.enumerate() {
                if let Some((_, front)) = self.entrances.get(place, 0) {
                    walker.packet.enter(lane, mesh.fronts.front(front), mesh.vertices, is_perspective);
                    walker.entered[lane] = 1;
                }
            }
            return Some(walker);
        }
        None
    }

    /// Brings rays that have left the mesh in again, where there is more of it.
    #[inline(never)]
    fn come_in_again(&mut self, walker: &mut Walker, mesh: &RayMesh) {
        for lane in 0..LANES {
            self.violations += u64::from(walker.packet.is_lost[lane] & 1);
            if walker.packet.has_left[lane] & !walker.packet.is_ended[lane] == 0 {
                continue;
            }
            let (place, left_at) = (walker.block * LANES + lane, walker.packet.depth[lane]);
            let Some((depth, front)) = self.entrances.get(place, walker.entered[lane]) else { continue };
            self.violations += u64::from(depth < left_at - BACK * left_at.abs());
            walker.entered[lane] += 1;
            walker.packet.enter(lane, mesh.fronts.front(front), mesh.vertices, mesh.frame.view.is_perspective);
        }
    }
}

/// Blocks along a curve of quarters (Morton 1966): those that are followed together lie together, and meet the same cells.
fn in_curve(nth: usize) -> usize {
    let every_other = |bits: usize| bits & 1 | bits >> 1 & 2 | bits >> 2 & 4;
    every_other(nth >> 1) * BLOCKS_A_SIDE + every_other(nth)
}

/// Columns, rows and world lengths per unit of depth of the rays of a block.
fn rays_of(view: &View, origin_px: [u32; 2], block: usize) -> (Lanes, Lanes, Lanes) {
    let [column, row] = [block % BLOCKS_A_SIDE, block / BLOCKS_A_SIDE].map(|place| place * BLOCK);
    let x: Lanes = std::array::from_fn(|lane| (origin_px[0] as usize + column + lane % BLOCK) as f32);
    let y: Lanes = std::array::from_fn(|lane| (origin_px[1] as usize + row + lane / BLOCK) as f32);
    let length = |lane: usize| view.length_world_per_depth(f64::from(x[lane]), f64::from(y[lane])) as f32;
    (x, y, std::array::from_fn(length))
}
