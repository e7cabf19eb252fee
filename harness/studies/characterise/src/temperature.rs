//! Bias at rest against temperature: a coefficient for each channel, and where it can't be told.
//!
//! Every stretch at rest has an offset of its own, which takes gravity, Earth's rate and the bias at the reference
//! temperature: only changes within a stretch count. [`regression`] has the interval. A thermometer's own noise makes a
//! coefficient too small: the outer end of the interval is as much further out, and none is told above [`TOO_SMALL`].

pub mod blocks;
pub mod correction;
pub mod regression;

use crate::deviations::{CHANNELS, RateChannels};
use crate::error::CharacteriseError;
use crate::recording::RestingRecording;
use crate::survey::RestSurvey;
use blocks::{StretchBlocks, TemperatureBlocks};
use correction::TemperatureCorrection;
use octant_base::number::{plain, significant};
use regression::{Coefficient, DIFFERENCES_MIN, regress};
use serde::Serialize;

/// Smallest change of the temperature within a stretch, K: a thermometer isn't at the sensors, and the difference
/// between two places of a case wanders by a tenth of it.
pub const SPAN_MIN_K: f64 = 0.5;
/// Part by which the noise of the thermometer may make a coefficient too small.
pub const TOO_SMALL: f64 = 0.1;
/// Part of the temperature's change that may be steady in time before it is told.
pub const STEADY: f64 = 0.9;

/// Coefficient of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TemperatureFit {
    /// Bias per kelvin, rad/s/K or m/s²/K; `None`: its interval has zero, or it isn't told.
    pub per_k: Option<f64>,
    /// Interval of 95 %; `None`: not told, as the thermometer is too noisy.
    pub interval: Option<[f64; 2]>,
    /// Part by which the thermometer's noise makes it too small.
    pub too_small: f64,
}

/// A block as the page shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TemperatureMean {
    /// Temperature, °C.
    pub temperature_c: f64,
    /// Means of the rates without the offset of the stretch.
    pub residuals: RateChannels,
}

/// Bias against temperature.
#[derive(Clone, Debug, Default, Serialize)]
pub struct TemperatureDependence {
    /// Why no coefficient is told.
    pub reason: Option<String>,
    /// Lowest and highest mean of a block at rest, °C.
    pub range_c: Option<[f64; 2]>,
    /// Mean temperature, at which biases aren't changed, °C.
    pub reference_c: Option<f64>,
    /// Largest change within a stretch, K.
    pub span_k: Option<f64>,
    /// Standard deviation of the thermometer in the mean of a block, K.
    pub noise_k: Option<f64>,
    /// Length of a block, s.
    pub block_s: f64,
    /// Differences of neighbouring blocks.
    pub differences: usize,
    /// Part of the change of the temperature that is steady in time.
    pub steady: Option<f64>,
    /// Largest change from the first temperature, K, and the time that it took, s.
    pub change: Option<[f64; 2]>,
    /// Coefficients by channel, in the order of the analysis; none for a reason.
    pub channels: Vec<TemperatureFit>,
    /// Means of blocks.
    #[serde(skip)]
    pub means: Vec<TemperatureMean>,
    /// What is taken off before noise terms are fitted.
    #[serde(skip)]
    correction: Option<TemperatureCorrection>,
}

impl TemperatureDependence {
    fn untold(reason: String) -> Self {
        Self { reason: Some(reason), ..Self::default() }
    }

    /// True if a channel shows a coefficient.
    #[must_use]
    pub fn is_shown(&self) -> bool {
        self.channels.iter().any(|fit| fit.per_k.is_some())
    }

    /// What is taken off the rates; none where no channel shows a coefficient.
    #[must_use]
    pub fn correction(&self) -> Option<&TemperatureCorrection> {
        self.correction.as_ref()
    }
}

