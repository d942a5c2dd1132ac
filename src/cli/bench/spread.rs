//! Several runs of one thing: the median, and how far the runs lie apart.

use std::time::Instant;

use serde::Serialize;

use super::Outcome;
use super::session::Session;

/// The times of runs, in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Spread {
    pub(super) runs: usize,
    pub(super) median_ms: f64,
    pub(super) least_ms: f64,
    /// A quarter of the runs took less than the first, a quarter more than the second.
    pub(super) quartiles_ms: [f64; 2],
}

impl Spread {
    /// Of at least one run.
    ///
    /// # Panics
    /// If there is none.
    pub(super) fn of(mut times_ms: Vec<f64>) -> Self {
        assert!(!times_ms.is_empty(), "a median needs a run");
        times_ms.sort_by(f64::total_cmp);
        // Linear between the runs, the first at 0 and the last at 1.
        let at = |share: f64| {
            let place = share * (times_ms.len() - 1) as f64;
            let (below, above) = (times_ms[place.floor() as usize], times_ms[place.ceil() as usize]);
            below + (above - below) * place.fract()
        };
        Self { runs: times_ms.len(), median_ms: at(0.5), least_ms: times_ms[0], quartiles_ms: [at(0.25), at(0.75)] }
    }

    pub(super) fn median_s(&self) -> f64 {
        self.median_ms * 1e-3
    }

    /// The distance between the quartiles as a share of the median, in percent.
    pub(super) fn percent(&self) -> f64 {
        100.0 * (self.quartiles_ms[1] - self.quartiles_ms[0]) / self.median_ms
    }
}

/// Runs `work` often enough, on memory that `prepare` readies before each run and `check` looks at after it; neither is timed.
pub(super) fn measure<T>(
    session: &Session,
    runs: usize,
    memory: &mut T,
    mut prepare: impl FnMut(&mut T),
    mut work: impl FnMut(&mut T),
    mut check: impl FnMut(&T) -> Outcome,
) -> Outcome<Spread> {
    let mut times_ms = Vec::with_capacity(runs);
    for run in 0..session.warm_up + runs {
        prepare(memory);
        let start = Instant::now();
        work(memory);
        let elapsed = start.elapsed();
        check(memory)?;
        if run >= session.warm_up {
            times_ms.push(elapsed.as_secs_f64() * 1e3);
        }
    }
    Ok(Spread::of(times_ms))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_lie_between_the_runs() {
        let spread = Spread::of(vec![5.0, 1.0, 3.0, 2.0, 4.0]);
        let expected = Spread { runs: 5, median_ms: 3.0, least_ms: 1.0, quartiles_ms: [2.0, 4.0] };
        assert_eq!(spread, expected);
        assert!((spread.percent() - 200.0 / 3.0).abs() < 1e-9);
        let two = Spread::of(vec![2.0, 1.0]);
        assert_eq!((two.median_ms, two.quartiles_ms), (1.5, [1.25, 1.75]));
        assert!(Spread::of(vec![7.0]).percent().abs() < 1e-12);
    }
}
