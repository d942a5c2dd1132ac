//! `Ring`: buffers that the `fans` stage writes while the GPU draws the ones before.
//!
//! In: bytes of memory. Out: slots, lent mapped and taken back filled. Where processor and GPU share memory the GPU reads the mapped buffer
//! itself (`MAPPABLE_PRIMARY_BUFFERS`); elsewhere each slot has a twin in device memory, into which it is copied.
//!
//! A slot goes round: free (mapped) → written → submitted → mapped again when the GPU has done with it → free.

use std::ops::Range;

use crossbeam_channel::{Receiver, Sender, bounded};
use wgpu::{BufferUsages, BufferViewMut, Features, MapMode};

use super::Gpu;
use crate::error::{Error, Result};
use crate::stages::fans::{Fan, FanSlot};

/// Bytes that a slot has at most: beyond this more memory draws no faster.
const SLOT_BYTES_MAX: u64 = 32 << 20;
/// Fans that a slot has at least: no cell but a polyhedron has more.
const FANS_MIN: u64 = 72;

/// One buffer of the ring.
struct Slot {
    /// Written by the processor.
    mapped: wgpu::Buffer,
    /// Read by the GPU; none where it reads `mapped`.
    on_device: Option<wgpu::Buffer>,
    binding: wgpu::BindGroup,
}

/// The buffers.
pub(super) struct Ring {
    slots: Vec<Slot>,
    /// Fans that a slot has room for.
    pub(super) capacity: usize,
    free: (Sender<Option<usize>>, Receiver<Option<usize>>),
}

impl Ring {
    /// One written, one drawn, one on its way.
    pub(super) const SLOTS: usize = 3;

    /// A ring of at most `bytes` bytes, device copies included.
    pub(super) fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, bytes: u64) -> Result<Self> {
        let device = &gpu.device;
        let reads_mapped = device.features().contains(Features::MAPPABLE_PRIMARY_BUFFERS)
            && device.adapter_info().device_type != wgpu::DeviceType::DiscreteGpu;
        let copies = if reads_mapped { 1 } else { 2 };
        let limits = device.limits();
        let most = SLOT_BYTES_MAX.min(limits.max_storage_buffer_binding_size).min(limits.max_buffer_size);
        let fan = size_of::<Fan>() as u64;
        let capacity = ((bytes / (Self::SLOTS as u64 * copies)).min(most) / fan).max(FANS_MIN);
        // Room for all slots and the news that none will come: nobody ever waits to send.
        let free = bounded(Self::SLOTS + 1);
        let slots = (0..Self::SLOTS).map(|i| {
            let buffer = |label, usage, mapped_at_creation| {
                device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some(label),
                    size: capacity * fan,
                    usage,
                    mapped_at_creation,
                })
            };
            let (mapped, on_device) = if reads_mapped {
                (buffer("fans", BufferUsages::MAP_WRITE | BufferUsages::STORAGE, true), None)
            } else {
                let staging = buffer("fans, staged", BufferUsages::MAP_WRITE | BufferUsages::COPY_SRC, true);
                (staging, Some(buffer("fans", BufferUsages::COPY_DST | BufferUsages::STORAGE, false)))
            };
            let binding = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("fans"),
                layout,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: on_device.as_ref().unwrap_or(&mapped).as_entire_binding(),
                }],
            });
            let _ = free.0.send(Some(i));
            Slot { mapped, on_device, binding }
        });
        let ring = Self { slots: slots.collect(), capacity: capacity as usize, free: free.clone() };
        gpu.check()?;
        Ok(ring)
    }

    /// Whether a slot has room for the largest cell.
    pub(super) fn check_room(&self, fans: usize) -> Result<()> {
        if fans <= self.capacity {
            return Ok(());
        }
        let bytes = |fans: usize| fans * size_of::<Fan>();
        let problem = format!(
            "a polyhedron takes up to {} bytes, the picture leaves {} for a slice of cells; give more",
            bytes(fans),
            bytes(self.capacity)
        );
        Err(Error::Option { option: "--gpu-memory", problem })
    }

    /// The next free slot; waits for the GPU if there is none. None where the GPU failed.
    pub(super) fn next(&self) -> Option<usize> {
        self.free.1.recv().ok().flatten()
    }

    /// The memory of a free slot, for `fans` fans.
    pub(super) fn memory(&self, slot: usize, fans: usize) -> MappedFans<'_> {
        MappedFans::new(&self.slots[slot].mapped, 0..fans)
    }

    /// Hands a written slot over to the GPU: its memory may not be lent any more.
    pub(super) fn hand_over(&self, slot: usize, fans: usize, encoder: &mut wgpu::CommandEncoder) {
        let Slot { mapped, on_device, .. } = &self.slots[slot];
        mapped.unmap();
        if let Some(on_device) = on_device {
            encoder.copy_buffer_to_buffer(mapped, 0, on_device, 0, (fans * size_of::<Fan>()) as u64);
        }
    }

    /// What binds the slot's fans.
    pub(super) fn binding(&self, slot: usize) -> &wgpu::BindGroup {
        &self.slots[slot].binding
    }

    /// Frees the slot when the GPU has done with what was submitted.
    pub(super) fn free_when_drawn(&self, slot: usize) {
        let free = self.free.0.clone();
        self.slots[slot].mapped.map_async(MapMode::Write, .., move |result| {
            let _ = free.send(result.ok().map(|()| slot));
        });
    }

    /// Ends the wait for a slot that will not come.
    pub(super) fn give_up(&self) {
        let _ = self.free.0.send(None);
    }
}

/// A part of a mapped buffer, as the memory of so many fans.
pub(super) struct MappedFans<'a> {
    buffer: &'a wgpu::Buffer,
    fans: Range<usize>,
    /// The part in memory, once something is written; its first `written` fans are.
    view: Option<BufferViewMut>,
    written: usize,
}

impl<'a> MappedFans<'a> {
    fn new(buffer: &'a wgpu::Buffer, fans: Range<usize>) -> Self {
        Self { buffer, fans, view: None, written: 0 }
    }
}

impl FanSlot for MappedFans<'_> {
    fn split_at(self, fans: usize) -> (Self, Self) {
        let Range { start, end } = self.fans;
        let middle = start + fans;
        assert!(middle <= end, "the slot was counted for these fans");
        (Self::new(self.buffer, start..middle), Self::new(self.buffer, middle..end))
    }

    fn put(&mut self, fans: &[Fan]) {
        if fans.is_empty() {
            return;
        }
        let bytes_of = |fans: usize| fans * size_of::<Fan>();
        if self.view.is_none() {
            let bytes = bytes_of(self.fans.start) as u64..bytes_of(self.fans.end) as u64;
            self.view = self.buffer.get_mapped_range_mut(bytes).ok();
        }
        // Without memory the device has failed, which is noted there; the frame is an error.
        let Some(view) = &mut self.view else { return };
        let range = bytes_of(self.written)..bytes_of(self.written + fans.len());
        view.slice(range).copy_from_slice(bytemuck::cast_slice(fans));
        self.written += fans.len();
    }
}
