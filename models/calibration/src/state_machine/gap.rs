//! Missing samples.

use super::Core;
use super::estimation::Estimation;
use crate::config::Base;
use octant_sample::{Mode, Sample};

/// Missing samples over which the last increments are held; the rest of a longer gap is lost.
const HOLD_MAX_SAMPLES: u64 = 400;
/// Longest hold with bridging on a base that moves, s: see [`crate::screen`].
const HOLD_MOVING_S: f64 = 0.1;

impl Core {
    /// Bridges the missing samples before this one: by the known motion, else by holding the last
    /// increments, up to a bound: an unbounded hold makes a fault at the start of a move worse.
    #[cold]
    pub(super) fn bridge(&mut self, missing: u64, sample: &Sample) {
        if !self.bridge_known(missing, sample) {
            self.hold_last(missing);
        }
        // The clock of the procedure goes on, as does the turntable.
        self.tick = self.tick.saturating_add(missing);
        self.disturbed_tick = self.tick;
    }

    fn hold_last(&mut self, missing: u64) {
        let [x, y, z, u, v, w] = *self.screen.last();
        let integrates = match self.mode {
            Mode::Navigating => true,
            Mode::Calibrating => matches!(self.estimation, Estimation::Kalman(_)),
            _ => false,
        };
        if !integrates {
            return;
        }
        let screening = &self.config.screening;
        let hold = if screening.bridging && screening.base != Base::Still {
            super::ticks(HOLD_MOVING_S, self.sample_s)
        } else {
            HOLD_MAX_SAMPLES
        };
        for _ in 0..missing.min(hold) {
            self.integrate(self.sample_s, x, y, z, u, v, w);
        }
        self.doubt_gap(missing);
    }
}
