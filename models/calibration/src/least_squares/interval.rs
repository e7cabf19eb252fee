//! Static intervals and the moves between them, sample by sample.

use super::moves::{Compensation, Move};
use nalgebra::Vector3;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS, GIMBAL_LSB_RAD};
use octant_sample::{Sample, Status};

/// Means of a static interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct StaticInterval {
    /// Mean specific force as measured, m/s².
    pub force_mps2: Vector3<f64>,
    /// Mean angular rate as measured, rad/s.
    pub rate_radps: Vector3<f64>,
    /// White noise of the mean force, variance per axis times duration, (m/s²)²·s.
    pub force_noise: Vector3<f64>,
    /// White noise of the mean rate, variance per axis times duration, rad²/s.
    pub rate_noise: Vector3<f64>,
    /// Mean gimbal angles (azimuth, roll), rad; `None` without valid encoders.
    pub gimbal_rad: Option<(f64, f64)>,
    /// Samples averaged.
    pub samples: u32,
    /// Time averaged, s.
    pub duration_s: f64,
}

/// Running sums of a static interval. Counts are summed as integers: the mean has no rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
struct Sums {
    delta_theta: [i64; 3],
    delta_velocity: [i64; 3],
    /// Squared differences of successive increments: twice the white variance, independent of slow
    /// drift (the Allan variance at one sample).
    theta_differences: [f64; 3],
    velocity_differences: [f64; 3],
    last: Option<([i32; 3], [i32; 3])>,
    differences: u32,
    gimbal: (i64, i64),
    gimbal_samples: u32,
    samples: u32,
    duration_s: f64,
}

impl Sums {
    fn add(&mut self, sample: &Sample, dt_s: f64) {
        for axis in 0..3 {
            self.delta_theta[axis] += i64::from(sample.delta_theta[axis]);
            self.delta_velocity[axis] += i64::from(sample.delta_velocity[axis]);
        }
        if let Some((theta, velocity)) = self.last {
            for axis in 0..3 {
                let dt = f64::from(sample.delta_theta[axis]) - f64::from(theta[axis]);
                let dv = f64::from(sample.delta_velocity[axis]) - f64::from(velocity[axis]);
                self.theta_differences[axis] += dt * dt;
                self.velocity_differences[axis] += dv * dv;
            }
            self.differences += 1;
        }
        self.last = Some((sample.delta_theta, sample.delta_velocity));
        if !sample.status.contains(Status::GIMBAL_INVALID) {
            self.gimbal.0 += i64::from(sample.gimbal.azimuth);
            self.gimbal.1 += i64::from(sample.gimbal.roll);
            self.gimbal_samples += 1;
        }
        self.samples += 1;
        self.duration_s += dt_s;
    }

    fn interval(&self) -> StaticInterval {
        let per_s = 1.0 / self.duration_s;
        // Variance of an increment over the sample period; at least that of rounding.
        let pairs = 2.0 * f64::from(self.differences.max(1));
        let dt_s = self.duration_s / f64::from(self.samples);
        let noise = |sum: f64, lsb: f64| lsb * lsb * (sum / pairs).max(1.0 / 6.0) / dt_s;
        StaticInterval {
            force_mps2: Vector3::from(self.delta_velocity)
                .map(|sum| sum as f64 * (DELTA_VELOCITY_LSB_MPS * per_s)),
            rate_radps: Vector3::from(self.delta_theta)
                .map(|sum| sum as f64 * (DELTA_THETA_LSB_RAD * per_s)),
            force_noise: Vector3::from(self.velocity_differences)
                .map(|sum| noise(sum, DELTA_VELOCITY_LSB_MPS)),
            rate_noise: Vector3::from(self.theta_differences)
                .map(|sum| noise(sum, DELTA_THETA_LSB_RAD)),
            gimbal_rad: (self.gimbal_samples > 0).then(|| {
                let scale = GIMBAL_LSB_RAD / f64::from(self.gimbal_samples);
                (self.gimbal.0 as f64 * scale, self.gimbal.1 as f64 * scale)
            }),
            samples: self.samples,
            duration_s: self.duration_s,
        }
    }
}

/// Cuts the stream of samples into static intervals and moves.
///
/// A standstill shorter than the shortest interval belongs to the move around it: the rotation is
/// integrated through it until it is long enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segmenter {
    shortest_s: f64,
    standing: bool,
    sums: Sums,
    /// Move up to the start of the standstill.
    arrival: Move,
    /// Move up to now.
    running: Move,
    last_sequence: Option<u64>,
}

#[cfg(feature = "state")]
octant_state::state! {
    Segmenter {
        values: standing, sums, arrival, running, last_sequence;
        parts: ;
        kept: shortest_s;
        check: Self::check_sums
    }
}

#[cfg(feature = "state")]
impl Segmenter {
    /// Checks loaded sums: each is no larger than its number of samples allows, and the number
    /// leaves room for as many again.
    fn check_sums(&self) -> Result<(), octant_state::StateError> {
        use octant_state::check_below;
        let Sums { delta_theta, delta_velocity, gimbal, samples, .. } = &self.sums;
        check_below("sums.samples", (*samples).into(), 1 << 31)?;
        check_below("sums.differences", self.sums.differences.into(), (*samples).into())?;
        check_below("sums.gimbal_samples", self.sums.gimbal_samples.into(), (*samples).into())?;
        let largest = u64::from(*samples) << 31;
        for sum in delta_theta.iter().chain(delta_velocity).chain([&gimbal.0, &gimbal.1]) {
            check_below("a sum of counts", sum.unsigned_abs(), largest)?;
        }
        Ok(())
    }
}

