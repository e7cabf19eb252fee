//! Second pass over a recording: variances, spectrum and histogram of the stretches at rest, and the fits.

use super::deviations::{CHANNELS, Deviations, RateChannels};
use super::drift::{BlockMeans, RampEstimate};
use super::error::CharacteriseError;
use super::fit::{NoiseFitter, RandomTermsFit};
use super::freedom::{VarianceKind, degrees_of_freedom, interval};
use super::recording::RestingRecording;
use super::spectrum::{SpectrumLine, WelchSpectrum};
use super::survey::RestSurvey;
use super::temperature::correction::TemperatureCorrection;
pub use octant_scenario::file_names::NAMES;
use serde::Serialize;

/// Values of a channel that are kept for its histogram.
const KEPT: u64 = 4000;
/// Bins of a spectrum in the result, in a third of an octave.
const THIRDS: f64 = 3.0;

/// A deviation with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DeviationEstimate {
    /// Deviation, rad/s or m/s².
    pub deviation: f64,
    /// Interval of 95 %.
    pub interval: [f64; 2],
    /// Equivalent degrees of freedom.
    pub freedom: f64,
}

/// Deviations at an averaging time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeviationRow {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Averaging time in samples.
    pub samples: u64,
    /// Overlapping Allan deviation.
    pub allan: DeviationEstimate,
    /// Modified Allan deviation; none where the record is too short for one.
    pub modified: Option<DeviationEstimate>,
    /// Overlapping Hadamard deviation; none where the record is too short for one.
    pub hadamard: Option<DeviationEstimate>,
}

/// Mean of a spectral density over a third of an octave.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SpectrumBand {
    /// Centre, Hz.
    pub frequency_hz: f64,
    /// Square root of the one-sided density, (rad/s)/√Hz or (m/s²)/√Hz.
    pub density: f64,
    /// Degrees of freedom of the density.
    pub freedom: f64,
}

/// One channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelAnalysis {
    /// Name: `gyro_x`.
    pub name: &'static str,
    /// Unit of its rates: rad/s or m/s².
    pub unit: &'static str,
    /// Mean over all stretches, at the mean temperature.
    pub mean: f64,
    /// Deviations by averaging time.
    pub deviations: Vec<DeviationRow>,
    /// Noise terms; none where the stretches are too short for a fit.
    pub noise: Option<RandomTermsFit>,
    /// Steady change of the rate; none without a fit.
    pub ramp: Option<RampEstimate>,
    /// Spectral density by thirds of an octave.
    pub spectrum: Vec<SpectrumBand>,
    /// Lines.
    pub lines: Vec<SpectrumLine>,
    /// Increments from sample to sample, evenly picked.
    #[serde(skip)]
    pub increments: Vec<f64>,
}

/// All channels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RestAnalysis {
    /// Lengths of the stretches, in samples.
    pub stretches: Vec<u64>,
    /// Number of segments of the spectra.
    pub segments: u64,
    /// Width of a bin of the spectra, Hz.
    pub bin_hz: f64,
    /// RateChannels: gyros x, y, z, accelerometers x, y, z.
    pub channels: Vec<ChannelAnalysis>,
}

/// Takes samples at rest.
pub(crate) struct RestTaker {
    period_s: f64,
    deviations: Deviations,
    spectrum: WelchSpectrum,
    blocks: BlockMeans,
    sums: RateChannels,
    count: u64,
    every: u64,
    before: Option<RateChannels>,
    increments: Vec<RateChannels>,
}

impl RestTaker {
    pub(crate) fn new(period_s: f64, lengths: &[u64]) -> Self {
        let total: u64 = lengths.iter().sum();
        let longest = lengths.iter().copied().max().unwrap_or(0);
        Self {
            period_s,
            deviations: Deviations::new(period_s),
            spectrum: WelchSpectrum::new(period_s, longest),
            blocks: BlockMeans::new(lengths),
            sums: [0.0; CHANNELS],
            count: 0,
            // An odd step: increments of neighbours aren't independent.
            every: (total / KEPT).max(2) | 1,
            before: None,
            increments: Vec::new(),
        }
    }

    pub(crate) fn push(&mut self, rates: &RateChannels) {
        self.deviations.push(rates);
        self.spectrum.push(rates);
        self.blocks.push(rates);
        for (sum, rate) in self.sums.iter_mut().zip(rates) {
            *sum += rate;
        }
        self.count += 1;
        if let Some(before) = &self.before
            && self.count.is_multiple_of(self.every)
        {
            self.increments.push(core::array::from_fn(|c| rates[c] - before[c]));
        }
        self.before = Some(*rates);
    }

    pub(crate) fn end_stretch(&mut self) {
        self.deviations.end_stretch();
        self.spectrum.end_stretch();
        self.blocks.end_stretch();
        self.before = None;
    }

