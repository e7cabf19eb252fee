//! Errors of the last navigation against the truth.

use super::solution::errors;
use super::true_motion::TrueMotion;
use octant_sample::{Mode, Output, Truth};
use octant_score::attitude::CaseAngles;
use octant_score::drift::{DriftSample, DriftScorer};
use octant_score::run_series::SolutionSeries;

/// Drift of the last navigation; one before it doesn't count.
#[derive(Clone, Debug, Default)]
pub struct NavigationDrift {
    /// Device time at which the present navigation began.
    start_ns: Option<u64>,
    /// Device time of the last sample.
    scored_ns: Option<u64>,
    scorer: DriftScorer,
    samples: u64,
    /// Errors of attitude and velocity over the navigation.
    pub solution: SolutionSeries,
    /// Motion of the truth while the unit navigates.
    pub moved: TrueMotion,
}

impl NavigationDrift {
    /// Begins with a navigation. A restarted core navigates anew: the last navigation is the one that is scored.
    #[cold]
    pub(super) fn begin(&mut self, now_ns: u64) {
        let moved = self.moved;
        *self = Self { start_ns: Some(now_ns), moved, ..Self::default() };
    }

    /// Takes the truth at an answer with the errors of its attitude and velocity; returns the sample, if it counts.
    ///
    /// A drift is a function of time: stamps that a fault puts before the last scored one are left out, as are those of
    /// a restarted core.
    pub(super) fn truth(
        &mut self,
        output: &Output,
        truth: &Truth,
        attitude_error: Option<CaseAngles>,
        velocity_error_mps: Option<[f64; 2]>,
    ) -> Option<DriftSample> {
        let (start_ns, now_ns) = (self.start_ns?, output.device_time.ns);
        if now_ns < start_ns
            || self.scored_ns.is_some_and(|scored_ns| now_ns <= scored_ns)
            || !matches!(output.mode, Mode::Navigating | Mode::Done)
        {
            return None;
        }
        self.scored_ns = Some(now_ns);
        self.moved.push(now_ns, truth);
        self.samples += 1;
        let sample = DriftSample {
            t_s: (now_ns - start_ns) as f64 * 1e-9,
            latitude_error_rad: output.navigation.latitude_rad - truth.latitude_rad,
            longitude_error_rad: output.navigation.longitude_rad - truth.longitude_rad,
            attitude_error,
            velocity_error_mps,
            latitude_rad: truth.latitude_rad,
            height_m: truth.height_m,
        };
        self.solution.push(sample.t_s / 3600.0, errors(attitude_error, velocity_error_mps));
        self.scorer.push(&sample);
        Some(sample)
    }

    /// Returns the drift so far; `None` without navigation or without truth.
    #[must_use]
    pub fn scored(&self) -> Option<&DriftScorer> {
        (self.samples >= 2).then_some(&self.scorer)
    }

    /// Returns the time at which the last navigation began, h; `None` without one.
    #[must_use]
    pub fn start_h(&self) -> Option<f64> {
        self.start_ns.map(|ns| ns as f64 / 3.6e12)
    }
}
