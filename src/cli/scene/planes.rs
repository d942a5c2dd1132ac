//! Depth planes: their arguments, what the library takes, and what draws them.

use cellfan::depth_planes::{Classification, Filter, Light, Lighting, Options, Planes as Positions, Samples};
use cellfan::geometry::GeometryOptions;
use cellfan::hierarchy::Interpolation;
use cellfan::render::{VolumeScene, depth_planes};
use cellfan::{Camera, Error, Rendered, Result};
use clap::Args;

use super::Arguments;
use crate::cli::arguments::{factor, light, number, one_of, samples};

/// How a volume is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::cli) enum Method {
    /// Cell by cell.
    #[default]
    Cells,
    /// On planes across the view.
    DepthPlanes,
    /// Cubes of an octree of the samples.
    Cubes,
}

#[derive(Args)]
#[group(id = "planes")]
#[expect(clippy::struct_excessive_bools, reason = "one for each switch of the command line")]
pub(in crate::cli) struct Planes {
    /// What draws: cells, one by one; depth-planes, samples of a regular grid (.vti, NRRD, raw …) on planes across the view, nearest
    /// first, on the CPU; or cubes, boxes of the samples of such a grid, from their octree. The options below are for depth planes;
    /// light from --shade on is for all of them.
    #[arg(long, help_heading = "Depth planes", default_value = "cells", value_parser = one_of([("cells", Method::Cells), ("depth-planes", Method::DepthPlanes), ("cubes", Method::Cubes)]))]
    pub(super) method: Method,
    /// What is interpolated between points: the scalar, which is classified then, or colour and extinction, classified before
    /// [default: post].
    #[arg(long, value_name = "WHEN", help_heading = "Depth planes", value_parser = one_of(Classification::ALL.iter().map(|&one| (one.name(), one))))]
    classify: Option<Classification>,
    /// What a sample is made of: the 8 points around it, or the 64 of a smoothing or an interpolating spline [default: trilinear]. With
    /// cubes, trilinear puts the points at their corners and interpolates between them; without it a cube has one value.
    #[arg(long, value_name = "FILTER", help_heading = "Depth planes", value_parser = one_of(Filter::ALL.iter().map(|&one| (one.name(), one))))]
    filter: Option<Filter>,
    /// Samples across and down the picture, and planes: numbers, auto for as many as the grid's steps ask for, pixels for one each
    /// [default: pixels,pixels,auto].
    #[arg(long, value_name = "X,Y,PLANES", help_heading = "Depth planes", value_parser = samples)]
    samples: Option<[Samples; 3]>,
    /// Samples a step of the grid where their number is auto [default: 1].
    #[arg(long, value_name = "RATE", help_heading = "Depth planes", value_parser = factor, allow_hyphen_values = true)]
    sample_rate: Option<f64>,
    /// Samples a pixel across and down; below 1 the picture is drawn small and enlarged [default: 1].
    #[arg(long, value_name = "SCALE", help_heading = "Depth planes", value_parser = factor, allow_hyphen_values = true)]
    render_scale: Option<f64>,
    /// Planes evenly spaced in screen depth, from the nearest to the farthest corner, and pixels from border to border, as Vol has them.
    #[arg(long, help_heading = "Depth planes")]
    vol_compat: bool,
    /// Leave out samples that are less opaque than this from plane to plane [default: 0].
    #[arg(long, value_name = "OPACITY", help_heading = "Depth planes", value_parser = number, allow_hyphen_values = true)]
    opacity_threshold: Option<f32>,
    /// Show reflected light, by Phong on both sides of surfaces, whose normals are the scalar's gradient; cells and cubes, on the CPU, have
    /// one each. So does each option below.
    #[arg(long, help_heading = "Depth planes")]
    shade: bool,
    /// What is reflected of light from everywhere [default: 0.4].
    #[arg(long, value_name = "KA", help_heading = "Depth planes", value_parser = number, allow_hyphen_values = true)]
    ambient: Option<f32>,
    /// What is reflected in all directions [default: 0.6].
    #[arg(long, value_name = "KD", help_heading = "Depth planes", value_parser = number, allow_hyphen_values = true)]
    diffuse: Option<f32>,
    /// What is reflected as by a mirror [default: 0.3].
    #[arg(long, value_name = "KS", help_heading = "Depth planes", value_parser = number, allow_hyphen_values = true)]
    specular: Option<f32>,
    /// How small highlights are: the exponent [default: 15].
    #[arg(long, value_name = "N", help_heading = "Depth planes", value_parser = number, allow_hyphen_values = true)]
    shininess: Option<f32>,
    /// Towards a light at infinity, and its linear colour; may be given again [default: over the eye's left shoulder, white].
    #[arg(long, value_name = "X,Y,Z[:R,G,B]", help_heading = "Depth planes", value_parser = light, allow_hyphen_values = true)]
    light: Vec<Light>,
    /// Multiply extinction by the surface strength: the gradient over the array's range, a grid step long.
    #[arg(long, help_heading = "Depth planes")]
    strength: bool,
    /// Dim light by what lies between it and a sample, on depth planes.
    #[arg(long, help_heading = "Depth planes")]
    shadows: bool,
}

impl Planes {
    /// What draws.
    pub(super) fn method(&self) -> Method {
        self.method
    }

    /// Whether depth planes draw.
    pub(super) fn are_chosen(&self) -> bool {
        self.method == Method::DepthPlanes
    }