    pub(crate) fn finish(self) -> RestAnalysis {
        let stretches = self.deviations.stretches().to_vec();
        let mut fitter = NoiseFitter::new(self.period_s, &stretches);
        let channels = (0..CHANNELS).map(|c| self.channel(c, &mut fitter, &stretches)).collect();
        RestAnalysis {
            segments: self.spectrum.segments(),
            bin_hz: self.spectrum.bin_hz(),
            stretches,
            channels,
        }
    }

    fn channel(&self, c: usize, fitter: &mut NoiseFitter, stretches: &[u64]) -> ChannelAnalysis {
        let all = self.deviations.variances();
        let octaves: Vec<f64> = all
            .iter()
            .filter(|v| fitter.octaves().contains(&v.samples))
            .filter_map(|v| Some(v.hadamard?[c]))
            .collect();
        let noise = fitter.fit(&octaves);
        let white = [0.0, 1.0, 0.0, 0.0, 0.0];
        let squares = noise.as_ref().map_or(white, RandomTermsFit::squares);
        let kernel = noise.as_ref().map_or_else(
            || crate::kernel::Kernel { period_s: self.period_s, correlation_time_s: 1.0 },
            |noise| noise.kernel(self.period_s),
        );
        let estimate = |kind, samples, variance: f64| {
            let freedom = degrees_of_freedom(&kernel, kind, samples, (stretches, &squares));
            let bounds = if variance > 0.0 { interval(variance, freedom) } else { [0.0; 2] };
            DeviationEstimate {
                deviation: libm::sqrt(variance),
                interval: bounds.map(libm::sqrt),
                freedom,
            }
        };
        let row = |v: &crate::deviations::Variances| DeviationRow {
            tau_s: v.samples as f64 * self.period_s,
            samples: v.samples,
            allan: estimate(VarianceKind::Allan, v.samples, v.allan[c]),
            modified: v.modified.map(|m| estimate(VarianceKind::Modified, v.samples, m[c])),
            hadamard: v.hadamard.map(|h| estimate(VarianceKind::Hadamard, v.samples, h[c])),
        };
        ChannelAnalysis {
            name: NAMES[c],
            unit: if c < 3 { "rad/s" } else { "m/s^2" },
            mean: self.sums[c] / self.count.max(1) as f64,
            deviations: all.iter().map(row).collect(),
            ramp: noise.as_ref().and_then(|noise| self.blocks.ramp(c, noise, self.period_s)),
            noise,
            spectrum: bands(&self.spectrum, c),
            lines: self.spectrum.lines(c),
            increments: self.increments.iter().map(|increments| increments[c]).collect(),
        }
    }
}

/// Means over thirds of an octave.
fn bands(spectrum: &WelchSpectrum, channel: usize) -> Vec<SpectrumBand> {
    let density = spectrum.density(channel);
    let third = |bin: usize| (libm::log2(bin as f64) * THIRDS).round() as i64;
    let mut bands: Vec<(i64, f64, f64, f64)> = Vec::new();
    // The first bins have what is left of the mean, the last one is half as wide.
    for bin in 3..density.len().saturating_sub(1) {
        match bands.last_mut() {
            Some(last) if last.0 == third(bin) => {
                last.1 += 1.0;
                last.2 += density[bin];
                last.3 += bin as f64;
            }
            _ => bands.push((third(bin), 1.0, density[bin], bin as f64)),
        }
    }
    let band = |(_, count, sum, place): &(i64, f64, f64, f64)| SpectrumBand {
        frequency_hz: place / count * spectrum.bin_hz(),
        density: libm::sqrt(sum / count),
        // Neighbours of a Hann window share: 1 + 2 (4/9 + 1/36).
        freedom: 2.0 * spectrum.segments() as f64 * (count / (35.0 / 18.0)).max(1.0),
    };
    if spectrum.segments() == 0 { Vec::new() } else { bands.iter().map(band).collect() }
}

/// Analyses the stretches at rest of a recording, without the part that the temperature explains.
///
/// # Errors
/// If it can't be read.
pub fn analyse(
    recording: &RestingRecording,
    survey: &RestSurvey,
    correction: Option<&TemperatureCorrection>,
) -> Result<RestAnalysis, CharacteriseError> {
    let lengths: Vec<u64> = survey.stretches.iter().map(|stretch| stretch.samples).collect();
    let mut taker = RestTaker::new(recording.period_s(), &lengths);
    survey.read(recording, |sample, place| {
        match correction {
            None => taker.push(&sample.rates),
            Some(correction) => {
                let warmer_k = correction.warmer_k(place.stretch, place.sample);
                taker.push(&correction.taken_off(&sample.rates, warmer_k));
            }
        }
        if place.is_last {
            taker.end_stretch();
        }
    })?;
    Ok(taker.finish())
}
