//! A [`Report`] as a picture: frames a second, and where each frame's milliseconds go, over the frames.
//!
//! In: a report. Out: SVG, written here; PNG, which [resvg](https://docs.rs/resvg) makes of it with a typeface of its own, so that no
//! font need be installed (feature `plot`).

mod axis;
#[cfg(feature = "plot")]
mod png;
mod svg;

use std::io::Write;
use std::path::Path;

use axis::{Axis, Frames};
use svg::{Anchor, Svg};

use super::{Distribution, Report, StageSummary};
use crate::atomic::{io_at, write_atomically};
use crate::{Error, Result};

/// Width and height, in points of an SVG and pixels of a PNG.
const SIZE: [f64; 2] = [1200.0, 720.0];
/// Where the panels begin and end, from left to right; legends stand beside them.
const COLUMNS: [f64; 2] = [72.0, 950.0];
/// The panel of rates, from its top to its bottom.
const RATES: [f64; 2] = [92.0, 256.0];
/// The panel of times.
const TIMES: [f64; 2] = [316.0, 648.0];

/// Colours of stages; Tableau's ten, which colour-blind readers tell apart, and two more.
const COLORS: [&str; 12] = [
    "#4e79a7", "#f28e2b", "#59a14f", "#e15759", "#76b7b2", "#edc948", "#b07aa1", "#ff9da7", "#9c755f", "#86bcb6",
    "#d4a6c8", "#8cd17d",
];
const OTHER: &str = "#c4c4c4";
const INK: &str = "#222222";
const FAINT: &str = "#666666";
const GRID: &str = "#e4e4e4";

/// A frame that takes more than this many times the median is cut off, and marked, where all others would be flat beside it.
const CUT: f64 = 4.0;

impl Report {
    /// The plot as SVG.
    ///
    /// ```
    /// # use cellfan::profile::{FrameRecord, Profile, Report};
    /// let frames = (0..20).map(|view| FrameRecord::new(view, 10.0, &Profile::default())).collect();
    /// let svg = Report { frames, ..Report::default() }.to_svg();
    /// assert!(svg.starts_with("<svg ") && svg.contains("median 100.0"));
    /// ```
    pub fn to_svg(&self) -> String {
        let mut svg = Svg::new(SIZE, &self.heading());
        let left = COLUMNS[0];
        let heading = self.heading();
        // Bold letters are some 0.66 of their size wide: a long name in smaller ones.
        let size = (1.5 * (SIZE[0] - 2.0 * left) / heading.chars().count() as f64).clamp(8.0, 18.0);
        svg.bold([left, 34.0], size, &heading);
        svg.text([left, 56.0], 12.0, FAINT, Anchor::Start, &self.origin());
        let Some(ms) = self.frame_ms() else {
            svg.text([left, 120.0], 14.0, INK, Anchor::Start, "no frames");
            return svg.finish();
        };
        let frames = Frames { count: self.frames.len(), columns: COLUMNS };
        draw_rates(&mut svg, &frames, self, &ms);
        draw_times(&mut svg, &frames, self, &ms);
        svg.finish()
    }

    /// Writes the plot: as SVG or PNG, by the name's end; the file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Encode`] for another end, or for .png without the feature `plot`; [`Error::Io`] where the system refuses to write.
    pub fn save_plot(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let bytes = match PlotFormat::from_path(path)? {
            PlotFormat::Svg => self.to_svg().into_bytes(),
            #[cfg(feature = "plot")]
            PlotFormat::Png => png::encode(&self.to_svg()).map_err(|problem| encode_error(path, problem))?,
        };
        write_atomically(path, |writer| writer.write_all(&bytes).map_err(io_at(path)))
    }
}

/// What a plot is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlotFormat {
    /// Lines and letters.
    Svg,
    /// Pixels.
    #[cfg(feature = "plot")]
    Png,
}

impl PlotFormat {
    /// The format of the path's extension, in upper or lower case.
    ///
    /// # Errors
    /// [`Error::Encode`] where it is none.
    ///
    /// ```
    /// # use cellfan::profile::plot::PlotFormat;
    /// assert_eq!(PlotFormat::from_path("rates.SVG".as_ref())?, PlotFormat::Svg);
    /// assert!(PlotFormat::from_path("rates.pdf".as_ref()).is_err());
    /// # Ok::<(), cellfan::Error>(())
    /// ```
    pub fn from_path(path: &Path) -> Result<Self> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("svg") => Ok(Self::Svg),
            #[cfg(feature = "plot")]
            Some("png") => Ok(Self::Png),
            #[cfg(not(feature = "plot"))]
            Some("png") => {
                Err(encode_error(path, "this build plots no .png (feature plot); end the name in .svg".to_owned()))
            }
            _ => Err(encode_error(path, "plots are written as .svg or .png; end the name in one of them".to_owned())),
        }
    }
}

