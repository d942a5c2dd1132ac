//! What shaders read beside the fans, declared once in Rust; a test holds every offset against the shaders' own.

use bytemuck::{Pod, Zeroable};

use crate::backends::tiles::TileGrid;
use crate::backends::{Frame, Opaque};
use crate::columns::Bounds;
use crate::geometry::{Layer, Looks, SurfaceFaces};
use crate::optics::texture::OpacityTexture;
use crate::optics::{BandPiece, LinearPiece, Pieces};
use crate::stages::View;

/// `Frame` of `shaders/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct FrameUniform {
    pub(super) ndc_scale: [f32; 2],
    pub(super) ndc_offset: [f32; 2],
    pub(super) ray: [f32; 3],
    pub(super) is_perspective: u32,
    pub(super) ray_step_x: [f32; 3],
    pub(super) piece_count: u32,
    pub(super) ray_step_y: [f32; 3],
    pub(super) v_far: f32,
    pub(super) v_near: f32,
    pub(super) texels: u32,
    pub(super) texels_per_length: f32,
    pub(super) texels_per_extinction: f32,
    pub(super) s_middle: f32,
    pub(super) s_scale: f32,
    pub(super) order_scale: f32,
    pub(super) order_offset: f32,
    pub(super) first_px: [f32; 2],
    pub(super) tile_columns: u32,
    pub(super) first_tile: u32,
}

/// `Piece` of `shaders/pieces.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct PieceRecord {
    pub(super) begin: f32,
    pub(super) end: f32,
    pub(super) start: f32,
    pub(super) extinction: f32,
    pub(super) color: [f32; 3],
    pub(super) extinction_slope: f32,
    pub(super) color_slope: [f32; 3],
    pub(super) is_transparent: u32,
}

/// `Piece` of `shaders/band_pieces.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct BandPieceRecord {
    pub(super) begin: f32,
    pub(super) end: f32,
    pub(super) start: f32,
    pub(super) is_transparent: u32,
    pub(super) extinction: [f32; 4],
    pub(super) extinction_slope: [f32; 4],
    pub(super) color: [f32; 4],
    pub(super) color_slope: [f32; 4],
}

/// Where lengths and extinctions are among the texels of an opacity texture; nothing without one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Texels {
    side: u32,
    per_length: f32,
    per_extinction: f32,
}

impl Texels {
    pub(super) fn of(texture: &OpacityTexture) -> Self {
        let [per_length, per_extinction] = texture.texel_per_length_and_extinction();
        Self { side: texture.size() as u32, per_length, per_extinction }
    }
}

impl FrameUniform {
    pub(super) fn new(frame: &Frame, texels: Texels, (s_middle, s_scale): (f32, f32)) -> Self {
        let (view, intervals) = (frame.view, frame.intervals());
        let [order_scale, order_offset] = order_from_inverse_depth(frame);
        let [width, height] = view.region.size_px().map(|side| side as f32);
        let tiles = TileGrid::new(view);
        let tile_columns = tiles.columns.len() as u32;
        let world = |direction: glam::DVec3| (direction * view.world_per_scene).as_vec3().to_array();
        let (ray, step_x, step_y) = if view.is_perspective {
            (view.forward + view.corner, view.step_x, view.step_y)
        } else {
            (view.forward, glam::DVec3::ZERO, glam::DVec3::ZERO)
        };
        let (v_far, v_near) = view.inverse_depth_range();
        Self {
            // Pixel centres are at whole numbers, rows run down.
            ndc_scale: [2.0 / width, -2.0 / height],
            ndc_offset: [1.0 / width - 1.0, 1.0 - 1.0 / height],
            ray: world(ray),
            is_perspective: view.is_perspective.into(),
            ray_step_x: world(step_x),
            piece_count: intervals.len() as u32,
            ray_step_y: world(step_y),
            v_far: finite(v_far),
            v_near: finite(v_near),
            texels: texels.side,
            texels_per_length: texels.per_length,
            texels_per_extinction: texels.per_extinction,
            s_middle,
            s_scale,
            order_scale,
            order_offset,
            first_px: [view.region.x0 as f32, view.region.y0 as f32],
            tile_columns,
            first_tile: tiles.rows.start * tile_columns + tiles.columns.start,
        }
    }
}

/// `Geometry` of `shaders/geometry.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct GeometryUniform {
    pub(super) eye: [f32; 3],
    pub(super) is_perspective: u32,
    pub(super) forward: [f32; 3],
    pub(super) near: f32,
    pub(super) to_x: [f32; 3],
    pub(super) center_x: f32,
    pub(super) to_y: [f32; 3],
    pub(super) center_y: f32,
    pub(super) first: [f32; 3],
    pub(super) v_far: f32,
    pub(super) step_x: [f32; 3],
    pub(super) v_near: f32,
    pub(super) step_y: [f32; 3],
    pub(super) setback_px: f32,
    pub(super) color: [f32; 3],
    pub(super) width_px: f32,
    pub(super) ndc_scale: [f32; 2],
    pub(super) ndc_offset: [f32; 2],
    pub(super) size_px: [f32; 2],
    pub(super) z_scale: f32,
    pub(super) z_offset: f32,
    pub(super) first_px: [f32; 2],
    pub(super) has_back_only: u32,
    pub(super) has_looks: u32,
}

