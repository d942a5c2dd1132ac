//! In: control points, perhaps hundreds sampled from a colour map. Out: a subset that draws the same function.
//!
//! A chord starts at a kept point and is drawn out for as long as it passes within 1/1000 of every point below it: of
//! extinction's range, or of the range of the colour channel that varies most. Each point passed narrows the slopes that the chord
//! may have, so one pass is enough: O(n), however the points lie. Both sides of a step stay, so right-continuity does too.

use super::transfer::ControlPoint;

/// Allowed deviation, as a part of the range.
const TOLERANCE: f64 = 1e-3;

/// The points worth keeping, in order: the ends, both sides of each step, and what the tolerance asks for.
pub(super) fn thin_points(points: &[ControlPoint]) -> Vec<ControlPoint> {
    let allowed = allowed_deviation(points);
    let mut kept: Vec<ControlPoint> = Vec::new();
    let mut cone = Cone::OPEN;
    for (i, point) in points.iter().enumerate() {
        if let Some(start) = kept.last() {
            let before = &points[i - 1];
            if point.value <= before.value {
                // A step: its lower side ends the chord, its upper side starts one. `before` may be that start already.
                if start.value < before.value {
                    kept.push(*before);
                }
                kept.push(*point);
                cone = Cone::OPEN;
                continue;
            }
            if !cone.contains(start, point) {
                kept.push(*before);
                cone = Cone::OPEN;
            }
        } else {
            kept.push(*point);
            continue;
        }
        if let Some(start) = kept.last() {
            cone.narrow(start, point, &allowed);
        }
    }
    if let (Some(last), Some(kept_last)) = (points.last(), kept.last())
        && kept_last.value < last.value
    {
        kept.push(*last);
    }
    kept
}

/// The slopes, per channel, of chords that pass near enough to all points so far.
struct Cone {
    low: [f64; 4],
    high: [f64; 4],
}

impl Cone {
    const OPEN: Self = Self { low: [f64::NEG_INFINITY; 4], high: [f64::INFINITY; 4] };

    /// Whether the chord from `start` to `end` lies in the cone.
    fn contains(&self, start: &ControlPoint, end: &ControlPoint) -> bool {
        let slopes = slopes(start, end, [0.0; 4]);
        (0..4).all(|k| self.low[k] <= slopes[k] && slopes[k] <= self.high[k])
    }

    /// Leaves only what passes near `point`.
    fn narrow(&mut self, start: &ControlPoint, point: &ControlPoint, allowed: &[f64; 4]) {
        // A channel that does not vary allows nothing, and misses by rounding only: compare with its size.
        let channels = point.channels();
        let limit: [f64; 4] = std::array::from_fn(|k| allowed[k].max(1e-12 * channels[k].abs()));
        let (low, high) = (slopes(start, point, limit.map(|limit| -limit)), slopes(start, point, limit));
        for k in 0..4 {
            self.low[k] = self.low[k].max(low[k]);
            self.high[k] = self.high[k].min(high[k]);
        }
    }
}

/// Per half unit of value (so that the widest range does not overflow), from one point to another raised by `raise`.
fn slopes(start: &ControlPoint, end: &ControlPoint, raise: [f64; 4]) -> [f64; 4] {
    let half_width = 0.5 * end.value - 0.5 * start.value;
    let (from, to) = (start.channels(), end.channels());
    std::array::from_fn(|k| (to[k] - from[k] + raise[k]) / half_width)
}

fn allowed_deviation(points: &[ControlPoint]) -> [f64; 4] {
    let range = |k: usize| {
        let channel = || points.iter().map(|point| point.channels()[k]);
        channel().fold(f64::MIN, f64::max) - channel().fold(f64::MAX, f64::min)
    };
    let color = TOLERANCE * range(1).max(range(2)).max(range(3));
    [TOLERANCE * range(0), color, color, color]
}

#[cfg(test)]
mod tests {
    use super::super::transfer::TransferFunction;
    use super::*;

    fn sampled(n: usize, f: impl Fn(f64) -> f64) -> Vec<ControlPoint> {
        let value = |i: usize| i as f64 / (n - 1) as f64;
        (0..n).map(|i| ControlPoint { value: value(i), color: [f(value(i)), 0.3, 1.0], extinction: 2.0 }).collect()
    }

    #[test]
    fn straight_runs_keep_their_ends() {
        let thin = thin_points(&sampled(1000, |t| (t - 0.5).abs()));
        assert!(thin.len() <= 4, "{}", thin.len());
        assert_eq!(thin_points(&sampled(1000, |_| 0.7)).len(), 2);
        assert_eq!(thin_points(&sampled(2, |t| t)).len(), 2);
    }

    #[test]
    fn curves_stay_within_a_thousandth_of_their_range() {
        let full = TransferFunction::new(sampled(700, |t| 5.0 + (9.0 * t).sin())).unwrap();
        let thin = full.thinned();
        assert!(thin.points().len() < 120, "{}", thin.points().len());
        let worst = (0..=5000)
            .map(|i| f64::from(i) / 5000.0)
            .map(|t| (full.eval(t).color[0] - thin.eval(t).color[0]).abs())
            .fold(0.0, f64::max);
        assert!(worst <= 2.001e-3, "{worst}");
    }

    #[test]
    fn a_hundred_thousand_growing_points_take_no_time() {
        // The farthest point from a chord lies next to its end here: methods that split there are quadratic.
        let points = sampled(100_000, |t| (40.0 * t).exp());
        assert!(thin_points(&points).len() < 1000);
    }

    #[test]
    fn steps_at_both_ends_stay() {
        let at = |value, extinction| ControlPoint { value, color: [1.0; 3], extinction };
        let points = [at(0.0, 1.0), at(0.0, 2.0), at(0.5, 2.0), at(1.0, 2.0), at(1.0, 3.0)];
        assert_eq!(thin_points(&points), [points[0], points[1], points[3], points[4]]);
        assert_eq!(thin_points(&points[..1]), points[..1]);
        assert_eq!(thin_points(&[]), []);
    }

    #[test]
    fn steps_stay() {
        let mut points = sampled(101, |t| t);
        points.insert(51, ControlPoint { extinction: 9.0, ..points[50] });
        points.insert(51, ControlPoint { extinction: 4.0, ..points[50] });
        let thin = TransferFunction::new(thin_points(&points)).unwrap();
        assert_eq!(thin.eval(0.5).extinction, 9.0);
        assert_eq!(thin.eval(0.499_999).extinction, 2.0);
    }
}
