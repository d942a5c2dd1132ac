//! NPY: `float32` in the machine's byte order, C order, shape `(height, width, 4)` or `(n, height, width, 4)`.

use std::io::Write;
use std::path::Path;

use npyz::{WriteOptions, WriterBuilder};

use super::Image;
use crate::Result;
use crate::atomic::io_at;

/// Writes `image` as NPY.
pub(super) fn encode(image: &Image, path: &Path, mut writer: impl Write) -> Result<()> {
    write_header(&mut writer, &[u64::from(image.height), u64::from(image.width), 4], path)?;
    write_pixels(&mut writer, image, path)
}

/// Writes what stands before the values.
pub(super) fn write_header(writer: impl Write, shape: &[u64], path: &Path) -> Result<()> {
    let header = WriteOptions::<f32>::new().default_dtype().shape(shape).writer(writer);
    header.write_header_only().map(drop).map_err(io_at(path))
}

/// Writes the values of one picture.
pub(super) fn write_pixels(mut writer: impl Write, image: &Image, path: &Path) -> Result<()> {
    writer.write_all(bytemuck::cast_slice(&image.pixels)).map_err(io_at(path))
}