impl GeometryUniform {
    /// Of a layer, or of the external picture.
    pub(super) fn new(frame: &Frame, opaque: &Opaque, layer: Option<&Layer>) -> Self {
        let view = frame.view;
        let narrow = |v: glam::DVec3| v.as_vec3().to_array();
        let (to_x, to_y) = (view.step_x / view.step_x.length_squared(), view.step_y / view.step_y.length_squared());
        let (v_far, v_near) = view.inverse_depth_range();
        let of_frame = FrameUniform::new(frame, Texels::default(), (0.0, 1.0));
        // Compared is v · near, or what is in the middle of 0 to 1, so that nothing is clipped that a rounding moves out.
        let [z_scale, z_offset] =
            if view.is_perspective { [view.near, 0.0] } else { compared_from_depth(frame, opaque) };
        let looks = layer.and_then(|layer| layer.list.looks());
        let has = |each: fn(&Looks) -> &Vec<[f32; 3]>| looks.is_some_and(|looks| !each(looks).is_empty());
        Self {
            eye: narrow(view.eye),
            is_perspective: view.is_perspective.into(),
            forward: narrow(view.forward),
            near: view.near,
            to_x: narrow(to_x),
            center_x: -view.corner.dot(to_x) as f32,
            to_y: narrow(to_y),
            center_y: -view.corner.dot(to_y) as f32,
            first: narrow(view.corner + if view.is_perspective { view.forward } else { view.eye }),
            v_far: finite(v_far),
            step_x: narrow(view.step_x),
            v_near: finite(v_near),
            step_y: narrow(view.step_y),
            setback_px: opaque.setback_px(),
            color: layer.map_or([0.0; 3], |layer| layer.color),
            width_px: layer.map_or(0.0, |layer| layer.width_px),
            ndc_scale: of_frame.ndc_scale,
            ndc_offset: of_frame.ndc_offset,
            size_px: view.size_px.map(|side| side as f32),
            z_scale,
            z_offset,
            first_px: of_frame.first_px,
            has_back_only: layer.is_some_and(|layer| layer.faces == SurfaceFaces::Back).into(),
            has_looks: u32::from(has(|looks| &looks.colors)) | u32::from(has(|looks| &looks.normals)) << 1,
        }
    }
}

/// Scale and offset that bring the inverse depths −w of the mesh along parallel rays to 0..1.
fn order_from_inverse_depth(frame: &Frame) -> [f32; 2] {
    let View { eye, forward, world_per_scene, .. } = frame.view;
    let depth = |corner: glam::Vec3| (corner.as_dvec3() / *world_per_scene - *eye).dot(*forward);
    let depths = frame.dataset.bounds.corners().map(depth);
    let (near, far) =
        depths.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(near, far), &w| (near.min(w), far.max(w)));
    let range = (far - near).max(f64::MIN_POSITIVE);
    [1.0 / range, far / range].map(|value| finite(value as f32))
}

/// Scale and offset that bring the inverse depths −w of everything opaque along parallel rays to the middle of 0 to 1.
fn compared_from_depth(frame: &Frame, opaque: &Opaque) -> [f32; 2] {
    let View { eye, forward, world_per_scene, .. } = frame.view;
    let scene_per_world = world_per_scene.recip() as f32;
    let bounds = &frame.dataset.bounds;
    let of_mesh = Bounds { min: bounds.min * scene_per_world, max: bounds.max * scene_per_world };
    let lists = opaque.layers().iter().filter(|layer| !layer.list.is_empty()).map(|layer| layer.list.bounds());
    let corners = lists.fold(of_mesh, Bounds::union).corners();
    let of_corners = corners.iter().map(|corner| -(corner.as_dvec3() - *eye).dot(*forward));
    let external = opaque.external().into_iter().flat_map(|external| &external.v);
    let of_external = external.filter(|v| v.is_finite()).map(|&v| f64::from(v));
    let (low, high) = of_corners
        .chain(of_external)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let scale = 0.5 / (high - low).max(f64::MIN_POSITIVE);
    [scale, 0.25 - low * scale].map(|value| finite(value as f32))
}

/// WGSL need not know infinity.
fn finite(value: f32) -> f32 {
    value.clamp(f32::MIN, f32::MAX)
}

/// The pieces that a frame's shaders read, as bytes.
pub(super) fn piece_bytes(frame: &Frame) -> Vec<u8> {
    match frame.bands {
        Some(bands) => bytemuck::cast_slice(&band_records(bands)).to_vec(),
        None => bytemuck::cast_slice(&piece_records(frame.pieces)).to_vec(),
    }
}

/// The bands of a pass.
fn band_records(pieces: &Pieces<BandPiece>) -> Vec<BandPieceRecord> {
    let record = |k: usize| {
        let piece = pieces.piece(k);
        BandPieceRecord {
            begin: finite(pieces.start_of(k)),
            end: finite(pieces.end_of(k)),
            start: piece.start,
            is_transparent: piece.is_transparent().into(),
            extinction: piece.extinction,
            extinction_slope: piece.extinction_slope,
            color: piece.color,
            color_slope: piece.color_slope,
        }
    };
    (0..pieces.len()).map(record).collect()
}

/// The pieces of a transfer function.
fn piece_records(pieces: &Pieces) -> Vec<PieceRecord> {
    let record = |k: usize| {
        let piece = pieces.piece(k);
        PieceRecord {
            begin: finite(pieces.start_of(k)),
            end: finite(pieces.end_of(k)),
            start: piece.start,
            extinction: piece.extinction,
            color: piece.color,
            extinction_slope: piece.extinction_slope,
            color_slope: piece.color_slope,
            is_transparent: piece.is_transparent().into(),
        }
    };
    (0..pieces.len()).map(record).collect()
}
