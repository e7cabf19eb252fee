//! Power spectral density by Welch's method, and lines in it.
//!
//! Segments have 2ᵏ samples, their mean and slope are taken off, and they have a Hann window. They don't overlap, so
//! that the mean of K periodograms of white noise is Γ-distributed with K degrees of freedom exactly (Welch, IEEE Trans.
//! Audio Electroacoust. 15, 1967). A bin is part of a line if it is above the level that noise without lines reaches in
//! any of the bins of a channel with a probability of [`FALSE_ALARM`]. That noise has a power law over the neighbours of a
//! bin, as white, flicker, walking and quantization noise and their sums have: its exponent and its level there come from
//! their medians, and the fewer there are, and the further the bin is from their middle, the less certain the level.
//!
//! The transform is a radix-2 one of 60 lines: a segment is transformed once in its length, which is no hot path, and
//! a crate for it would be the only reason for its packages.

use super::deviations::{CHANNELS, RateChannels};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::f64::consts::PI;

/// Probability of a false line in a channel of noise without lines.
pub const FALSE_ALARM: f64 = 0.01;
/// Longest segment, in samples.
const SEGMENT_MAX: u64 = 1 << 15;
/// Segments that a record has at least.
const SEGMENTS_MIN: u64 = 8;
/// Neighbours on each side that tell the level; those next to the bin are left out.
const NEIGHBOURS: usize = 48;
const GUARD: usize = 3;
/// Farthest neighbours, as a ratio of frequencies: within it a spectrum of several noises has about a power law.
const FARTHEST: usize = 3;
/// Passes that find the exponent of the noise.
const EXPONENT_PASSES: usize = 4;
/// Efficiency of the median of correlated neighbours, as independent ones.
const EFFICIENCY: f64 = 0.4;
/// Lowest bin that is looked at: below is drift.
const LOWEST: usize = 8;

/// Line in the spectrum of a channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpectrumLine {
    /// Frequency, Hz; a line above half of the sample rate is seen folded.
    pub frequency_hz: f64,
    /// Resolution, Hz: the line is within it.
    pub resolution_hz: f64,
    /// Amplitude of the sinusoid in the rates, rad/s or m/s².
    pub amplitude: f64,
    /// Probability that noise without lines has a bin as high in this channel.
    pub false_alarm: f64,
    /// Harmonic of the mains that it fits, folded or not: "50 Hz", "3 × 60 Hz".
    pub mains: Option<String>,
}

/// Spectral density of all channels.
#[derive(Clone, Debug)]
pub struct WelchSpectrum {
    period_s: f64,
    length: usize,
    segment: Vec<RateChannels>,
    window: Vec<f64>,
    sums: Vec<RateChannels>,
    segments: u64,
}

impl WelchSpectrum {
    /// Creates the estimator; `longest` is the longest stretch, in samples.
    #[must_use]
    pub fn new(period_s: f64, longest: u64) -> Self {
        let most = (longest / SEGMENTS_MIN).clamp(64, SEGMENT_MAX);
        let length = 1usize << most.ilog2();
        let hann = |i: usize| 0.5 - 0.5 * libm::cos(2.0 * PI * i as f64 / length as f64);
        Self {
            period_s,
            length,
            segment: Vec::with_capacity(length),
            window: (0..length).map(hann).collect(),
            sums: vec![[0.0; CHANNELS]; length / 2 + 1],
            segments: 0,
        }
    }

    /// Takes the next sample of a stretch.
    pub fn push(&mut self, rates: &RateChannels) {
        self.segment.push(*rates);
        if self.segment.len() == self.length {
            self.add();
            self.segment.clear();
        }
    }

    /// Ends a stretch: a segment that has begun is dropped.
    pub fn end_stretch(&mut self) {
        self.segment.clear();
    }

