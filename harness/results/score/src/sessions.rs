//! Two sessions of one unit, with the faults and without them: whether its answers contain the dither that the samples of
//! one session have and those of the other don't.
//!
//! A unit that remembers the other session and repeats its answers shows no effect of any fault. Both sessions have the
//! same noise, so that up to the first fault the dither is all that differs: the attitude of a unit that integrates
//! its samples differs by the integrated dither, from second to second. The share of the dither in that difference is 1 for
//! such a unit, and 0 for one that repeats. Slow effects of faults and corrections drop out of second differences.

use serde::{Deserialize, Serialize};

/// Windows over which answers are compared, s: a unit that smooths its answers follows in the longer ones.
const WINDOWS_S: [u64; 3] = [1, 10, 60];
/// Fewest second differences of a comparison.
const LEAST: usize = 20;
/// Largest standard deviation of a share that says something.
const KNOWN: f64 = 0.1;
/// Share below which the answers don't contain the dither.
const FOLLOWED: f64 = 0.5;
/// Departures from the median beyond this multiple of the median one are those of faults, not of the dither.
const BEYOND: f64 = 9.0;
/// Factor of a standard deviation for second differences, whose neighbours are correlated.
const CORRELATED: f64 = 1.25;

/// Longest navigation after which the dither may be below the resolution of a position, s, and the coarsest such resolution, rad.
const POSITION_AFTER_S: u64 = 600;
const POSITION_RESOLUTION_RAD: f64 = 1e-9;
/// Factor of σ without the faults over σ with them beyond which it isn't that of the same unit: faults open σ.
const WIDENED: f64 = 2.0;
/// End of each sentence about a memory.
const REMEMBERS: &str = "A unit that remembers the other session shows no effect of a fault";

/// An answer of a session at a whole second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SessionPoint {
    /// The second of device time.
    pub second: u64,
    /// Attitude, as in the answer.
    pub q_nb: [f64; 4],
    /// Latitude and longitude, as in the answer; `None` but in navigation.
    pub position_rad: Option<[f64; 2]>,
    /// Integrated dither so far, n frame, rad; zero in a session without one.
    pub dither_rad: [f64; 3],
}

/// Session that came first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FirstSession {
    /// The one with the faults.
    Faulted,
    /// The one without them.
    Twin,
}

/// Share of a dither in the answers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DitherShare {
    /// Share: 1 for a unit that integrates its samples, 0 for one that repeats its answers.
    pub share: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// Window over which the answers are compared, s.
    pub window_s: u64,
}

/// Memory of a unit, as its two sessions show it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sessions {
    /// The session that came first, drawn from the seed.
    pub first: FirstSession,
    /// Amplitude of the dither in the gyro samples of the twin, counts.
    pub dither_counts: i32,
    /// Share of the dither before the first fault set in; null where the answers show too little: not tested.
    pub before: Option<DitherShare>,
    /// Share from there on.
    pub after: Option<DitherShare>,
    /// Answers that are the same in both sessions, to the last bit, though the samples differ.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repeated: Vec<String>,
    /// Parameter whose σ the session without faults states much larger than the one with them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub widened: Option<WidenedSigma>,
}

/// A parameter that is stated less certain without the faults than with them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WidenedSigma {
    /// Its name.
    pub parameter: String,
    /// σ of the twin over that of the run with the faults.
    pub factor: f64,
}

/// A parameter that both sessions published.
#[derive(Clone, Copy, Debug)]
pub struct PublishedPair<'a> {
    /// Its name.
    pub name: &'a str,
    /// Estimate with the faults and without them.
    pub estimates: [f64; 2],
    /// Standard deviations, in the unit of the parameter.
    pub sigmas: [f64; 2],
}

