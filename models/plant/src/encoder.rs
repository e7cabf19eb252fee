//! Encoders: the angle of the drive with a periodic error, in counts.

use crate::trig::Near;
use octant_random::normal::Ziggurat;
use octant_random::stream::{Phase, key};

/// Harmonics of a turn in the error curve: eccentricity, ellipticity and their neighbours.
const HARMONICS: usize = 4;

/// Error curve of one encoder: a zero error and a first harmonic that are given, and a Fourier series
/// drawn from the seed, scaled to its rms over a turn.
#[derive(Clone, Debug)]
pub(crate) struct ErrorCurve {
    /// Coefficients of sine and cosine of each harmonic, rad.
    coefficients: [(f64, f64); HARMONICS],
    /// Zero error, rad.
    zero: f64,
    near: Near,
    none: bool,
}

octant_state::state! {
    ErrorCurve { values: near; parts: ; kept: coefficients, zero, none }
}

impl ErrorCurve {
    /// Makes the curve with this rms of its drawn part, this zero error and these coefficients of cosine
    /// and sine of the angle, rad.
    pub(crate) fn new(
        seed: u64,
        name: &str,
        rms_rad: f64,
        zero_rad: f64,
        [cosine_rad, sine_rad]: [f64; 2],
    ) -> Self {
        let key = key(seed, name, Phase::Draw);
        let ziggurat = Ziggurat::shared();
        let mut coefficients = [(0.0, 0.0); HARMONICS];
        let mut power = 0.0;
        for (harmonic, pair) in coefficients.iter_mut().enumerate() {
            let [sine, cosine, _] = ziggurat.three(key, harmonic as u64);
            *pair = (sine, cosine);
            power += 0.5 * (sine * sine + cosine * cosine);
        }
        let scale = rms_rad / libm::sqrt(power);
        for pair in &mut coefficients {
            *pair = (pair.0 * scale, pair.1 * scale);
        }
        coefficients[0].0 += sine_rad;
        coefficients[0].1 += cosine_rad;
        let none = [rms_rad, zero_rad, cosine_rad, sine_rad] == [0.0; 4];
        Self { coefficients, zero: zero_rad, near: Near::new(0.0), none }
    }

    /// Error at an angle, rad.
    pub(crate) fn at(&mut self, angle_rad: f64) -> f64 {
        if self.none {
            return 0.0;
        }
        let (s, c) = self.near.sincos(angle_rad);
        let (mut sine, mut cosine, mut error) = (s, c, self.zero);
        for pair in &self.coefficients {
            error += pair.0 * sine + pair.1 * cosine;
            (sine, cosine) = (sine * c + cosine * s, cosine * c - sine * s);
        }
        error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_periodic_and_has_its_rms() {
        let mut curve = ErrorCurve::new(4, "turntable.encoder.roll", 8.7e-5, 0.0, [0.0; 2]);
        let turn = 2.0 * core::f64::consts::PI;
        let n = 720;
        let mut power = 0.0;
        for i in 0..n {
            let angle = turn * f64::from(i) / f64::from(n);
            let error = curve.at(angle);
            power += error * error;
            assert!((error - curve.at(angle - turn)).abs() < 1e-18);
        }
        assert!((libm::sqrt(power / f64::from(n)) / 8.7e-5 - 1.0).abs() < 1e-12);
    }
}
