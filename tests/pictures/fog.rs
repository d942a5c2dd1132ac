//! Ground fog: a flight at a level of detail beside the same flight over all points, and from inside the fog.

use cellfan::fog::{Flight, HeightMap, MapSettings, Terrain, fog_map, ground_map};
use cellfan::image::Image;
use cellfan::render::{FogLook, FogRenderer};
use cellfan::{Camera, Model, Renderer};
use glam::DVec3;

fn terrain(points: usize) -> Terrain {
    let settings = MapSettings { points, ..MapSettings::default() };
    let ground = ground_map(&settings).unwrap();
    let fog = fog_map(&ground, &settings).unwrap();
    Terrain::new(&ground, &fog, 10.0, [1.6, 0.25]).unwrap()
}

fn draw(terrain: &Terrain, camera: &Camera, look: &FogLook) -> Image {
    FogRenderer::new(Renderer::new(FogRenderer::options(look))).render(terrain, camera, look).unwrap().image
}

/// The grey of each pixel, in levels of 8 bits as a display has them; sky is 0.
fn greys(image: &Image) -> Vec<f64> {
    let srgb =
        |linear: f64| if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    let grey = |[r, g, b, _]: [f32; 4]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
    image.pixels.iter().map(|&pixel| 255.0 * srgb(grey(pixel).clamp(0.0, 1.0))).collect()
}

fn mean_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>() / a.len() as f64
}

/// A part of a flight whose frames are as far apart as those of one of 100 frames a round.
#[test]
fn a_flight_at_a_level_of_detail_looks_like_one_over_all_points() {
    let terrain = terrain(129);
    let flight = Flight::new(&terrain, 0.35);
    for model in [Model::Emission, Model::Mip] {
        let look = FogLook::new(model, &terrain).unwrap();
        let full = FogLook { tolerance_px: None, ..look };
        let coarse = FogLook { tolerance_px: Some(40.0), ..look };
        let (mut before, mut coarse_most) = (None, 0.0_f64);
        for frame in 0..8 {
            let camera = flight.camera(0.3 + f64::from(frame) * 0.01, [160, 120]);
            let all = greys(&draw(&terrain, &camera, &full));
            let image = draw(&terrain, &camera, &look);
            let difference = mean_difference(&greys(&image), &all);
            assert!(difference < 2.0, "{model} frame {frame}: {difference} levels");
            let jump = (difference - before.unwrap_or(difference)).abs();
            assert!(jump < 1.0, "{model} frame {frame}: a jump of {jump} levels");
            before = Some(difference);
            // Ground fills the lowest rows: no crack lets the sky through.
            let below = &image.pixels[160 * 100..];
            assert!(below.iter().all(|pixel| pixel[3] == 1.0 && pixel[..3].iter().sum::<f32>() > 0.0), "a hole");
            coarse_most = coarse_most.max(mean_difference(&greys(&draw(&terrain, &camera, &coarse)), &all));
        }
        assert!(coarse_most > 2.0, "{model}: a coarse terrain passes, {coarse_most}");
    }
}

/// Flat ground under fog of one thickness, whose density falls from 1 to 0 with height: light by closed form.
#[test]
fn light_of_a_layer_is_that_of_its_density_from_above_and_from_inside() {
    let ground = HeightMap::sample(17, |_| 0.0).unwrap();
    let fog = HeightMap::sample(17, |_| 1.0).unwrap();
    let terrain = Terrain::new(&ground, &fog, 10.0, [1.0, 0.5]).unwrap();
    let look =
        FogLook { color: [1.0; 3], extinction_per_unit: 2.0, ..FogLook::new(Model::Emission, &terrain).unwrap() };
    for (height, expected) in [
        // ∫ 2 (1 − z/0.5) dz over 0…h, where h is at most the layer's 0.5.
        (3.0, 0.5),
        (0.25, 2.0 * (0.25 - 0.25 * 0.25)),
        (0.1, 2.0 * (0.1 - 0.1 * 0.1)),
    ] {
        let camera = Camera::looking_at(DVec3::new(5.1, 4.9, height), DVec3::new(5.1, 4.9, 0.0), 9, 9);
        let lit = draw(&terrain, &camera, &look).pixel(4, 4);
        let dark = draw(&terrain, &camera, &FogLook { extinction_per_unit: 1e-12, ..look }).pixel(4, 4);
        for k in 0..3 {
            let light = f64::from(lit[k]) - f64::from(dark[k]);
            assert!((light - expected).abs() < 1e-4, "from {height}: {light}, expected {expected}");
        }
    }
}

#[cfg(feature = "gpu")]
#[test]
fn fog_has_parity_with_the_cpu() {
    use crate::parity::Parity;
    use cellfan::backends::gpu::GpuCompositor;
    let terrain = terrain(65);
    let camera = Flight::new(&terrain, 0.35).camera(0.35, [160, 120]);
    for gpu in crate::gpus::gpus("fog_has_parity_with_the_cpu") {
        for model in [Model::Emission, Model::EmissionAbsorption, Model::Mip] {
            let look = FogLook::new(model, &terrain).unwrap();
            let cpu = draw(&terrain, &camera, &look);
            let renderer = Renderer::on_gpu(FogRenderer::options(&look), gpu.clone(), GpuCompositor::MEMORY_BYTES);
            let mut image = FogRenderer::new(renderer).render(&terrain, &camera, &look).unwrap().image;
            let parity = Parity::of(&cpu, &image, 0.0);
            println!("{model} {parity:?}");
            // An outline of the ground in front of ground far behind may be off by a pixel.
            let holds = |parity: &Parity| parity.covered > 5000 && parity.mean < 1e-3 && parity.within >= 0.995;
            assert!(holds(&parity), "{model} {parity:?}");
            image.pixels.iter_mut().for_each(|pixel| pixel[2] += 1.0 / 255.0);
            assert!(!holds(&Parity::of(&cpu, &image, 0.0)), "one level passes");
        }
    }
}
