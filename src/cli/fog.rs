//! `fog`: ground fog over a terrain, as a picture or a flight.

use std::path::PathBuf;
use std::time::Instant;

use cellfan::fog::{Flight, HeightMap, MapSettings, Terrain, fog_map, ground_map};
use cellfan::image::Encoding;
use cellfan::render::{FogLook, FogRenderer};
use cellfan::{Camera, Model, Projection, Renderer};
use clap::Args;

use super::Outcome;
use super::arguments::{Srgb, finite, length, named, size, srgb};
use super::numbers::count;
use super::progress::Progress;
use super::render::Pictures;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// The picture to write: .png (8 bits, sRGB), .exr or .npy (linear); a flight is numbered.
    #[arg(short = 'o', long = "out", value_name = "OUT")]
    output: PathBuf,
    /// Heights of the ground: a picture of 8 or 16 bits, black is 0 [default: mountains of Perlin noise].
    #[arg(long, value_name = "MAP.png", help_heading = "Terrain")]
    terrain: Option<PathBuf>,
    /// How thick the fog is on it [default: banks of Perlin noise in the valleys].
    #[arg(long, value_name = "MAP.png", help_heading = "Terrain")]
    fog_map: Option<PathBuf>,
    /// Points a side of maps of noise; rounded up to a power of two and one more.
    #[arg(long, value_name = "N", help_heading = "Terrain", default_value_t = MapSettings::default().points)]
    points: usize,
    /// Seed of everything random.
    #[arg(long, value_name = "S", help_heading = "Terrain", default_value_t = MapSettings::default().seed)]
    seed: u64,
    /// When, in seconds: fog of noise drifts.
    #[arg(long, value_name = "SECONDS", help_heading = "Terrain", default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    time: f64,
    /// The terrain's side; the ground is a square from 0,0 to here.
    #[arg(long, value_name = "LENGTH", help_heading = "Terrain", default_value = "10", value_parser = length, allow_hyphen_values = true)]
    side: f64,
    /// How high white is on the ground's map.
    #[arg(long, value_name = "LENGTH", help_heading = "Terrain", default_value = "1.6", value_parser = length, allow_hyphen_values = true)]
    relief: f64,
    /// How thick white is on the fog's map.
    #[arg(long, value_name = "LENGTH", help_heading = "Terrain", default_value = "0.25", value_parser = length, allow_hyphen_values = true)]
    fog_height: f64,

    /// Light that is added up, or its maximum (both as in Röttger and Ertl 2003), or light that is dimmed as well.
    #[arg(long, help_heading = "Picture", default_value = "emission", value_parser = named::<Model>(MODELS))]
    model: Model,
    /// Light per unit length where fog is densest; its extinction in emission-absorption [default: by the terrain's side].
    #[arg(long, value_name = "E", help_heading = "Picture", value_parser = length, allow_hyphen_values = true)]
    density: Option<f64>,
    /// The sky of a .png: R,G,B or #rrggbb.
    #[arg(long, value_name = "COLOR", help_heading = "Picture", default_value = "#7aa0c8", value_parser = srgb)]
    sky: Srgb,
    /// Size in pixels.
    #[arg(long, value_name = "WxH", help_heading = "Picture", default_value = "512x384", value_parser = size)]
    size: [u32; 2],
    /// Pixels by which ground and fog may be off where points are left out.
    #[arg(long, value_name = "PX", help_heading = "Picture", default_value = "1", value_parser = length, conflicts_with = "full", allow_hyphen_values = true)]
    tolerance: f64,
    /// Draw all points of the terrain.
    #[arg(long, help_heading = "Picture")]
    full: bool,

    /// Fly: draw N frames along the path, one round of it in all.
    #[arg(long, value_name = "N", help_heading = "Flight", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: Option<u32>,
    /// Where on the path the picture or the flight begins, as a share of it.
    #[arg(long, value_name = "SHARE", help_heading = "Flight", default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    start: f64,
    /// How much of the path a flight covers.
    #[arg(long, value_name = "SHARE", help_heading = "Flight", default_value_t = 1.0, value_parser = finite, allow_hyphen_values = true)]
    part: f64,
    /// How high the path is above the ground.
    #[arg(long, value_name = "LENGTH", help_heading = "Flight", default_value = "0.35", value_parser = length, allow_hyphen_values = true)]
    clearance: f64,
    /// From above instead, the whole terrain in view, from this azimuth.
    #[arg(long, value_name = "DEGREES", help_heading = "Flight", conflicts_with_all = ["frames", "start", "part"], value_parser = finite, allow_hyphen_values = true)]
    overview: Option<f64>,
}

