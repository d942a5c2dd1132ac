//! SVG to PNG, with `DejaVu` Sans built in.

use ::image::codecs::png::PngEncoder;
use ::image::{ExtendedColorType, ImageEncoder};
use resvg::{tiny_skia, usvg};

/// Pixels a point: sharp on a screen of twice the density.
const SCALE: f32 = 2.0;

/// The bytes of a PNG; what went wrong in words.
pub(super) fn encode(svg: &str) -> Result<Vec<u8>, String> {
    let mut options = usvg::Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    let [width, height] = [tree.size().width(), tree.size().height()].map(|side| (side * SCALE).ceil() as u32);
    let mut pixels = tiny_skia::Pixmap::new(width, height).ok_or("it has no size")?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    let mut png = Vec::new();
    // The background is opaque: premultiplied and straight alpha are the same.
    let written = PngEncoder::new(&mut png).write_image(pixels.data(), width, height, ExtendedColorType::Rgba8);
    written.map_err(|error| error.to_string())?;
    Ok(png)
}
