//! `draw`: the tiles of a picture in parallel, each block of 4×4 pixels by a [`March`].

use rayon::prelude::*;

use super::blocks::{BLOCK, Occupancy, ValueBlocks};
use super::classify::Classifier;
use super::dispatch::Dispatch;
use super::enlarge::{Scale, enlarged};
use super::lighting::Lit;
use super::march::{Block, March};
use super::planes::largest_step;
use super::rays::Screen;
use super::sample::{Grid, with_sampler};
use super::shadows::LightVolume;
use super::source::offset_of;
use super::{Options, Planes, Samples};
use crate::camera::{Camera, Frame, Region};
use crate::columns::{Volume, VolumeField};
use crate::error::{Error, Result};
use crate::image::Image;
use crate::optics::lanes::LANES;
use crate::optics::{Model, TransferFunction};

/// Side of a tile in pixels.
const TILE: u32 = 32;

/// What is drawn: a volume, one of its scalars, and what that looks like.
#[derive(Clone, Copy, Debug)]
pub struct Medium<'a> {
    /// The grid.
    pub volume: &'a Volume,
    /// The scalar.
    pub field: &'a VolumeField,
    /// The field's blocks.
    pub blocks: &'a ValueBlocks,
    /// Colour and extinction of the scalar.
    pub transfer: &'a TransferFunction,
}