    /// What the library takes.
    ///
    /// # Errors
    /// [`Error::Option`] where options do not fit together.
    pub(super) fn options(&self, arguments: &Arguments) -> Result<Options> {
        let default = Options::default();
        let options = Options {
            model: arguments.model,
            output: arguments.output,
            classification: self.classify.unwrap_or_default(),
            filter: self.filter.unwrap_or_default(),
            samples: self.samples.unwrap_or(default.samples),
            sample_rate: self.sample_rate.unwrap_or(default.sample_rate),
            render_scale: self.render_scale.unwrap_or(default.render_scale),
            is_vol_compatible: self.vol_compat,
            opacity_threshold: self.opacity_threshold.unwrap_or(0.0),
            stop_transmittance: arguments.stop,
            lighting: self.lighting(),
            ..default
        };
        if !self.are_chosen() {
            self.interpolation()?;
            let option = self.first_given();
            return option.map_or(Ok(options), |option| {
                Err(Error::Option { option, problem: "is for depth planes; add --method depth-planes".to_owned() })
            });
        }
        let refused = [
            ("--bands", arguments.bands.is_some()),
            ("--memory", arguments.memory.is_some()),
            ("--check-order", arguments.check_order),
            ("--cells", arguments.cells.is_some()),
        ];
        if let Some((option, _)) = refused.into_iter().find(|&(_, is_given)| is_given) {
            return Err(Error::Option { option, problem: "is not for depth planes; use --method cells".to_owned() });
        }
        options.check()?;
        Ok(options)
    }

    /// What cubes have between their corners.
    ///
    /// # Errors
    /// [`Error::Option`] where they cannot.
    pub(super) fn interpolation(&self) -> Result<Interpolation> {
        match self.filter {
            Some(Filter::Trilinear) => Ok(Interpolation::Trilinear),
            Some(filter) if self.method == Method::Cubes => {
                let problem = format!("{} is for depth planes; cubes take trilinear", filter.name());
                Err(Error::Option { option: "--filter", problem })
            }
            None | Some(_) => Ok(Interpolation::Constant),
        }
    }

    /// The light that cells and cubes reflect.
    ///
    /// # Errors
    /// [`Error::Option`] where they cannot be lit as is asked for.
    pub(super) fn lighting_of_cells(&self, arguments: &Arguments) -> Result<Option<Lighting>> {
        let lighting = self.lighting().filter(|_| !self.are_chosen());
        let Some(lighting) = lighting else { return Ok(None) };
        lighting.check_cells(arguments.model, arguments.integral)?;
        if arguments.bands.is_some() {
            let problem = "wavelength bands have no light that could be reflected; leave one of both out".to_owned();
            return Err(Error::Option { option: "--shade", problem });
        }
        Ok(Some(lighting))
    }

    /// What light, or values between points in cubes, where they are asked for, need: GPUs draw neither.
    pub(super) fn needs_processor(&self) -> Option<&'static str> {
        if self.lighting().is_some() {
            return Some("light is reflected on the CPU (--shade)");
        }
        (self.filter.is_some() && self.method == Method::Cubes).then_some("cubes with --filter trilinear are the CPU's")
    }

    fn lighting(&self) -> Option<Lighting> {
        let default = Lighting::default();
        let coefficients = [self.ambient, self.diffuse, self.specular, self.shininess];
        let is_lit = self.shade || self.strength || self.shadows || !self.light.is_empty();
        (is_lit || coefficients.iter().any(Option::is_some)).then(|| Lighting {
            ambient: self.ambient.unwrap_or(default.ambient),
            diffuse: self.diffuse.unwrap_or(default.diffuse),
            specular: self.specular.unwrap_or(default.specular),
            shininess: self.shininess.unwrap_or(default.shininess),
            lights: self.light.clone(),
            has_strength: self.strength,
            has_shadows: self.shadows,
        })
    }

    /// The first option that is given and for depth planes alone.
    fn first_given(&self) -> Option<&'static str> {
        let all = [
            ("--classify", self.classify.is_some()),
            ("--filter", self.filter.is_some() && self.method != Method::Cubes),
            ("--samples", self.samples.is_some()),
            ("--sample-rate", self.sample_rate.is_some()),
            ("--render-scale", self.render_scale.is_some()),
            ("--vol-compat", self.vol_compat),
            ("--opacity-threshold", self.opacity_threshold.is_some()),
        ];
        all.into_iter().find(|&(_, is_given)| is_given).map(|(option, _)| option)
    }
}

/// A volume, and how it is drawn.
pub(in crate::cli) struct PlanesDrawer {
    pub(super) scene: VolumeScene,
    pub(super) options: Options,
    pub(super) geometry: GeometryOptions,
    /// Whether depths are asked for.
    pub(super) depth: bool,
}

impl PlanesDrawer {
    pub(super) fn draw(&self, camera: &Camera, only_plane: Option<u32>) -> Result<Rendered> {
        let options = Options { only_plane, ..self.options.clone() };
        depth_planes(&self.scene, camera, &options, &self.geometry, self.depth)
    }

    /// How many planes a view has.
    pub(super) fn count(&self, camera: &Camera) -> Result<u32> {
        Positions::new(self.scene.volume(), camera, &self.options).map(|planes| planes.depths.len() as u32)
    }
}
