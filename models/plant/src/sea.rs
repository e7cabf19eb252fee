//! Sea spectra as sums of sinusoids with drawn phases.
//!
//! A spectrum describes the motion itself, in rad or m: its significant value is four standard
//! deviations of that degree of freedom.

use crate::config::Sinusoid;
use crate::draw::{phases, uniform_at};

/// One-sided spectrum of a degree of freedom, by its significant value and peak period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum {
    /// Significant value, rad or m: four standard deviations.
    pub significant: f64,
    /// Period of the peak, s.
    pub peak_period_s: f64,
    /// Peak enhancement γ of JONSWAP (3.3 is the mean of that campaign); 1: Pierson-Moskowitz.
    pub peak_enhancement: f64,
}

impl Spectrum {
    /// Pierson-Moskowitz (1964).
    #[must_use]
    pub fn pierson_moskowitz(significant: f64, peak_period_s: f64) -> Self {
        Self { significant, peak_period_s, peak_enhancement: 1.0 }
    }

    /// JONSWAP (Hasselmann et al., 1973).
    #[must_use]
    pub fn jonswap(significant: f64, peak_period_s: f64, peak_enhancement: f64) -> Self {
        Self { significant, peak_period_s, peak_enhancement }
    }

    /// Spectral shape over the frequency relative to the peak, without scale.
    fn shape(&self, x: f64) -> f64 {
        let width = if x <= 1.0 { 0.07 } else { 0.09 };
        let hump = (x - 1.0) / width;
        let x2 = x * x;
        libm::exp(-1.25 / (x2 * x2)) / (x2 * x2 * x)
            * libm::pow(self.peak_enhancement, libm::exp(-0.5 * hump * hump))
    }

    /// Makes `count` sinusoids with exactly the spectrum's variance: bins of equal width from half
    /// to four times the peak frequency, the frequency drawn within each bin so that the sum
    /// doesn't repeat, and the phase drawn too. Streams `draw.phase.NAME` and
    /// `draw.frequency.NAME`.
    #[must_use]
    pub fn components(&self, seed: u64, name: &str, count: usize) -> Vec<Sinusoid> {
        const FROM: f64 = 0.5;
        const TO: f64 = 4.0;
        let phase = phases(seed, name, count);
        let stream = format!("draw.frequency.{name}");
        let width = (TO - FROM) / count as f64;
        let mut power = 0.0;
        let mut all = Vec::with_capacity(count);
        for (i, phase_rad) in phase.into_iter().enumerate() {
            let x = FROM + (i as f64 + uniform_at(seed, &stream, i as u64)) * width;
            let amplitude = libm::sqrt(2.0 * self.shape(x) * width);
            power += 0.5 * amplitude * amplitude;
            all.push(Sinusoid { amplitude, period_s: self.peak_period_s / x, phase_rad });
        }
        let scale = 0.25 * self.significant / libm::sqrt(power);
        for sinusoid in &mut all {
            sinusoid.amplitude *= scale;
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variance_and_peak_are_those_of_the_spectrum() {
        for gamma in [1.0, 3.3] {
            let all = Spectrum::jonswap(2.0, 8.0, gamma).components(1, "heave", 200);
            let variance: f64 = all.iter().map(|s| 0.5 * s.amplitude * s.amplitude).sum();
            assert!((variance - 0.25).abs() < 1e-12);
            let peak = all.iter().max_by(|a, b| a.amplitude.total_cmp(&b.amplitude)).unwrap();
            assert!((peak.period_s - 8.0).abs() < 0.4, "{}", peak.period_s);
        }
    }

    /// Compares with the closed form of Pierson-Moskowitz: the share of variance below x ω_p is
    /// exp(−1.25 / x⁴).
    #[test]
    fn pierson_moskowitz_has_its_closed_form_distribution() {
        let all = Spectrum::pierson_moskowitz(4.0, 10.0).components(5, "roll", 2000);
        for x in [0.8, 1.0, 1.5, 2.5] {
            let below: f64 = all
                .iter()
                .filter(|s| 10.0 / s.period_s < x)
                .map(|s| 0.5 * s.amplitude * s.amplitude)
                .sum();
            let cdf = |x: f64| libm::exp(-1.25 / (x * x * x * x));
            assert!((below - cdf(x) / cdf(4.0)).abs() < 3e-3, "{x} {below}");
        }
    }
}
