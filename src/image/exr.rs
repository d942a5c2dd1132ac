//! `OpenEXR`: f32, linear, run-length coded, no loss. Channels R, G, B, A, premultiplied as the format expects, and Z, the depth, where there
//! is one; or one channel a band, by its name.

use std::io::{Cursor, Seek, Write};
use std::path::Path;

use ::exr::image::read::image::ReadLayers;
use ::exr::image::read::layers::ReadChannels;
use ::exr::image::write::WritableImage;
use ::exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image as ExrImage, Layer};
use ::exr::math::Vec2;
use ::exr::meta::MetaData;
use ::exr::meta::attribute::Text;
use ::exr::meta::header::LayerAttributes;
use ::exr::prelude::SmallVec;
use ::image::codecs::openexr::OpenExrEncoder;
use ::image::{ExtendedColorType, ImageEncoder};

use super::{BandImage, DepthImage, Image, encoder_error, read};
use crate::error::presentable;
use crate::{Error, Result, memory};

/// Writes `image` as EXR.
pub(super) fn encode(image: &Image, path: &Path, writer: impl Write + Seek) -> Result<()> {
    OpenExrEncoder::new(writer)
        .write_image(bytemuck::cast_slice(&image.pixels), image.width, image.height, ExtendedColorType::Rgba32F)
        .map_err(|error| encoder_error(path, error))
}

/// Writes `image` as EXR, one channel a band.
pub(super) fn encode_bands(image: &BandImage, path: &Path, writer: impl Write + Seek) -> Result<()> {
    let bands = image.names.len();
    let what = || format!("writing an EXR of {}x{} pixels in {bands} bands", image.width, image.height);
    // Once channel by channel, once coded.
    memory::check(what, (image.values.len() as u64).checked_mul(8))?;
    let refuse = |problem: String| Error::Encode { path: path.to_owned(), problem };
    let channel = |(k, name): (usize, &String)| {
        let text = Text::new_or_none(name).filter(|_| !name.is_empty() && name.len() < 256).ok_or_else(|| {
            refuse(format!("an EXR cannot have a channel {name:?}; give the band a plain, short name"))
        })?;
        let values = image.values.iter().skip(k).step_by(bands).copied().collect();
        Ok(AnyChannel::new(text, FlatSamples::F32(values)))
    };
    let channels = image.names.iter().enumerate().map(channel).collect::<Result<_>>()?;
    write_channels([image.width, image.height], channels, path, writer)
}

/// Writes `picture` as EXR, its depth as channel Z.
pub(super) fn encode_with_depth(picture: &DepthImage, path: &Path, writer: impl Write + Seek) -> Result<()> {
    let DepthImage { image, depth_world } = picture;
    let (width, height) = (image.width, image.height);
    memory::check(
        || format!("writing an EXR of {width}x{height} pixels with depth"),
        (depth_world.len() as u64).checked_mul(40),
    )?;
    let of_image = |(name, k): (&str, usize)| {
        let values = image.pixels.iter().map(|pixel| pixel[k]).collect();
        AnyChannel::new(name, FlatSamples::F32(values))
    };
    let depth = AnyChannel::new("Z", FlatSamples::F32(depth_world.clone()));
    let channels = [("R", 0), ("G", 1), ("B", 2), ("A", 3)].map(of_image).into_iter().chain([depth]);
    write_channels([width, height], channels.collect(), path, writer)
}

fn write_channels(
    [width, height]: [u32; 2],
    channels: SmallVec<[AnyChannel<FlatSamples>; 4]>,
    path: &Path,
    writer: impl Write + Seek,
) -> Result<()> {
    let size = (width as usize, height as usize);
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::FAST_LOSSLESS, AnyChannels::sort(channels));
    // On one thread: blocks of the file then stand in one order.
    ExrImage::from_layer(layer).write().non_parallel().to_buffered(writer).map_err(|error| match error {
        ::exr::error::Error::Io(source) => Error::Io { path: path.to_owned(), source },
        other => Error::Encode { path: path.to_owned(), problem: other.to_string() },
    })
}