/// Draws the part of the picture that `camera` draws. A ray ends at view depth `end(x, y)` of its pixel in the whole picture, at an
/// opaque surface perhaps; infinity does not end one.
///
/// Runs on the threads of the rayon pool it is called in; the picture does not depend on their number.
///
/// # Errors
/// [`Error::Camera`] and [`Error::Option`] where camera or options are not valid, [`Error::NoCells`] where the volume has no thickness.
///
/// ```
/// use cellfan::columns::{Array, Association, FieldSelection, Lattice, Volume};
/// use cellfan::depth_planes::{Medium, Options, ValueBlocks, draw};
/// use cellfan::{Camera, Projection, TransferFunction};
/// // A cube of side 2 and extinction 0.75 per unit.
/// let array = Array { name: "v".into(), association: Association::Point, components: 1, values: vec![7_u8; 27].into() };
/// let volume = Volume::new([3, 3, 3], Lattice::default(), vec![array])?;
/// let field = volume.field(&FieldSelection::parse("v", &[]))?;
/// let medium = Medium {
///     volume: &volume,
///     field: &field,
///     blocks: &ValueBlocks::new(&field),
///     transfer: &TransferFunction::constant([1.0, 0.5, 0.0], 0.75)?,
/// };
/// let mut camera = Camera::looking_at([9.0, 1.0, 1.0].into(), [1.0; 3].into(), 5, 5);
/// camera.projection = Projection::Orthographic { height_world: 1.0 };
/// let image = draw(medium, &camera, &Options::default(), &|_, _| f64::INFINITY)?;
/// let opacity = 1.0 - (-1.5_f32).exp();
/// assert!((image.pixel(2, 2)[3] - opacity).abs() < 1e-6 && (image.pixel(2, 2)[1] - 0.5 * opacity).abs() < 1e-6);
/// // An opaque wall half way through.
/// let image = draw(medium, &camera, &Options::default(), &|_, _| 8.0)?;
/// assert!((image.pixel(2, 2)[3] - (1.0 - (-0.75_f32).exp())).abs() < 1e-6);
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn draw(
    medium: Medium<'_>,
    camera: &Camera,
    options: &Options,
    end: &(dyn Fn(u32, u32) -> f64 + Sync),
) -> Result<Image> {
    options.check()?;
    let Medium { volume, field, blocks, transfer } = medium;
    let frame = camera.frame()?;
    if !volume.has_volume() || !volume.lattice.is_finite() || !volume.lattice.grid_from_world().is_finite() {
        let [i, j, k] = volume.dims;
        let found = format!("{i}x{j}x{k} points, whose cells are flat");
        return Err(Error::NoCells { found });
    }
    let planes = Planes::new(volume, camera, options)?;
    let (frame, scales) = sampled(&frame, volume, &planes, options);
    let [width, height] = frame.size_px;
    let [x, y] =
        [scales[0].samples(frame.region.x0, frame.region.x1), scales[1].samples(frame.region.y0, frame.region.y1)];
    let drawn = Region { x0: x[0], y0: y[0], x1: x[1], y1: y[1] };
    let is_scaled = scales.iter().any(|scale| scale.pixels != scale.samples);
    let drawn = if is_scaled { drawn } else { frame.region };
    debug_assert!(drawn.x1 <= width && drawn.y1 <= height);

    let [near, far] = planes.limits;
    let slab = (far - near) / planes.depths.len().max(1) as f64;
    let threshold = -(-f64::from(options.opacity_threshold)).ln_1p() / slab.max(f64::MIN_POSITIVE);
    let classifier = Classifier::new(&transfer.pieces(offset_of(field)), threshold as f32);
    let occupancy = (options.model != Model::Mip).then(|| Occupancy::new(blocks, &classifier, options.filter));
    let dispatch = Dispatch::new(options.instruction_set);
    let grid = Grid::of(field);
    let mut lit = options.lighting.as_ref().map(|lighting| Lit::new(lighting, &frame, &volume.lattice, field));
    let has_shadows = options.lighting.as_ref().is_some_and(|lighting| lighting.has_shadows);
    let from_near = |depths: &[f64]| depths.iter().map(|depth| (depth - near) as f32).collect::<Vec<f32>>();
    // A stretch is about as long as a block.
    let stretch = (0.75 * BLOCK as f64 * largest_step(volume, frame.forward) / slab).clamp(1.0, 1024.0) as usize;
    let only = options.only_plane.map(|plane| plane as usize);
    let between = match only {
        Some(plane) if plane < planes.depths.len() => [planes.edges[plane] - near, planes.edges[plane + 1] - near],
        Some(_) => [0.0, 0.0],
        None => [0.0, far - near],
    };

    let image = with_sampler(field, options.filter, dispatch, |sampler| {
        for lamp in lit.iter_mut().flat_map(Lit::lamps_mut).filter(|_| has_shadows) {
            let toward = lamp.toward_in_grid(&volume.lattice);
            lamp.arriving = Some(LightVolume::new(sampler, &grid, &classifier, toward));
        }
        let march = March {
            sampler,
            classifier: &classifier,
            occupancy: occupancy.as_ref(),
            lit: lit.as_ref(),
            options,
            edges: from_near(&planes.edges),
            depths: options.is_vol_compatible.then(|| from_near(&planes.depths)),
            stretch,
            upper: grid.upper,
        };
        let screen = Screen::new(volume, &frame, near);
        let end = |x: u32, y: u32| end(scales[0].pixel(x), scales[1].pixel(y));
        let block = |corner: [u32; 2], pixels: &mut [[f32; 4]; LANES]| {
            let rays = screen.rays(corner, between, end);
            dispatch.run(Block { march: &march, rays, pixels });
        };
        let is_blank = occupancy.as_ref().is_some_and(|occupancy| !occupancy.is_any);
        let seen = if is_blank || near >= far { None } else { seen(volume, &frame) };
        tiles(drawn, seen, miss(options), block)
    });
    let whole = |scale: Scale| scale.pixels;
    debug_assert!(frame.region.x1 <= whole(scales[0]));
    Ok(if is_scaled { enlarged(&image, drawn, frame.region, scales) } else { image })
}

/// The pixel of a ray that meets nothing.
fn miss(options: &Options) -> [f32; 4] {
    if options.model == Model::Absorption { [options.output.miss(); 4] } else { [0.0; 4] }
}

/// The frame of the samples, whose steps and size are theirs; its region is still that of the picture.
fn sampled(frame: &Frame, volume: &Volume, planes: &Planes, options: &Options) -> (Frame, [Scale; 2]) {
    let mut sampled = *frame;
    let steps = [frame.step_x, frame.step_y];
    let scales = [0, 1].map(|axis| {
        let pixels = frame.size_px[axis];
        let wanted = match options.samples[axis] {
            Samples::Pixels => f64::from(pixels) * options.render_scale,
            Samples::Count(count) => f64::from(count),
            Samples::Nyquist => {
                // What the picture is wide at the nearest plane, in the largest steps across it.
                let depth = if frame.is_perspective { planes.limits[0] } else { 1.0 };
                let across = f64::from(pixels) * steps[axis].length() * depth;
                let step = largest_step(volume, steps[axis].normalize());
                (across / step * options.sample_rate).ceil().min(pixels.into())
            }
        };
        let most = f64::from(Camera::MAX_SIDE);
        Scale { pixels, samples: wanted.round().clamp(1.0, most) as u32, is_to_the_border: options.is_vol_compatible }
    });
    sampled.size_px = scales.map(|scale| scale.samples);
    for (axis, step) in [&mut sampled.step_x, &mut sampled.step_y].into_iter().enumerate() {
        let Scale { pixels, samples, .. } = scales[axis];
        let (pixels, samples) = (f64::from(pixels), f64::from(samples));
        // The paper's outermost samples are on the picture's border.
        let intervals = if options.is_vol_compatible && samples > 1.0 { samples - 1.0 } else { samples };
        *step *= pixels / intervals;
    }
    (sampled, scales)
}