fn encode_error(path: &Path, problem: String) -> Error {
    Error::Encode { path: path.to_owned(), problem }
}

/// Frames a second.
fn draw_rates(svg: &mut Svg, frames: &Frames, report: &Report, ms: &Distribution) {
    let rate = |ms: f64| 1e3 / ms.max(1e-6);
    // One frame that is very fast must not flatten the others either.
    let top = rate(ms.least).min(CUT * rate(ms.median));
    let axis = Axis::new(top * 1.08, RATES);
    draw_panel(svg, frames, &axis, "frames a second", report.views.orbit_degrees, false);
    let mut free = 0.0;
    for (value, name, dash) in [(rate(ms.median), "median", "7 4"), (rate(ms.p95), "95 % of frames reach", "2 3")] {
        let y = axis.y(value);
        svg.line([COLUMNS[0], y], [COLUMNS[1], y], INK, 1.0, dash);
        // Names keep apart where the lines do not.
        let below = y.max(free);
        svg.text([COLUMNS[1] + 12.0, below + 4.0], 12.0, INK, Anchor::Start, &format!("{name} {value:.1}"));
        free = below + 15.0;
    }
    let points: Vec<[f64; 2]> =
        report.frames.iter().enumerate().map(|(i, frame)| [frames.center(i), axis.y(rate(frame.ms))]).collect();
    match points[..] {
        [[x, y]] => svg.circle([x, y], 3.0, COLORS[0]),
        _ => svg.polyline(&points, COLORS[0], 1.6, ""),
    }
}

/// Milliseconds a frame: stages on top of each other, what runs beside them as lines.
fn draw_times(svg: &mut Svg, frames: &Frames, report: &Report, ms: &Distribution) {
    let (in_frame, beside): (Vec<_>, Vec<_>) = report.stages().into_iter().partition(|stage| stage.track.is_frame());
    let highest_beside = beside.iter().map(|stage| stage.ms.most).fold(0.0, f64::max);
    let top = ms.most.max(highest_beside).min((CUT * ms.median).max(1.2 * ms.p95));
    let axis = Axis::new(top * 1.05, TIMES);
    draw_panel(svg, frames, &axis, "milliseconds a frame", report.views.orbit_degrees, true);

    let mut below = vec![0.0; report.frames.len()];
    let colors = || COLORS.iter().cycle();
    for (stage, color) in in_frame.iter().zip(colors()) {
        let above: Vec<f64> =
            below.iter().zip(&report.frames).map(|(below, frame)| below + frame.stage_ms(&stage.name)).collect();
        svg.polygon(&frames.band(&axis, &below, &above), color);
        below = above;
    }
    let whole: Vec<f64> = report.frames.iter().map(|frame| frame.ms).collect();
    let other: Vec<f64> = below.iter().zip(&whole).map(|(below, whole)| below.max(*whole)).collect();
    svg.polygon(&frames.band(&axis, &below, &other), OTHER);
    svg.polyline(&frames.steps(&axis, &whole), INK, 1.2, "");
    for (i, stage) in beside.iter().enumerate() {
        let times: Vec<f64> = report.frames.iter().map(|frame| frame.stage_ms(&stage.name)).collect();
        let color = COLORS[(in_frame.len() + i) % COLORS.len()];
        svg.polyline(&frames.steps(&axis, &times), color, 2.0, "6 3");
    }
    for (value, dash) in [(ms.median, "7 4"), (ms.p95, "2 3")] {
        let y = axis.y(value);
        svg.line([COLUMNS[0], y], [COLUMNS[1], y], INK, 1.0, dash);
    }
    for (i, &ms) in whole.iter().enumerate().filter(|&(_, &ms)| ms > axis.top) {
        let x = frames.center(i);
        svg.polygon(&[[x - 5.0, TIMES[0] + 9.0], [x, TIMES[0] + 1.0], [x + 5.0, TIMES[0] + 9.0]], COLORS[3]);
        let (at, anchor) = if x > 0.8 * COLUMNS[1] { (x - 8.0, Anchor::End) } else { (x + 8.0, Anchor::Start) };
        svg.text([at, TIMES[0] + 10.0], 11.0, COLORS[3], anchor, &format!("{ms:.1} ms"));
    }
    let other_ms = report.other_ms().map_or(0.0, |other| other.median);
    draw_legend(svg, ms, &in_frame, other_ms, &beside);
}

