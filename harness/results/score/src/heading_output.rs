//! Output of a heading against a reference that turns: latency, follow-up error, error of transmission.
//!
//! An output that is late by τ shows the heading of a time τ before: with a constant error b its difference from the
//! reference h is
//!
//! ```text
//! e(t) = b + h(t - τ) - h(t) + n(t)
//! ```
//!
//! τ and b are those with the least squares of n, by steps of Gauss and Newton from the best of a grid of latencies. Between
//! two points h is the cubic with the rates of turn of both, which are differences of the points around each. Points beside a gap
//! have no rate, and don't count.
//!
//! The follow-up error is e - b while the ship turns, by class of the rate of turn (MSC.116(73), 4.3.2.4, has limits for
//! both). The error of transmission is n: what is left once constant error and latency are taken out. A number that is
//! rounded to d leaves n of up to d/2.

use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Standard deviations in an expanded uncertainty (95 %).
const EXPANDED: f64 = 1.96;
/// Interval that is a gap, in medians of all intervals.
const GAP: f64 = 1.5;
/// Latencies of the grid, s: from the first to the last in these steps.
const GRID_S: (f64, f64, f64) = (-1.0, 3.0, 0.1);
/// Largest uncertainty of a latency that is told, s (95 %).
const UNCERTAINTY_MAX_S: f64 = 1.0;
/// Upper ends of the classes of rates of turn, deg/s.
const CLASSES_DEGPS: [f64; 2] = [10.0, 20.0];
/// Fewest points with a rate of turn.
const POINTS_LEAST: usize = 30;

/// Heading of an output and of its reference at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingPair {
    /// Time, s.
    pub t_s: f64,
    /// Heading of the output, rad.
    pub output_rad: f64,
    /// Heading of the reference, rad.
    pub reference_rad: f64,
}

/// Scores of the output of a heading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeadingOutputScore {
    /// Change of the heading by one in its last digit, deg; 0: it has all digits.
    pub resolution_deg: f64,
    /// Constant error, deg.
    pub constant_error_deg: f64,
    /// Error of transmission: what is left without constant error and latency. Its largest magnitude, deg.
    pub transmission_error_deg: f64,
    /// Its root mean square, deg.
    pub transmission_rms_deg: f64,
    /// Expanded uncertainty (95 %) of both, deg, without that of the reference: by the constant error and by the times of
    /// headings that have none.
    #[serde(default)]
    pub transmission_uncertainty_deg: f64,
    /// Latency, s; null if the reference turns too little to show it.
    pub latency_s: Option<f64>,
    /// Its expanded uncertainty (95 %), s: by what is left of the errors, by half of the last digit, and by
    /// the times of headings that have none.
    pub latency_uncertainty_s: Option<f64>,
    /// Follow-up error at rates of turn up to 10 deg/s; null if there are none.
    pub follow_up_10: Option<FollowUpScore>,
    /// Follow-up error at rates of turn above 10, up to 20 deg/s.
    pub follow_up_20: Option<FollowUpScore>,
}

/// Follow-up error of a class of rates of turn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FollowUpScore {
    /// Largest magnitude, deg.
    pub max_deg: f64,
    /// Root mean square, deg.
    pub rms_deg: f64,
    /// Expanded uncertainty (95 %) of both, deg, without that of the reference.
    pub uncertainty_deg: f64,
    /// Largest rate of turn of the class, deg/s.
    pub rate_max_degps: f64,
    /// Number of points.
    pub points: u64,
}

