//! Checks of the gimbals: encoders against the set point, and gyros against encoders.

use super::{Core, kalman_of};
use crate::config::Base;
use crate::covariance::PHI;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use octant_earth::rotation::log;
use octant_sample::parameters::ParameterGroup;
use octant_sample::{GimbalAngles, GimbalCommand, Health, Mode, Sample, Status};

/// Standard deviations of the difference between a turn by gyros and by encoders above which it is
/// a slip. Every second is compared: 2e-9 × 1e5 in 28 h for each axis.
const SLIP_SIGMAS: f64 = 6.0;

/// `q_cb` of gimbal angles: `Rx(roll) · Rz(azimuth)`.
fn q_cb(gimbal: GimbalAngles) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::x_axis(), gimbal.roll_rad())
        * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), gimbal.azimuth_rad())
}

impl Core {
    #[inline]
    pub(super) fn compare_gimbals(
        &mut self,
        sample: &Sample,
        phase_tick: u64,
        health: &mut Health,
    ) {
        let Some(cursor) = &self.cursor else { return };
        if sample.status.contains(Status::GIMBAL_INVALID)
            || phase_tick < cursor.arrival_tick() + self.settle_ticks
            || self.mode == Mode::Refused
        {
            return;
        }
        // Between command and first motion there are two samples with the new set point.
        let GimbalCommand { target } = self.gimbals.command;
        let tolerance = self.gimbal_tolerance;
        let off = |reading: i32, target: i32| {
            (i64::from(reading) - i64::from(target)).unsigned_abs() > tolerance
        };
        if off(sample.gimbal.azimuth, target.azimuth) || off(sample.gimbal.roll, target.roll) {
            *health |= Health::GIMBAL_DISAGREES;
            self.gimbal_disagreements = self.gimbal_disagreements.saturating_add(1);
        }
    }

    /// Compares gyros with encoders. The case of a base at rest doesn't turn: the attitude without
    /// the encoder angles is the same at every standstill. An error of the gyros or of an encoder
    /// shows as a difference between two standstills, a second or a move apart.
    ///
    /// The limit allows for both readings' errors, the body axes' error against the gimbals (no
    /// better known than the gyros' misalignments before the calibration) over the turn, and the
    /// filter's possible corrections in between: its σ.
    #[cold]
    pub(super) fn compare_turns(&mut self, sample: &Sample, health: &mut Health) {
        let screening = &self.config.screening;
        if !screening.gimbals
            || screening.base != Base::Still
            || self.mode != Mode::Calibrating
            || self.gimbals_may_move()
            || sample.status.contains(Status::GIMBAL_INVALID)
        {
            return;
        }
        let (Some(filter), Some(kalman)) = (self.filter(), kalman_of(&self.config)) else { return };
        if filter.is_recovering() {
            self.slips.last = None;
            return;
        }
        let [w, i, j, k] = self.strapdown.navigation().q_nb;
        let q_nb = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
        let q_nc = q_nb * q_cb(sample.gimbal).inverse();
        if let Some((before, gimbal)) = self.slips.last {
            let turned = (q_cb(gimbal).inverse() * q_cb(sample.gimbal)).angle();
            let axes_rad = turned * kalman.prior.of(ParameterGroup::GyroMisalignment);
            let sigma = screening.encoder_sigma_rad;
            let attitude: f64 =
                (0..3).map(|axis| filter.covariance().at(PHI + axis, PHI + axis)).sum();
            let variance = 2.0 * sigma * sigma + axes_rad * axes_rad + attitude;
            let difference = log(&(before.inverse() * q_nc)).norm();
            if difference > SLIP_SIGMAS * libm::sqrt(variance) {
                *health |= Health::GIMBAL_SLIPPED;
                self.slips.count = self.slips.count.saturating_add(1);
            }
        }
        self.slips.last = Some((q_nc, sample.gimbal));
    }
}
