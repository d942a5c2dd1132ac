//! The arguments of `fog`.

use std::path::PathBuf;

use cellfan::fog::{Flight, HeightMap, MapSettings, Terrain, fog_map, ground_map};
use cellfan::{Camera, Error, Model, Projection};
use clap::Args;

use crate::cli::arguments::{Srgb, finite, length, named, size, srgb};
use crate::cli::scene::Device;

/// Width and height without `--size` or a camera file, in pixels: those of the paper's window.
const SIZE: [u32; 2] = [512, 384];

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Arguments {
    /// The picture to write: .png (8 bits, sRGB), .exr or .npy (linear); a flight is numbered.
    #[arg(short = 'o', long = "out", value_name = "OUT")]
    pub(super) output: PathBuf,
    /// Heights of the ground: a picture of 8 or 16 bits, black is 0 [default: mountains of Perlin noise].
    #[arg(long, value_name = "MAP.png", help_heading = "Terrain")]
    pub(super) terrain: Option<PathBuf>,
    /// How thick the fog is on it [default: banks of Perlin noise in the valleys].
    #[arg(long, value_name = "MAP.png", help_heading = "Terrain")]
    pub(super) fog_map: Option<PathBuf>,
    /// Points a side of maps of noise; rounded up to a power of two and one more.
    #[arg(long, value_name = "N", help_heading = "Terrain", default_value_t = MapSettings::default().points)]
    pub(super) points: usize,
    /// Seed of everything random.
    #[arg(long, value_name = "S", help_heading = "Terrain", default_value_t = MapSettings::default().seed)]
    pub(super) seed: u64,
    /// When, in seconds: fog of noise drifts.
    #[arg(long, value_name = "SECONDS", help_heading = "Terrain", default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    pub(super) time: f64,
    /// The terrain's side; the ground is a square from 0,0 to here.
    #[arg(long, value_name = "LENGTH", help_heading = "Terrain", default_value = "10", value_parser = length, allow_hyphen_values = true)]
    pub(super) side: f64,
    /// How high white is on the ground's map.
    #[arg(long, value_name = "LENGTH", help_heading = "Terrain", default_value = "1.6", value_parser = length, allow_hyphen_values = true)]
    pub(super) relief: f64,
    /// How thick white is on the fog's map.
    #[arg(long, value_name = "LENGTH", help_heading = "Terrain", default_value = "0.25", value_parser = length, allow_hyphen_values = true)]
    pub(super) fog_height: f64,

    /// Light that is added up, or its maximum (both as in Röttger and Ertl 2003), or light that is dimmed as well.
    #[arg(long, help_heading = "Picture", default_value = "emission", value_parser = named::<Model>(MODELS))]
    pub(super) model: Model,
    /// Light per unit length where fog is densest; its extinction in emission-absorption [default: by the terrain's side].
    #[arg(long, value_name = "E", help_heading = "Picture", value_parser = length, allow_hyphen_values = true)]
    pub(super) density: Option<f64>,
    /// The sky of a .png: R,G,B or #rrggbb.
    #[arg(long, value_name = "COLOR", help_heading = "Picture", default_value = "#7aa0c8", value_parser = srgb)]
    pub(super) sky: Srgb,
    /// Size in pixels; goes before the camera's [default: 512x384].
    #[arg(long, value_name = "WxH", help_heading = "Picture", value_parser = size)]
    pub(super) size: Option<[u32; 2]>,
    /// Pixels by which ground and fog may be off where points are left out.
    #[arg(long, value_name = "PX", help_heading = "Picture", default_value = "0.5", value_parser = length, conflicts_with = "full", allow_hyphen_values = true)]
    pub(super) tolerance: f64,
    /// Draw all points of the terrain.
    #[arg(long, help_heading = "Picture")]
    pub(super) full: bool,

    /// Fly: draw N frames along the path, one round of it in all.
    #[arg(long, value_name = "N", help_heading = "Flight", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(super) frames: Option<u32>,
    /// Where on the path the picture or the flight begins, as a share of it.
    #[arg(long, value_name = "SHARE", help_heading = "Flight", default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    pub(super) start: f64,
    /// How much of the path a flight covers.
    #[arg(long, value_name = "SHARE", help_heading = "Flight", default_value_t = 1.0, value_parser = finite, allow_hyphen_values = true)]
    pub(super) part: f64,
    /// How high the path is above the ground.
    #[arg(long, value_name = "LENGTH", help_heading = "Flight", default_value = "0.35", value_parser = length, allow_hyphen_values = true)]
    pub(super) clearance: f64,
    /// From above instead, the whole terrain in view, from this azimuth.
    #[arg(long, value_name = "DEGREES", help_heading = "Flight", conflicts_with_all = ["frames", "start", "part"], value_parser = finite, allow_hyphen_values = true)]
    pub(super) overview: Option<f64>,
    /// From a camera file with eye, target, up, fov, width, height instead; the ground's heights are along z.
    #[arg(long, value_name = "CAM.json", help_heading = "Flight", conflicts_with_all = ["frames", "start", "part", "overview"])]
    pub(super) camera: Option<PathBuf>,
    /// Compare each frame with the same over all points of the terrain, and look for holes in the ground; fails where the mean difference of a frame
    /// is 2 levels of grey or more, jumps by more than 1 from frame to frame, or the sky shows below the horizon. Takes some times as long.
    #[arg(long, help_heading = "Flight", conflicts_with = "full")]
    pub(super) check: bool,

    #[command(flatten)]
    pub(super) device: Device,
    /// Write figures as JSON: cells, order, stages, times, what was checked; - is stdout.
    #[arg(long, value_name = "STATS.json", help_heading = "Method", allow_hyphen_values = true)]
    pub(super) stats: Option<PathBuf>,
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
  cellfan fog --frames 100 --check --stats - -o flight.png | jq .fog.check
  cellfan fog --terrain heights.png --fog-map layer.png --model mip --overview 40 -o valley.png";

impl Arguments {
    pub(super) fn terrain(&self) -> cellfan::Result<Terrain> {
        let settings = MapSettings { points: self.points, seed: self.seed, time_s: self.time };
        let ground = self.terrain.as_deref().map_or_else(|| ground_map(&settings), HeightMap::read)?;
        let fog = self.fog_map.as_deref().map_or_else(|| fog_map(&ground, &settings), HeightMap::read)?;
        Terrain::new(&ground, &fog, self.side, [self.relief, self.fog_height])
    }

    /// Where frames are seen from.
    pub(super) fn views(&self, terrain: &Terrain) -> cellfan::Result<Views> {
        let size = self.size.unwrap_or(SIZE);
        if let Some(path) = &self.camera {
            let text = std::fs::read_to_string(path).map_err(|source| Error::Io { path: path.clone(), source })?;
            let mut camera = Camera::from_json(&text).map_err(|error| error.in_file(path))?;
            [camera.width, camera.height] = self.size.unwrap_or([camera.width, camera.height]);
            camera.frame()?;
            return Ok(Views::One(camera));
        }
        let Some(azimuth) = self.overview else {
            let flight = Flight::new(terrain, self.clearance);
            return Ok(Views::Flight { flight, start: self.start, part: self.part, size });
        };
        let [far, high] = [terrain.side_world(), self.relief + self.fog_height];
        let corners: [_; 8] = std::array::from_fn(|i| {
            [far * f64::from(i as u8 & 1), far * f64::from(i as u8 >> 1 & 1), high * f64::from(i as u8 >> 2)].into()
        });
        let mut camera = Camera::framing(&corners, azimuth, 32.0, size[0], size[1]);
        camera.projection = Projection::Perspective { fov_degrees: 24.0 };
        Ok(Views::One(camera))
    }
}

/// Where frames are seen from.
pub(super) enum Views {
    One(Camera),
    Flight { flight: Flight, start: f64, part: f64, size: [u32; 2] },
}

impl Views {
    /// The camera after a share of the frames.
    pub(super) fn camera(&self, share: f64) -> Camera {
        match self {
            Self::One(camera) => camera.clone(),
            Self::Flight { flight, start, part, size } => flight.camera(start + part * share, *size),
        }
    }
}
