//! Do the gimbals stand where they were sent?

use super::Core;
use octant_sample::{GimbalCommand, Health, Mode, Sample, Status};

/// Difference of encoder and set point in a dwell that is called a disagreement, counts (0.5°).
const GIMBAL_TOLERANCE: i32 = (0.5 * core::f64::consts::PI / 180.0 * (1u64 << 27) as f64) as i32;

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
        let off = |reading: i32, target: i32| {
            (i64::from(reading) - i64::from(target)).unsigned_abs() > GIMBAL_TOLERANCE as u64
        };
        if off(sample.gimbal.azimuth, target.azimuth) || off(sample.gimbal.roll, target.roll) {
            *health |= Health::GIMBAL_DISAGREES;
            self.gimbal_disagreements += 1;
        }
    }
}