/// Names and medians, the uppermost stage first, as they are stacked.
fn draw_legend(svg: &mut Svg, ms: &Distribution, in_frame: &[StageSummary], other_ms: f64, beside: &[StageSummary]) {
    let left = COLUMNS[1] + 12.0;
    let mut y = TIMES[0] + 4.0;
    let head = |svg: &mut Svg, y: f64, name: &str, value: f64, dash: &str| {
        svg.line([left, y], [left + 18.0, y], INK, 1.2, dash);
        svg.text([left + 26.0, y + 4.0], 12.0, INK, Anchor::Start, name);
        svg.text([SIZE[0] - 16.0, y + 4.0], 12.0, INK, Anchor::End, &format!("{value:.2} ms"));
    };
    for (name, value, dash) in [
        ("median frame", ms.median, "7 4"),
        ("95 %", ms.p95, "2 3"),
        ("99 %", ms.p99, "none"),
        ("most", ms.most, "none"),
    ] {
        if dash == "none" {
            svg.text([left + 26.0, y + 4.0], 12.0, INK, Anchor::Start, name);
            svg.text([SIZE[0] - 16.0, y + 4.0], 12.0, INK, Anchor::End, &format!("{value:.2} ms"));
        } else {
            head(svg, y, name, value, dash);
        }
        y += 18.0;
    }
    y += 10.0;
    let rows =
        in_frame.iter().zip(COLORS.iter().cycle()).map(|(stage, &color)| (stage.name.as_str(), stage.ms.median, color));
    let rows: Vec<_> = rows.chain([("other", other_ms, OTHER)]).collect();
    let values = |svg: &mut Svg, y: f64, name: &str, value: f64| {
        svg.text([left + 26.0, y + 4.0], 12.0, INK, Anchor::Start, name);
        let share = 100.0 * value / ms.median.max(1e-9);
        svg.text([SIZE[0] - 64.0, y + 4.0], 12.0, INK, Anchor::End, &format!("{value:.2}"));
        svg.text([SIZE[0] - 16.0, y + 4.0], 12.0, FAINT, Anchor::End, &format!("{share:.0} %"));
    };
    for &(name, value, color) in rows.iter().rev() {
        svg.rect([left + 3.0, y - 6.0], [12.0, 12.0], color);
        values(svg, y, name, value);
        y += 18.0;
    }
    if !beside.is_empty() {
        y += 10.0;
        svg.text([left, y + 4.0], 11.0, FAINT, Anchor::Start, "meanwhile, on GPU or thread:");
        y += 18.0;
    }
    for (i, stage) in beside.iter().enumerate() {
        svg.line([left, y], [left + 18.0, y], COLORS[(in_frame.len() + i) % COLORS.len()], 2.0, "6 3");
        values(svg, y, &stage.name, stage.ms.median);
        y += 18.0;
    }
}

/// Grid, numbers and names of a panel; the lower one names the frames.
fn draw_panel(svg: &mut Svg, frames: &Frames, axis: &Axis, name: &str, orbit_degrees: f64, names_frames: bool) {
    let [left, right] = COLUMNS;
    svg.bold([left, axis.rows[0] - 12.0], 13.0, name);
    for (value, label) in axis.ticks() {
        let y = axis.y(value);
        svg.line([left, y], [right, y], GRID, 1.0, "");
        svg.text([left - 8.0, y + 4.0], 11.0, FAINT, Anchor::End, &label);
    }
    for i in frames.ticks() {
        let x = frames.center(i);
        svg.line([x, axis.rows[1]], [x, axis.rows[1] + 5.0], FAINT, 1.0, "");
        if names_frames {
            svg.text([x, axis.rows[1] + 20.0], 11.0, FAINT, Anchor::Middle, &i.to_string());
            if orbit_degrees != 0.0 {
                let degrees = orbit_degrees * i as f64 / frames.count as f64;
                svg.text([x, axis.rows[1] + 36.0], 11.0, FAINT, Anchor::Middle, &format!("{degrees:.0}°"));
            }
        }
    }
    svg.line([left, axis.rows[1]], [right, axis.rows[1]], FAINT, 1.0, "");
    if names_frames {
        let what = if orbit_degrees == 0.0 { "frame" } else { "frame, and the degrees that the eye has turned" };
        svg.text([0.5 * (left + right), axis.rows[1] + 56.0], 12.0, INK, Anchor::Middle, what);
    }
}

#[cfg(test)]
mod tests;