impl HeadingOutputScore {
    /// Scores pairs in the order of time. `digit_rad` is the change of the output by one in its last digit, `doubt_s` how far
    /// the times of its headings may be off. `None`: there are too few pairs without gaps.
    #[must_use]
    pub fn of(pairs: &[HeadingPair], digit_rad: f64, doubt_s: f64) -> Option<Self> {
        let track = Track::of(pairs)?;
        let used: Vec<usize> = (0..pairs.len()).filter(|k| track.rate(*k).is_some()).collect();
        if used.len() < POINTS_LEAST {
            return None;
        }
        let error = |k: usize| wrapped(pairs[k].output_rad - pairs[k].reference_rad);
        let fit = fit(&track, &used, &error, digit_rad)
            .filter(|fit| fit.uncertainty_s <= UNCERTAINTY_MAX_S);
        let constant_rad = match &fit {
            Some(fit) => fit.constant_rad,
            None => used.iter().map(|k| error(*k)).sum::<f64>() / used.len() as f64,
        };
        let latency_s = fit.as_ref().map(|fit| fit.latency_s);
        let left = |k: usize| {
            let late = match latency_s {
                Some(latency_s) => track.moved(k, latency_s)?.0,
                None => 0.0,
            };
            Some(error(k) - constant_rad - late)
        };
        let (mut left_max, mut left_square, mut left_count) = (0.0_f64, 0.0, 0_u32);
        for left in used.iter().filter_map(|k| left(*k)) {
            left_max = left_max.max(left.abs());
            left_square += left * left;
            left_count += 1;
        }
        let left_rms = libm::sqrt(left_square / f64::from(left_count.max(1)));
        let of_mean_rad = EXPANDED * left_rms / libm::sqrt(used.len() as f64);
        let uncertainty_rad = libm::hypot(0.5 * digit_rad, of_mean_rad);
        let rates = used.iter().filter_map(|k| track.rate(*k));
        let late_rad = rates.fold(0.0_f64, |most, rate| most.max(rate.abs())) * doubt_s;
        let class = |index: usize| {
            let above = if index == 0 { 0.0 } else { CLASSES_DEGPS[index - 1] };
            let mut score = FollowUpScore {
                max_deg: 0.0,
                rms_deg: 0.0,
                uncertainty_deg: 0.0,
                rate_max_degps: 0.0,
                points: 0,
            };
            for k in &used {
                let rate_degps = track.rate(*k).unwrap_or_default().abs().to_degrees();
                if !(rate_degps > above && rate_degps <= CLASSES_DEGPS[index]) {
                    continue;
                }
                let off_deg = (error(*k) - constant_rad).to_degrees();
                score.max_deg = score.max_deg.max(off_deg.abs());
                score.rms_deg += off_deg * off_deg;
                score.rate_max_degps = score.rate_max_degps.max(rate_degps);
                score.points += 1;
            }
            score.rms_deg = libm::sqrt(score.rms_deg / score.points as f64);
            // A time that is off is a heading that is off by as much of a turn.
            let late_deg = score.rate_max_degps * doubt_s;
            score.uncertainty_deg = libm::hypot(uncertainty_rad.to_degrees(), late_deg);
            (score.points > 0).then_some(score)
        };
        Some(Self {
            resolution_deg: digit_rad.to_degrees(),
            constant_error_deg: constant_rad.to_degrees(),
            transmission_error_deg: left_max.to_degrees(),
            transmission_rms_deg: left_rms.to_degrees(),
            transmission_uncertainty_deg: libm::hypot(of_mean_rad, late_rad).to_degrees(),
            latency_s,
            latency_uncertainty_s: fit.map(|fit| libm::hypot(fit.uncertainty_s, doubt_s)),
            follow_up_10: class(0),
            follow_up_20: class(1),
        })
    }

    /// Expanded uncertainty (95 %) of a measure by its path below the score, in its unit, without that of the reference.
    #[must_use]
    pub fn uncertainty(&self, path: &str) -> f64 {
        let of = |score: Option<FollowUpScore>| score.map_or(0.0, |score| score.uncertainty_deg);
        match path.split('.').next() {
            Some("follow_up_10") => of(self.follow_up_10),
            Some("follow_up_20") => of(self.follow_up_20),
            Some("latency_s") => self.latency_uncertainty_s.unwrap_or(0.0),
            Some("constant_error_deg") => 0.5 * self.resolution_deg,
            // Rounding is part of the error of transmission, and not in doubt.
            Some("transmission_error_deg" | "transmission_rms_deg") => {
                self.transmission_uncertainty_deg
            }
            _ => 0.0,
        }
    }
}

/// Latency and constant error of the least squares.
#[derive(Clone, Copy, Debug)]
struct Fit {
    latency_s: f64,
    constant_rad: f64,
    uncertainty_s: f64,
}

/// Sums of one latency: number of points, of what is left its mean and square, and the normal equation of the next step.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    points: f64,
    left: f64,
    square: f64,
    slope: f64,
    slope_square: f64,
    product: f64,
    neighbours: f64,
}

impl Sums {
    fn of(track: &Track<'_>, used: &[usize], error: &dyn Fn(usize) -> f64, latency_s: f64) -> Self {
        let mut sums = Self::default();
        let mut last = None;
        for k in used {
            let Some((moved, rate)) = track.moved(*k, latency_s) else { continue };
            let (left, slope) = (error(*k) - moved, -rate);
            sums.points += 1.0;
            sums.left += left;
            sums.square += left * left;
            sums.slope += slope;
            sums.slope_square += slope * slope;
            sums.product += left * slope;
            sums.neighbours += last.map_or(0.0, |last: f64| last * left);
            last = Some(left);
        }
        sums
    }

    /// Variance of what is left about its mean.
    fn variance(&self) -> f64 {
        let mean = self.left / self.points;
        (self.square / self.points - mean * mean).max(0.0)
    }

    /// Sum of squares of the slopes about their mean.
    fn turning(&self) -> f64 {
        self.slope_square - self.slope * self.slope / self.points
    }
}

