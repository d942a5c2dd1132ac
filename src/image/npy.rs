//! NPY: `float32` in the machine's byte order, C order, shape `(height, width, channels)` or `(n, height, width, channels)`; RGBA
//! has four channels.

use std::io::Write;
use std::path::Path;

use npyz::{WriteOptions, WriterBuilder};

use super::Picture;
use crate::Result;
use crate::atomic::io_at;

/// Writes `image` as NPY.
pub(super) fn encode(image: &impl Picture, path: &Path, mut writer: impl Write) -> Result<()> {
    write_header(&mut writer, &image.shape().map(u64::from), path)?;
    write_pixels(&mut writer, image, path)
}

/// Writes what stands before the values.
pub(super) fn write_header(writer: impl Write, shape: &[u64], path: &Path) -> Result<()> {
    let header = WriteOptions::<f32>::new().default_dtype().shape(shape).writer(writer);
    header.write_header_only().map(drop).map_err(io_at(path))
}

/// Writes the values of one picture.
pub(super) fn write_pixels(mut writer: impl Write, image: &impl Picture, path: &Path) -> Result<()> {
    writer.write_all(bytemuck::cast_slice(image.values())).map_err(io_at(path))
}
