//! Samples, references, truth and receipts as values.

use super::table::{FAULT_SLOTS, slot};
use crate::values::CellValues;
use octant_faults::Station;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{Epoch, Reference, Truth};

/// Writes a sample and its aiding. Counts are exact as Real.
#[inline]
pub(super) fn put(epoch: &Epoch, values: &mut CellValues) {
    let Epoch { sample, aiding } = epoch;
    for axis in 0..3 {
        let theta = f64::from(sample.delta_theta[axis]) * DELTA_THETA_LSB_RAD;
        values.set_real(slot::GYRO + axis, theta);
        let velocity = f64::from(sample.delta_velocity[axis]) * DELTA_VELOCITY_LSB_MPS;
        values.set_real(slot::ACCELEROMETER + axis, velocity);
    }
    values.set_real(slot::GIMBAL_AZIMUTH, sample.gimbal.azimuth_rad());
    values.set_real(slot::GIMBAL_ROLL, sample.gimbal.roll_rad());
    values.set_boolean(slot::IMU_VALID, true);
    values.set_integer(slot::IMU_STATUS, i32::from(sample.status.bits()));
    values.set_count(slot::IMU_SEQUENCE, sample.sequence);
    values.set_count(slot::IMU_DEVICE_TIME, sample.device_time.ns);
    let kind = match aiding.as_ref().map(|aiding| aiding.reference) {
        None => 0,
        Some(Reference::Velocity(velocity)) => {
            values.set_reals(slot::REFERENCE_VELOCITY, &velocity);
            1
        }
        Some(Reference::Position { latitude_rad, longitude_rad, height_m }) => {
            values.set_real(slot::REFERENCE_LATITUDE, latitude_rad);
            values.set_real(slot::REFERENCE_LONGITUDE, longitude_rad);
            values.set_real(slot::REFERENCE_HEIGHT, height_m);
            2
        }
    };
    values.set_integer(slot::REFERENCE_KIND, kind);
    if let Some(aiding) = aiding {
        // Stamps of the same run: their difference is a small whole number.
        let age = i128::from(sample.device_time.ns) - i128::from(aiding.device_time.ns);
        values.set_real(slot::REFERENCE_AGE, age as f64);
    }
}

/// Outputs of the earlier sample periods of a communication step.
pub(super) struct Gathered {
    valid: bool,
    theta_rad: [f64; 3],
    velocity_mps: [f64; 3],
    status: i32,
    kind: i32,
    age_ns: f64,
}

impl Gathered {
    pub(super) fn of(values: &CellValues) -> Self {
        Self {
            valid: values.boolean(slot::IMU_VALID),
            theta_rad: values.reals(slot::GYRO),
            velocity_mps: values.reals(slot::ACCELEROMETER),
            status: values.integer(slot::IMU_STATUS),
            kind: values.integer(slot::REFERENCE_KIND),
            age_ns: values.real(slot::REFERENCE_AGE),
        }
    }

    /// Adds them to the outputs of the next period: sums of increments, which are exact, flags of any
    /// period, and the last reference with its age. Where a sample was lost the whole step isn't valid.
    pub(super) fn add_to(&self, values: &mut CellValues, period_ns: u64) {
        let valid = values.boolean(slot::IMU_VALID);
        values.set_boolean(slot::IMU_VALID, valid && self.valid);
        for axis in 0..3 {
            for (slot, before) in [
                (slot::GYRO + axis, self.theta_rad[axis]),
                (slot::ACCELEROMETER + axis, self.velocity_mps[axis]),
            ] {
                // Without a sample the increments are old ones.
                let now = if valid { values.real(slot) } else { 0.0 };
                values.set_real(slot, if self.valid { before } else { 0.0 } + now);
            }
        }
        values.set_integer(slot::IMU_STATUS, self.status | values.integer(slot::IMU_STATUS));
        if values.integer(slot::REFERENCE_KIND) == 0 && self.kind != 0 {
            values.set_integer(slot::REFERENCE_KIND, self.kind);
            values.set_real(slot::REFERENCE_AGE, self.age_ns + period_ns as f64);
        }
    }
}

/// Writes that there is no sample.
pub(super) fn put_none(values: &mut CellValues) {
    values.set_boolean(slot::IMU_VALID, false);
    values.set_integer(slot::REFERENCE_KIND, 0);
}

/// Writes the truth.
pub(super) fn put_truth(truth: &Truth, values: &mut CellValues) {
    values.set_real(slot::TRUTH_LATITUDE, truth.latitude_rad);
    values.set_real(slot::TRUTH_LONGITUDE, truth.longitude_rad);
    values.set_real(slot::TRUTH_HEIGHT, truth.height_m);
    values.set_reals(slot::TRUTH_VELOCITY, &truth.velocity_mps);
    values.set_reals(slot::TRUTH_ATTITUDE, &truth.q_nb);
    values.set_real(slot::TRUTH_GIMBAL_AZIMUTH, truth.gimbal_rad[0]);
    values.set_real(slot::TRUTH_GIMBAL_ROLL, truth.gimbal_rad[1]);
}

/// Writes the receipts of the faults; `places`: their indices among the parameters.
pub(super) fn put_receipts(station: &Station, places: &[usize], values: &mut CellValues) {
    for (fault, place) in places.iter().enumerate().filter(|(_, place)| **place < FAULT_SLOTS) {
        let Some(progress) = station.progress(fault) else { continue };
        let base = place * slot::RECEIPT_STRIDE;
        values.set_boolean(slot::FAULT_ARMED + base, true);
        values.set_boolean(slot::FAULT_ACTIVE + base, progress.active);
        values.set_boolean(slot::FAULT_FIRED + base, progress.samples_altered > 0);
        values.set_count(slot::FAULT_ALTERED + base, progress.samples_altered);
    }
}
