//! The twin of a recording: the plant with the instrument that was found, over stretches of the same lengths, and how
//! well it matches.

use super::analysis::{ChannelAnalysis, RestAnalysis, RestTaker};
use super::deviations::CHANNELS;
use super::error::CharacteriseError;
use super::kernel::RandomTerm;
use octant_sample::GimbalCommand;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_scenario::Scenario;
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_source::{Epoch, PlantSource, Source};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::path::Path;

/// Probability of each comparison of a channel below which twin and recording differ.
pub const LEVEL: f64 = 0.01;
/// Degrees of freedom below which a deviation tells nothing.
const FREEDOM_MIN: f64 = 4.0;

/// Comparison of a channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelMatch {
    /// Name: `gyro_x`.
    pub name: &'static str,
    /// Allan deviations at octaves that were compared.
    pub allan_points: usize,
    /// Those of the twin that are within the recording's intervals of 95 %.
    pub allan_within: usize,
    /// Largest ratio of an Allan deviation of the twin to the recording's, or its inverse.
    pub allan_ratio: f64,
    /// Probability of a worse octave if both have the same noise, for all octaves together.
    pub allan_probability: f64,
    /// The same of the spectral densities in thirds of an octave.
    pub spectrum_probability: f64,
    /// Largest ratio of spectral densities.
    pub spectrum_ratio: f64,
    /// Largest distance of the distributions of increments (Kolmogorov and Smirnov).
    pub increments_distance: f64,
    /// Probability of a larger distance if both have the same distribution.
    pub increments_probability: f64,
}

impl ChannelMatch {
    /// True if no comparison tells them apart.
    #[must_use]
    pub fn matches(&self) -> bool {
        [self.allan_probability, self.spectrum_probability, self.increments_probability]
            .iter()
            .all(|probability| *probability >= LEVEL)
    }
}

/// The twin with its comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InstrumentTwin {
    /// Seed of the simulation.
    pub seed: u64,
    /// Level of each comparison.
    pub level: f64,
    /// Comparisons by channel.
    pub channels: Vec<ChannelMatch>,
    /// Analysis of the twin.
    #[serde(skip)]
    pub analysis: RestAnalysis,
}

/// Simulates the twin of a scenario's instrument.
///
/// # Errors
/// If the scenario is refused.
pub fn simulate(
    text: &str,
    seed: u64,
    stretches: &[u64],
) -> Result<RestAnalysis, CharacteriseError> {
    let scenario = Scenario::parse(text, "the twin", Path::new(""), &[])?;
    let period_s = scenario.sample_period_ns as f64 * 1e-9;
    let draws = DrawnValues::of(&scenario, &Seeded(seed));
    let total: u64 = stretches.iter().sum();
    let failed = |error: &dyn std::fmt::Display| CharacteriseError::Twin(error.to_string());
    let mut plant =
        PlantSource::new(&scenario.plant(seed, &draws), total).map_err(|e| failed(&e))?;
    let mut taker = RestTaker::new(period_s, stretches);
    let (command, mut epoch) = (GimbalCommand::default(), Epoch::default());
    for length in stretches {
        for _ in 0..*length {
            if !plant.next(&command, &mut epoch).map_err(|e| failed(&e))? {
                return Err(CharacteriseError::Twin("the plant ended early".to_owned()));
            }
            let mut rates = [0.0; CHANNELS];
            for axis in 0..3 {
                rates[axis] =
                    f64::from(epoch.sample.delta_theta[axis]) * DELTA_THETA_LSB_RAD / period_s;
                rates[axis + 3] = f64::from(epoch.sample.delta_velocity[axis])
                    * DELTA_VELOCITY_LSB_MPS
                    / period_s;
            }
            taker.push(&rates);
        }
        taker.end_stretch();
    }
    Ok(taker.finish())
}

/// Compares a twin with the recording.
#[must_use]
pub fn compare(recording: &RestAnalysis, twin: RestAnalysis, seed: u64) -> InstrumentTwin {
    let pairs = recording.channels.iter().zip(&twin.channels);
    InstrumentTwin {
        seed,
        level: LEVEL,
        channels: pairs.map(|(a, b)| compare_channel(a, b)).collect(),
        analysis: twin,
    }
}

/// Worst of many comparisons of variances: the largest ratio, and the probability for all together.
#[derive(Default)]
struct Worst {
    points: usize,
    ratio: f64,
    probability: f64,
}