/// Reads the picture of the first layer: channels R, G, B and A, or Y for all of R, G and B, and Z; a channel may have words and a dot before its
/// name. Pixels outside the file's data are nothing.
pub(super) fn decode(bytes: &[u8], path: &Path) -> Result<(Image, Option<Vec<f32>>)> {
    let malformed = |place: &str, problem: String| Error::Malformed {
        path: path.to_owned(),
        place: place.to_owned(),
        problem: presentable(problem),
    };
    let damaged = |error: ::exr::error::Error| malformed("EXR", error.to_string());
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(damaged)?;
    let Some(header) = meta.headers.first() else {
        return Err(malformed("EXR", "there is no picture in it".to_owned()));
    };
    let whole = header.shared_attributes.display_window;
    let channels = header.channels.list.len() as u64;
    for size in meta.headers.iter().map(|header| header.layer_size).chain([whole.size]) {
        let side = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
        // What is decoded and what is kept, 4 bytes a channel each; the picture and its depth.
        read::check_expansion(bytes, path, [side(size.x()), side(size.y())], 8 * channels + 20)?;
    }
    let layer = ::exr::image::read::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(damaged)?
        .layer_data;
    let find = |name: &str| -> Result<Option<Vec<f32>>> {
        let list = &layer.channel_data.list;
        let is_called = |channel: &&AnyChannel<FlatSamples>| channel.name.to_string() == name;
        let ends_so = |channel: &&AnyChannel<FlatSamples>| channel.name.to_string().ends_with(&format!(".{name}"));
        let Some(channel) = list.iter().find(is_called).or_else(|| list.iter().find(ends_so)) else { return Ok(None) };
        if channel.sampling != Vec2(1, 1) {
            let advice = "write it with a value for each pixel".to_owned();
            let what = format!("channel {name} of an EXR with fewer values than pixels");
            return Err(Error::Unsupported { path: path.to_owned(), what, advice });
        }
        Ok(Some(channel.sample_data.values_as_f32().collect()))
    };
    let gray = if find_name(&layer.channel_data.list, "R") { None } else { find("Y")? };
    let color = |name: &str| if gray.is_some() { Ok(gray.clone()) } else { find(name) };
    let [red, green, blue] = [color("R")?, color("G")?, color("B")?];
    let (alpha, depth) = (find("A")?, find("Z")?);
    let Vec2(width, height) = whole.size;
    let mut image = Image::filled(width as u32, height as u32, [0.0; 4]);
    let mut depth_world = depth.is_some().then(|| vec![f32::INFINITY; width * height]);
    let (first, origin) = (layer.attributes.layer_position, whole.position);
    // Where a value of the data is in the picture; none outside.
    let place = |first: i32, origin: i32, at: usize, side: usize| {
        usize::try_from(i64::from(first) - i64::from(origin) + at as i64).ok().filter(|&at| at < side)
    };
    for y in 0..layer.size.y() {
        let Some(row) = place(first.y(), origin.y(), y, height) else { continue };
        for x in 0..layer.size.x() {
            let Some(column) = place(first.x(), origin.x(), x, width) else { continue };
            let (from, to) = (y * layer.size.x() + x, row * width + column);
            let value = |channel: &Option<Vec<f32>>, missing| channel.as_ref().map_or(missing, |values| values[from]);
            image.pixels[to] = [value(&red, 0.0), value(&green, 0.0), value(&blue, 0.0), value(&alpha, 1.0)];
            if let (Some(kept), Some(depth)) = (&mut depth_world, &depth) {
                kept[to] = depth[from];
            }
        }
    }
    Ok((image, depth_world))
}

/// Whether there is such a channel.
fn find_name(channels: &[AnyChannel<FlatSamples>], name: &str) -> bool {
    channels
        .iter()
        .map(|channel| channel.name.to_string())
        .any(|known| known == name || known.ends_with(&format!(".{name}")))
}
