//! `Axes`: the grid that the fields about axes make.

use glam::{DMat3, DVec3};

use super::header::Header;
use crate::columns::Lattice;
use crate::error::{Error, Result};
use crate::io::source::Source;

/// The format allows no more (`NRRD_DIM_MAX`).
const MOST_AXES: usize = 16;

/// Kinds of axes along which samples are values of one point, or that are not of space.
const KINDS_BESIDE_SPACE: [&str; 31] = [
    "time",
    "list",
    "point",
    "vector",
    "covariant-vector",
    "normal",
    "stub",
    "scalar",
    "complex",
    "2-vector",
    "3-color",
    "rgb-color",
    "hsv-color",
    "xyz-color",
    "4-color",
    "rgba-color",
    "3-vector",
    "3-gradient",
    "3-normal",
    "4-vector",
    "quaternion",
    "2d-symmetric-matrix",
    "2d-masked-symmetric-matrix",
    "2d-matrix",
    "2d-masked-matrix",
    "3d-symmetric-matrix",
    "3d-masked-symmetric-matrix",
    "3d-matrix",
    "3d-masked-matrix",
    "pixel",
    "real",
];

/// A grid of tuples, perhaps several times.
#[derive(Debug)]
pub(super) struct Axes {
    /// Points along the axes of space, 1 along those that are missing.
    pub(super) dims: [usize; 3],
    /// Where the samples are.
    pub(super) lattice: Lattice,
    /// Samples a point, which stand together: axes before those of space.
    pub(super) components: usize,
    /// Grids one after the other: axes behind those of space.
    pub(super) arrays: usize,
}

impl Axes {
    pub(super) fn of(header: &Header<'_>, source: Source<'_>) -> Result<Self> {
        let field = header.required("dimension", source)?;
        let dimension = field.count(source)?;
        if !(1..=MOST_AXES).contains(&dimension) {
            return Err(field.malformed(format!("{dimension} is not between 1 and {MOST_AXES}"), source));
        }
        let field = header.required("sizes", source)?;
        let sizes = field.counts(dimension, source)?;
        if sizes.contains(&0) {
            return Err(field.malformed(format!("{sizes:?}: an axis has no sample"), source));
        }
        let directions = header.field("spacedirections").map(|field| field.vectors(dimension, source)).transpose()?;
        let space = spatial_axes(header, &sizes, directions.as_deref(), source)?;
        let product = |sizes: &[usize]| sizes.iter().try_fold(1_usize, |all, &size| all.checked_mul(size));
        let too_many = || field.malformed(format!("{sizes:?} are more samples than there can be: damaged"), source);
        let components = product(&sizes[..space.start]).ok_or_else(too_many)?;
        let arrays = product(&sizes[space.end..]).ok_or_else(too_many)?;
        let mut dims = [1; 3];
        dims[..space.len()].copy_from_slice(&sizes[space.clone()]);

        let mut steps = [DVec3::X, DVec3::Y, DVec3::Z];
        let mut origin = DVec3::ZERO;
        if let Some(directions) = directions {
            let of_space = directions[space.clone()].iter().flatten();
            steps.iter_mut().zip(of_space).for_each(|(step, direction)| *step = DVec3::from(*direction));
        } else {
            let straight = Straight::of(header, dimension, source)?;
            for (along, axis) in space.enumerate() {
                let (spacing, first) = straight.along(axis, sizes[axis]);
                steps[along] *= spacing;
                origin[along] = first;
            }
        }
        if let Some(field) = header.field("spaceorigin") {
            origin = field.vector(field.value, source)?.into();
        }
        let lattice = Lattice::sheared(origin, DMat3::from_cols(steps[0], steps[1], steps[2]));
        Ok(Self { dims, lattice, components, arrays })
    }
}

/// The axes of space, which stand together.
fn spatial_axes(
    header: &Header<'_>,
    sizes: &[usize],
    directions: Option<&[Option<[f64; 3]>]>,
    source: Source<'_>,
) -> Result<std::ops::Range<usize>> {
    let kinds = header.field("kinds");
    let kinds = kinds.as_ref().map(|field| field.words(sizes.len(), source)).transpose()?;
    let is_spatial = |axis: usize| match (directions, &kinds) {
        (Some(directions), _) => directions[axis].is_some(),
        (None, Some(kinds)) => !KINDS_BESIDE_SPACE.contains(&kinds[axis].to_ascii_lowercase().as_str()),
        (None, None) => true,
    };
    let spatial: Vec<usize> = (0..sizes.len()).filter(|&axis| is_spatial(axis)).collect();
    let unsupported = |what: &str| -> Result<_, Error> {
        let advice =
            "say with kinds (space, vector, RGB-color …) which one to three axes, side by side, are those of space";
        Err(source.unsupported(format!("a NRRD file {what}"), advice))
    };
    match spatial[..] {
        [] => unsupported("without an axis of space"),
        [.., last] if spatial.len() > 3 => {
            unsupported(&format!("of {} axes of space (up to axis {last})", spatial.len()))
        }
        [first, ..] => {
            let range = first..first + spatial.len();
            if spatial.iter().copied().eq(range.clone()) {
                Ok(range)
            } else {
                unsupported("with an axis between those of space")
            }
        }
    }
}

/// What fields say of each axis by itself, without directions.
struct Straight {
    spacings: Option<Vec<f64>>,
    mins: Option<Vec<f64>>,
    maxs: Option<Vec<f64>>,
    /// Whether samples stand in the middle of cells, of which `mins` and `maxs` are the borders.
    is_cell: Vec<bool>,
}

impl Straight {
    fn of(header: &Header<'_>, dimension: usize, source: Source<'_>) -> Result<Self> {
        let numbers = |name: &str| header.field(name).map(|field| field.numbers(dimension, source)).transpose();
        let centers = header.field("centerings").or_else(|| header.field("centers"));
        let centers = centers.as_ref().map(|field| field.words(dimension, source)).transpose()?;
        let is_cell = centers.map_or(vec![false; dimension], |centers| {
            centers.iter().map(|center| center.eq_ignore_ascii_case("cell")).collect()
        });
        Ok(Self { spacings: numbers("spacings")?, mins: numbers("axismins")?, maxs: numbers("axismaxs")?, is_cell })
    }

    /// From sample to sample, and where the first is.
    fn along(&self, axis: usize, size: usize) -> (f64, f64) {
        let of = |numbers: &Option<Vec<f64>>| numbers.as_ref().map(|numbers| numbers[axis]);
        // NaN: its writer did not know.
        let border = |numbers: &Option<Vec<f64>>| of(numbers).filter(|border| !border.is_nan());
        // An axis from border to border has a cell a sample, one from sample to sample a cell less.
        let cells = if self.is_cell[axis] { size } else { (size - 1).max(1) };
        let from_borders = || Some((border(&self.maxs)? - border(&self.mins)?) / cells as f64);
        let spacing = of(&self.spacings).or_else(from_borders).unwrap_or(1.0);
        let middle = if self.is_cell[axis] { 0.5 * spacing } else { 0.0 };
        (spacing, border(&self.mins).map_or(0.0, |border| border + middle))
    }
}