const MODELS: [(&str, &str); 3] = [
    ("emission", "light of the fog is added to that of the ground"),
    ("mip", "the fog's height at the thickest place, by maximum"),
    ("emission-absorption", "light that the fog emits and dims"),
];

const EXAMPLES: &str = "\
Examples:
  cellfan fog -o fog.png
  cellfan fog --frames 100 -o flight.png
  cellfan fog --terrain heights.png --fog-map layer.png --model mip --overview 40 -o valley.png";

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let encoding = Encoding { background: Some(arguments.sky.0), ..Encoding::default() };
    let mut pictures = Pictures::create(arguments.output.clone(), encoding, arguments.frames)?;
    let terrain = {
        let _progress = Progress::running("making the terrain");
        arguments.terrain()?
    };
    let mut look = FogLook::new(arguments.model, &terrain)?;
    look.extinction_per_unit = arguments.density.unwrap_or(look.extinction_per_unit);
    look.tolerance_px = (!arguments.full).then_some(arguments.tolerance);

    let flight = Flight::new(&terrain, arguments.clearance);
    let mut renderer = FogRenderer::new(Renderer::new(FogRenderer::options(&look)));
    let frames = arguments.frames.unwrap_or(1);
    let start = Instant::now();
    let (mut tetrahedra, mut triangles) = (0, 0);
    {
        let progress =
            if frames == 1 { Progress::running("drawing") } else { Progress::counting("drawing", frames.into()) };
        for frame in 0..frames {
            let camera = arguments.camera(&terrain, &flight, f64::from(frame) / f64::from(frames));
            let rendered = renderer.render(&terrain, &camera, &look)?;
            tetrahedra += rendered.cells.total;
            triangles += rendered.geometry.triangles;
            pictures.push(&rendered)?;
            progress.step();
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    let written = pictures.finish()?;
    let of_frame = |total: u64| total / u64::from(frames);
    let all = 2 * (terrain.side() as u64 - 1).pow(2);
    tracing::info!(
        "{} of {all} triangles and about {} a frame, {:.1} frames/s with writing; wrote {written}",
        of_frame(triangles),
        count(of_frame(tetrahedra) / 3, "prism"),
        f64::from(frames) / seconds,
    );
    Ok(())
}

impl Arguments {
    fn terrain(&self) -> cellfan::Result<Terrain> {
        let settings = MapSettings { points: self.points, seed: self.seed, time_s: self.time };
        let ground = self.terrain.as_deref().map_or_else(|| ground_map(&settings), HeightMap::read)?;
        let fog = self.fog_map.as_deref().map_or_else(|| fog_map(&ground, &settings), HeightMap::read)?;
        Terrain::new(&ground, &fog, self.side, [self.relief, self.fog_height])
    }

    fn camera(&self, terrain: &Terrain, flight: &Flight, share: f64) -> Camera {
        let Some(azimuth) = self.overview else { return flight.camera(self.start + self.part * share, self.size) };
        let [far, high] = [terrain.side_world(), self.relief + self.fog_height];
        let corners: [_; 8] = std::array::from_fn(|i| {
            [far * f64::from(i as u8 & 1), far * f64::from(i as u8 >> 1 & 1), high * f64::from(i as u8 >> 2)].into()
        });
        let mut camera = Camera::framing(&corners, azimuth, 32.0, self.size[0], self.size[1]);
        camera.projection = match camera.projection {
            Projection::Perspective { .. } => Projection::Perspective { fov_degrees: 24.0 },
            parallel @ Projection::Orthographic { .. } => parallel,
        };
        camera
    }
}
