//! First pass over a recording: where the instrument is at rest.
//!
//! Every second has the mean and the standard deviation of each channel. A second is at rest if no channel deviates
//! more than [`MOVES`] times as much as in the calmest fifth of all seconds, and no mean steps by more than six of its
//! own standard deviations. Stretches at rest shorter than [`SHORTEST_S`] are left out.
//!
//! A base that sways all the time has no calm fifth. It is found by its geometry: the specific force f of a turning
//! instrument changes by f × ω. Steps of f from second to second that follow f × ω with a correlation above
//! [`SWAYS`] are a motion and no noise.

use super::deviations::{CHANNELS, RateChannels};
use super::error::CharacteriseError;
use super::recording::{RateSample, RecordingEnd, RestingRecording};
use nalgebra::Vector3;
use octant_account::Account;
use octant_base::number::{counted, plain};

/// Standard deviation against that of the calmest fifth, above which a second isn't at rest.
pub const MOVES: f64 = 3.0;
/// Correlation above which the base sways.
pub const SWAYS: f64 = 0.5;
/// Shortest stretch at rest, s.
pub const SHORTEST_S: f64 = 10.0;
/// Shortest rest in all, s.
pub const REST_MIN_S: f64 = 60.0;
/// Most stretches.
const STRETCHES_MAX: usize = 2000;
const NAMES: [&str; CHANNELS] =
    ["gyro x", "gyro y", "gyro z", "accelerometer x", "accelerometer y", "accelerometer z"];

/// A stretch at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestStretch {
    /// Number of the first sample.
    pub first: u64,
    /// Number of samples.
    pub samples: u64,
    /// Stamp of its first sample, s.
    pub from_s: f64,
    /// Mean rates, rad/s and m/s².
    pub mean: RateChannels,
}

/// Result of the first pass.
#[derive(Clone, Debug)]
pub struct RestSurvey {
    /// Stretches at rest.
    pub stretches: Vec<RestStretch>,
    /// Samples in all.
    pub samples: u64,
    /// Number of gaps.
    pub gaps: u64,
    /// Samples that are invalid or saturated.
    pub invalid: u64,
    /// Samples with a temperature.
    pub temperatures: u64,
    /// How the recording was cut short.
    pub cut_short: Option<String>,
    /// Accounts of what was read.
    pub inputs: Vec<Account>,
}

/// Place of a sample at rest.
#[derive(Clone, Copy, Debug)]
pub struct RestPlace {
    /// Number of its stretch.
    pub stretch: usize,
    /// Number of the sample in the stretch.
    pub sample: u64,
    /// True for the last sample of the stretch.
    pub is_last: bool,
}

impl RestSurvey {
    /// Reads the samples at rest once more.
    ///
    /// # Errors
    /// If the recording can't be read.
    pub fn read(
        &self,
        recording: &RestingRecording,
        mut take: impl FnMut(&RateSample, RestPlace),
    ) -> Result<(), CharacteriseError> {
        let (mut stretch, mut number) = (0, 0);
        recording.read(|sample| {
            if let Some(RestStretch { first, samples, .. }) = self.stretches.get(stretch)
                && number >= *first
            {
                let is_last = number + 1 == first + samples;
                take(sample, RestPlace { stretch, sample: number - first, is_last });
                stretch += usize::from(is_last);
            }
            number += 1;
        })?;
        Ok(())
    }
}

/// One second.
#[derive(Clone, Copy, Debug)]
struct Second {
    first: u64,
    samples: u64,
    from_s: f64,
    mean: RateChannels,
    deviation: RateChannels,
    /// False if it is the first one after a gap.
    follows: bool,
}

/// Sums of the present second.
#[derive(Default)]
struct Sums {
    samples: u64,
    from_s: f64,
    first: RateChannels,
    sum: RateChannels,
    squares: RateChannels,
}

impl Sums {
    fn second(&self, first: u64, follows: bool) -> Second {
        let n = self.samples as f64;
        let mean: RateChannels = core::array::from_fn(|c| self.sum[c] / n);
        let deviation = core::array::from_fn(|c| {
            libm::sqrt((self.squares[c] / n - mean[c] * mean[c]).max(0.0))
        });
        Second {
            first,
            samples: self.samples,
            from_s: self.from_s,
            mean: core::array::from_fn(|c| self.first[c] + mean[c]),
            deviation,
            follows,
        }
    }
}

