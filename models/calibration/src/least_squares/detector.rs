//! Detection of standstill from the data: windowed standard deviation of specific force against
//! that of a first interval that is known to be static.

use super::refusal::{AdjustmentRefusal, WINDOW_SAMPLES_MAX};
use nalgebra::Vector3;
use octant_sample::Sample;
use octant_sample::counts::DELTA_VELOCITY_LSB_MPS;

/// Delays the stream by half a window, and decides for each sample whether the instrument was at
/// rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Detector {
    initial_s: f64,
    threshold: f64,
    window: usize,
    ring: [(Sample, f64); WINDOW_SAMPLES_MAX],
    /// Number of samples taken.
    count: usize,
    /// Number of samples returned.
    delivered: usize,
    time_s: f64,
    delivered_time_s: f64,
    initial_samples: f64,
    initial_mean: Vector3<f64>,
    initial_squares: f64,
    standing: bool,
}

#[cfg(feature = "state")]
impl octant_state::State for Detector {
    fn save(&self, to: &mut octant_state::Writer) {
        let Self {
            initial_s: _,
            threshold: _,
            window,
            ring,
            count,
            delivered,
            time_s,
            delivered_time_s,
            initial_samples,
            initial_mean,
            initial_squares,
            standing,
        } = self;
        to.value("times", &(time_s, delivered_time_s));
        to.value("initial", &(initial_samples, initial_mean, initial_squares));
        to.value("standing", standing);
        to.value("counts", &(count, delivered));
        for held in &ring[..*count.min(window)] {
            to.value("held", held);
        }
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        (self.time_s, self.delivered_time_s) = from.value("times")?;
        (self.initial_samples, self.initial_mean, self.initial_squares) = from.value("initial")?;
        self.standing = from.value("standing")?;
        (self.count, self.delivered) = from.value("counts")?;
        octant_state::check_count("count", self.count as u64)?;
        octant_state::check_below("delivered", self.delivered as u64, self.count as u64)?;
        let waiting = (self.count - self.delivered) as u64;
        octant_state::check_below("samples held back", waiting, self.window as u64)?;
        for held in &mut self.ring[..self.count.min(self.window)] {
            *held = from.value("held")?;
        }
        Ok(())
    }
}

impl Detector {
    pub(crate) fn new(
        initial_s: f64,
        window_s: f64,
        threshold: f64,
        sample_period_ns: u64,
    ) -> Result<Self, AdjustmentRefusal> {
        let samples = window_s / (sample_period_ns as f64 * 1e-9);
        let window = samples + 0.5;
        if !(window >= 4.0 && window < (WINDOW_SAMPLES_MAX + 1) as f64) {
            return Err(AdjustmentRefusal::Window { samples });
        }
        if !(initial_s >= window_s && initial_s.is_finite()) {
            return Err(AdjustmentRefusal::InitialInterval { initial_s });
        }
        if !(threshold > 1.0 && threshold.is_finite()) {
            return Err(AdjustmentRefusal::Threshold { threshold });
        }
        Ok(Self {
            initial_s,
            threshold,
            window: window as usize,
            ring: [(Sample::default(), 0.0); WINDOW_SAMPLES_MAX],
            count: 0,
            delivered: 0,
            time_s: 0.0,
            delivered_time_s: 0.0,
            initial_samples: 0.0,
            initial_mean: Vector3::zeros(),
            initial_squares: 0.0,
            standing: true,
        })
    }

    /// Takes a sample; returns the sample half a window ago, its period, and whether the instrument
    /// was at rest.
    pub(crate) fn step(&mut self, sample: &Sample, dt_s: f64) -> Option<(Sample, f64, bool)> {
        self.ring[self.count % self.window] = (*sample, dt_s);
        self.count += 1;
        self.time_s += dt_s;
        if self.time_s <= self.initial_s {
            // Welford: mean and sum of squares in one pass without cancellation.
            self.initial_samples += 1.0;
            let force = force_of(sample, dt_s);
            let from_old = force - self.initial_mean;
            self.initial_mean += from_old / self.initial_samples;
            self.initial_squares += from_old.dot(&(force - self.initial_mean));
        }
        if self.count <= self.window / 2 {
            return None;
        }
        if self.count >= self.window {
            let limit = self.threshold * self.threshold * self.initial_squares
                / (self.initial_samples - 1.0).max(1.0);
            self.standing = self.delivered_time_s < self.initial_s || self.variance() < limit;
        }
        self.deliver()
    }

    /// Returns the samples still held at the end of the stream, one a call, each at rest if the
    /// last one was.
    pub(crate) fn drain(&mut self) -> Option<(Sample, f64, bool)> {
        (self.delivered < self.count).then(|| self.deliver()).flatten()
    }

    fn deliver(&mut self) -> Option<(Sample, f64, bool)> {
        let (sample, dt_s) = self.ring[self.delivered % self.window];
        self.delivered += 1;
        self.delivered_time_s += dt_s;
        Some((sample, dt_s, self.standing))
    }

    /// Sum over the axes of the variance of specific force in the window, (m/s²)². Computed anew
    /// for every sample: running sums would accumulate rounding, and the window is bounded.
    fn variance(&self) -> f64 {
        let held = &self.ring[..self.window];
        let n = self.window as f64;
        let mean = held.iter().fold(Vector3::zeros(), |sum, (s, dt)| sum + force_of(s, *dt)) / n;
        held.iter().fold(0.0, |sum, (s, dt)| sum + (force_of(s, *dt) - mean).norm_squared())
            / (n - 1.0)
    }
}

/// Mean specific force in b over a sample, m/s².
fn force_of(sample: &Sample, dt_s: f64) -> Vector3<f64> {
    Vector3::from(sample.delta_velocity).map(|c| f64::from(c) * (DELTA_VELOCITY_LSB_MPS / dt_s))
}
