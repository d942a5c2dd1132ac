//! A solver that draws itself: dye in a bent channel, by finite volumes on a curvilinear grid, a picture every few steps.
//!
//! `cargo run --release --example insitu -- --steps 2000 --budget 5% --out pictures`
//!
//! How often it draws follows from the budget, the share of the time that pictures may take; `--every N` fixes it. It writes
//! `frame_0000.png` and so on, `animation.png` (an animated PNG, which browsers show), and says what pictures took.

use std::f64::consts::PI;
use std::io::BufWriter;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use cellfan::columns::Association;
use cellfan::image::Encoding;
use cellfan::session::{Cells, MeshView, Scalars, Session, Threads};
use cellfan::{Camera, ControlPoint, Image, Positions, RenderOptions, TransferFunction};
use glam::DVec3;

type Result<T, E = Box<dyn std::error::Error>> = std::result::Result<T, E>;

/// Cells along the channel, from its inner to its outer wall, from bottom to top.
const CELLS: [usize; 3] = [120, 36, 28];
const POINTS: [usize; 3] = [CELLS[0] + 1, CELLS[1] + 1, CELLS[2] + 1];
/// Inner and outer radius, height, and how far the channel bends.
const RADII: [f64; 2] = [1.0, 2.0];
const HEIGHT: f64 = 0.8;
const BEND: f64 = 1.6 * PI;

fn main() -> Result<()> {
    let settings = Settings::from_arguments()?;
    std::fs::create_dir_all(&settings.out)?;
    let (points, mut flow) = Flow::new();
    let mut dye = vec![0.0_f32; CELLS.iter().product()];

    // The grid does not move and is lent to the session; the dye changes, and is read when it is drawn.
    let mesh = MeshView::new(Positions::F32(&points), Cells::Structured { dims: POINTS })
        .with_scalars(Association::Cell, Scalars::F32(&dye));
    let mut session = Session::on(Threads::Count(settings.threads), &mesh)?;
    let (width, height) = settings.size;
    let mut camera = Camera::framing(&session.corners_world(), -60.0, 42.0, width, height);
    // The corners of the box are empty: the channel fills the picture from nearer.
    camera.eye = camera.target + (camera.eye - camera.target) * 0.72;
    let transfer = dye_colors()?;
    let options = RenderOptions::default();

    let (mut every, mut next) = (settings.every.unwrap_or(1), 0);
    let (mut solving, mut drawing) = (Duration::ZERO, Duration::ZERO);
    let mut frames: Vec<Image> = Vec::new();
    for step in 0..settings.steps {
        if step == next {
            let start = Instant::now();
            session.update_scalars(Association::Cell, Scalars::F32(&dye))?;
            let image = session.render(&camera, &transfer, &options)?.image;
            image.save(settings.out.join(format!("frame_{:04}.png", frames.len())), &Encoding::default())?;
            frames.push(image);
            drawing += start.elapsed();
            if settings.every.is_none() && step > 0 {
                // A picture takes so many steps' time; what it takes now and what a step took so far decide.
                let (picture, a_step) =
                    (drawing.as_secs_f64() / frames.len() as f64, solving.as_secs_f64() / step as f64);
                every = (picture * (1.0 - settings.budget) / (settings.budget * a_step)).ceil().max(1.0) as usize;
            }
            next = step + every;
        }
        let start = Instant::now();
        flow.advance(&mut dye);
        solving += start.elapsed();
    }
    let share = drawing.as_secs_f64() / (drawing + solving).as_secs_f64();
    write_animation(&settings.out.join("animation.png"), &frames)?;
    println!(
        "{} steps of {} cells in {:.2} s; {} pictures in {:.2} s, {:.1} % of the time, at last one every {every} steps",
        settings.steps,
        dye.len(),
        solving.as_secs_f64(),
        frames.len(),
        drawing.as_secs_f64(),
        100.0 * share
    );
    println!("dye in the channel: {:.4} of what came in less what went out", flow.balance(&dye));
    Ok(())
}

/// What the command line asks for.
struct Settings {
    steps: usize,
    budget: f64,
    every: Option<usize>,
    threads: usize,
    size: (u32, u32),
    out: PathBuf,
}

