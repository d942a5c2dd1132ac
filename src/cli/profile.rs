//! `profile`: many frames, what each of them took, and what that says; or what changed between two such runs.
//!
//! In: [`Arguments`]; a mesh, or two files that an earlier run wrote with `--stats`. Out: a table and hints on stdout; JSON, CSV, a plot,
//! a trace where they are asked for. What is measured and said is the library's ([`cellfan::profile`]).

mod arguments;

use std::path::Path;

use cellfan::io::check_target;
use cellfan::profile::plot::PlotFormat;
use cellfan::profile::trace::Recorder;
use cellfan::profile::{CellStats, Comparison, FrameRecord, OrderStats, Report, peak_rss_bytes};
use cellfan::render::profile_views;

pub(super) use arguments::{Arguments, with_conflicts};

use super::numbers::count;
use super::progress::Progress;
use super::scene::{Request, Setup};
use super::{Outcome, meshes, stdout};

/// Measures, or compares; `recorder` is where spans go if a trace was asked for.
pub(super) fn run(arguments: &Arguments, recorder: Option<&Recorder>) -> Outcome {
    if let [a, b] = &arguments.compare[..] {
        let comparison = Comparison::new(&Report::load(a)?, &Report::load(b)?);
        return stdout::write(&format!("a: {}\nb: {}\n{comparison}\n", a.display(), b.display()));
    }
    arguments.plot.as_deref().map(PlotFormat::from_path).transpose()?;
    let stats_path = arguments.stats.as_deref().filter(|path| *path != Path::new("-"));
    for path in [arguments.plot.as_deref(), arguments.csv.as_deref(), arguments.trace.as_deref(), stats_path] {
        path.map(check_target).transpose()?;
    }
    let frames = arguments.warm_up + arguments.frames;
    let mut setup = Request::new(&arguments.meshes, frames, &arguments.scene, &arguments.geometry, None)?.read()?;
    let report = measure(arguments, &mut setup, recorder)?;

    if let Some(path) = stats_path {
        report.save(path)?;
        tracing::info!("wrote {}", path.display());
    }
    if let Some(path) = &arguments.csv {
        report.save_csv(path)?;
        tracing::info!("wrote {}", path.display());
    }
    if let Some(path) = &arguments.plot {
        report.save_plot(path)?;
        tracing::info!("wrote {}", path.display());
    }
    if let (Some(path), Some(recorder)) = (&arguments.trace, recorder) {
        let trace = recorder.take();
        trace.save(path)?;
        let lost = match trace.lost {
            0 => String::new(),
            lost => format!("; {} more had no room: take fewer --frames", count(lost, "span")),
        };
        let spans = count(trace.spans.len() as u64, "span");
        tracing::info!("wrote {}: {spans}, open it in ui.perfetto.dev{lost}", path.display());
        tracing::info!("recording takes time itself: for figures leave out --trace");
    }
    match (&arguments.stats, stats_path) {
        (Some(_), None) => stdout::write(&report.to_json()),
        _ => stdout::write(&format!("{report}\n")),
    }
}

/// What is kept of the last frame.
type Last = Option<(CellStats, OrderStats)>;

/// Draws all frames, all over again where `auto` leaves a GPU that fails for the processor.
fn measure(arguments: &Arguments, setup: &mut Setup, recorder: Option<&Recorder>) -> cellfan::Result<Report> {
    let (mut last, mut report);
    loop {
        let backend = setup.backend.name();
        last = None;
        report = draw_all(arguments, setup, recorder, &mut last)?;
        if setup.backend.name() == backend {
            break;
        }
    }
    report.mesh = setup.mesh_record(&meshes::label(&arguments.meshes).display().to_string());
    report.before = FrameRecord::new(0, 0.0, &std::mem::take(&mut setup.before)).stages;
    report.settings = arguments.scene.settings(setup);
    report.settings.insert("trace".to_owned(), arguments.trace.is_some().into());
    report.peak_rss_bytes = peak_rss_bytes();
    setup.backend.say();
    if let Some((cells, order)) = &last {
        setup.summary.say(cells, order);
    }
    if report.frames.iter().all(|frame| frame.covered_px == 0) {
        Setup::warn_blank();
    }
    Ok(report)
}

fn draw_all(
    arguments: &Arguments,
    setup: &mut Setup,
    recorder: Option<&Recorder>,
    last: &mut Last,
) -> cellfan::Result<Report> {
    let Arguments { frames, warm_up, half_size, orbit, .. } = *arguments;
    let of_trace = u64::from(warm_up) + u64::from(frames);
    let progress = Progress::counting("drawing", of_trace + 2 * u64::from(half_size.min(frames)));
    if let Some(recorder) = recorder {
        recorder.take();
        recorder.switch(true);
    }
    let (camera, mut drawn) = (setup.camera.clone(), 0);
    let report = profile_views(&camera, orbit, frames, [warm_up, half_size], |camera| {
        // Smaller pictures are no part of the trace.
        if let Some(recorder) = recorder.filter(|_| drawn == of_trace) {
            recorder.switch(false);
        }
        drawn += 1;
        let rendered = setup.draw(camera)?;
        progress.step();
        *last = Some((rendered.cells.clone(), rendered.order));
        Ok((rendered.covered_px(&setup.options), rendered))
    });
    if let Some(recorder) = recorder {
        recorder.switch(false);
    }
    report
}
