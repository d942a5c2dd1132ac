//! Scales: values to rows, frames to columns.

/// A vertical axis from 0.
pub(super) struct Axis {
    /// The value at the upper end.
    pub(super) top: f64,
    /// Where it ends above and below.
    pub(super) rows: [f64; 2],
}

impl Axis {
    pub(super) fn new(top: f64, rows: [f64; 2]) -> Self {
        Self { top: if top.is_finite() && top > 0.0 { top } else { 1.0 }, rows }
    }

    /// The row of a value; one beyond the top stays at the top.
    pub(super) fn y(&self, value: f64) -> f64 {
        let [above, below] = self.rows;
        below - (value / self.top).clamp(0.0, 1.0) * (below - above)
    }

    /// Round values, four to nine of them, with their labels.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let step = round_step(self.top / 8.0);
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let count = (self.top / step + 1e-9).floor() as usize;
        (0..=count).map(|i| i as f64 * step).map(|value| (value, format!("{value:.digits$}"))).collect()
    }
}

/// The next of 1, 2, 5, 10 … from `at_least`.
fn round_step(at_least: f64) -> f64 {
    let power = 10_f64.powf(at_least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|step| step * power)
        .find(|&step| step >= at_least * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// The horizontal axis: a strip for each frame.
pub(super) struct Frames {
    pub(super) count: usize,
    /// Where the first begins and the last ends.
    pub(super) columns: [f64; 2],
}

impl Frames {
    /// Where frame `i` begins; where the last ends for one more.
    fn start(&self, i: usize) -> f64 {
        let [left, right] = self.columns;
        left + (right - left) * i as f64 / self.count.max(1) as f64
    }

    /// The middle of frame `i`.
    pub(super) fn center(&self, i: usize) -> f64 {
        0.5 * (self.start(i) + self.start(i + 1))
    }

    /// Frames whose numbers are written.
    pub(super) fn ticks(&self) -> impl Iterator<Item = usize> {
        let step = round_step((self.count as f64 / 10.0).max(1.0)) as usize;
        (0..self.count).step_by(step)
    }

    /// A line that is level in each frame.
    pub(super) fn steps(&self, axis: &Axis, values: &[f64]) -> Vec<[f64; 2]> {
        values
            .iter()
            .enumerate()
            .flat_map(|(i, &value)| [i, i + 1].map(|end| [self.start(end), axis.y(value)]))
            .collect()
    }

    /// What lies between two such lines.
    pub(super) fn band(&self, axis: &Axis, below: &[f64], above: &[f64]) -> Vec<[f64; 2]> {
        let mut outline = self.steps(axis, above);
        outline.extend(self.steps(axis, below).into_iter().rev());
        outline
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        for top in [1e-3, 0.07, 0.99, 1.0, 7.3, 10.0, 123.0, 99_999.0] {
            let ticks = Axis::new(top, [0.0, 100.0]).ticks();
            assert!(
                (3..=10).contains(&ticks.len()) && ticks.last().unwrap().0 <= top * (1.0 + 1e-6),
                "{top}: {ticks:?}"
            );
        }
        let labels =
            |top: f64| Axis::new(top, [0.0, 1.0]).ticks().into_iter().map(|(_, label)| label).collect::<Vec<_>>();
        assert_eq!(labels(10.0), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(0.5), ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        let frames = |count: usize| Frames { count, columns: [0.0, 1.0] }.ticks().collect::<Vec<_>>();
        assert_eq!((frames(1), frames(3), frames(200).len()), (vec![0], vec![0, 1, 2], 10));
    }

    #[test]
    fn values_and_frames_have_their_places() {
        let axis = Axis::new(10.0, [20.0, 120.0]);
        assert_eq!([0.0, 5.0, 10.0, 99.0].map(|value| Some(axis.y(value))), [120.0, 70.0, 20.0, 20.0].map(Some));
        let frames = Frames { count: 2, columns: [10.0, 30.0] };
        assert_eq!((frames.center(0), frames.center(1)), (15.0, 25.0));
        assert_eq!(frames.steps(&axis, &[5.0, 10.0]), [[10.0, 70.0], [20.0, 70.0], [20.0, 20.0], [30.0, 20.0]]);
        assert_eq!(frames.band(&axis, &[0.0, 0.0], &[5.0, 10.0]).len(), 8);
        assert_eq!(Some(Axis::new(f64::NAN, [0.0, 1.0]).top), Some(1.0));
    }
}
