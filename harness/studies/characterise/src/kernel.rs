//! Noise terms as generalized covariances of the phase, from which every variance and covariance of differences
//! follows in closed form.
//!
//! The phase x is the integral of the rate. Differences of order two and more of x have covariances
//! `E[Dx(s) Dx(0)] = Σ cₖ g(s + kτ)` with the generalized covariance g(t) of the term; a polynomial of second degree
//! in g cancels (Matheron 1973; NIST SP 1065, 5.4.1 with Greenhall and Riley, PTTI 2003, for powers of the frequency):
//!
//! | term | coefficient | g(t) of a coefficient 1, t ≥ 0 |
//! |---|---|---|
//! | quantization | Q | 1 at t = 0, else 0 |
//! | random walk | N | −t / 2 |
//! | bias instability | B | t² ln t / 2π |
//! | rate random walk | K | t³ / 12 |
//! | Gauss-Markov | σ, T | −T² (t/T − 1 + e^(−t/T)) |
//!
//! The coefficients are those of IEEE Std 952-1997, annex C: AVAR = 3Q²/τ², N²/τ, (2 ln 2/π) B², K²τ/3.

use serde::Serialize;
use std::f64::consts::PI;

/// Random terms of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RandomTerm {
    /// White noise of the integral, of a counter's last digit.
    Quantization,
    /// White noise of the rate: angle or velocity random walk.
    RandomWalk,
    /// Flicker noise of the rate.
    BiasInstability,
    /// Random walk of the rate.
    RateRandomWalk,
    /// First-order Gauss-Markov rate.
    GaussMarkov,
}

/// Number of random terms.
pub const TERMS: usize = 5;

impl RandomTerm {
    /// All terms.
    pub const ALL: [Self; TERMS] = [
        Self::Quantization,
        Self::RandomWalk,
        Self::BiasInstability,
        Self::RateRandomWalk,
        Self::GaussMarkov,
    ];

    /// Name, as in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Quantization => "quantization",
            Self::RandomWalk => "random_walk",
            Self::BiasInstability => "bias_instability",
            Self::RateRandomWalk => "rate_random_walk",
            Self::GaussMarkov => "gauss_markov",
        }
    }
}

/// Order of a difference of the phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DifferenceOrder {
    /// Second: of the Allan variance.
    Second,
    /// Third: of the Hadamard variance.
    Third,
}

impl DifferenceOrder {
    /// Coefficients of the covariance of two differences, from lag −order to order.
    const fn coefficients(self) -> &'static [f64] {
        match self {
            Self::Second => &[1.0, -4.0, 6.0, -4.0, 1.0],
            Self::Third => &[-1.0, 6.0, -15.0, 20.0, -15.0, 6.0, -1.0],
        }
    }

    /// Averaging times that a difference spans.
    pub(crate) const fn span(self) -> usize {
        match self {
            Self::Second => 2,
            Self::Third => 3,
        }
    }

    /// Divisor of the mean square, in τ².
    const fn divisor(self) -> f64 {
        match self {
            Self::Second => 2.0,
            Self::Third => 6.0,
        }
    }
}

/// Generalized covariances of the phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    /// Sample period, s.
    pub period_s: f64,
    /// Correlation time of the Gauss-Markov term, s.
    pub correlation_time_s: f64,
}

impl Kernel {
    /// Generalized covariance at a lag, s.
    #[must_use]
    pub fn at(&self, term: RandomTerm, lag_s: f64) -> f64 {
        let t = lag_s.abs();
        match term {
            RandomTerm::Quantization => f64::from(t < 0.25 * self.period_s),
            RandomTerm::RandomWalk => -0.5 * t,
            RandomTerm::BiasInstability if t == 0.0 => 0.0,
            RandomTerm::BiasInstability => t * t * libm::log(t) / (2.0 * PI),
            RandomTerm::RateRandomWalk => t * t * t / 12.0,
            RandomTerm::GaussMarkov => {
                // Without the −u²/2 of its series, which cancels in every difference and is much larger than the rest.
                let u = t / self.correlation_time_s;
                let rest = if u < 0.1 {
                    u * u
                        * u
                        * (-1.0
                            + u * (1.0 / 4.0 - u * (1.0 / 20.0 - u * (1.0 / 120.0 - u / 840.0))))
                        / 6.0
                } else {
                    u - 1.0 + libm::exp(-u) - 0.5 * u * u
                };
                -self.correlation_time_s * self.correlation_time_s * rest
            }
        }
    }

