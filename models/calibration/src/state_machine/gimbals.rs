//! Do the gimbals stand where they were sent, and do gyros and encoders show the same turns?

use super::{Core, kalman_of};
use crate::config::{Base, Screening};
use crate::covariance::PHI;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use octant_earth::rotation::log;
use octant_sample::counts::GIMBAL_LSB_RAD;
use octant_sample::parameters::Group;
use octant_sample::{GimbalAngles, GimbalCommand, Health, Mode, Sample, Status};

const DEG: f64 = core::f64::consts::PI / 180.0;

/// Difference of encoder and set point in a dwell that is called a disagreement, rad: coarsely, and
/// where the gimbals are checked: a servo comes to its set point, so a tenth of a degree, or what an
/// encoder of this σ shows once in 1e15 readings.
const COARSE_TOLERANCE_RAD: f64 = 0.5 * DEG;
const TOLERANCE_RAD: f64 = 0.1 * DEG;
const TOLERANCE_SIGMAS: f64 = 8.0;

/// Standard deviations of the difference of a turn by gyros and by encoders that is called a slip.
/// Every second is compared: 2e-9 × 1e5 in 28 h for each axis.
const SLIP_SIGMAS: f64 = 6.0;

/// Attitude of the case by the last comparison, with the encoders' angles of it.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Slips {
    last: Option<(UnitQuaternion<f64>, GimbalAngles)>,
    /// Slips so far.
    pub(super) count: u64,
}

/// Tolerance of encoder against set point, counts.
pub(super) fn tolerance_counts(screening: &Screening) -> u64 {
    let tolerance = if screening.gimbals {
        TOLERANCE_RAD.max(TOLERANCE_SIGMAS * screening.encoder_sigma_rad)
    } else {
        COARSE_TOLERANCE_RAD
    };
    (tolerance / GIMBAL_LSB_RAD) as u64
}

/// `q_cb` of gimbal angles: `Rx(roll) · Rz(azimuth)`.
fn q_cb(gimbal: GimbalAngles) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::x_axis(), gimbal.roll_rad())
        * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), gimbal.azimuth_rad())
}

impl Core {
    #[inline]
    pub(super) fn compare_gimbals(&mut self, sample: &Sample, health: &mut Health) {
        let Some(cursor) = &self.cursor else { return };
        if sample.status.contains(Status::GIMBAL_INVALID)
            || self.phase_tick() < cursor.arrival_tick() + self.settle_ticks
            || self.mode == Mode::Refused
        {
            return;
        }
        // Between command and first motion lie two samples in which the set point is already new.
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

    /// The case of a base that stands doesn't turn: attitude, with the encoders' angles taken back,
    /// is the same at every standstill. What the gyros missed, or an encoder, shows as a difference
    /// between two of them, a second or a move apart.
    ///
    /// Allowed are both readings' errors, the body axes' error against the gimbals (no better known
    /// than the gyros' misalignments before the calibration) over the turn, and what the filter may
    /// have corrected in between: its σ.
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
            let axes_rad = turned * kalman.prior.of(Group::GyroMisalignment);
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