/// The samples that rays through the volume may have; all where a corner is behind the eye.
fn seen(volume: &Volume, frame: &Frame) -> Option<Region> {
    let whole = Region::whole(frame.size_px);
    let corners = volume.corners_world();
    if frame.is_perspective && corners.iter().any(|&corner| frame.depth(corner) <= 0.0) {
        return Some(whole);
    }
    let pixels = corners.map(|corner| frame.pixel(corner));
    let fold = |f: fn(f64, f64) -> f64, start: f64| {
        let x = pixels.iter().map(|pixel| pixel.x).fold(start, f);
        [x, pixels.iter().map(|pixel| pixel.y).fold(start, f)]
    };
    let (low, high) = (fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY));
    let first = |axis: usize| (low[axis] - 1.0).clamp(0.0, frame.size_px[axis].into()) as u32;
    let end = |axis: usize| (high[axis] + 2.0).clamp(0.0, frame.size_px[axis].into()) as u32;
    let region = Region { x0: first(0), y0: first(1), x1: end(0), y1: end(1) };
    (region.x0 < region.x1 && region.y0 < region.y1).then_some(region)
}

/// The picture in `drawn`, tile by tile; blocks that `seen` does not touch are a miss. Tiles and blocks lie as in the whole picture.
fn tiles(
    drawn: Region,
    seen: Option<Region>,
    miss: [f32; 4],
    block: impl Fn([u32; 2], &mut [[f32; 4]; LANES]) + Sync,
) -> Image {
    let [width, height] = drawn.size_px();
    let mut image = Image::filled(width, height, miss);
    let Some(seen) = seen else { return image };
    let (x0, x1) = (drawn.x0.max(seen.x0), drawn.x1.min(seen.x1));
    let (y0, y1) = (drawn.y0.max(seen.y0), drawn.y1.min(seen.y1));
    if x0 >= x1 || y0 >= y1 {
        return image;
    }
    let columns = x0 / TILE..x1.div_ceil(TILE);
    let places: Vec<[u32; 2]> = (y0 / TILE..y1.div_ceil(TILE))
        .flat_map(|row| columns.clone().map(move |column| [column * TILE, row * TILE]))
        .collect();
    let of_tile = |&[left, top]: &[u32; 2]| {
        let _span = tracing::trace_span!("planes", left, top).entered();
        let mut tile = vec![miss; (TILE * TILE) as usize];
        for y in (top..(top + TILE).min(y1)).step_by(4).filter(|y| y + 4 > y0) {
            for x in (left..(left + TILE).min(x1)).step_by(4).filter(|x| x + 4 > x0) {
                let mut pixels = [miss; LANES];
                block([x, y], &mut pixels);
                for (row, pixels) in pixels.chunks(4).enumerate() {
                    let start = ((y - top) as usize + row) * TILE as usize + (x - left) as usize;
                    tile[start..start + 4].copy_from_slice(pixels);
                }
            }
        }
        tile
    };
    let drawn_tiles: Vec<Vec<[f32; 4]>> = places.par_iter().map(of_tile).collect();
    for (&[left, top], tile) in places.iter().zip(&drawn_tiles) {
        let (from, to) = (left.max(drawn.x0), (left + TILE).min(drawn.x1));
        for y in top.max(drawn.y0)..(top + TILE).min(drawn.y1) {
            let source = ((y - top) * TILE + from - left) as usize;
            let target = (y - drawn.y0) as usize * width as usize + (from - drawn.x0) as usize;
            let count = (to - from) as usize;
            image.pixels[target..target + count].copy_from_slice(&tile[source..source + count]);
        }
    }
    image
}
