//! Volumes on depth planes, with the edges and walls of their box as opaque geometry in them.
//!
//! In: a [`VolumeScene`], a camera, [`Options`], [`GeometryOptions`]. Out: a [`Rendered`] picture.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;

use super::{Rendered, VolumeScene};
use crate::backends::{Counts, Opaque, OpaquePicture};
use crate::camera::Camera;
use crate::columns::Volume;
use crate::depth_planes::{Medium, Options, ValueBlocks, draw};
use crate::error::Result;
use crate::geometry::{GeometryOptions, Layer, List, Primitive};
use crate::memory;
use crate::profile::{CellStats, Exactness, OrderStats, Profile};
use crate::stages::{View, scene_per_length};

/// Bytes of a pixel: the picture, its tiles, and the picture that is enlarged.
const BYTES_PER_PIXEL: u64 = 3 * 16;

/// Draws one frame of a volume on depth planes. Of geometry it has the walls, edges and corners of its box; `has_depth` asks for
/// [`Rendered::depth_world`].
///
/// Runs on the threads of the rayon pool it is called in; the picture does not depend on their number.
///
/// # Errors
/// Those of [`draw`]; [`Error::Option`](crate::Error::Option) where the geometry cannot be drawn as it is asked for,
/// [`Error::OutOfMemory`](crate::Error::OutOfMemory) where the picture is too large, [`Error::Changed`](crate::Error::Changed) where a
/// file that is used in place has changed.
///
/// ```
/// use cellfan::columns::{Array, Association, FieldSelection, Lattice, Volume};
/// use cellfan::render::{VolumeScene, depth_planes};
/// use cellfan::{Camera, TransferFunction, depth_planes::Options, geometry::GeometryOptions};
/// let values: Vec<f32> = (0..8 * 8 * 8).map(|n| (n % 8) as f32).collect();
/// let array = Array { name: "v".into(), association: Association::Point, components: 1, values: values.into() };
/// let volume = Volume::new([8; 3], Lattice::default(), vec![array])?;
/// let field = volume.field(&FieldSelection::parse("v", &[]))?;
/// let camera = Camera::framing(&volume.corners_world(), 35.0, 20.0, 32, 32);
/// let scene = VolumeScene::new(volume, field, &TransferFunction::constant([1.0; 3], 0.2)?);
/// let walls = GeometryOptions { surface: Some([0.5; 3]), ..GeometryOptions::default() };
/// let picture = depth_planes(&scene, &camera, &Options::default(), &walls, false)?;
/// assert_eq!(picture.image.pixel(16, 16)[3], 1.0);
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn depth_planes(
    scene: &VolumeScene,
    camera: &Camera,
    options: &Options,
    geometry: &GeometryOptions,
    has_depth: bool,
) -> Result<Rendered> {
    let start = Instant::now();
    options.check()?;
    geometry.check()?;
    let VolumeScene { volume, field, transfer, blocks, triangles, external } = scene;
    if let Some(backing) = &volume.backing {
        backing.check()?;
    }
    let [center, diagonal] = scene.extent();
    let diagonal_world = diagonal.length();
    let view = View::around(camera, center, diagonal_world)?;
    let [width, height] = view.region.size_px();
    let bytes = u64::from(width) * u64::from(height) * BYTES_PER_PIXEL;
    memory::check(|| format!("drawing a picture of {width}x{height} pixels"), Some(bytes))?;

    let mut profile = Profile::default();
    let mut layers = layers(volume, center, diagonal_world, geometry);
    // Lines and points over all that they lie on.
    let surfaces = usize::from(geometry.surface.is_some());
    layers.splice(surfaces..surfaces, triangles.iter().cloned());
    let external = external.as_ref().map(|external| external.part(view.size_px, view.region)).transpose()?;
    let opaque = (!layers.is_empty() || external.is_some()).then(|| {
        let opaque = Opaque::new(layers);
        match external {
            Some(part) => opaque.with_external(OpaquePicture::of_external(&part, &view)),
            None => opaque,
        }
    });
    let behind = opaque.as_ref().map(|opaque| profile.time("geometry", || opaque.picture(&view)));
    let blocks = blocks.get_or_init(|| profile.time("blocks", || ValueBlocks::new(field)));
    let medium = Medium { volume, field, blocks, transfer };
    let end = |x: u32, y: u32| behind.map_or(f64::INFINITY, |behind| behind.depth_world(&view, [x, y]));
    let mut image = profile.time("planes", || draw(medium, camera, options, &end))?;
    if let Some(behind) = behind {
        behind.put_behind(&mut image, view.region, options.model, options.output);
    }
    let nothing = || vec![f32::INFINITY; image.pixels.len()];
    let depth_world = has_depth.then(|| behind.map_or_else(nothing, |behind| behind.depths_world(&view, view.region)));
    let cells = volume.cells() as u64;
    Ok(Rendered {
        image,
        bands: None,
        depth_world,
        cells: CellStats { total: cells, drawn: cells, ..CellStats::default() },
        triangles: 0,
        geometry: super::opaque::stats(opaque.as_ref(), &Counts::default()),
        order: OrderStats { kind: "planes", exactness: Exactness::Exact, ..OrderStats::default() },
        profile,
        frame_ms: start.elapsed().as_secs_f64() * 1e3,
    })
}

/// The box of a volume as geometry.
fn layers(volume: &Volume, center: DVec3, diagonal_world: f64, options: &GeometryOptions) -> Vec<Layer> {
    let scale = scene_per_length(diagonal_world);
    let corners = volume.corners_world().map(|corner| ((corner - center) * scale).as_vec3().to_array());
    // Of the two faces across each axis, outwards where the grid is right-handed.
    let is_left_handed = volume.lattice.steps().determinant() < 0.0;
    let triangles = (0..3).flat_map(|axis| {
        let [u, v] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
        [0, 1 << axis].into_iter().flat_map(move |side| {
            let turned = (side == 0) != is_left_handed;
            let [u, v] = if turned { [v, u] } else { [u, v] };
            [side, side + u, side + u + v, side, side + u + v, side + v]
        })
    });
    let ends = (0..8_usize).flat_map(|a| (0..3).map(move |axis| [a, a | 1 << axis]).filter(|&[a, b]| a != b).flatten());
    let list = |primitive, places: Vec<usize>| {
        Arc::new(List::new(primitive, places.into_iter().map(|place| corners[place]).collect()))
    };
    let all = [
        (options.surface, list(Primitive::Triangles, triangles.collect()), 0.0),
        (options.edges, list(Primitive::Lines, ends.collect()), options.line_px),
        (options.points, list(Primitive::Points, (0..8).collect()), options.point_px),
    ];
    let layer = |(color, list, width_px): (Option<[f32; 3]>, Arc<List>, f32)| {
        Some(Layer { list, color: color?, faces: options.surface_faces, width_px })
    };
    all.into_iter().filter_map(layer).collect()
}
