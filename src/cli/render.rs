//! `render`: a mesh becomes a picture, or several.
//!
//! In: [`Arguments`], checked as far as they can be before anything is read. Out: pictures, STATS.json, and a line on
//! stderr that says what was chosen ([`scene`](super::scene)).

mod arguments;
mod pictures;

use std::path::Path;
use std::time::Instant;

use cellfan::image::{Encoding, Format, check_output};
use cellfan::optics::Output;
use cellfan::profile::{GeometryStats, Profile, Stats, peak_rss_bytes};
use cellfan::{Error, Image, Model, Region, RenderOptions, Rendered, io};

pub(super) use arguments::Arguments;
pub(super) use pictures::Pictures;

use super::progress::Progress;
use super::scene::{Backend, Request, Setup};
use super::{Outcome, stdout};

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let output_path = arguments.output_path();
    if arguments.scene.output == Output::Depth && Format::from_path(&output_path)? == Format::Png {
        let problem = "a PNG cannot show optical depths; write .exr or .npy (-o OUT.exr)".to_owned();
        return Err(Error::Option { option: "--output", problem }.into());
    }
    let (meshes, composite) = (&arguments.meshes, Some(&arguments.composite));
    let frames = arguments.frames.unwrap_or(1);
    let request = Request::new(meshes, frames, &arguments.scene, &arguments.geometry, composite)?;
    let stats_path = arguments.stats.as_deref().filter(|path| *path != Path::new("-"));
    stats_path.map(io::check_target).transpose()?;
    let output = encoding(arguments);
    check_output(&output_path, &output)?;
    let mut setup = request.read()?;
    let planes = arguments.cross_sections.then(|| setup.plane_count()).transpose()?;
    let mut pictures = Pictures::create(output_path, output, planes.or(arguments.frames))?;

    let mut after = Profile::default();
    let mut frames = Frames::default();
    let count = planes.or(arguments.frames).unwrap_or(1);
    {
        let progress = match count {
            1 => Progress::running("drawing"),
            _ => Progress::counting("drawing", count.into()),
        };
        for frame in 0..count {
            let (camera, rendered) = if planes.is_some() {
                (setup.camera.clone(), setup.draw_plane(frame)?)
            } else {
                let camera = setup.orbited(frame, count, arguments.orbit);
                let rendered = setup.draw(&camera)?;
                (camera, rendered)
            };
            let start = Instant::now();
            pictures.push(&rendered)?;
            if let (Some(path), Some(picture)) = (&arguments.composite.depth, rendered.depth_image()) {
                picture.save(path, Some(&camera))?;
            }
            after.add("write", start.elapsed(), 0);
            after.sample_memory();
            frames.add(rendered, setup.options);
            progress.step();
        }
    }
    let start = Instant::now();
    let written = pictures.finish()?;
    after.add("write", start.elapsed(), 0);

    let are_blank = frames.are_blank;
    let (size, region) = ([setup.camera.width, setup.camera.height], setup.camera.region);
    let stats = Stats {
        before: setup.before,
        memory_bytes: arguments.scene.memory,
        ..frames.into_stats(&setup.backend, after, size, region)
    };
    setup.backend.say();
    setup.summary.say(&stats.cells, &stats.order);
    if are_blank {
        Setup::warn_blank();
    }
    tracing::info!("wrote {written}");
    tracing::debug!("stages\n{stats}");
    match (stats_path, &arguments.stats) {
        (Some(path), _) => stats.save(path)?,
        (None, Some(_)) => stdout::write(&stats.to_json())?,
        (None, None) => {}
    }
    Ok(())
}

/// What is kept of the frames.
#[derive(Default)]
pub(super) struct Frames {
    profiles: Vec<Profile>,
    times_ms: Vec<f64>,
    /// Bytes of geometry that were sent to a GPU.
    uploaded_bytes: u64,
    /// The last frame, without its picture.
    last: Option<Rendered>,
    are_blank: bool,
}

impl Frames {
    pub(super) fn add(&mut self, rendered: Rendered, options: RenderOptions) {
        self.are_blank = rendered.covered_px(&options) == 0 && (self.are_blank || self.last.is_none());
        self.profiles.push(rendered.profile.clone());
        self.times_ms.push(rendered.frame_ms);
        self.uploaded_bytes += rendered.geometry.uploaded_bytes;
        self.last = Some(Rendered { image: Image::filled(0, 0, [0.0; 4]), bands: None, ..rendered });
    }

    /// The figures of all, and of what came `after` them.
    pub(super) fn into_stats(
        self,
        backend: &Backend,
        after: Profile,
        size_px: [u32; 2],
        region: Option<Region>,
    ) -> Stats {
        let of_last = |last: Rendered| Stats {
            cells: last.cells,
            triangles: last.triangles,
            geometry: GeometryStats { uploaded_bytes: self.uploaded_bytes, ..last.geometry },
            order: last.order,
            ..Stats::default()
        };
        Stats {
            frame: Profile::median(&self.profiles),
            after,
            frames: self.times_ms,
            backend: backend.name(),
            adapter: backend.adapter(),
            threads: rayon::current_num_threads(),
            peak_rss_bytes: peak_rss_bytes(),
            size_px,
            region,
            ..self.last.map(of_last).unwrap_or_default()
        }
    }
}

fn encoding(arguments: &Arguments) -> Encoding {
    if arguments.scene.model != Model::Absorption {
        return Encoding { background: arguments.background, ..Encoding::default() };
    }
    if arguments.background.is_some() {
        tracing::warn!("an absorption picture shows transmitted light and has no background: --background is ignored");
    }
    Encoding::TRANSMITTED
}