/// Surveys a recording.
///
/// # Errors
/// If it can't be read, is too short, moves, or has a channel that is stuck.
pub fn survey(recording: &RestingRecording) -> Result<RestSurvey, CharacteriseError> {
    let per_second = (1.0 / recording.period_s()).round().max(1.0) as u64;
    let per_second = per_second.max(16);
    let (mut seconds, mut sums) = (Vec::new(), Sums::default());
    let (mut samples, mut gaps, mut invalid, mut temperatures) = (0, 0, 0, 0);
    let mut follows = false;
    let RecordingEnd { cut_short, inputs } = recording.read(|sample| {
        samples += 1;
        temperatures += u64::from(sample.temperature_c.is_some());
        let is_gap = samples > 1 && !sample.follows;
        gaps += u64::from(is_gap);
        invalid += u64::from(!sample.valid && !is_gap);
        if !sample.valid {
            (sums, follows) = (Sums::default(), false);
            return;
        }
        if sums.samples == 0 {
            (sums.first, sums.from_s) = (sample.rates, sample.time_s);
        }
        for c in 0..CHANNELS {
            let value = sample.rates[c] - sums.first[c];
            sums.sum[c] += value;
            sums.squares[c] += value * value;
        }
        sums.samples += 1;
        if sums.samples == per_second {
            seconds.push(sums.second(samples - per_second, follows));
            (sums, follows) = (Sums::default(), true);
        }
    })?;
    let total_s = samples as f64 * recording.period_s();
    if total_s < REST_MIN_S {
        return Err(recording.unusable(format!(
            "it lasts {} s, expected {REST_MIN_S} s at least",
            plain(total_s, 3)
        )));
    }
    let stretches = stretches(recording, &seconds, per_second)?;
    let rest_s: f64 =
        stretches.iter().map(|s| s.samples as f64).sum::<f64>() * recording.period_s();
    if rest_s < REST_MIN_S {
        return Err(recording.unusable(format!(
            "it moves: {} s of {} s are at rest in stretches of {SHORTEST_S} s or more ({}), expected {REST_MIN_S} s at \
             least",
            plain(rest_s, 3),
            plain(total_s, 4),
            counted(gaps, "gap", "gaps"),
        )));
    }
    Ok(RestSurvey { stretches, samples, gaps, invalid, temperatures, cut_short, inputs })
}

/// Finds the stretches at rest.
fn stretches(
    recording: &RestingRecording,
    seconds: &[Second],
    per_second: u64,
) -> Result<Vec<RestStretch>, CharacteriseError> {
    let mut calm = [0.0; CHANNELS];
    for c in 0..CHANNELS {
        let mut all: Vec<f64> = seconds.iter().map(|second| second.deviation[c]).collect();
        all.sort_unstable_by(f64::total_cmp);
        calm[c] = all.get(all.len() / 5).copied().unwrap_or(0.0);
        let (stuck, first) = (all.last().is_none_or(|most| *most == 0.0), seconds.first());
        if stuck && let Some(first) = first {
            return Err(recording.unusable(format!(
                "{} is {} in every sample of every second, expected noise: the channel is stuck",
                recording.names().channel(NAMES[c]),
                plain(first.mean[c], 6)
            )));
        }
    }
    let is_still = |second: &Second| {
        (0..CHANNELS).all(|c| {
            // Where a pulse is coarser than the noise, the calmest second may have none.
            second.deviation[c] <= MOVES * calm[c] || calm[c] == 0.0
        })
    };
    let steps = |a: &Second, b: &Second| {
        (0..CHANNELS).any(|c| {
            let sigma = calm[c] / libm::sqrt(b.samples as f64);
            calm[c] > 0.0
                && (a.mean[c] - b.mean[c]).abs() > 6.0 * libm::sqrt(2.0) * sigma.max(calm[c] / 8.0)
        })
    };
    let mut runs: Vec<&[Second]> = Vec::new();
    let mut from = 0;
    for at in 0..=seconds.len() {
        let ends = at == seconds.len()
            || !is_still(&seconds[at])
            || (at > from && (!seconds[at].follows || steps(&seconds[at - 1], &seconds[at])));
        if !ends {
            continue;
        }
        let long = (at - from) as f64 * per_second as f64 * recording.period_s() >= SHORTEST_S;
        if at > from && long {
            runs.push(&seconds[from..at]);
        }
        from = if at < seconds.len() && is_still(&seconds[at]) { at } else { at + 1 };
    }
    if runs.len() > STRETCHES_MAX {
        return Err(recording.unusable(format!(
            "it has {} stretches at rest, expected {STRETCHES_MAX} at most: too many gaps or motions",
            runs.len()
        )));
    }
    if let Some(correlation) = sway(&runs).filter(|correlation| *correlation > SWAYS) {
        return Err(recording.unusable(format!(
            "it moves all the time: the accelerometers feel the turning of the gyros, with a correlation of {} from second to \
             second, expected below {SWAYS} at rest",
            plain(correlation, 2)
        )));
    }
    Ok(runs.into_iter().filter_map(rest).collect())
}

fn rest(run: &[Second]) -> Option<RestStretch> {
    let first = run.first()?;
    let count = run.len() as f64;
    Some(RestStretch {
        first: first.first,
        samples: run.iter().map(|second| second.samples).sum(),
        from_s: first.from_s,
        mean: core::array::from_fn(|c| {
            run.iter().map(|second| second.mean[c]).sum::<f64>() / count
        }),
    })
}

/// Correlation of the steps of the specific force with f × ω.
fn sway(runs: &[&[Second]]) -> Option<f64> {
    let (mut both, mut felt, mut turned, mut count) = (0.0, 0.0, 0.0, 0);
    for run in runs {
        let mean = rest(run)?.mean;
        let triad = |values: &RateChannels, at: usize| {
            Vector3::new(values[at], values[at + 1], values[at + 2])
        };
        let (omega, force) = (triad(&mean, 0), triad(&mean, 3));
        for pair in run.windows(2) {
            let rate = 0.5 * (triad(&pair[0].mean, 0) + triad(&pair[1].mean, 0)) - omega;
            let turning = force.cross(&rate);
            let step = triad(&pair[1].mean, 3) - triad(&pair[0].mean, 3);
            both += turning.dot(&step);
            felt += step.norm_squared();
            turned += turning.norm_squared();
            count += 1;
        }
    }
    (count >= 20 && felt > 0.0 && turned > 0.0).then(|| both / libm::sqrt(felt * turned))
}