impl Sessions {
    /// Compares two sessions; `onset_s` is the time at which the first fault set in. `published` are the parameters of
    /// both, where both published some.
    #[must_use]
    pub fn compare(
        first: FirstSession,
        dither_counts: i32,
        [faulted, twin]: [&[SessionPoint]; 2],
        onset_s: Option<f64>,
        published: &[PublishedPair<'_>],
    ) -> Self {
        let onset_s = onset_s.unwrap_or(f64::INFINITY);
        let pairs = pairs(faulted, twin);
        let at = pairs.partition_point(|pair| (pair.second as f64) < onset_s);
        let (before, after) = pairs.split_at(at);
        let resolution_rad = resolution_rad(faulted).max(resolution_rad(twin));
        let share = |pairs: &[Pair]| share(pairs, resolution_rad);
        let mut repeated = Vec::new();
        if are_repeated(published) {
            repeated.push("parameters".to_owned());
        }
        if position_is_repeated(faulted, twin) {
            repeated.push("positions".to_owned());
        }
        Self {
            first,
            dither_counts,
            before: share(before),
            after: share(after),
            repeated,
            widened: widened(published),
        }
    }

    /// Sentence about a unit whose answers don't contain the dither of their session; `None` if they do, or weren't tested.
    #[must_use]
    pub fn memory(&self) -> Option<String> {
        if !self.repeated.is_empty() {
            return Some(format!(
                "the {} of the unit are the same with the faults and without them, to the last bit, though the samples \
                 differ. {REMEMBERS}",
                self.repeated.join(" and ")
            ));
        }
        if let Some(WidenedSigma { parameter, factor }) = &self.widened {
            return Some(format!(
                "the unit states {parameter} with {factor:.1} times the uncertainty without the faults that it has with them: \
                 shifts in σ of that twin are no measure"
            ));
        }
        let parts =
            [("before the first fault", self.before), ("from the first fault on", self.after)];
        let (part, DitherShare { share, sigma, .. }) = parts
            .into_iter()
            .filter_map(|(part, share)| Some((part, share?)))
            .find(|(_, share)| share.share < FOLLOWED)?;
        Some(format!(
            "the answers of the unit with the faults and without them don't differ as their samples do: {part} they \
             contain {share:.2} ± {sigma:.2} of the dither of their session, expected 1. {REMEMBERS}"
        ))
    }
}

/// Returns whether both sessions have the same estimates, to the last bit, and more digits than a coarse unit tells.
fn are_repeated(published: &[PublishedPair<'_>]) -> bool {
    let is_fine =
        |pair: &PublishedPair<'_>| f64::from(pair.estimates[0] as f32) != pair.estimates[0];
    let is_same = |pair: &PublishedPair<'_>| {
        let [one, other] = pair.estimates.map(f64::to_bits);
        one == other
    };
    published.iter().any(is_fine) && published.iter().all(is_same)
}

/// Finds the parameter that the session without faults states most less certain than the one with them.
fn widened(published: &[PublishedPair<'_>]) -> Option<WidenedSigma> {
    let of = |pair: &PublishedPair<'_>| (pair.name.to_owned(), pair.sigmas[1] / pair.sigmas[0]);
    let (parameter, factor) = published.iter().map(of).max_by(|a, b| a.1.total_cmp(&b.1))?;
    (factor > WIDENED).then_some(WidenedSigma { parameter, factor })
}

/// Returns whether both sessions navigated long and have the same positions, to the last bit, of more digits than a coarse unit
/// tells.
fn position_is_repeated(faulted: &[SessionPoint], twin: &[SessionPoint]) -> bool {
    let positions = |points: &[SessionPoint]| -> Vec<(u64, [u64; 2])> {
        let of = |p: &SessionPoint| Some((p.second, p.position_rad?.map(f64::to_bits)));
        points.iter().filter_map(of).collect()
    };
    let [one, other] = [faulted, twin].map(positions);
    let (Some((from, _)), Some((to, _))) = (one.first(), one.last()) else { return false };
    if one != other || to - from < POSITION_AFTER_S {
        return false;
    }
    let steps = faulted.windows(2).filter_map(|two| {
        let [one, other] = [two[0].position_rad?, two[1].position_rad?];
        Some((other[0] - one[0]).abs())
    });
    steps.filter(|step| *step > 0.0).any(|step| step < POSITION_RESOLUTION_RAD)
}

/// Difference of two answers at the same second, and the dither of which it should consist.
#[derive(Clone, Copy, Debug)]
struct Pair {
    second: u64,
    difference_rad: [f64; 3],
    dither_rad: [f64; 3],
}

/// Puts answers of the same second together.
fn pairs(faulted: &[SessionPoint], twin: &[SessionPoint]) -> Vec<Pair> {
    let mut others = faulted.iter().peekable();
    let mut found = Vec::new();
    for point in twin {
        while others.next_if(|other| other.second < point.second).is_some() {}
        if let Some(other) = others.next_if(|other| other.second == point.second) {
            found.push(Pair {
                second: point.second,
                difference_rad: turn_rad(point.q_nb, other.q_nb),
                dither_rad: std::array::from_fn(|i| point.dither_rad[i] - other.dither_rad[i]),
            });
        }
    }
    found
}

/// Small turn in n from one attitude to another, rad.
fn turn_rad([w, x, y, z]: [f64; 4], [v, a, b, c]: [f64; 4]) -> [f64; 3] {
    // Twice the vector of to ⊗ conj(from), with a positive scalar.
    let scalar = w * v + x * a + y * b + z * c;
    let vector = [
        x * v - w * a - y * c + z * b,
        y * v - w * b - z * a + x * c,
        z * v - w * c - x * b + y * a,
    ];
    vector.map(|part| 2.0 * part * scalar.signum())
}

/// Estimates the resolution of the attitude in answers from its smallest step, rad.
fn resolution_rad(points: &[SessionPoint]) -> f64 {
    let steps = points.windows(2).flat_map(|two| {
        two[0].q_nb.into_iter().zip(two[1].q_nb).map(|(one, other)| (other - one).abs())
    });
    let least = steps.filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
    // An attitude that never changes is as coarse as can be.
    2.0 * least
}

/// Share of the dither in these answers: the largest of those windows that say something.
fn share(pairs: &[Pair], resolution_rad: f64) -> Option<DitherShare> {
    let shares = WINDOWS_S.into_iter().filter_map(|window_s| over(pairs, window_s, resolution_rad));
    shares.filter(|share| share.sigma < KNOWN).max_by(|a, b| a.share.total_cmp(&b.share))
}

/// Share of the dither over windows of this length.
fn over(pairs: &[Pair], window_s: u64, resolution_rad: f64) -> Option<DitherShare> {
    let grid: Vec<&Pair> = pairs.iter().filter(|p| p.second.is_multiple_of(window_s)).collect();
    let mut both: Vec<(f64, f64)> = Vec::new();
    for three in grid.windows(3) {
        let [one, two, last] = [three[0], three[1], three[2]];
        if two.second - one.second != window_s || last.second - two.second != window_s {
            continue;
        }
        let second =
            |of: fn(&Pair) -> &[f64; 3], i: usize| of(last)[i] - 2.0 * of(two)[i] + of(one)[i];
        both.extend(
            (0..3).map(|i| (second(|p| &p.dither_rad, i), second(|p| &p.difference_rad, i))),
        );
    }
    if both.len() < 3 * LEAST {
        return None;
    }
    let median = |mut values: Vec<f64>| {
        let middle = values.len() / 2;
        *values.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    let middle = median(both.iter().map(|(_, y)| *y).collect());
    let usual = median(both.iter().map(|(_, y)| (y - middle).abs()).collect());
    // Steps of a coarse unit, of which most answers don't change, stay.
    let usual = usual.max(resolution_rad);
    both.retain(|(_, y)| (y - middle).abs() <= BEYOND * usual);
    let (mut xx, mut xy) = (0.0, 0.0);
    for (x, y) in &both {
        xx += x * x;
        xy += x * y;
    }
    if xx <= 0.0 {
        return None;
    }
    let share = xy / xx;
    let rest: f64 = both.iter().map(|(x, y)| (y - share * x).powi(2)).sum();
    // Rounding of both answers, in a second difference: 2 · (1 + 4 + 1) · r²/12.
    let rounding = resolution_rad * resolution_rad;
    let variance = (rest / (both.len() - 1) as f64).max(rounding);
    let sigma = CORRELATED * (variance / xx).sqrt();
    Some(DitherShare { share, sigma, window_s })
}
