//! Streams of known noise from closed-form generators.

use octant_characterise::deviations::{CHANNELS, RateChannels};
use octant_random::stream::Triad;

/// Coefficients of the terms of a stream, in SI units.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Coefficients {
    pub(crate) quantization: f64,
    pub(crate) random_walk: f64,
    pub(crate) bias_instability: f64,
    pub(crate) rate_random_walk: f64,
    /// σ and correlation time, s.
    pub(crate) gauss_markov: Option<(f64, f64)>,
    pub(crate) ramp: f64,
}

/// Normal numbers of six channels.
struct Normals([Triad; 2]);

impl Normals {
    fn new(seed: u64, name: &str) -> Self {
        Self(["a", "b"].map(|half| Triad::new(seed, &format!("{name}.{half}"))))
    }

    fn at(&self, sample: u64) -> RateChannels {
        let (a, b) = (self.0[0].at(sample), self.0[1].at(sample));
        [a[0], a[1], a[2], b[0], b[1], b[2]]
    }

    fn initial(&self) -> RateChannels {
        let (a, b) = (self.0[0].initial(), self.0[1].initial());
        [a[0], a[1], a[2], b[0], b[1], b[2]]
    }
}

/// A Gauss-Markov rate, averaged exactly over each sample: state and integral are drawn together.
struct Process {
    state: RateChannels,
    decay: f64,
    /// Mean of the integral given the state; factor of the two normal numbers.
    gain: f64,
    factors: [f64; 3],
    normals: [Normals; 2],
}

impl Process {
    /// σ = 1; `time_s` infinite: a random walk of 1 per √s.
    fn new((seed, name): (u64, &str), time_s: f64, dt: f64) -> Self {
        let normals = [0, 1].map(|part| Normals::new(seed, &format!("{name}.{part}")));
        let (decay, gain, variance, shared, of_integral) = if time_s.is_finite() {
            let (u, t) = (dt / time_s, time_s);
            let e = (-u).exp();
            // Driven by white noise of density 2/T from the state at the beginning.
            let variance = -(-2.0 * u).exp_m1();
            let shared = t * (1.0 - e) * (1.0 - e);
            // For small u the difference of large numbers is lost; its series isn't.
            let of_integral = if u < 1e-2 {
                t * t * (2.0 / 3.0 * u * u * u - 0.5 * u.powi(4) + 7.0 / 30.0 * u.powi(5))
            } else {
                t * t * (2.0 * u - 3.0 + 4.0 * e - (-2.0 * u).exp())
            };
            (e, -t * (-u).exp_m1(), variance, shared, of_integral)
        } else {
            (1.0, dt, dt, dt * dt / 2.0, dt * dt * dt / 3.0)
        };
        let first = variance.sqrt();
        let second = shared / first;
        let third = (of_integral - second * second).max(0.0).sqrt();
        let state = if time_s.is_finite() { normals[0].initial() } else { [0.0; CHANNELS] };
        Self { state, decay, gain, factors: [first, second, third], normals }
    }

    fn integral(&mut self, sample: u64) -> RateChannels {
        let [a, b] = [self.normals[0].at(sample), self.normals[1].at(sample)];
        let mut integral = [0.0; CHANNELS];
        for c in 0..CHANNELS {
            integral[c] =
                self.gain * self.state[c] + self.factors[1] * a[c] + self.factors[2] * b[c];
            self.state[c] = self.decay * self.state[c] + self.factors[0] * a[c];
        }
        integral
    }
}

/// Generates rates: six channels alike, each on its own.
pub(crate) fn stream(
    seed: u64,
    of: &Coefficients,
    dt: f64,
    samples: u64,
    mut take: impl FnMut(&RateChannels),
) {
    let white = Normals::new(seed, "white");
    let counts = Normals::new(seed, "counts");
    let mut processes = Vec::new();
    if of.rate_random_walk > 0.0 {
        processes.push((of.rate_random_walk, Process::new((seed, "walk"), f64::INFINITY, dt)));
    }
    if let Some((sigma, time_s)) = of.gauss_markov {
        processes.push((sigma, Process::new((seed, "gm"), time_s, dt)));
    }
    if of.bias_instability > 0.0 {
        // Gauss-Markov processes whose correlation times double: S(f) = B²/(2π|f|) within 1e-5 in between.
        let sigma = of.bias_instability * (2f64.ln() / std::f64::consts::PI).sqrt();
        let mut time_s = dt / 16.0;
        let mut number = 0;
        while time_s < 32.0 * dt * samples as f64 {
            processes.push((sigma, Process::new((seed, &format!("flicker {number}")), time_s, dt)));
            time_s *= 2.0;
            number += 1;
        }
    }
    let mut before = counts.initial();
    for sample in 0..samples {
        let normal = white.at(sample);
        let now = counts.at(sample);
        let mut rate = [of.ramp * dt * (sample as f64 + 0.5); CHANNELS];
        for c in 0..CHANNELS {
            rate[c] += of.random_walk * normal[c] / dt.sqrt();
            rate[c] += of.quantization * (now[c] - before[c]) / dt;
        }
        before = now;
        for (factor, process) in &mut processes {
            let integral = process.integral(sample);
            for c in 0..CHANNELS {
                rate[c] += *factor * integral[c] / dt;
            }
        }
        take(&rate);
    }
}
