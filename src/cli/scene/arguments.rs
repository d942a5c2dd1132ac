//! What is drawn and how: the arguments that `render` and `profile` share.

use std::path::PathBuf;

use cellfan::optics::Output;
use cellfan::stages::fans::Faces;
use cellfan::{CpuMethod, Integral, Model, Region, SortMethod};
use clap::Args;

use super::Device;
use super::cubes::Cubes;
use super::planes::Planes;
use crate::cli::arguments::{Cells, bytes, finite, length, named, one_of, region, size, transmittance, view};
use crate::cli::meshes::Raw;

#[derive(Args)]
#[group(id = "scene")]
pub(in crate::cli) struct Arguments {
    #[command(flatten)]
    pub(in crate::cli) raw: Raw,

    /// The array to draw: NAME, NAME[component], point:NAME or cell:NAME; a vector by its magnitude
    /// [default: one that varies].
    #[arg(long, value_name = "NAME", help_heading = "Picture")]
    pub(super) array: Option<String>,
    /// Of an `OpenFOAM` case: the time to draw [default: the last].
    #[arg(long, value_name = "TIME", help_heading = "Picture", value_parser = finite, allow_hyphen_values = true)]
    pub(super) time: Option<f64>,
    /// Colour and extinction: a .json (points, or materials by their values) or .csv file, or viridis, inferno, cool-warm or x-ray over the array's range
    /// [default: from the array's histogram].
    #[arg(long, value_name = "TF", help_heading = "Picture")]
    pub(super) transfer: Option<String>,
    /// What opacities of a transfer function refer to, in world units [default: a hundredth of the diagonal].
    #[arg(long, value_name = "LENGTH", help_heading = "Picture", value_parser = length, allow_hyphen_values = true)]
    pub(super) unit_distance: Option<f64>,
    /// What a ray computes.
    #[arg(long, help_heading = "Picture", default_value_t, value_parser = named::<Model>(MODELS))]
    pub(in crate::cli) model: Model,
    /// Extinctions of wavelength bands: a .csv table of rows `value k1 k2 … kn` over the array, a .json table, or array:NAME,NAME…,
    /// whose values are extinctions. Any number for absorption (.exr: a channel a band, .npy: height, width, bands; .png: the
    /// first three); three for emission: how much red, green and blue each place emits, a unit of length; three for emission-absorption, red,
    /// green, blue in the colours of --transfer, or more, whose light is written in the same way. Arrays are white without --transfer [default: extinction times r, g, b, 1].
    #[arg(long, value_name = "BANDS", help_heading = "Picture")]
    pub(super) bands: Option<String>,
    /// What an absorption picture holds: transmitted intensity, or optical depth (not as .png).
    #[arg(long, value_name = "WHAT", help_heading = "Picture", default_value_t, value_parser = one_of(Output::ALL.map(|output| (output.name(), output))))]
    pub(in crate::cli) output: Output,

    /// A camera file with eye, target, up, fov, width, height.
    #[arg(long, value_name = "CAM.json", help_heading = "View", conflicts_with = "view")]
    pub(super) camera: Option<PathBuf>,
    /// The whole mesh from this direction, in degrees; +z is up [default: 35,20].
    #[arg(long, value_name = "AZIMUTH,ELEVATION", help_heading = "View", value_parser = view, allow_hyphen_values = true)]
    pub(super) view: Option<[f64; 2]>,
    /// Size in pixels; goes before the camera's [default: 512x512].
    #[arg(long, value_name = "WxH", help_heading = "View", value_parser = size)]
    pub(super) size: Option<[u32; 2]>,
    /// Draw only the pixels from column X0 to before X1 and from row Y0 to before Y1 of that size, with the values that they have in
    /// the whole picture: for walls of displays, and for pictures of up to 32768x32768 part by part [default: all].
    #[arg(long, value_name = "X0,Y0,X1,Y1", help_heading = "View", value_parser = region, allow_hyphen_values = true)]
    pub(super) region: Option<Region>,

    #[command(flatten)]
    pub(super) device: Device,
    /// How cells are put in order. exact is right for any mesh (of a GPU's picture the CPU draws those tiles again in which cells came
    /// too late); topological is where no cells hide each other in a circle, which it counts; auto takes exact on the CPU, else
    /// topological, and exact where that finds such circles.
    #[arg(long, help_heading = "Method", default_value_t, value_parser = one_of(SortMethod::ALL.map(|method| (method.name(), method))))]
    pub(super) sort: SortMethod,
    /// How the light of a cell is integrated along a ray.
    #[arg(long, help_heading = "Method", default_value_t, value_parser = named::<Integral>(INTEGRALS))]
    pub(super) integral: Integral,
    /// Read a container (.cells) or the samples of a volume whole instead of using them in place through a memory map.
    #[arg(long, help_heading = "Method")]
    pub(super) no_mmap: bool,
    /// End a ray at this transmittance, which bounds the error; 0 never ends one.
    #[arg(long, value_name = "T", help_heading = "Method", default_value = "1e-5", value_parser = transmittance, allow_hyphen_values = true)]
    pub(super) stop: f32,
    /// How the CPU composites: planes per pixel, rays followed from cell to cell (of tetrahedra; where that cannot be, planes), or the
    /// triangles of the papers [default: rays for three frames or more of a mesh with more cells than pixels, else footprints].
    #[arg(long, value_name = "METHOD", help_heading = "Method", value_parser = one_of([("footprints", CpuMethod::Footprints), ("rays", CpuMethod::Rays), ("fans", CpuMethod::Fans)]))]
    pub(super) cpu_method: Option<CpuMethod>,
    /// Draw hexahedra, wedges, pyramids and voxels whole, or cut into tetrahedra, which is another field inside a cell
    /// [default: whole].
    #[arg(long, value_name = "CELLS", help_heading = "Method", value_parser = one_of(Cells::NAMED))]
    pub(super) cells: Option<Cells>,
    /// How fans, on a GPU or not, draw faces of four corners: by their two triangles in each pixel, or by the triangles of the papers,
    /// which are approximate where a face is warped. Footprints are exact.
    #[arg(long, value_name = "FACES", help_heading = "Method", default_value = "exact", value_parser = one_of([("exact", Faces::Exact), ("fan", Faces::Fan)]))]
    pub(super) faces: Faces,
    /// Count the neighbouring cells that the order puts the wrong way round.
    #[arg(long, help_heading = "Method")]
    pub(super) check_order: bool,
    /// What the process may hold, mapped files aside: 800M, 2Gi. The picture is the same, drawn in as many parts as needed
    /// [default: as it comes].
    #[arg(long, value_name = "BYTES", help_heading = "Method", value_parser = bytes, allow_hyphen_values = true)]
    pub(in crate::cli) memory: Option<u64>,

    #[command(flatten)]
    pub(in crate::cli) planes: Planes,

    #[command(flatten)]
    pub(super) cubes: Cubes,
}

const MODELS: [(&str, &str); 4] = [
    ("emission-absorption", "light that is emitted and dimmed on its way"),
    ("absorption", "transmitted light, as an X-ray picture"),
    ("emission", "light that nothing dims"),
    ("mip", "the colour of the largest value on the ray"),
];

const INTEGRALS: [(&str, &str); 4] = [
    ("exact", "linear extinction and colour, to 1e-6"),
    ("average", "the mean colour times the exact opacity"),
    ("texture", "the mean colour times an opacity from a table"),
    (
        "pcp",
        "emission and mip on the CPU: the mean emission of both ends times a length in eight bits of the cell's depth",
    ),
];