    /// Generalized covariance of the mean of the phase over a length, s, at a lag.
    fn averaged(&self, term: RandomTerm, lag_s: f64, over_s: f64) -> f64 {
        let period = self.period_s;
        let m = (over_s / period).round().max(1.0);
        if term == RandomTerm::Quantization {
            let apart = (lag_s.abs() / period).round();
            return (1.0 - apart / m).max(0.0) / m;
        }
        if m <= 16.0 {
            let m = m as i32;
            let of = |k: i32| f64::from(m - k.abs()) * self.at(term, lag_s + f64::from(k) * period);
            return (1 - m..m).map(of).sum::<f64>() / f64::from(m * m);
        }
        // The double integral of the covariance, in second differences.
        let twice = |t: f64| self.integrated(term, t);
        (twice(lag_s + over_s) - 2.0 * twice(lag_s) + twice(lag_s - over_s)) / (over_s * over_s)
    }

    /// Double integral of the generalized covariance, without polynomials that cancel.
    fn integrated(&self, term: RandomTerm, lag_s: f64) -> f64 {
        let t = lag_s.abs();
        match term {
            RandomTerm::Quantization => 0.0,
            RandomTerm::RandomWalk => -t * t * t / 12.0,
            RandomTerm::BiasInstability if t == 0.0 => 0.0,
            RandomTerm::BiasInstability => t * t * t * t * libm::log(t) / (24.0 * PI),
            RandomTerm::RateRandomWalk => t * t * t * t * t / 240.0,
            RandomTerm::GaussMarkov => {
                let u = t / self.correlation_time_s;
                let t4 = self.correlation_time_s.powi(4);
                let rest = if u < 0.3 {
                    u.powi(5)
                        * (-1.0
                            + u * (1.0 / 6.0 - u * (1.0 / 42.0 - u * (1.0 / 336.0 - u / 3024.0))))
                        / 120.0
                } else {
                    u.powi(3) / 6.0 - 0.5 * u * u + u - 1.0 + libm::exp(-u) - u.powi(4) / 24.0
                };
                -t4 * rest
            }
        }
    }

    /// Covariance of two differences of the phase whose beginnings are a lag apart.
    #[must_use]
    pub fn covariance(
        &self,
        term: RandomTerm,
        order: DifferenceOrder,
        tau_s: f64,
        lag_s: f64,
    ) -> f64 {
        let of = |(k, c): (i32, &f64)| c * self.at(term, lag_s + f64::from(k) * tau_s);
        (-(order.span() as i32)..).zip(order.coefficients()).map(of).sum()
    }

    /// The same of the means over τ, of the modified Allan variance.
    #[must_use]
    pub fn modified_covariance(&self, term: RandomTerm, tau_s: f64, lag_s: f64) -> f64 {
        let of = |(k, c): (i32, &f64)| c * self.averaged(term, lag_s + f64::from(k) * tau_s, tau_s);
        (-2..).zip(DifferenceOrder::Second.coefficients()).map(of).sum()
    }

    /// Variance of a coefficient 1: Allan's or Hadamard's.
    #[must_use]
    pub fn variance(&self, term: RandomTerm, order: DifferenceOrder, tau_s: f64) -> f64 {
        self.covariance(term, order, tau_s, 0.0) / (order.divisor() * tau_s * tau_s)
    }

    /// Modified Allan variance of a coefficient 1.
    #[must_use]
    pub fn modified_variance(&self, term: RandomTerm, tau_s: f64) -> f64 {
        self.modified_covariance(term, tau_s, 0.0) / (2.0 * tau_s * tau_s)
    }

    /// Third difference of the generalized covariance over a short time: `g(t+3τ) − 3g(t+2τ) + 3g(t+τ) − g(t)`.
    /// Far from zero it is τ³ times the third derivative, where the difference of large numbers would be lost.
    fn third(&self, term: RandomTerm, lag_s: f64, tau_s: f64) -> f64 {
        let middle = lag_s + 1.5 * tau_s;
        if middle.abs() > 24.0 * tau_s {
            return tau_s * tau_s * tau_s * self.derivative(term, middle);
        }
        let at = |k: f64| self.at(term, lag_s + k * tau_s);
        at(3.0) - 3.0 * (at(2.0) - at(1.0)) - at(0.0)
    }

    /// Third derivative of the generalized covariance, away from zero.
    fn derivative(&self, term: RandomTerm, lag_s: f64) -> f64 {
        match term {
            RandomTerm::Quantization | RandomTerm::RandomWalk => 0.0,
            RandomTerm::BiasInstability => 1.0 / (PI * lag_s),
            RandomTerm::RateRandomWalk => 0.5 * lag_s.signum(),
            RandomTerm::GaussMarkov => {
                let u = lag_s.abs() / self.correlation_time_s;
                libm::exp(-u) * lag_s.signum() / self.correlation_time_s
            }
        }
    }

    /// Covariance of two third differences of different averaging times: the first begins `lag_s` after the second.
    #[must_use]
    pub fn cross_covariance(&self, term: RandomTerm, tau_s: [f64; 2], lag_s: f64) -> f64 {
        let [short, long] = tau_s;
        let of = |(l, c): (f64, f64)| c * self.third(term, lag_s - l * long, short);
        [(0.0, -1.0), (1.0, 3.0), (2.0, -3.0), (3.0, 1.0)].into_iter().map(of).sum()
    }
}
