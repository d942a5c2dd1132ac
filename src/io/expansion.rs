//! `Expansion`: how much larger than itself a file may become, so that a small one cannot ask for all memory.

use std::cell::Cell;

/// All arrays of a file may become this many times its bytes. Whole meshes reach 36: a grid of hexahedra in one block of
/// LZMA (zlib, and LZMA in VTK's blocks of 32 KiB: 6 and 15).
const LARGEST: u64 = 64;
/// What a file may expand to whatever its size: small files hold little but repetitions.
const SMALLEST_BYTES: u64 = 4 << 20;

/// Bytes that a file may still become.
#[derive(Debug)]
pub(super) struct Expansion {
    left: Cell<u64>,
}

impl Expansion {
    /// Of a file of `file_len` bytes.
    pub(super) fn of(file_len: usize) -> Self {
        Self { left: Cell::new((file_len as u64).saturating_mul(LARGEST).saturating_add(SMALLEST_BYTES)) }
    }

    /// Takes `bytes`; the error is a sentence about what takes them.
    pub(super) fn take(&self, bytes: u64) -> Result<(), String> {
        let left = self.left.get().checked_sub(bytes);
        let left = left.ok_or_else(|| {
            format!("its {bytes} bytes make all arrays more than {LARGEST} times the file; write it uncompressed")
        })?;
        self.left.set(left);
        Ok(())
    }
}