/// Reads a recording and finds the coefficients.
///
/// # Errors
/// If it can't be read, or has a temperature that isn't one.
pub fn of(
    recording: &RestingRecording,
    survey: &RestSurvey,
) -> Result<TemperatureDependence, CharacteriseError> {
    if survey.temperatures == 0 {
        return Ok(TemperatureDependence::untold(recording.without_temperature().to_owned()));
    }
    let lengths: Vec<u64> = survey.stretches.iter().map(|stretch| stretch.samples).collect();
    let mut blocks = TemperatureBlocks::new(&lengths);
    survey.read(recording, |sample, place| {
        blocks.push(&sample.rates, sample.temperature_c);
        if place.is_last {
            blocks.end_stretch();
        }
    })?;
    let starts: Vec<f64> = survey.stretches.iter().map(|stretch| stretch.from_s).collect();
    Ok(dependence(&blocks, &starts, recording.period_s()))
}

/// Finds the coefficients from the blocks of stretches that start at these times, s.
#[must_use]
pub fn dependence(
    blocks: &TemperatureBlocks,
    starts_s: &[f64],
    period_s: f64,
) -> TemperatureDependence {
    let block_s = blocks.samples() as f64 * period_s;
    let usable: Vec<(f64, &StretchBlocks)> = starts_s
        .iter()
        .copied()
        .zip(blocks.stretches())
        .filter(|(_, stretch)| stretch.is_usable())
        .collect();
    let temperatures = || usable.iter().flat_map(|(_, s)| s.temperature_c.iter().copied());
    let range_c = [
        temperatures().fold(f64::INFINITY, f64::min),
        temperatures().fold(f64::NEG_INFINITY, f64::max),
    ];
    let differences = usable.iter().map(|(_, s)| s.temperature_c.len() - 1).sum();
    if differences < DIFFERENCES_MIN {
        return TemperatureDependence::untold(format!(
            "{differences} pairs of neighbouring blocks of {} s at rest have one, expected {DIFFERENCES_MIN} at least",
            plain(block_s, 4)
        ));
    }
    let span_k = usable.iter().map(|(_, stretch)| span(&stretch.temperature_c)).fold(0.0, f64::max);
    let noise_k = noise(&usable);
    let mut found = TemperatureDependence {
        range_c: Some(range_c),
        reference_c: Some(blocks.mean_c()),
        span_k: Some(span_k),
        noise_k: Some(noise_k),
        block_s,
        differences,
        steady: steady(&usable),
        change: change(&usable, block_s),
        ..TemperatureDependence::default()
    };
    found.means = means(&usable, &[0.0; CHANNELS], blocks.mean_c());
    if span_k < SPAN_MIN_K {
        found.reason = Some(format!(
            "the temperature changes by {} K at most while the instrument rests, expected {SPAN_MIN_K} K at least",
            significant(span_k, 2)
        ));
        return found;
    }
    let lengths: Vec<usize> = usable.iter().map(|(_, s)| s.temperature_c.len() - 1).collect();
    let steps =
        |values: &[f64]| values.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>();
    let regressor: Vec<f64> = usable.iter().flat_map(|(_, s)| steps(&s.temperature_c)).collect();
    let response = |c: usize| -> Vec<f64> {
        let of = |s: &StretchBlocks| steps(&s.rates.iter().map(|r| r[c]).collect::<Vec<_>>());
        usable.iter().flat_map(|(_, stretch)| of(stretch)).collect()
    };
    let responses: Vec<Vec<f64>> = (0..CHANNELS).map(response).collect();
    let fits: Option<Vec<Coefficient>> =
        regress(&lengths, (&regressor, noise_k), &responses).into_iter().collect();
    let Some(fits) = fits else {
        found.reason =
            Some("a channel has the same mean in every block, expected noise".to_owned());
        return found;
    };
    found.channels = fits.iter().map(told).collect();
    if found.channels.iter().all(|fit| fit.interval.is_none()) {
        let least = fits.iter().map(|fit| fit.too_small).fold(f64::INFINITY, f64::min);
        found.channels.clear();
        found.reason = Some(format!(
            "the temperature changes by {} K, and its noise of {} K in blocks of {} s would make a coefficient too small by \
             {} %, expected {} % at most",
            significant(span_k, 2),
            significant(noise_k, 2),
            plain(block_s, 4),
            significant(100.0 * least, 2),
            plain(100.0 * TOO_SMALL, 2)
        ));
        return found;
    }
    let per_k = core::array::from_fn(|c| found.channels[c].per_k.unwrap_or(0.0));
    found.means = means(&usable, &per_k, blocks.mean_c());
    found.correction = found.is_shown().then(|| TemperatureCorrection::new(per_k, blocks));
    found
}