impl Segmenter {
    pub(crate) fn new(shortest_s: f64) -> Self {
        Self {
            shortest_s,
            standing: false,
            sums: Sums::default(),
            arrival: Move::default(),
            running: Move::default(),
            last_sequence: None,
        }
    }

    /// Takes one sample; returns an interval that just ended and the move before it.
    pub(crate) fn step(
        &mut self,
        sample: &Sample,
        dt_s: f64,
        standing: bool,
        compensation: &Compensation,
    ) -> Option<(Move, StaticInterval)> {
        let ended = if self.standing && !standing { self.flush() } else { None };
        let unbroken =
            self.last_sequence.is_none_or(|last| sample.sequence == last.wrapping_add(1));
        self.last_sequence = Some(sample.sequence);
        let usable = !sample.status.intersects(
            Status::INERTIAL_INVALID | Status::GYRO_SATURATED | Status::ACCELEROMETER_SATURATED,
        );
        if standing && !self.standing {
            self.sums = Sums::default();
            self.arrival = self.running;
            self.arrival.complete &= unbroken;
        }
        self.standing = standing;
        if standing && usable {
            self.sums.add(sample, dt_s);
        }
        if !standing || self.sums.duration_s < self.shortest_s {
            self.running.complete &= usable && unbroken;
            self.integrate(sample, dt_s, compensation);
        }
        ended
    }

    /// Ends a standstill; returns its interval if it was long enough.
    pub(crate) fn flush(&mut self) -> Option<(Move, StaticInterval)> {
        if !self.standing {
            return None;
        }
        self.standing = false;
        if self.sums.duration_s < self.shortest_s || self.sums.samples < 2 {
            return None;
        }
        self.running = Move::default();
        Some((self.arrival, self.sums.interval()))
    }

    /// Restarts the move with its first sample, under another compensation.
    pub(crate) fn restart(&mut self, sample: &Sample, dt_s: f64, compensation: &Compensation) {
        let complete = self.running.complete;
        self.running = Move::default();
        self.running.complete = complete;
        self.integrate(sample, dt_s, compensation);
    }

    fn integrate(&mut self, sample: &Sample, dt_s: f64, compensation: &Compensation) {
        let delta_theta =
            Vector3::from(sample.delta_theta).map(|c| f64::from(c) * DELTA_THETA_LSB_RAD);
        let delta_velocity =
            Vector3::from(sample.delta_velocity).map(|c| f64::from(c) * DELTA_VELOCITY_LSB_MPS);
        self.running.step(&delta_theta, &delta_velocity, dt_s, compensation);
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use octant_earth::rotation::log;
    use octant_sample::Parameters;

    /// Sample of a body that turns about z by 0.001 rad a sample while `turning`.
    fn sample(sequence: u64, turning: bool) -> Sample {
        let z = if turning { (0.001 / DELTA_THETA_LSB_RAD) as i32 } else { 0 };
        Sample { sequence, delta_theta: [0, 0, z], ..Sample::default() }
    }

    #[test]
    fn a_pause_too_short_belongs_to_the_move_around_it() {
        let compensation = Compensation::new(&Parameters::default()).unwrap();
        let mut segmenter = Segmenter::new(1.0);
        // Rest 2 s, turn, pause 0.5 s (while still turning a little), turn, rest 2 s.
        let plan = [(200, true), (100, false), (50, true), (100, false), (200, true)];
        let (mut sequence, mut found) = (0, std::vec::Vec::new());
        for (part, (samples, standing)) in plan.into_iter().enumerate() {
            for _ in 0..samples {
                sequence += 1;
                let sample = sample(sequence, !standing || part == 2);
                found.extend(segmenter.step(&sample, 0.01, standing, &compensation));
            }
        }
        found.extend(segmenter.flush());
        assert_eq!(found.len(), 2);
        let (arrival, interval) = &found[1];
        assert_eq!((interval.samples, arrival.complete), (200, true));
        assert!((arrival.duration_s - 2.5).abs() < 1e-9);
        let turned = log(&arrival.rotation());
        assert!((turned - Vector3::new(0.0, 0.0, 0.25)).norm() < 1e-8, "{turned}");
    }

    #[test]
    fn a_jump_in_the_numbers_spoils_the_move_and_not_the_interval() {
        let compensation = Compensation::new(&Parameters::default()).unwrap();
        let mut segmenter = Segmenter::new(1.0);
        let mut found = std::vec::Vec::new();
        for sequence in (1..=600).filter(|n| ![150, 250].contains(n)) {
            let standing = !(200..300).contains(&sequence);
            let sample = sample(sequence, !standing);
            found.extend(segmenter.step(&sample, 0.01, standing, &compensation));
        }
        found.extend(segmenter.flush());
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].1.samples, 198);
        assert!(!found[1].0.complete);
        assert!(found[1].1.force_mps2.norm() == 0.0 && found[1].1.rate_radps.norm() == 0.0);
    }
}
