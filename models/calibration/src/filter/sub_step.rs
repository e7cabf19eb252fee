//! Sums over samples: of one sub-step of the transition, and of a longer time.

use nalgebra::{Matrix3, Vector3};

/// Longest sub-step of the transition, ns.
const SUB_STEP_MAX_NS: u64 = 50_000_000;

/// Integrals of the sensors over a time: increments of the gyros (b, rad), change of velocity by
/// specific force (n, m/s), and the duration, s.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct SensorIntegrals {
    /// Increments of the gyros, compensated, in b, rad.
    pub delta_theta: Vector3<f64>,
    /// Change of velocity by specific force in n, m/s.
    pub delta_velocity_n: Vector3<f64>,
    /// Duration, s.
    pub elapsed_s: f64,
    /// Channels that were bridged within that time, as bits.
    pub bridged: u8,
}

impl SensorIntegrals {
    pub(super) fn add(&mut self, other: &Self) {
        self.delta_theta += other.delta_theta;
        self.delta_velocity_n += other.delta_velocity_n;
        self.elapsed_s += other.elapsed_s;
        self.bridged |= other.bridged;
    }
}

/// Sums over the samples of one sub-step.
#[derive(Clone, Debug)]
pub(super) struct SubStep {
    pub(super) samples_max: u32,
    pub(super) samples: u32,
    pub(super) elapsed_s: f64,
    pub(super) c_middle: Matrix3<f64>,
    pub(super) delta_theta: Vector3<f64>,
    pub(super) delta_velocity: Vector3<f64>,
    pub(super) delta_velocity_n: Vector3<f64>,
    /// Channels that were bridged in the sub-step, as bits.
    pub(super) bridged: u8,
}

#[cfg(feature = "state")]
octant_state::state! {
    SubStep {
        values: samples, elapsed_s, c_middle, delta_theta, delta_velocity, delta_velocity_n,
            bridged;
        parts: ;
        kept: samples_max;
        check: Self::check_samples
    }
}

#[cfg(feature = "state")]
impl SubStep {
    fn check_samples(&self) -> Result<(), octant_state::StateError> {
        octant_state::check_below("samples", self.samples.into(), self.samples_max.into())
    }
}

impl SubStep {
    pub(super) fn turned(&self) -> SensorIntegrals {
        SensorIntegrals {
            delta_theta: self.delta_theta,
            delta_velocity_n: self.delta_velocity_n,
            elapsed_s: self.elapsed_s,
            bridged: self.bridged,
        }
    }

    pub(super) fn new(samples_max: u32) -> Self {
        Self {
            samples_max,
            samples: 0,
            elapsed_s: 0.0,
            c_middle: Matrix3::identity(),
            delta_theta: Vector3::zeros(),
            delta_velocity: Vector3::zeros(),
            delta_velocity_n: Vector3::zeros(),
            bridged: 0,
        }
    }
}

/// Number of samples in a sub-step: as many as fit into 50 ms and divide the period.
#[must_use]
pub fn sub_step_samples(sample_period_ns: u64, period_ns: u64) -> u32 {
    let in_period = (period_ns / sample_period_ns.max(1)).max(1);
    let mut samples = (SUB_STEP_MAX_NS / sample_period_ns.max(1)).clamp(1, in_period);
    while !in_period.is_multiple_of(samples) {
        samples -= 1;
    }
    samples as u32
}
