//! `fog`: ground fog over a terrain, as a picture or a flight.
//!
//! In: [`Arguments`]. Out: pictures, STATS.json; with `--check` every frame beside the same one over all points of the terrain
//! ([`FlightCheck`]), and a failure where they are too far apart.

mod arguments;

use std::path::Path;
use std::time::Instant;

use cellfan::image::Encoding;
use cellfan::io;
use cellfan::profile::{Profile, Stats};
use cellfan::render::{FlightCheck, FogLook, FogRenderer, FogScene, FrameCheck};
use serde_json::{Value, json};

pub(super) use arguments::Arguments;

use super::numbers::count;
use super::progress::Progress;
use super::render::{Frames, Pictures};
use super::scene::Backend;
use super::{Failure, Outcome, stdout};

/// The largest mean difference of a frame from the same over all points, in levels of grey; it stays below.
const MOST_DIFFERENCE: f64 = 2.0;

/// By how much it may change from frame to frame.
const MOST_JUMP: f64 = 1.0;

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let stats_path = arguments.stats.as_deref().filter(|path| *path != Path::new("-"));
    stats_path.map(io::check_target).transpose()?;
    let encoding = Encoding { background: Some(arguments.sky.0), ..Encoding::default() };
    let mut pictures = Pictures::create(arguments.output.clone(), encoding, arguments.frames)?;
    let mut backend = Backend::choose(&arguments.device, None)?;
    let terrain = {
        let _progress = Progress::running("making the terrain");
        arguments.terrain()?
    };
    let mut look = FogLook::new(arguments.model, &terrain)?;
    look.extinction_per_unit = arguments.density.unwrap_or(look.extinction_per_unit);
    look.tolerance_px = (!arguments.full).then_some(arguments.tolerance);

    let views = arguments.views(&terrain)?;
    let options = FogRenderer::options(&look);
    let renderer = || FogRenderer::new(backend.renderer(options));
    let check = || FlightCheck::new(renderer(), &terrain, &look, arguments.sky.linear().map(f64::from));
    let mut check = arguments.check.then(check).transpose()?;
    let mut checked = Vec::new();
    let mut renderer = renderer();
    let wanted = arguments.frames.unwrap_or(1);
    let (mut frames, mut after) = (Frames::default(), Profile::default());
    let (mut prisms, mut triangles, mut landscapes_s) = (0, 0, 0.0);
    {
        let progress =
            if wanted == 1 { Progress::running("drawing") } else { Progress::counting("drawing", wanted.into()) };
        for frame in 0..wanted {
            let camera = views.camera(f64::from(frame) / f64::from(wanted));
            camera.frame()?;
            let start = Instant::now();
            let landscape = FogRenderer::landscape(&terrain, &camera, &look);
            prisms += landscape.fog.hexahedra.len() as u64;
            triangles += landscape.triangles.len() as u64;
            let scene = FogScene::new(landscape)?;
            landscapes_s += start.elapsed().as_secs_f64();
            let rendered = backend.render(&mut renderer, options, |renderer| renderer.draw(&scene, &camera, &look))?;
            if let Some(check) = &mut check {
                checked.push(check.frame(&terrain, (scene, &camera, &look), &rendered.image)?);
            }
            let start = Instant::now();
            pictures.push(&rendered)?;
            after.add("write", start.elapsed(), 0);
            frames.add(rendered, options);
            progress.step();
        }
    }
    let written = pictures.finish()?;
    let camera = views.camera(0.0);
    let stats = frames.into_stats(&backend, after, [camera.width, camera.height], camera.region);
    backend.say();
    let [prisms, triangles] = [prisms, triangles].map(|total| total / u64::from(wanted));
    let landscape_ms = 1e3 * landscapes_s / f64::from(wanted);
    let all = 2 * (terrain.side() as u64 - 1).pow(2);
    tracing::info!(
        "{triangles} of {all} triangles and about {} a frame, {:.1} frames/s; wrote {written}",
        count(prisms, "prism"),
        1e3 / (landscape_ms + stats.frame_ms().unwrap_or(f64::NAN)),
    );
    let of_check = of_check(&checked);
    if let Some(most) = checked.iter().copied().reduce(FrameCheck::most) {
        tracing::info!(
            "of {}, {} in the fog: mean difference from all points at most {:.3} levels of grey, jumps at most {:.3}, popping at most {:.3}, {} of \
             sky in the ground",
            count(checked.len() as u64, "frame"),
            checked.iter().filter(|found| found.is_in_fog).count(),
            most.difference,
            most.jump,
            most.popping,
            count(most.holes_px as u64, "pixel"),
        );
    }
    let text = to_json(
        &stats,
        json!({ "triangles": triangles, "prisms": prisms, "landscape_ms": landscape_ms, "check": of_check }),
    );
    match (stats_path, &arguments.stats) {
        (Some(path), _) => io::write_text(path, &text)?,
        (None, Some(_)) => stdout::write(&text)?,
        (None, None) => {}
    }
    for (frame, found) in checked.iter().enumerate() {
        let is_good = found.difference < MOST_DIFFERENCE && found.jump <= MOST_JUMP && found.holes_px == 0;
        if !is_good {
            return Err(Failure::WrongAnswer(format!(
                "frame {frame} differs from all points by {:.3} levels of grey, {:.3} from the frame before, and has {} of sky in the ground; \
                 at most {MOST_DIFFERENCE}, {MOST_JUMP} and none may be",
                found.difference,
                found.jump,
                count(found.holes_px as u64, "pixel"),
            )));
        }
    }
    Ok(())
}

/// Of all frames the mean and the largest, and each; nothing where none was checked.
fn of_check(checked: &[FrameCheck]) -> Value {
    let Some(most) = checked.iter().copied().reduce(FrameCheck::most) else { return Value::Null };
    let mean = |of: fn(&FrameCheck) -> f64| checked.iter().map(of).sum::<f64>() / checked.len() as f64;
    json!({
        "most": most,
        "mean": { "difference": mean(|found| found.difference), "jump": mean(|found| found.jump), "popping": mean(|found| found.popping) },
        "frames": checked,
    })
}

/// STATS.json with what is fog's.
fn to_json(stats: &Stats, fog: Value) -> String {
    let mut record: Value = serde_json::to_value(stats).unwrap_or_default();
    record["fog"] = fog;
    // Maps with string keys and numbers: nothing in here can fail.
    let mut text = serde_json::to_string_pretty(&record).unwrap_or_default();
    text.push('\n');
    text
}
