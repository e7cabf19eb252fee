//! Noise that the harness adds to the samples of an instrument whose own noise isn't known.
//!
//! White noise from the seed, whose sums are whole counts and known: a unit that integrates its samples has them in its
//! errors, and one that doesn't can't.

use octant_random::stream::Triad;
use octant_sample::counts::{Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{NoiseIntegral, Sample};
use octant_scenario::Scenario;

/// Noise for one run.
#[derive(Clone, Debug)]
pub(super) struct Dither {
    gyro: Sensor,
    accelerometer: Sensor,
    sample: u64,
}

/// Noise for the three axes of a sensor.
#[derive(Clone, Debug)]
struct Sensor {
    noise: Triad,
    sigma_counts: f64,
    remainders: [Accumulator; 3],
    sum_counts: [i64; 3],
}

impl Sensor {
    fn new(seed: u64, name: &str, sigma_counts: f64) -> Self {
        let (noise, remainders) = (Triad::new(seed, name), Default::default());
        Self { noise, sigma_counts, remainders, sum_counts: [0; 3] }
    }

    fn add(&mut self, sample: u64, counts: &mut [i32; 3]) {
        for (axis, noise) in self.noise.at(sample).into_iter().enumerate() {
            let added = self.remainders[axis].count(self.sigma_counts * noise).value;
            // A count at its limit takes less.
            let sum = counts[axis].saturating_add(added);
            self.sum_counts[axis] += i64::from(sum) - i64::from(counts[axis]);
            counts[axis] = sum;
        }
    }

    fn sum(&self, lsb: f64) -> [f64; 3] {
        self.sum_counts.map(|counts| counts as f64 * lsb)
    }
}

impl Dither {
    /// Makes the noise that a scenario asks for.
    pub(super) fn of(scenario: &Scenario, seed: u64) -> Option<Self> {
        let part = scenario.dither?;
        let root_s = libm::sqrt(scenario.sample_period_ns as f64 * 1e-9);
        let counts = |density: f64, lsb: f64| part * density * root_s / lsb;
        let (theta, velocity) = (
            counts(scenario.imu.angle_random_walk, DELTA_THETA_LSB_RAD),
            counts(scenario.imu.velocity_random_walk, DELTA_VELOCITY_LSB_MPS),
        );
        Some(Self {
            gyro: Sensor::new(seed, "dither.gyro", theta),
            accelerometer: Sensor::new(seed, "dither.accelerometer", velocity),
            sample: 0,
        })
    }

    /// Adds the noise of the next sample.
    pub(super) fn add(&mut self, sample: &mut Sample) {
        self.gyro.add(self.sample, &mut sample.delta_theta);
        self.accelerometer.add(self.sample, &mut sample.delta_velocity);
        self.sample += 1;
    }

    /// Sums of the noise so far.
    pub(super) fn sum(&self) -> NoiseIntegral {
        NoiseIntegral {
            delta_theta_rad: self.gyro.sum(DELTA_THETA_LSB_RAD),
            delta_velocity_mps: self.accelerometer.sum(DELTA_VELOCITY_LSB_MPS),
        }
    }
}