    fn add(&mut self) {
        let n = self.length as f64;
        for c in 0..CHANNELS {
            let (mut mean, mut slope) = (0.0, 0.0);
            for (i, rates) in self.segment.iter().enumerate() {
                mean += rates[c] / n;
                slope += rates[c] * (i as f64 - 0.5 * (n - 1.0));
            }
            slope *= 12.0 / (n * (n * n - 1.0));
            let mut real = Vec::with_capacity(self.length);
            for (i, rates) in self.segment.iter().enumerate() {
                let rest = rates[c] - mean - slope * (i as f64 - 0.5 * (n - 1.0));
                real.push(rest * self.window[i]);
            }
            let mut imaginary = vec![0.0; self.length];
            transform(&mut real, &mut imaginary);
            // One-sided; the window has the mean square 3/8.
            let scale = 2.0 * self.period_s / (n * 0.375);
            for (bin, sums) in self.sums.iter_mut().enumerate() {
                sums[c] += scale * (real[bin] * real[bin] + imaginary[bin] * imaginary[bin]);
            }
        }
        self.segments += 1;
    }

    /// Segments so far.
    #[must_use]
    pub fn segments(&self) -> u64 {
        self.segments
    }

    /// Width of a bin, Hz.
    #[must_use]
    pub fn bin_hz(&self) -> f64 {
        1.0 / (self.length as f64 * self.period_s)
    }

    /// One-sided density of a channel by bins, in the square of its unit per Hz; the first is that at 0 Hz.
    #[must_use]
    pub fn density(&self, channel: usize) -> Vec<f64> {
        let count = self.segments.max(1) as f64;
        self.sums.iter().map(|sums| sums[channel] / count).collect()
    }

    /// Finds lines.
    #[must_use]
    pub fn lines(&self, channel: usize) -> Vec<SpectrumLine> {
        let density = self.density(channel);
        let bins = density.len().saturating_sub(LOWEST + 1);
        if self.segments == 0 || bins < 4 * NEIGHBOURS {
            return Vec::new();
        }
        let k = 2.0 * self.segments as f64;
        let mut lines: Vec<SpectrumLine> = Vec::new();
        for bin in LOWEST..density.len() - 1 {
            let is_peak = density[bin] >= density[bin - 1] && density[bin] >= density[bin + 1];
            let Some(background) = is_peak.then(|| Background::of(&density, bin, k)).flatten()
            else {
                continue;
            };
            let Ok(ratio) = FisherSnedecor::new(k, background.freedom) else { continue };
            let chance = bins as f64 * ratio.sf(density[bin] / background.level);
            if chance < FALSE_ALARM {
                lines.push(self.line(&density, background.level, bin, chance));
            }
        }
        // Side lobes of a strong line are lower and near.
        let near = 4.0 * self.bin_hz();
        let all = lines.clone();
        lines.retain(|line| {
            !all.iter().any(|other| {
                other.amplitude > line.amplitude
                    && (other.frequency_hz - line.frequency_hz).abs() < near
            })
        });
        lines
    }

    fn line(&self, density: &[f64], level: f64, bin: usize, chance: f64) -> SpectrumLine {
        let above = |bin: usize| (density[bin] - level).max(0.0);
        let (left, middle, right) = (above(bin - 1), above(bin), above(bin + 1));
        // Power of the main lobe; its centre of gravity by amplitudes of a Hann window.
        let power = (left
            + middle
            + right
            + above(bin - 2)
            + density.get(bin + 2).map_or(0.0, |_| above(bin + 2)))
            * self.bin_hz();
        let (a, b) = (libm::sqrt(left), libm::sqrt(right));
        let (side, sign) = if b > a { (b, 1.0) } else { (a, -1.0) };
        let ratio = side / libm::sqrt(middle).max(f64::MIN_POSITIVE);
        let shift = sign * ((2.0 * ratio - 1.0) / (1.0 + ratio)).clamp(0.0, 0.5);
        let frequency_hz = (bin as f64 + shift) * self.bin_hz();
        SpectrumLine {
            frequency_hz,
            resolution_hz: self.bin_hz(),
            amplitude: libm::sqrt(2.0 * power),
            false_alarm: chance.min(1.0),
            mains: mains(frequency_hz, self.bin_hz(), 1.0 / self.period_s),
        }
    }
}

/// Level of the noise at a bin.
struct Background {
    level: f64,
    /// Degrees of freedom of the level.
    freedom: f64,
}

