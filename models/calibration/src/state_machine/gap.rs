//! Missing samples.

use super::Core;
use super::estimation::Estimation;
use octant_sample::Mode;

/// Missing samples over which the last increments are held; what is longer is lost.
const HOLD_MAX_SAMPLES: u64 = 400;

impl Core {
    /// Bridges missing samples by holding the last increments, up to a bound: a hold without one
    /// makes a fault at the start of a move worse.
    #[cold]
    pub(super) fn bridge(&mut self, missing: u64) {
        let [x, y, z, u, v, w] = self.held;
        let integrates = match self.mode {
            Mode::Navigating => true,
            Mode::Calibrating => matches!(self.estimation, Estimation::Kalman(_)),
            _ => false,
        };
        if integrates {
            for _ in 0..missing.min(HOLD_MAX_SAMPLES) {
                self.integrate(self.sample_s, x, y, z, u, v, w);
            }
        }
        // The clock of the procedure goes on: the turntable does too.
        self.tick = self.tick.saturating_add(missing);
    }
}