impl Worst {
    fn add(&mut self, variances: [f64; 2], freedoms: [f64; 2]) {
        let Ok(distribution) = FisherSnedecor::new(freedoms[0], freedoms[1]) else { return };
        let ratio = variances[0] / variances[1];
        let tail = distribution.cdf(ratio).min(distribution.sf(ratio));
        let probability = (2.0 * tail).min(1.0);
        if self.points == 0 || probability < self.probability {
            self.probability = probability;
        }
        self.ratio = self.ratio.max(libm::sqrt(ratio.max(1.0 / ratio)));
        self.points += 1;
    }

    /// Probability of the worst for all points (Šidák).
    fn together(&self) -> f64 {
        if self.points == 0 {
            1.0
        } else {
            -libm::expm1(self.points as f64 * libm::log1p(-self.probability.min(1.0 - 1e-16)))
        }
    }
}

fn compare_channel(recording: &ChannelAnalysis, twin: &ChannelAnalysis) -> ChannelMatch {
    let (mut allan, mut spectrum) = (Worst::default(), Worst::default());
    let mut within = 0;
    for (a, b) in recording.deviations.iter().zip(&twin.deviations) {
        let (a_of, b_of) = (&a.allan, &b.allan);
        let enough = a_of.freedom.min(b_of.freedom) >= FREEDOM_MIN;
        if !(a.samples.is_power_of_two() && enough && a_of.deviation > 0.0 && b_of.deviation > 0.0)
        {
            continue;
        }
        let square = |x: f64| x * x;
        allan.add([square(b_of.deviation), square(a_of.deviation)], [b_of.freedom, a_of.freedom]);
        within +=
            usize::from(a_of.interval[0] <= b_of.deviation && b_of.deviation <= a_of.interval[1]);
    }
    for (a, b) in recording.spectrum.iter().zip(&twin.spectrum) {
        if a.density > 0.0 && b.density > 0.0 {
            spectrum.add([b.density * b.density, a.density * a.density], [b.freedom, a.freedom]);
        }
    }
    let count_rate = count_rate(recording);
    let distance =
        distance(&spread(&recording.increments, count_rate), &spread(&twin.increments, count_rate));
    let count = |channel: &ChannelAnalysis| channel.increments.len() as f64;
    let (n, m) = (count(recording), count(twin));
    ChannelMatch {
        name: recording.name,
        allan_points: allan.points,
        allan_within: within,
        allan_ratio: allan.ratio,
        allan_probability: allan.together(),
        spectrum_probability: spectrum.together(),
        spectrum_ratio: spectrum.ratio,
        increments_distance: distance,
        increments_probability: kolmogorov(distance * libm::sqrt(n * m / (n + m))),
    }
}

/// Step of the increments of a channel whose counts are seen: that of a rate by one count.
fn count_rate(recording: &ChannelAnalysis) -> f64 {
    let fit = recording.noise.as_ref().and_then(|noise| noise.term(RandomTerm::Quantization));
    let count = libm::sqrt(12.0) * fit.and_then(|fit| fit.value).unwrap_or(0.0);
    let period_s = recording.deviations.first().map_or(1.0, |row| row.tau_s);
    count / period_s
}

/// Spreads values evenly over a step: where they are whole numbers of counts, two sizes of a count that differ by a
/// percent have no value in common.
fn spread(values: &[f64], step: f64) -> Vec<f64> {
    // Fractional parts of multiples of the golden ratio are even.
    let place = |k: usize| (k as f64 * 0.618_033_988_749_894_9).fract() - 0.5;
    values.iter().enumerate().map(|(k, value)| value + step * place(k)).collect()
}

/// Largest distance of two empirical distributions.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let sorted = |values: &[f64]| {
        let mut values = values.to_vec();
        values.sort_unstable_by(f64::total_cmp);
        values
    };
    let (a, b) = (sorted(a), sorted(b));
    let (mut i, mut j, mut most) = (0, 0, 0.0f64);
    while i < a.len() && j < b.len() {
        let value = a[i].min(b[j]);
        while i < a.len() && a[i] <= value {
            i += 1;
        }
        while j < b.len() && b[j] <= value {
            j += 1;
        }
        most = most.max((i as f64 / a.len() as f64 - j as f64 / b.len() as f64).abs());
    }
    most
}

/// Probability that Kolmogorov's statistic is above a value (Kolmogorov 1933).
fn kolmogorov(value: f64) -> f64 {
    if !(value > 0.2) {
        return 1.0;
    }
    let term = |k: i32| {
        let sign = if k % 2 == 1 { 2.0 } else { -2.0 };
        sign * libm::exp(-2.0 * f64::from(k * k) * value * value)
    };
    (1..=100).map(term).sum::<f64>().clamp(0.0, 1.0)
}