impl Background {
    /// Takes the level from the neighbours of a bin; `freedom` is that of each. `None` where there are too few.
    fn of(density: &[f64], bin: usize, freedom: f64) -> Option<Self> {
        let last = density.len().checked_sub(2)?;
        let reach = NEIGHBOURS + GUARD;
        let high = (bin + reach).min(FARTHEST * bin).min(last);
        // At the ends the neighbourhood keeps its size on the other side.
        let low = high.saturating_sub(2 * reach).max(bin.div_ceil(FARTHEST)).max(LOWEST / 2);
        let high = (low + 2 * reach).min(FARTHEST * bin).min(last);
        let around: Vec<[f64; 2]> = (low..=high)
            .filter(|other| other.abs_diff(bin) > GUARD && density[*other] > 0.0)
            .map(|other| [libm::log(other as f64), libm::log(density[other])])
            .collect();
        if around.len() < 8 {
            return None;
        }
        let n = around.len() as f64;
        let (lower, upper) = around.split_at(around.len() / 2);
        let [from, to] = [lower, upper].map(|half| mean(half.iter().map(|[x, _]| *x)));
        let at = libm::log(bin as f64);
        // A median of logarithms along a steep law is drawn to one side; of what the last exponent leaves it isn't.
        let mut exponent = 0.0;
        for _ in 0..EXPONENT_PASSES {
            let left = |half: &[[f64; 2]]| median(half.iter().map(|[x, y]| y - exponent * x));
            exponent += (left(upper)? - left(lower)?) / (to - from);
        }
        let level = median(around.iter().map(|[x, y]| y + exponent * (at - x)))?;
        // Median of χ² against its mean.
        let part = 1.0 - 2.0 / (9.0 * freedom);
        // The level away from the middle of the neighbours is as uncertain as the exponent makes it.
        let off = (at - 0.5 * (from + to)) / (to - from);
        Some(Self {
            level: libm::exp(level) / (part * part * part),
            freedom: freedom * n * EFFICIENCY / (1.0 + 4.0 * off * off),
        })
    }
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    values.sum::<f64>() / n
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Names the harmonic of the mains that a frequency fits.
fn mains(frequency_hz: f64, resolution_hz: f64, rate_hz: f64) -> Option<String> {
    for base in [50.0, 60.0] {
        for harmonic in 1..=12 {
            let true_hz = base * f64::from(harmonic);
            let folded = (true_hz - rate_hz * (true_hz / rate_hz).round()).abs();
            let is_folded = true_hz > 0.5 * rate_hz;
            // The mains themselves are off by a tenth of a percent. Folded harmonics lie all over the spectrum: with that
            // much room, some would fit anything.
            let off_hz = if is_folded { 0.0 } else { 1e-3 * true_hz };
            if (folded - frequency_hz).abs() <= resolution_hz + off_hz {
                let name = if harmonic == 1 { String::new() } else { format!("{harmonic} × ") };
                let seen = if is_folded { ", folded" } else { "" };
                return Some(format!("{name}{base} Hz{seen}"));
            }
        }
    }
    None
}

/// Fourier transform in place of a power of two (Cooley and Tukey, Math. Comput. 19, 1965).
fn transform(real: &mut [f64], imaginary: &mut [f64]) {
    let n = real.len();
    let bits = n.trailing_zeros();
    for i in 0..n {
        let j = i.reverse_bits() >> (usize::BITS - bits);
        if i < j {
            real.swap(i, j);
            imaginary.swap(i, j);
        }
    }
    let turns: Vec<(f64, f64)> = (0..n / 2)
        .map(|k| -2.0 * PI * k as f64 / n as f64)
        .map(|angle| (libm::cos(angle), libm::sin(angle)))
        .collect();
    let mut half = 1;
    while half < n {
        let stride = n / (2 * half);
        for from in (0..n).step_by(2 * half) {
            for k in 0..half {
                let (c, s) = turns[k * stride];
                let (a, b) = (from + k, from + k + half);
                let (x, y) = (real[b] * c - imaginary[b] * s, real[b] * s + imaginary[b] * c);
                (real[b], imaginary[b]) = (real[a] - x, imaginary[a] - y);
                (real[a], imaginary[a]) = (real[a] + x, imaginary[a] + y);
            }
        }
        half *= 2;
    }
}
