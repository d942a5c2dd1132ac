//! `VolumeScene`: a regular grid, the scalar drawn on it, and what the scalar looks like.

use std::sync::OnceLock;

use crate::columns::{Volume, VolumeField};
use crate::depth_planes::ValueBlocks;
use crate::optics::TransferFunction;

/// A regular grid, the scalar drawn on it, and what the scalar looks like. Arrays are used in place.
#[derive(Clone, Debug)]
pub struct VolumeScene {
    pub(super) volume: Volume,
    pub(super) field: VolumeField,
    pub(super) transfer: TransferFunction,
    /// Made when a frame first asks for them.
    pub(super) blocks: OnceLock<ValueBlocks>,
}

impl VolumeScene {
    /// A volume, one of its fields, and colour and extinction of that.
    pub fn new(volume: Volume, field: VolumeField, transfer: &TransferFunction) -> Self {
        Self { volume, field, transfer: transfer.clone(), blocks: OnceLock::new() }
    }

    /// The grid.
    pub fn volume(&self) -> &Volume {
        &self.volume
    }

    /// The scalar.
    pub fn field(&self) -> &VolumeField {
        &self.field
    }

    /// Shows the field with another transfer function.
    pub fn set_transfer(&mut self, transfer: &TransferFunction) {
        self.transfer = transfer.clone();
    }
}