impl Settings {
    fn from_arguments() -> Result<Self> {
        let mut settings =
            Self { steps: 1200, budget: 0.05, every: None, threads: 0, size: (480, 360), out: "insitu".into() };
        let mut arguments = std::env::args().skip(1);
        while let Some(name) = arguments.next() {
            let value = arguments.next().ok_or_else(|| format!("{name} needs a value"))?;
            match name.as_str() {
                "--steps" => settings.steps = value.parse()?,
                "--budget" => {
                    let percent: f64 = value.trim_end_matches('%').parse()?;
                    settings.budget = Some(percent / 100.0)
                        .filter(|b| *b > 0.0 && *b < 1.0)
                        .ok_or("--budget: above 0 %, below 100 %")?;
                }
                "--every" => settings.every = Some(value.parse::<usize>()?.max(1)),
                "--threads" => settings.threads = value.parse()?,
                "--size" => {
                    let (width, height) = value.split_once('x').ok_or("--size WIDTHxHEIGHT")?;
                    settings.size = (width.parse()?, height.parse()?);
                }
                "--out" => settings.out = value.into(),
                _ => return Err(format!("{name}: --steps, --budget, --every, --threads, --size or --out").into()),
            }
        }
        Ok(settings)
    }
}

/// Clear water, and dye from blue over orange to white as it thickens.
fn dye_colors() -> Result<TransferFunction> {
    let points = [
        (0.0, [0.25, 0.35, 0.6], 0.12),
        (0.02, [0.25, 0.35, 0.6], 0.12),
        (0.1, [0.05, 0.25, 0.9], 2.0),
        (0.45, [1.0, 0.35, 0.05], 9.0),
        (1.0, [1.0, 0.95, 0.7], 30.0),
    ];
    let point = |(value, color, extinction)| ControlPoint { value, color, extinction };
    Ok(TransferFunction::new(points.map(point).to_vec())?)
}

/// A steady flow through the channel, as what passes each face in a step, and the dye that it carries.
struct Flow {
    /// Volume through the faces across i, j and k, a face a point: that of the cell whose lowest corner the point is.
    through: [Vec<f64>; 3],
    /// Of each cell.
    volume: Vec<f64>,
    time: f64,
    /// Dye that came in less what went out.
    net: f64,
}

fn point(i: usize, j: usize, k: usize) -> usize {
    i + POINTS[0] * (j + POINTS[1] * k)
}

fn cell([i, j, k]: [usize; 3]) -> usize {
    i + CELLS[0] * (j + CELLS[1] * k)
}

fn all([ni, nj, nk]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..nk).flat_map(move |k| (0..nj).flat_map(move |j| (0..ni).map(move |i| [i, j, k])))
}

/// Where a point is: around the bend, finer towards the walls, the bottom rising and falling.
fn place([i, j, k]: [usize; 3]) -> DVec3 {
    let [u, v, w] = [i as f64 / CELLS[0] as f64, j as f64 / CELLS[1] as f64, k as f64 / CELLS[2] as f64];
    let finer = |t: f64| t - 0.12 * (2.0 * PI * t).sin() / 2.0;
    let (angle, radius) = (BEND * u, RADII[0] + (RADII[1] - RADII[0]) * finer(v));
    let z = HEIGHT * finer(w) + 0.12 * (1.0 - w) * (3.0 * angle).sin();
    DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
}

/// A vector potential, summed up along the edge of the grid that leads from a point one step along `axis`. What passes a face is the sum
/// around it, so that no cell gains or loses water, whatever its shape; at the walls it is 0.
fn along_edge(axis: usize, [_, j, k]: [usize; 3]) -> f64 {
    let [v, w] = [j as f64 / CELLS[1] as f64, k as f64 / CELLS[2] as f64];
    match axis {
        // Swirling: two rolls.
        0 => 0.12 * (PI * v).sin() * (2.0 * PI * w).sin(),
        1 => 0.0,
        // Along the channel, fastest in the middle: the integral of 6 v (1 − v).
        _ => 3.0 * v * v - 2.0 * v * v * v,
    }
}

