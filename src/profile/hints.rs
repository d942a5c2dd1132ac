//! [`Hint`]: what the figures of a [`Report`] say about where its time goes, each with the numbers that it is drawn from.
//!
//! To add one: a function from a [`Report`] to a text, or none where there is nothing to say, and its line in [`Report::hints`].

use serde::Serialize;

use super::report_table::grouped;
use super::table::in_units;
use super::{FrameRecord, Report, StageSummary, Track, quantile};

/// One remark.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Hint {
    /// What it is about.
    pub topic: &'static str,
    /// The remark, with its numbers.
    pub text: String,
}

/// Frames on either side of one that its time is compared with.
const NEIGHBOURS: usize = 4;
/// A frame that takes so many times its neighbours' median may be an outlier.
const OUTLIER: f64 = 1.3;
/// Pixels that are left out at half the width and height.
const LEFT_OUT: f64 = 0.75;

impl Report {
    /// What the figures say; nothing without a frame.
    ///
    /// ```
    /// # use cellfan::profile::{FrameRecord, Profile, Report};
    /// let mut profile = Profile::default();
    /// profile.add("composite", std::time::Duration::from_millis(9), 0);
    /// let report = Report { frames: vec![FrameRecord::new(0, 12.0, &profile)], ..Report::default() };
    /// let hint = &report.hints().into_iter().find(|hint| hint.topic == "stage").unwrap();
    /// assert!(hint.text.starts_with("75 % of the frame is composite (9.00 of 12.00 ms)"));
    /// ```
    pub fn hints(&self) -> Vec<Hint> {
        if self.frames.is_empty() {
            return Vec::new();
        }
        let all: [(&'static str, Option<String>); 11] = [
            ("build", self.build()),
            ("stage", self.dominant_stage()),
            ("pixels", self.pixels_or_cells()),
            ("gpu", self.gpu_or_cpu()),
            ("cells", self.cells_a_pixel()),
            ("outliers", self.outliers()),
            ("first", self.first_frame()),
            ("drift", self.changes_slowly()),
            ("other", self.unaccounted()),
            ("threads", self.idle_cores()),
            ("memory", self.memory()),
        ];
        all.into_iter().filter_map(|(topic, text)| text.map(|text| Hint { topic, text })).collect()
    }

    fn build(&self) -> Option<String> {
        self.program
            .has_debug_assertions
            .then(|| "built with debug assertions: these are no figures of a release".to_owned())
    }

    fn median_ms(&self) -> f64 {
        self.frame_ms().map_or(0.0, |ms| ms.median)
    }

    fn dominant_stage(&self) -> Option<String> {
        let stages = self.stages();
        // Waiting is not work: the hint on GPUs has it.
        let works = |s: &&StageSummary| s.track.is_frame() && s.name != "wait_for_gpu";
        let largest = stages.iter().filter(works).max_by(|a, b| a.share.total_cmp(&b.share))?;
        let StageSummary { name, ms, share, .. } = largest;
        let of = format!("({:.2} of {:.2} ms)", ms.median, self.median_ms());
        (*share >= 0.2).then(|| {
            format!(
                "{:.0} % of the frame is {name} {of}: were it twice as fast, the frame would be {:.2} times as fast",
                100.0 * share,
                1.0 / (1.0 - (share / 2.0).min(0.5))
            )
        })
    }

    /// What the same views took at half the width and height.
    fn pixels_or_cells(&self) -> Option<String> {
        let share_left = |ms: &dyn Fn(&FrameRecord) -> f64| {
            let pair = |half: &FrameRecord| {
                let full = self.frames.iter().find(|frame| frame.view == half.view)?;
                (ms(full) > 0.0).then(|| ms(half) / ms(full))
            };
            median(self.half_size.iter().filter_map(pair).collect())
        };
        let left = share_left(&|frame| frame.ms)?;
        let with_pixels = ((1.0 - left) / LEFT_OUT).clamp(0.0, 1.0);
        let bound = match with_pixels {
            p if p >= 0.6 => "the frame is bound by fragments: a smaller picture helps, fewer cells do not",
            p if p <= 0.3 => {
                "the frame is bound by cells: fewer cells, or more of them culled, help, a smaller picture does not"
            }
            _ => "both count",
        };
        let stage = self
            .stages()
            .into_iter()
            .filter(|stage| stage.track.is_frame() && stage.share >= 0.1)
            .max_by(|a, b| a.share.total_cmp(&b.share));
        let of_stage = stage.and_then(|stage| {
            let left = share_left(&|frame| frame.stage_ms(&stage.name))?;
            Some(format!(" ({} {left:.2} times)", stage.name))
        });
        Some(format!(
            "a quarter of the pixels takes {left:.2} times as long{} (median of {} views): about {:.0} % of the time goes with pixels, the rest \
             with cells; {bound}",
            of_stage.unwrap_or_default(),
            self.half_size.len(),
            100.0 * with_pixels
        ))
    }

    fn gpu_or_cpu(&self) -> Option<String> {
        let stages = self.stages();
        let mut on_gpu = stages.iter().filter(|stage| stage.track == Track::Gpu).peekable();
        on_gpu.peek()?;
        let busy: f64 = on_gpu.map(|stage| stage.share).sum();
        let waiting = stages.iter().find(|stage| stage.name == "wait_for_gpu").map_or(0.0, |stage| stage.share);
        let bound = if busy >= 0.7 {
            "GPU-bound"
        } else if waiting >= 0.5 {
            "bound by handing over to the GPU and waiting for it"
        } else {
            "CPU-bound"
        };
        Some(format!(
            "{bound}: passes take {:.0} % of the frame by the GPU's clock, and the program waits {:.0} % of it for the GPU",
            100.0 * busy,
            100.0 * waiting
        ))
    }

    fn cells_a_pixel(&self) -> Option<String> {
        let drawn = median(self.frames.iter().map(|frame| frame.drawn_cells as f64).collect())?;
        let covered = median(self.frames.iter().map(|frame| frame.covered_px as f64).collect())?;
        if drawn == 0.0 || covered == 0.0 || self.mesh.cells == 0 {
            return None;
        }
        Some(format!(
            "{} of {} cells are drawn ({:.0} %), on {} pixels that show something: {:.2} cells a pixel",
            grouped(drawn as u64),
            grouped(self.mesh.cells),
            100.0 * drawn / self.mesh.cells as f64,
            grouped(covered as u64),
            drawn / covered
        ))
    }

    /// Frames that took much longer than those before and after them.
    fn outliers(&self) -> Option<String> {
        let times: Vec<f64> = self.frames.iter().map(|frame| frame.ms).collect();
        if times.len() <= 2 * NEIGHBOURS {
            return None;
        }
        let usual = running_medians(&times);
        let off: Vec<f64> = times.iter().zip(&usual).map(|(ms, usual)| (ms - usual).abs()).collect();
        // Five times the median deviation: of normal noise, one frame in a thousand.
        let noise = 5.0 * median(off)?;
        let is_outlier = |i: &usize| times[*i] > OUTLIER * usual[*i] && times[*i] - usual[*i] > noise;
        let slow: Vec<usize> = (0..times.len()).filter(is_outlier).collect();
        let worst = slow.iter().copied().max_by(|&i, &j| (times[i] - usual[i]).total_cmp(&(times[j] - usual[j])))?;
        let excess = |stage: &StageSummary| {
            let times: Vec<f64> = self.frames.iter().map(|frame| frame.stage_ms(&stage.name)).collect();
            (stage.name.clone(), times[worst] - running_medians(&times)[worst])
        };
        let of_frame = self.stages().into_iter().filter(|stage| stage.track.is_frame());
        let stage = of_frame.map(|stage| excess(&stage)).max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, ms)| *ms > 0.0);
        let stage = stage.map(|(name, ms)| format!(", {ms:.2} ms more than usual of it in {name}")).unwrap_or_default();
        Some(format!(
            "{} of {} frames took over {OUTLIER} times as long as their neighbours; the worst is frame {worst}, {:.2} ms instead of {:.2}{stage}",
            slow.len(),
            times.len(),
            times[worst],
            usual[worst]
        ))
    }

    fn first_frame(&self) -> Option<String> {
        let first = self.warm_up.first()?;
        let median = self.median_ms();
        if first.ms < 1.2 * median {
            return None;
        }
        let usual =
            |name: &str| self.stages().iter().find(|stage| stage.name == name).map_or(0.0, |stage| stage.ms.median);
        let in_frame = first.stages.iter().filter(|stage| stage.track.is_frame());
        let excess =
            in_frame.map(|stage| (&stage.name, stage.ms - usual(&stage.name))).max_by(|a, b| a.1.total_cmp(&b.1));
        let stage = excess.map(|(name, ms)| format!(", {ms:.2} ms of the difference in {name}")).unwrap_or_default();
        Some(format!(
            "the first frame took {:.2} ms, {:.1} times the median of those that count{stage}",
            first.ms,
            first.ms / median
        ))
    }

    /// How much frame times change in the long run, outliers aside: what changes them cannot be told from one run.
    fn changes_slowly(&self) -> Option<String> {
        let times: Vec<f64> = self.frames.iter().map(|frame| frame.ms).collect();
        if times.len() <= 2 * NEIGHBOURS {
            return None;
        }
        let smooth = running_medians(&times);
        let at = |i: usize| (i, smooth[i]);
        let (least, low) = (0..smooth.len()).map(at).min_by(|a, b| a.1.total_cmp(&b.1))?;
        let (most, high) = (0..smooth.len()).map(at).max_by(|a, b| a.1.total_cmp(&b.1))?;
        let why = match self.views.orbit_degrees {
            0.0 => "the view is the same, so something else took the machine's time, or it slowed down",
            _ => {
                "by the view, or by what else the machine did meanwhile; a second run of the same views tells (--compare)"
            }
        };
        (high > 1.25 * low).then(|| {
            format!(
                "frames change slowly: {low:.2} ms around frame {least}, {high:.2} ms around frame {most} (medians of {}): {why}",
                2 * NEIGHBOURS + 1
            )
        })
    }

    fn unaccounted(&self) -> Option<String> {
        let (other, median) = (self.other_ms()?.median, self.median_ms());
        (other > 0.05 * median)
            .then(|| format!("{:.0} % of the frame ({other:.2} ms) is in no stage: memory for the picture, and what lies between stages", 100.0 * other / median))
    }

    fn idle_cores(&self) -> Option<String> {
        let threads = self.settings.get("threads")?.as_u64()?;
        let cores = self.machine.threads as u64;
        (threads < cores).then(|| format!("{threads} of {cores} cores have a thread (--threads)"))
    }

    fn memory(&self) -> Option<String> {
        let resident = in_units(self.peak_rss_bytes?);
        let anonymous = self
            .peak_anonymous_bytes
            .map(|bytes| format!("; in the frames at most {} without a file behind it", in_units(bytes)));
        Some(format!(
            "the process held at most {resident}, mapped files and the reading of the mesh included{}",
            anonymous.unwrap_or_default()
        ))
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    quantile(&values, 0.5)
}

/// Of each value the median of it and its neighbours; at the ends of those that there are.
fn running_medians(values: &[f64]) -> Vec<f64> {
    let around = |i: usize| values[i.saturating_sub(NEIGHBOURS)..(i + NEIGHBOURS + 1).min(values.len())].to_vec();
    (0..values.len()).map(|i| median(around(i)).unwrap_or_default()).collect()
}

#[cfg(test)]
mod tests;
