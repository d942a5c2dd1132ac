//! Many views drawn one after the other, for a [`Report`] of what they took.

use std::collections::BTreeMap;

use serde_json::Value;

use super::{CpuMethod, RenderOptions, Rendered, Scene};
use crate::backends::cpu::InstructionSet;
use crate::camera::{Camera, Region};
use crate::error::Result;
use crate::geometry::GeometryOptions;
use crate::optics::Model;
use crate::profile::{FrameRecord, Machine, MeshRecord, Program, Report, Views};
use crate::stages::fans::Faces;

/// Draws the views of an orbit with `draw` and notes what each took: `views.frames` that count, after `warm_up` that do not.
///
/// Frames that do not count show the views that come before the first that counts, so that this follows its neighbour; the first of
/// all is the first that `draw` draws. Then `half_size` of the views, evenly spread, are drawn again at half the width and height,
/// each once for nothing before it counts: what stays is not of the pixels. Mesh, memory and [settings](RenderOptions::settings) are for
/// the caller to fill in.
///
/// # Errors
/// Those of `draw`; [`Error::Camera`](crate::Error::Camera) where `camera` is not valid.
///
/// ```
/// use cellfan::{Camera, Dataset, RenderOptions, Renderer, Scene, TransferFunction, generate, render::profile_views};
/// let mesh = generate::tets(&generate::Settings { cells: 1_000, ..Default::default() })?;
/// let dataset = Dataset::from_tets(mesh)?;
/// let camera = Camera::framing(&dataset.corners_world(), 35.0, 20.0, 32, 32);
/// let field = dataset.homogeneous_field();
/// let scene = Scene::new(dataset, field, &TransferFunction::constant([1.0; 3], 1.0)?);
/// let mut renderer = Renderer::new(RenderOptions::default());
/// let report = profile_views(&camera, 360.0, 10, [2, 1], |camera| {
///     let rendered = renderer.render(&scene, camera)?;
///     Ok((rendered.covered_px(&RenderOptions::default()), rendered))
/// })?;
/// assert_eq!([report.warm_up.len(), report.frames.len(), report.half_size.len()], [2, 10, 1]);
/// assert!(report.frames_per_second().unwrap() > 0.0 && report.frames[0].covered_px > 0);
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn profile_views(
    camera: &Camera,
    orbit_degrees: f64,
    frames: u32,
    [warm_up, half_size]: [u32; 2],
    mut draw: impl FnMut(&Camera) -> Result<(u64, Rendered)>,
) -> Result<Report> {
    camera.frame()?;
    let view = |number: i64| match number {
        0 => camera.clone(),
        _ => camera.orbited(number as f64 * orbit_degrees / f64::from(frames.max(1))),
    };
    let mut peak_anonymous_bytes = None;
    let mut record = |number: i64, camera: &Camera| {
        let _span = tracing::trace_span!("frame", view = number.rem_euclid(i64::from(frames.max(1))) as u64).entered();
        let (covered_px, rendered) = draw(camera)?;
        peak_anonymous_bytes = peak_anonymous_bytes.max(rendered.profile.peak_anonymous_bytes());
        let frame =
            FrameRecord::new(number.rem_euclid(i64::from(frames.max(1))) as u32, rendered.frame_ms, &rendered.profile);
        Ok(FrameRecord { drawn_cells: rendered.cells.drawn, covered_px, ..frame })
    };
    let mut all =
        |numbers: std::ops::Range<i64>| numbers.map(|number| record(number, &view(number))).collect::<Result<Vec<_>>>();
    let warmed_up = all(-i64::from(warm_up)..0)?;
    let counted = all(0..i64::from(frames))?;
    let mut halved = Vec::new();
    for i in 0..half_size.min(frames) {
        let number = i64::from(i) * i64::from(frames) / i64::from(half_size.min(frames));
        let full = view(number);
        let half = Camera {
            width: full.width.div_ceil(2),
            height: full.height.div_ceil(2),
            region: full.region.map(Region::halved),
            ..full
        };
        record(number, &half)?;
        halved.push(record(number, &half)?);
    }
    Ok(Report {
        program: Program::this(),
        machine: Machine::here(),
        views: Views { camera: serde_json::from_str(&camera.to_json()).unwrap_or_default(), orbit_degrees, frames },
        warm_up: warmed_up,
        frames: counted,
        half_size: halved,
        peak_anonymous_bytes,
        ..Report::default()
    })
}

impl RenderOptions {
    /// The options by the names that they have on the command line.
    ///
    /// ```
    /// # use cellfan::RenderOptions;
    /// assert_eq!(RenderOptions::default().settings()["model"], "emission-absorption");
    /// ```
    pub fn settings(&self) -> BTreeMap<String, Value> {
        let cpu_method = match self.cpu_method {
            CpuMethod::Footprints => "footprints",
            CpuMethod::Rays => "rays",
            CpuMethod::Fans => "fans",
        };
        let faces = if self.faces == Faces::Fan { "fan" } else { "exact" };
        let GeometryOptions { surface, surface_faces, edges, points, line_px, point_px } = self.geometry;
        let all: [(&str, Value); 17] = [
            ("model", self.model.to_string().into()),
            ("integral", self.integral.to_string().into()),
            ("output", self.output.name().into()),
            ("sort", self.sort.name().into()),
            ("stop", f64::from(self.stop_transmittance).into()),
            ("cpu_method", cpu_method.into()),
            ("faces", faces.into()),
            ("check_order", self.check_order.into()),
            ("memory", self.memory_bytes.into()),
            ("surface", surface.map(Vec::from).into()),
            ("surface_faces", surface_faces.name().into()),
            ("edges", edges.map(Vec::from).into()),
            ("points", points.map(Vec::from).into()),
            ("line_px", f64::from(line_px).into()),
            ("point_px", f64::from(point_px).into()),
            ("depth", self.depth.into()),
            ("instruction_set", self.instruction_set.map(InstructionSet::name).into()),
        ];
        all.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

impl Rendered {
    /// Pixels that show something, in a picture that was drawn with `options`.
    pub fn covered_px(&self, options: &RenderOptions) -> u64 {
        let miss = if options.model == Model::Absorption { options.output.miss() } else { 0.0 };
        self.bands.as_ref().map_or(self.image.covered([miss; 4]), |bands| bands.covered(miss))
    }
}

impl Scene {
    /// What a report says of the mesh.
    pub fn mesh_record(&self, name: &str) -> MeshRecord {
        let dataset = self.dataset();
        let skipped = dataset.counts.lower_dimensional + dataset.counts.ghost + dataset.counts.unsupported;
        let cells = (dataset.cells() - dataset.hexahedra.absent()) as u64 + dataset.counts.degenerate + skipped;
        MeshRecord { name: name.to_owned(), cells, vertices: dataset.positions.len() as u64 }
    }
}
