//! Cubes: their arguments, and what draws them.

use cellfan::geometry::GeometryOptions;
use cellfan::profile::MeshRecord;
use cellfan::render::{CubeScene, CubeStats, Detail};
use cellfan::{Camera, Error, RenderOptions, Rendered, Renderer, Result};
use clap::Args;

use super::Arguments;
use super::backend::Backend;
use super::planes::Method;
use crate::cli::arguments::{factor, share};
use crate::cli::numbers::{count, grouped, short};

#[derive(Args)]
#[group(id = "cubes")]
pub(in crate::cli) struct Cubes {
    /// Draw boxes of samples of a regular grid as one cube with their mean where none differs from it by more than this share of
    /// the range of values: 18% or 0.18 [default: 0, equal samples only].
    #[arg(long, value_name = "SHARE", help_heading = "Cubes", value_parser = share, conflicts_with_all = ["error_image", "budget_ms"], allow_hyphen_values = true)]
    error: Option<f64>,
    /// The same where no channel of a pixel can differ by more than this from the picture of all samples.
    #[arg(long, value_name = "DIFFERENCE", help_heading = "Cubes", value_parser = share, conflicts_with = "budget_ms", allow_hyphen_values = true)]
    error_image: Option<f64>,
    /// The finest cubes that are drawn in so many milliseconds a frame; finer from frame to frame while the view stands still.
    #[arg(long, value_name = "MS", help_heading = "Cubes", value_parser = factor, allow_hyphen_values = true)]
    budget_ms: Option<f64>,
}

impl Cubes {
    /// How fine cubes are, where they are chosen.
    ///
    /// # Errors
    /// [`Error::Option`] where options do not fit together.
    pub(super) fn detail(
        &self,
        arguments: &Arguments,
        geometry: &GeometryOptions,
        has_others: bool,
    ) -> Result<Option<Detail>> {
        let given = [
            ("--error", self.error.map(Detail::Error)),
            ("--error-image", self.error_image.map(Detail::PictureError)),
            ("--budget-ms", self.budget_ms.map(Detail::BudgetMs)),
        ];
        let given = given.into_iter().find_map(|(option, detail)| Some((option, detail?)));
        if arguments.planes.method() != Method::Cubes {
            return given.map_or(Ok(None), |(option, _)| {
                Err(Error::Option { option, problem: "is for cubes; add --method cubes".to_owned() })
            });
        }
        let refused = [
            ("--bands", arguments.bands.is_some()),
            ("--memory", arguments.memory.is_some()),
            ("--check-order", arguments.check_order),
            ("--cells", arguments.cells.is_some()),
            ("--surface, --edges and --points", *geometry != GeometryOptions::default()),
            ("--mesh, --composite or --depth", has_others),
        ];
        if let Some((option, _)) = refused.into_iter().find(|&(_, is_given)| is_given) {
            return Err(Error::Option { option, problem: "is not for cubes; use --method cells".to_owned() });
        }
        Ok(Some(given.map_or(Detail::Error(0.0), |(_, detail)| detail)))
    }
}

/// A volume with its octree, and how fine it is drawn.
pub(in crate::cli) struct CubesDrawer {
    pub(super) scene: CubeScene,
    pub(super) renderer: Renderer,
    pub(super) detail: Detail,
    /// Cells and points of the volume.
    pub(super) size: [usize; 2],
}

impl CubesDrawer {
    pub(super) fn draw(&mut self, backend: &mut Backend, options: RenderOptions, camera: &Camera) -> Result<Rendered> {
        let Self { scene, renderer, detail, .. } = self;
        let mut stats = CubeStats::default();
        let rendered = backend.render(renderer, options, |renderer| {
            let (rendered, of_frame) = renderer.render_cubes(scene, *detail, camera)?;
            stats = of_frame;
            Ok(rendered)
        })?;
        let CubeStats { cubes, visited, select_ms, draw_ms, error } = stats;
        let error = error.map_or(String::new(), |error| format!(", none off by more than {} %", short(100.0 * error)));
        tracing::debug!(
            "{} of {} nodes{error}; selected in {} ms, drawn in {} ms",
            count(cubes, "cube"),
            grouped(visited),
            short(select_ms),
            short(draw_ms)
        );
        Ok(rendered)
    }

    pub(super) fn mesh_record(&self, name: &str) -> MeshRecord {
        let [cells, vertices] = self.size.map(|count| count as u64);
        MeshRecord { name: name.to_owned(), cells, vertices }
    }
}