/// A coefficient with the interval as far out as the thermometer's noise may have brought it in.
fn told(fit: &Coefficient) -> TemperatureFit {
    let Coefficient { value, interval: [low, high], too_small } = *fit;
    if too_small > TOO_SMALL {
        return TemperatureFit { per_k: None, interval: None, too_small };
    }
    let further = 1.0 / (1.0 - too_small);
    let low = if low < 0.0 { low * further } else { low };
    let high = if high > 0.0 { high * further } else { high };
    let shown = low > 0.0 || high < 0.0;
    TemperatureFit { per_k: shown.then_some(value), interval: Some([low, high]), too_small }
}

/// Largest minus smallest value.
fn span(values: &[f64]) -> f64 {
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most - values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Standard deviation of the thermometer in a block, K.
///
/// Third differences of the means have twenty times its variance, and nearly nothing of a temperature that is smooth.
/// Without four neighbours anywhere it isn't known, and counts as none.
fn noise(usable: &[(f64, &StretchBlocks)]) -> f64 {
    let (mut rough, mut count) = (0.0, 0.0);
    for four in usable.iter().flat_map(|(_, stretch)| stretch.temperature_c.windows(4)) {
        let third = four[0] - 3.0 * four[1] + 3.0 * four[2] - four[3];
        rough += third * third;
        count += 20.0;
    }
    if count > 0.0 { libm::sqrt(rough / count) } else { 0.0 }
}

/// Part of the change of the temperature that is steady in time, with one rate for all stretches.
fn steady(usable: &[(f64, &StretchBlocks)]) -> Option<f64> {
    let (mut both, mut warm, mut time) = (0.0, 0.0, 0.0);
    for (_, stretch) in usable {
        let means = &stretch.temperature_c;
        let count = means.len() as f64;
        let mean = means.iter().sum::<f64>() / count;
        for (k, t) in means.iter().enumerate() {
            let (k, t) = (k as f64 - 0.5 * (count - 1.0), t - mean);
            both += k * t;
            warm += t * t;
            time += k * k;
        }
    }
    (warm > 0.0 && time > 0.0).then(|| both * both / (warm * time))
}

/// Largest change from the first temperature, K, and the time that it took, s.
fn change(usable: &[(f64, &StretchBlocks)], block_s: f64) -> Option<[f64; 2]> {
    let times = |(start_s, stretch): &(f64, &StretchBlocks)| -> Vec<[f64; 2]> {
        let at = |k: usize| start_s + (k as f64 + 0.5) * block_s;
        stretch.temperature_c.iter().enumerate().map(|(k, t)| [at(k), *t]).collect()
    };
    let all: Vec<[f64; 2]> = usable.iter().flat_map(times).collect();
    let [first_s, first] = *all.first()?;
    let of = |[time_s, t]: &[f64; 2]| [t - first, time_s - first_s];
    all.iter()
        .map(of)
        .max_by(|a, b| a[0].abs().total_cmp(&b[0].abs()))
        .filter(|change| change[1] > 0.0)
}

/// Means without the offset of their stretch at the reference temperature.
fn means(
    usable: &[(f64, &StretchBlocks)],
    per_k: &RateChannels,
    reference_c: f64,
) -> Vec<TemperatureMean> {
    let mut all = Vec::new();
    for (_, stretch) in usable {
        let count = stretch.temperature_c.len() as f64;
        let warmer = stretch.temperature_c.iter().sum::<f64>() / count - reference_c;
        let offset: RateChannels = core::array::from_fn(|c| {
            stretch.rates.iter().map(|rates| rates[c]).sum::<f64>() / count - per_k[c] * warmer
        });
        all.extend(stretch.temperature_c.iter().zip(&stretch.rates).map(|(t, rates)| {
            TemperatureMean {
                temperature_c: *t,
                residuals: core::array::from_fn(|c| rates[c] - offset[c]),
            }
        }));
    }
    all
}
