//! Increments of both triads as the integer counts of a sample.

use octant_sample::Status;
use octant_sample::counts::{Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};

/// Converts increments of both triads into counts and carries the remainder of each axis.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Triads {
    gyro: [Accumulator; 3],
    accel: [Accumulator; 3],
    saturated: u64,
}

impl Triads {
    /// Number of samples in which at least one count saturated.
    pub(crate) fn saturated(&self) -> u64 {
        self.saturated
    }

    /// Converts increments, rad and m/s, to counts. An increment that is already a whole number of
    /// counts is passed unchanged.
    #[inline]
    pub(crate) fn count(
        &mut self,
        theta: &[f64; 3],
        velocity: &[f64; 3],
        delta_theta: &mut [i32; 3],
        delta_velocity: &mut [i32; 3],
    ) -> Status {
        let mut status = Status::empty();
        let mut triad = |accumulators: &mut [Accumulator; 3],
                         increments: &[f64; 3],
                         lsb: f64,
                         flag: Status,
                         counts: &mut [i32; 3]| {
            for axis in 0..3 {
                let exact = increments[axis] / lsb;
                let whole = exact as i32;
                if accumulators[axis].remainder == 0.0 && f64::from(whole) == exact {
                    counts[axis] = whole;
                    continue;
                }
                let count = accumulators[axis].count(exact);
                if count.saturated {
                    status |= flag;
                }
                counts[axis] = count.value;
            }
        };
        let (rad, mps) = (DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS);
        triad(&mut self.gyro, theta, rad, Status::GYRO_SATURATED, delta_theta);
        triad(&mut self.accel, velocity, mps, Status::ACCELEROMETER_SATURATED, delta_velocity);
        self.saturated += u64::from(!status.is_empty());
        status
    }
}
