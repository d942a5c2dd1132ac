//! A scene beside its reference, and the errors of a picture at some of its pixels.

use cellfan::image::Image;
use cellfan::{
    Camera, Dataset, Field, FieldSelection, Model, RenderOptions, Rendered, Renderer, Scene, TetMesh, TransferFunction,
};
use rayon::prelude::*;

use crate::meshes::Random;
use crate::reference::{Reference, Segment, shade};

/// A mesh with a field, and its reference.
pub(crate) struct Case {
    pub(crate) dataset: Dataset,
    pub(crate) field: Field,
    pub(crate) reference: Reference,
}

/// The segments of some pixels' rays.
pub(crate) struct Rays {
    pub(crate) pixels: Vec<(u32, u32)>,
    pub(crate) segments: Vec<Vec<Segment>>,
}

/// How far a picture is from the reference, over covered pixels.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Errors {
    /// Covered pixels compared.
    pub(crate) pixels: usize,
    /// The largest mean of any channel.
    pub(crate) mean: f64,
    /// The largest error of any channel.
    pub(crate) max: f64,
    /// Where it is.
    pub(crate) max_at: (u32, u32),
    /// Picture and reference there.
    pub(crate) worst: ([f32; 4], [f64; 4]),
}

impl Errors {
    /// Mean at most 1e-4, largest at most 2e-3, in every channel, and something was compared.
    pub(crate) fn are_small(&self) -> bool {
        self.pixels > 0 && self.mean <= 1e-4 && self.max <= 2e-3
    }
}

impl std::fmt::Display for Errors {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { pixels, mean, max, max_at, .. } = self;
        write!(f, "mean {mean:.1e}  max {max:.1e} at {max_at:?}  over {pixels} pixels")?;
        if *max > 2e-3 {
            write!(f, "  {:?} for {:?}", self.worst.0, self.worst.1)?;
        }
        Ok(())
    }
}

impl Case {
    /// The mesh with its array of that name.
    pub(crate) fn new(mesh: TetMesh, array: &str) -> Self {
        let dataset = Dataset::from_tets(mesh).unwrap();
        let field = dataset.field(&FieldSelection::parse(array, &dataset.arrays)).unwrap();
        Self::of(dataset, field)
    }

    /// A dataset with its field.
    pub(crate) fn of(dataset: Dataset, field: Field) -> Self {
        let reference = Reference::new(&dataset, &field);
        Self { dataset, field, reference }
    }

    pub(crate) fn scene(&self, transfer: &TransferFunction) -> Scene {
        Scene::new(self.dataset.clone(), self.field.clone(), transfer)
    }

    pub(crate) fn render(&self, options: RenderOptions, transfer: &TransferFunction, camera: &Camera) -> Rendered {
        Renderer::new(options).render(&self.scene(transfer), camera).unwrap()
    }

    /// The rays of up to `count` random pixels that meet the mesh.
    pub(crate) fn random_rays(&self, camera: &Camera, seed: u64, count: usize) -> Rays {
        let mut random = Random(seed);
        let candidates: Vec<_> =
            (0..4 * count).map(|_| (random.below(camera.width), random.below(camera.height))).collect();
        // Some at a time, until enough of them have met the mesh.
        let mut rays = Rays { pixels: Vec::new(), segments: Vec::new() };
        for some in candidates.chunks(256) {
            if rays.pixels.len() >= count {
                break;
            }
            let met: Vec<_> = some.par_iter().map(|&(x, y)| ((x, y), self.reference.segments(camera, x, y))).collect();
            for (pixel, segments) in met.into_iter().filter(|(_, segments)| !segments.is_empty()) {
                rays.pixels.push(pixel);
                rays.segments.push(segments);
            }
        }
        rays
    }

    /// The rays of all pixels.
    pub(crate) fn all_rays(&self, camera: &Camera) -> Rays {
        let pixels: Vec<_> = (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (x, y))).collect();
        let segments = pixels.par_iter().map(|&(x, y)| self.reference.segments(camera, x, y)).collect();
        Rays { pixels, segments }
    }

    /// Draws every model and compares every pixel with the reference.
    pub(crate) fn assert_right(&self, what: &str, transfer: &TransferFunction, camera: &Camera) {
        let rays = self.all_rays(camera);
        for model in Model::ALL {
            let options = RenderOptions { model, ..RenderOptions::default() };
            let image = self.render(options, transfer, camera).image;
            let errors = rays.errors(&image, model, transfer, usize::MAX);
            println!("{what:32} {model:20} {errors}");
            assert!(errors.are_small(), "{what}, {model}: {errors}");
        }
    }
}

impl Rays {
    /// The errors of `image` at the first `count` of these pixels that it or the reference covers.
    pub(crate) fn errors(&self, image: &Image, model: Model, transfer: &TransferFunction, count: usize) -> Errors {
        let miss = if model == Model::Absorption { 1.0 } else { 0.0 };
        let compared: Vec<_> = self
            .pixels
            .par_iter()
            .zip(&self.segments)
            .map(|(&(x, y), segments)| ((x, y), image.pixel(x, y), shade(model, transfer, segments)))
            .filter(|(_, found, expected)| {
                found.iter().any(|&f| f64::from(f) != miss) || expected.iter().any(|&e| e != miss)
            })
            .collect();
        let mut sum = [0.0; 4];
        let mut errors = Errors { pixels: compared.len().min(count), ..Errors::default() };
        for &(pixel, found, expected) in compared.iter().take(count) {
            for k in 0..4 {
                let error = (f64::from(found[k]) - expected[k]).abs();
                let error = if error.is_nan() { f64::INFINITY } else { error };
                sum[k] += error;
                if error > errors.max {
                    (errors.max, errors.max_at, errors.worst) = (error, pixel, (found, expected));
                }
            }
        }
        errors.mean = sum.into_iter().fold(0.0, f64::max) / errors.pixels.max(1) as f64;
        errors
    }
}
