//! Biases that wander: first-order Gauss-Markov, alone or in the sum that is a bias instability, and
//! rate random walk.

use crate::config::GaussMarkov;
use octant_random::stream::Triad;

/// Three independent processes `x(k+1) = a x(k) + q n(k)`, exact at the stamps for any period.
///
/// The increment of an interval is the integral's conditional mean given both ends,
/// `τ tanh(dt / 2τ) (x(k) + x(k+1))`; for the random walk, τ → ∞, that is the trapezoid.
#[derive(Clone, Debug)]
pub(crate) struct Wander {
    state: [f64; 3],
    decay: f64,
    driving: f64,
    weight_s: f64,
    pub(crate) stream: Triad,
}

octant_state::state! {
    Wander { values: state; parts: ; kept: decay, driving, weight_s, stream }
}

impl Wander {
    /// Gauss-Markov: a = exp(−dt/τ), q = σ √(1 − a²), begun in its stationary distribution.
    pub(crate) fn gauss_markov(process: &GaussMarkov, dt: f64, stream: Triad) -> Self {
        let ratio = dt / process.correlation_time_s;
        let driving = process.sigma * libm::sqrt(-libm::expm1(-2.0 * ratio));
        Self {
            state: stream.initial().map(|n| process.sigma * n),
            decay: libm::exp(-ratio),
            driving,
            weight_s: process.correlation_time_s * libm::tanh(0.5 * ratio),
            stream,
        }
    }

    /// Random walk of `density` per √s, begun at zero.
    pub(crate) fn random_walk(density: f64, dt: f64, stream: Triad) -> Self {
        let driving = density * libm::sqrt(dt);
        Self { state: [0.0; 3], decay: 1.0, driving, weight_s: 0.5 * dt, stream }
    }

    /// Integral over the interval of a sample.
    pub(crate) fn increment(&mut self, sample: u64) -> [f64; 3] {
        let noise = self.stream.at(sample);
        let mut integral = [0.0; 3];
        for axis in 0..3 {
            let before = self.state[axis];
            let after = self.decay * before + self.driving * noise[axis];
            self.state[axis] = after;
            integral[axis] = self.weight_s * (before + after);
        }
        integral
    }
}
