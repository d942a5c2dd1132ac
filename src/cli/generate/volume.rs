//! `generate volume`: an analytic signal on a regular grid, as NRRD or as a container with its octree.

use cellfan::Error;
use cellfan::generate::{Orbital, SampleType, Signal, volume};
use cellfan::io::{Compression, check_target, container, write_nrrd};
use clap::Args;

use super::Arguments;
use crate::cli::Outcome;
use crate::cli::arguments::one_of;
use crate::cli::convert::{is_container_name, told};
use crate::cli::numbers::grouped;
use crate::cli::progress::Progress;

/// What volumes have of their own.
#[derive(Args)]
pub(super) struct VolumeArguments {
    /// Signal of a volume.
    #[arg(long, value_name = "SIGNAL", help_heading = "Volumes", default_value = "marschner-lobb", value_parser = one_of(SIGNALS.map(|(name, _)| (name, name))))]
    signal: &'static str,
    /// Samples along x, y and z, in place of --cells.
    #[arg(long, value_name = "WxHxD", help_heading = "Volumes", value_parser = dims, conflicts_with = "cells")]
    dims: Option<[usize; 3]>,
    /// Type of the samples: u8 spans the signal.
    #[arg(long, value_name = "TYPE", help_heading = "Volumes", default_value = "u8", value_parser = one_of([("u8", SampleType::U8), ("f32", SampleType::F32)]))]
    samples: SampleType,
}

/// A signal of the orbital that is asked for, which most do not ask.
type SignalOf = fn(Orbital) -> Signal;

const SIGNALS: [(&str, SignalOf); 3] =
    [("marschner-lobb", |_| Signal::MarschnerLobb), ("buckyball", |_| Signal::Buckyball), ("orbital", Signal::Orbital)];

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let (path, of_volume) = (&arguments.output, &arguments.volume);
    let is_nrrd = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("nrrd"));
    if !is_nrrd && !is_container_name(path) {
        let problem = format!("\"{}\": volumes are written as .nrrd or .cells; end the name in it", path.display());
        return Err(Error::Option { option: "--out", problem }.into());
    }
    check_target(path)?;
    let side = cube_side(arguments.cells)?;
    let dims = of_volume.dims.unwrap_or([side; 3]);
    let signal = SIGNALS.iter().find(|(name, _)| *name == of_volume.signal);
    let signal = signal.map_or(Signal::MarschnerLobb, |(_, signal)| signal(arguments.orbital));
    let volume = {
        let _progress = Progress::running("generating a volume");
        volume(dims, signal, of_volume.samples)?
    };
    if !is_nrrd {
        told(path, |tell| container::write_volume(volume, path, tell))?;
        return Ok(());
    }
    {
        let _progress = Progress::running(format!("writing {}", path.display()));
        let compression = if arguments.raw { Compression::None } else { Compression::Zlib };
        write_nrrd(path, &volume, "value", compression)?;
    }
    tracing::info!("wrote {}: {} samples", path.display(), dims.map(|points| grouped(points as u64)).join(" x "));
    Ok(())
}

/// Points along the edge of the smallest cube with so many cells.
fn cube_side(cells: u64) -> cellfan::Result<usize> {
    if cells == 0 {
        return Err(Error::Option { option: "--cells", problem: "a volume needs at least 1 cell".to_owned() });
    }
    let along = (cells as f64).cbrt().round() as u64;
    let enough = (along.saturating_sub(1)..=along + 1).find(|&along| u128::from(along).pow(3) >= u128::from(cells));
    Ok(enough.map_or(usize::MAX, |along| along as usize + 1))
}

/// `WxHxD`.
fn dims(text: &str) -> Result<[usize; 3], String> {
    let sizes: Option<Vec<usize>> = text.split(['x', 'X']).map(|size| size.parse().ok()).collect();
    let dims = sizes.and_then(|sizes| sizes.try_into().ok());
    dims.ok_or_else(|| "expected the numbers of samples along x, y and z, such as 256x256x110".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubes_have_at_least_the_cells_wanted() {
        for (cells, side) in
            [(1, 2), (2, 3), (8, 3), (9, 4), (100_000, 48), (255 * 255 * 255, 256), (1_000_000_000_001, 10_002)]
        {
            assert_eq!(cube_side(cells).unwrap(), side, "{cells}");
        }
        assert!(cube_side(0).is_err() && cube_side(u64::MAX).is_ok());
        assert_eq!(dims("256x256x110"), Ok([256, 256, 110]));
        assert!(["", "2x2", "2x2x2x2", "2xax2"].iter().all(|bad| dims(bad).is_err()));
    }
}
