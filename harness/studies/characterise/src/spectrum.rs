//! Power spectral density by Welch's method, and lines in it.
//!
//! Segments have 2ᵏ samples, their mean and slope are taken off, and they have a Hann window. They don't overlap, so
//! that the mean of K periodograms of white noise is Γ-distributed with K degrees of freedom exactly (Welch, IEEE Trans.
//! Audio Electroacoust. 15, 1967). A bin is part of a line if it is above the level that white noise reaches in any of
//! the bins of a channel with a probability of [`FALSE_ALARM`], against the median of its neighbours.
//!
//! The transform is a radix-2 one of 60 lines: a segment is transformed once in its length, which is no hot path, and
//! a crate for it would be the only reason for its packages.

use super::deviations::{CHANNELS, RateChannels};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::f64::consts::PI;

/// Probability of a false line in a channel of white noise.
pub const FALSE_ALARM: f64 = 0.01;
/// Longest segment, in samples.
const SEGMENT_MAX: u64 = 1 << 15;
/// Segments that a record has at least.
const SEGMENTS_MIN: u64 = 8;
/// Neighbours on each side that tell the level; those next to the bin are left out.
const NEIGHBOURS: usize = 48;
const GUARD: usize = 3;
/// Noise bandwidth of a Hann window, in bins.
const BANDWIDTH: f64 = 1.5;
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
    /// Probability that white noise alone has a bin as high in this channel.
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
        let neighbours = 2.0 * NEIGHBOURS as f64 * EFFICIENCY;
        let Ok(ratio) = FisherSnedecor::new(k, k * neighbours) else { return Vec::new() };
        let level: Vec<f64> = (0..density.len()).map(|bin| background(&density, bin, k)).collect();
        let chance = |bin: usize| bins as f64 * ratio.sf(density[bin] / level[bin]);
        let mut lines: Vec<SpectrumLine> = Vec::new();
        for bin in LOWEST..density.len() - 1 {
            let is_peak = density[bin] >= density[bin - 1] && density[bin] >= density[bin + 1];
            let chance = if is_peak { chance(bin) } else { 1.0 };
            if chance < FALSE_ALARM {
                lines.push(self.line(&density, level[bin], (bin, chance)));
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

    fn line(&self, density: &[f64], level: f64, (bin, chance): (usize, f64)) -> SpectrumLine {
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
            mains: mains(frequency_hz, BANDWIDTH * self.bin_hz(), 1.0 / self.period_s),
        }
    }
}

/// Level around a bin, from the median of its neighbours.
fn background(density: &[f64], bin: usize, freedom: f64) -> f64 {
    let low = bin.saturating_sub(NEIGHBOURS + GUARD).max(LOWEST / 2);
    // At the ends the neighbourhood keeps its size on the other side.
    let high = (low + 2 * (NEIGHBOURS + GUARD) + 1).min(density.len() - 1);
    let low = high.saturating_sub(2 * (NEIGHBOURS + GUARD) + 1).max(LOWEST / 2);
    let mut around: Vec<f64> = (low..high)
        .filter(|other| other.abs_diff(bin) > GUARD)
        .map(|other| density[other])
        .collect();
    around.sort_unstable_by(f64::total_cmp);
    let median = around.get(around.len() / 2).copied().unwrap_or(f64::INFINITY);
    // Median of χ² against its mean.
    let part = 1.0 - 2.0 / (9.0 * freedom);
    median / (part * part * part)
}

/// Names the harmonic of the mains that a frequency fits.
fn mains(frequency_hz: f64, within_hz: f64, rate_hz: f64) -> Option<String> {
    for base in [50.0, 60.0] {
        for harmonic in 1..=12 {
            let true_hz = base * f64::from(harmonic);
            let folded = (true_hz - rate_hz * (true_hz / rate_hz).round()).abs();
            // The mains themselves are off by a tenth of a percent.
            if (folded - frequency_hz).abs() < within_hz + 1e-3 * true_hz {
                let name = if harmonic == 1 { String::new() } else { format!("{harmonic} × ") };
                let seen = if true_hz > 0.5 * rate_hz { ", folded" } else { "" };
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