fn fit(
    track: &Track<'_>,
    used: &[usize],
    error: &dyn Fn(usize) -> f64,
    digit_rad: f64,
) -> Option<Fit> {
    let (from_s, to_s, step_s) = GRID_S;
    let steps = ((to_s - from_s) / step_s).round() as usize;
    let sums = |latency_s: f64| Sums::of(track, used, error, latency_s);
    let mut latency_s = (0..=steps)
        .map(|step| from_s + step as f64 * step_s)
        .map(|latency_s| (latency_s, sums(latency_s)))
        .filter(|(_, sums)| sums.points >= POINTS_LEAST as f64)
        .map(|(latency_s, sums)| (latency_s, sums.variance()))
        .min_by(|a, b| a.1.total_cmp(&b.1))?
        .0;
    for _ in 0..20 {
        let sums = sums(latency_s);
        let turning = sums.turning();
        if turning <= 0.0 {
            return None;
        }
        let step_s = (sums.product - sums.left * sums.slope / sums.points) / turning;
        latency_s = (latency_s + step_s).clamp(from_s, to_s);
        if step_s.abs() < 1e-9 {
            break;
        }
    }
    let sums = sums(latency_s);
    if sums.points < POINTS_LEAST as f64 || sums.turning() <= 0.0 {
        return None;
    }
    let variance = sums.variance();
    let mean = sums.left / sums.points;
    // Neighbours that are alike, such as steps of a rounded heading that turns slowly, are fewer than they are many.
    let alike = match variance > 0.0 {
        true => (sums.neighbours / sums.points - mean * mean) / variance,
        false => 0.0,
    };
    let alike = alike.clamp(0.0, 0.999);
    let sigma_s = libm::sqrt(variance / sums.turning() * (1.0 + alike) / (1.0 - alike));
    // Errors of rounding may add up, and do in a motion that repeats: they are half a digit each, and by Cauchy and Schwarz no
    // sum of them with the slopes is larger.
    let rounding_s = 0.5 * digit_rad * libm::sqrt(sums.points / sums.turning());
    let uncertainty_s = libm::hypot(EXPANDED * sigma_s, rounding_s);
    Some(Fit { latency_s, constant_rad: mean, uncertainty_s })
}

/// The reference at any time.
struct Track<'a> {
    pairs: &'a [HeadingPair],
    /// Heading that runs on over a whole turn, rad.
    heading_rad: Vec<f64>,
    /// Rate of turn, rad/s; NaN beside a gap.
    rate_radps: Vec<f64>,
    gap_s: f64,
}

impl<'a> Track<'a> {
    fn of(pairs: &'a [HeadingPair]) -> Option<Self> {
        let mut apart_s: Vec<f64> = pairs.windows(2).map(|two| two[1].t_s - two[0].t_s).collect();
        if apart_s.len() < 2 {
            return None;
        }
        let middle = apart_s.len() / 2;
        let gap_s = GAP * *apart_s.select_nth_unstable_by(middle, f64::total_cmp).1;
        let mut heading_rad = Vec::with_capacity(pairs.len());
        for pair in pairs {
            let last = heading_rad.last().copied().unwrap_or(pair.reference_rad);
            heading_rad.push(last + wrapped(pair.reference_rad - last));
        }
        let mut rate_radps = vec![f64::NAN; pairs.len()];
        for k in 1..pairs.len() - 1 {
            let [before, at, after] = [k - 1, k, k + 1].map(|k| (pairs[k].t_s, heading_rad[k]));
            let (back_s, on_s) = (at.0 - before.0, after.0 - at.0);
            if back_s > 0.0 && on_s > 0.0 && back_s <= gap_s && on_s <= gap_s {
                // Of the parabola through three points.
                let back = (at.1 - before.1) / back_s;
                let on = (after.1 - at.1) / on_s;
                rate_radps[k] = (back * on_s + on * back_s) / (back_s + on_s);
            }
        }
        Some(Self { pairs, heading_rad, rate_radps, gap_s })
    }

    fn rate(&self, k: usize) -> Option<f64> {
        Some(self.rate_radps[k]).filter(|rate| rate.is_finite())
    }

    /// Turn of the reference from the time of a point to a latency before, rad, and its rate of turn then, rad/s.
    fn moved(&self, k: usize, latency_s: f64) -> Option<(f64, f64)> {
        let t_s = self.pairs[k].t_s - latency_s;
        let after = self.pairs.partition_point(|pair| pair.t_s <= t_s);
        let (before, after) = (after.checked_sub(1)?, after.min(self.pairs.len() - 1));
        let length_s = self.pairs[after].t_s - self.pairs[before].t_s;
        let since_s = t_s - self.pairs[before].t_s;
        if length_s > self.gap_s || (before == after && since_s > 0.0) {
            return None;
        }
        let (from, to) = (self.heading_rad[before], self.heading_rad[after]);
        let (rate_from, rate_to) = (self.rate(before)?, self.rate(after)?);
        if before == after {
            return Some((from - self.heading_rad[k], rate_from));
        }
        let s = since_s / length_s;
        let (a, b) = (rate_from * length_s, rate_to * length_s);
        let turned = to - from;
        let heading =
            from + s * s * (3.0 - 2.0 * s) * turned + s * (1.0 - s) * ((1.0 - s) * a - s * b);
        let slope = 6.0 * s * (1.0 - s) * turned
            + (1.0 - 4.0 * s + 3.0 * s * s) * a
            + (3.0 * s * s - 2.0 * s) * b;
        Some((heading - self.heading_rad[k], slope / length_s))
    }
}

/// An angle within half a turn.
fn wrapped(rad: f64) -> f64 {
    (rad + PI).rem_euclid(TAU) - PI
}
