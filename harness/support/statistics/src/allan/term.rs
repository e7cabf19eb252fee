//! Noise terms of a sensor: what each adds to the Allan variance of its rate.

use std::f64::consts::{LN_2, PI};

/// Noise term of a gyro's rate or an accelerometer's specific force (IEEE Std 952-1997, annex C; IEEE
/// Std 1293). With the coefficient in SI units, τ in s:
///
/// | term | σ²(τ) | coefficient of a gyro |
/// |---|---|---|
/// | quantization | 3 Q² / τ² | rad |
/// | random walk | N² / τ | rad/√s |
/// | bias instability | (2 ln 2 / π) B² | rad/s |
/// | rate random walk | K² τ / 3 | (rad/s)/√s |
/// | rate ramp | R² τ² / 2 | rad/s² |
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum NoiseTerm {
    /// White noise of the integral: of a counter's last digit.
    Quantization,
    /// White noise of the rate: angle or velocity random walk.
    RandomWalk,
    /// Flicker noise of the rate.
    BiasInstability,
    /// Random walk of the rate.
    RateRandomWalk,
    /// Steady change of the rate.
    RateRamp,
}

impl NoiseTerm {
    /// Number of terms.
    pub const COUNT: usize = 5;
    /// All terms, in the order of their slopes over time.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Quantization,
        Self::RandomWalk,
        Self::BiasInstability,
        Self::RateRandomWalk,
        Self::RateRamp,
    ];

    /// Name, as in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Quantization => "quantization",
            Self::RandomWalk => "random_walk",
            Self::BiasInstability => "bias_instability",
            Self::RateRandomWalk => "rate_random_walk",
            Self::RateRamp => "rate_ramp",
        }
    }

    /// Allan variance at an averaging time, s, of a coefficient 1.
    #[must_use]
    pub fn variance(self, tau_s: f64) -> f64 {
        match self {
            Self::Quantization => 3.0 / (tau_s * tau_s),
            Self::RandomWalk => 1.0 / tau_s,
            Self::BiasInstability => 2.0 * LN_2 / PI,
            Self::RateRandomWalk => tau_s / 3.0,
            Self::RateRamp => 0.5 * tau_s * tau_s,
        }
    }

    /// Correlation of two differences of neighbouring averages, whose beginnings are `distance`
    /// averaging times apart.
    ///
    /// A difference of averages is a second difference of the integral. That of white noise of the
    /// integral shares a value only at the distances 0, 1 and 2; of the other terms it is the fourth
    /// difference of |t|, t² ln |t| and |t|³ (NIST SP 1065, 5.4.1, for long averages). A ramp isn't
    /// random; it counts as a rate random walk.
    #[must_use]
    pub fn correlation(self, distance: f64) -> f64 {
        let t = distance.abs();
        let of = |kernel: fn(f64) -> f64| {
            let fourth = |t: f64| {
                let near = kernel(t - 1.0) + kernel(t + 1.0);
                let far = kernel(t - 2.0) + kernel(t + 2.0);
                6.0 * kernel(t) - 4.0 * near + far
            };
            fourth(t) / fourth(0.0)
        };
        match self {
            Self::Quantization if t == 0.0 => 1.0,
            Self::Quantization if t == 1.0 => -2.0 / 3.0,
            Self::Quantization if t == 2.0 => 1.0 / 6.0,
            Self::Quantization => 0.0,
            Self::RandomWalk => of(f64::abs),
            Self::BiasInstability => {
                of(|t| if t == 0.0 { 0.0 } else { t * t * libm::log(t.abs()) })
            }
            Self::RateRandomWalk | Self::RateRamp => of(|t| t.abs() * t * t),
        }
    }
}
