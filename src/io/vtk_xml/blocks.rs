//! Compressed arrays: a table of blocks, then the blocks, each compressed by itself.
//!
//! The table is: number of blocks, bytes of a block, bytes of the last block if it is shorter (else 0), and then the
//! compressed bytes of each block.

use std::io::Read;

use lzma_rust2::XzReader;
use rayon::prelude::*;

/// How a file's blocks are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compressor {
    Zlib,
    Lz4,
    Lzma,
}

/// What the head of the table says about the uncompressed bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockSizes {
    pub(super) blocks: u64,
    pub(super) block: u64,
    pub(super) last: u64,
}

/// An `.xz` stream asks for a dictionary of any size; VTK's largest (preset 9) takes 65 MiB.
const LZMA_MEMORY_KIB: u32 = 80 * 1024;

impl Compressor {
    /// The compressor that `VTKFile` names.
    pub(super) fn by_name(name: &str) -> Option<Self> {
        match name {
            "vtkZLibDataCompressor" => Some(Self::Zlib),
            "vtkLZ4DataCompressor" => Some(Self::Lz4),
            "vtkLZMADataCompressor" => Some(Self::Lzma),
            _ => None,
        }
    }

    /// No compressed byte gives more than these: deflate's longest match is 258 bytes for two bits, LZ4's lengths grow
    /// by 255 a byte, and `xz` reaches 6,850 on 256 MiB of zeros (presets 6 and 9e), rounded up.
    fn largest_ratio(self) -> u64 {
        match self {
            Self::Zlib => 1032,
            Self::Lz4 => 255,
            Self::Lzma => 8192,
        }
    }

    fn expand_block(self, compressed: &[u8], block: &mut [u8]) -> Result<(), String> {
        let read = |mut reader: Box<dyn Read + '_>, block: &mut [u8]| {
            reader.read_exact(block).map_err(|error| error.to_string())?;
            // Reading to the end checks the checksum.
            match reader.read(&mut [0]) {
                Ok(0) => Ok(()),
                Ok(_) => Err(format!("holds more than the {} bytes declared", block.len())),
                Err(error) => Err(error.to_string()),
            }
        };
        match self {
            Self::Zlib => read(Box::new(flate2::bufread::ZlibDecoder::new(compressed)), block),
            Self::Lzma => read(Box::new(XzReader::new_mem_limit(compressed, false, LZMA_MEMORY_KIB)), block),
            Self::Lz4 => match lz4_flex::block::decompress_into(compressed, block) {
                Ok(bytes) if bytes == block.len() => Ok(()),
                Ok(bytes) => Err(format!("holds {bytes} bytes, not the {} declared", block.len())),
                Err(error) => Err(error.to_string()),
            },
        }
    }

    /// How many bytes `compressed` ones become, if they can.
    ///
    /// The error is a sentence about the array.
    pub(super) fn total_bytes(self, sizes: BlockSizes, compressed: usize) -> Result<u64, String> {
        let total = sizes.total().ok_or("declares a size beyond 64 bits")?;
        if total > (compressed as u64).saturating_mul(self.largest_ratio()) {
            return Err(format!("declares {total} bytes in {compressed} compressed ones, which cannot be"));
        }
        Ok(total)
    }

    /// The uncompressed bytes of blocks that follow each other from block `first` on: `sizes` are their bytes in `compressed`
    /// and uncompressed.
    ///
    /// The error is a sentence about the array.
    pub(super) fn expand(self, first: usize, sizes: &[(usize, usize)], compressed: &[u8]) -> Result<Vec<u8>, String> {
        let mut bytes = vec![0_u8; sizes.iter().map(|&(_, size)| size).sum()];
        let mut work = Vec::with_capacity(sizes.len());
        let (mut input, mut output) = (compressed, &mut bytes[..]);
        for (i, &(compressed_size, size)) in sizes.iter().enumerate() {
            let (block_in, block_out);
            (block_in, input) = input.split_at_checked(compressed_size).ok_or("ends before its last block")?;
            (block_out, output) = output.split_at_mut(size);
            work.push((first + i, block_in, block_out));
        }
        work.into_par_iter().try_for_each(|(block, block_in, block_out)| {
            self.expand_block(block_in, block_out).map_err(|problem| format!("compressed block {block}: {problem}"))
        })?;
        Ok(bytes)
    }
}

impl BlockSizes {
    /// All uncompressed bytes; `None` where the sizes contradict each other or overflow.
    pub(super) fn total(self) -> Option<u64> {
        let Self { blocks, block, last } = self;
        match (blocks, last) {
            (0, _) => Some(0),
            (_, 0) => blocks.checked_mul(block),
            _ if last > block => None,
            _ => (blocks - 1).checked_mul(block)?.checked_add(last),
        }
    }

    /// The uncompressed bytes of block `block`.
    pub(super) fn of(self, block: u64) -> u64 {
        if block + 1 == self.blocks && self.last > 0 { self.last } else { self.block }
    }
}