impl Flow {
    /// The points of the grid, and the flow through it.
    fn new() -> (Vec<[f32; 3]>, Self) {
        let places: Vec<DVec3> = all(POINTS).map(place).collect();
        let face = |axis: usize, at: [usize; 3]| {
            let step = |mut at: [usize; 3], axis: usize| {
                at[axis] += 1;
                at
            };
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            if at[a] == CELLS[a] || at[b] == CELLS[b] {
                return 0.0;
            }
            along_edge(a, at) + along_edge(b, step(at, a)) - along_edge(a, step(at, b)) - along_edge(b, at)
        };
        let through: [Vec<f64>; 3] = std::array::from_fn(|axis| all(POINTS).map(|at| face(axis, at)).collect());
        let volume: Vec<f64> = all(CELLS)
            .map(|[i, j, k]| {
                let q = |a: usize, b: usize, c: usize| places[point(i + a, j + b, k + c)];
                let middle = [0, 1, 2, 3, 4, 5, 6, 7].map(|n| q(n & 1, n >> 1 & 1, n >> 2)).iter().sum::<DVec3>() / 8.0;
                let faces = [
                    [q(0, 0, 0), q(0, 0, 1), q(0, 1, 1), q(0, 1, 0)],
                    [q(1, 0, 0), q(1, 1, 0), q(1, 1, 1), q(1, 0, 1)],
                    [q(0, 0, 0), q(1, 0, 0), q(1, 0, 1), q(0, 0, 1)],
                    [q(0, 1, 0), q(0, 1, 1), q(1, 1, 1), q(1, 1, 0)],
                    [q(0, 0, 0), q(0, 1, 0), q(1, 1, 0), q(1, 0, 0)],
                    [q(0, 0, 1), q(1, 0, 1), q(1, 1, 1), q(0, 1, 1)],
                ];
                let of_face = |[a, b, c, d]: [DVec3; 4]| (c - a).cross(d - b).dot(a - middle) / 6.0;
                faces.into_iter().map(of_face).sum::<f64>().abs()
            })
            .collect();
        // A step in which no cell gives away more than 0.8 of what it holds.
        let leaves = |at: [usize; 3]| {
            let out = |axis: usize| {
                let mut far = at;
                far[axis] += 1;
                let here = |[i, j, k]: [usize; 3]| through[axis][point(i, j, k)];
                (-here(at)).max(0.0) + here(far).max(0.0)
            };
            (out(0) + out(1) + out(2)) / volume[cell(at)]
        };
        let step = 0.8 / all(CELLS).map(leaves).fold(0.0, f64::max);
        let through = through.map(|faces| faces.into_iter().map(|flux| flux * step).collect());
        let points = places.iter().map(|p| p.as_vec3().to_array()).collect();
        (points, Self { through, volume, time: 0.0, net: 0.0 })
    }

    /// Dye at the inlet: three jets that come and go.
    fn inlet(&self, j: usize, k: usize) -> f64 {
        let (v, w) = (j as f64 / CELLS[1] as f64 - 0.5, k as f64 / CELLS[2] as f64 - 0.5);
        let jet = |n: f64| {
            let (a, beat) = (2.0 * PI * n / 3.0, (0.02 * self.time + n / 3.0).fract());
            let distance = (v - 0.25 * a.cos()).hypot(w - 0.25 * a.sin());
            if beat < 0.45 { (1.0 - distance / 0.13).clamp(0.0, 1.0) } else { 0.0 }
        };
        jet(0.0) + jet(1.0) + jet(2.0)
    }

    /// One step: each face carries the dye of the cell from which it flows.
    fn advance(&mut self, dye: &mut [f32]) {
        let mut change = vec![0.0; dye.len()];
        for axis in 0..3 {
            let mut faces = CELLS;
            faces[axis] += 1;
            for at in all(faces) {
                let flux = self.through[axis][point(at[0], at[1], at[2])];
                let mut before = at;
                let before = (at[axis] > 0).then(|| {
                    before[axis] -= 1;
                    cell(before)
                });
                let after = (at[axis] < CELLS[axis]).then(|| cell(at));
                let carried = match (if flux > 0.0 { before } else { after }, axis) {
                    (Some(from), _) => flux * f64::from(dye[from]),
                    (None, 0) if at[0] == 0 => flux * self.inlet(at[1], at[2]),
                    (None, _) => 0.0,
                };
                match (before, after) {
                    (None, _) => self.net += carried,
                    (_, None) => self.net -= carried,
                    _ => {}
                }
                if let Some(before) = before {
                    change[before] -= carried;
                }
                if let Some(after) = after {
                    change[after] += carried;
                }
            }
        }
        for ((dye, change), volume) in dye.iter_mut().zip(change).zip(&self.volume) {
            *dye += (change / volume) as f32;
        }
        self.time += 1.0;
    }

    /// The dye in the channel over what came in less what went out: 1, but for rounding.
    fn balance(&self, dye: &[f32]) -> f64 {
        dye.iter().zip(&self.volume).map(|(&dye, volume)| f64::from(dye) * volume).sum::<f64>() / self.net
    }
}

/// An animated PNG, on black, twelve pictures a second.
fn write_animation(path: &std::path::Path, frames: &[Image]) -> Result<()> {
    let Some(first) = frames.first() else { return Ok(()) };
    let mut encoder = png::Encoder::new(BufWriter::new(std::fs::File::create(path)?), first.width, first.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_animated(u32::try_from(frames.len())?, 0)?;
    encoder.set_frame_delay(1, 12)?;
    let mut writer = encoder.write_header()?;
    for frame in frames {
        let eight_bits = |linear: f32| {
            let s = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
            (s.clamp(0.0, 1.0) * 255.0).round() as u8
        };
        let bytes: Vec<u8> = frame.pixels.iter().flat_map(|p| [p[0], p[1], p[2]].map(eight_bits)).collect();
        writer.write_image_data(&bytes)?;
    }
    writer.finish()?;
    Ok(())
}
