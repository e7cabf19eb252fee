//! Errors of the last navigation against the truth, and how quickly that changes.

use super::solution::{SolutionErrors, errors};
use octant_earth::ellipsoid::Ellipsoid;
use octant_endpoint::Tells;
use octant_sample::{Mode, Navigation, Output, Truth};
use octant_score::drift::{DriftSample, DriftScorer};
use octant_score::every_answer::{AnsweredSolution, StandingTruth};
use octant_score::run_series::SolutionSeries;

/// Drift of the last navigation; one before it doesn't count.
#[derive(Clone, Debug, Default)]
pub struct NavigationDrift {
    /// Device time at which the present navigation began.
    start_ns: Option<u64>,
    /// Device time of the last sample.
    scored_ns: Option<u64>,
    scorer: DriftScorer,
    /// Time between two samples of a solution that was made elsewhere, s.
    period_s: Option<f64>,
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
        let of_gaps = Self::of_gaps(self.period_s);
        *self = Self { start_ns: Some(now_ns), moved, ..of_gaps };
    }

    /// Creates one whose gaps are told, of samples that are this time apart, s; `None`: gaps aren't told.
    pub(super) fn of_gaps(period_s: Option<f64>) -> Self {
        let scorer = period_s.map_or_else(DriftScorer::new, DriftScorer::with_gaps);
        Self { period_s, scorer, ..Self::default() }
    }

    /// Takes the truth at an answer with the errors of its solution; returns the sample, if it counts.
    ///
    /// A drift is a function of time: stamps that a fault puts before the last scored one are left out, as are those of
    /// a restarted core.
    pub(super) fn truth(
        &mut self,
        output: &Output,
        truth: &Truth,
        solution: &SolutionErrors,
    ) -> Option<DriftSample> {
        let SolutionErrors { position_error_rad, attitude_error, velocity_error_mps } = *solution;
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
        // Where positions aren't compared, the unit stands where it says.
        let (latitude_rad, height_m) = if truth.latitude_rad.is_finite() {
            (truth.latitude_rad, truth.height_m)
        } else {
            (output.navigation.latitude_rad, output.navigation.height_m)
        };
        let sample = DriftSample {
            t_s: (now_ns - start_ns) as f64 * 1e-9,
            position_error_rad,
            attitude_error,
            velocity_error_mps,
            latitude_rad,
            height_m,
        };
        self.solution.push(sample.t_s / 3600.0, errors(attitude_error, velocity_error_mps));
        self.scorer.push(&sample);
        Some(sample)
    }

    /// Takes the truth at an answer, with which those after it are compared as long as it stands.
    pub(super) fn stand(&mut self, tells: Tells, truth: &Truth) {
        if self.start_ns.is_some() {
            self.scorer.stand(Some(standing(tells, truth)));
        }
    }

    /// Returns whether the truth is that at the answer before.
    pub(super) fn is_at(&self, tells: Tells, truth: &Truth) -> bool {
        self.scorer.stands_at(&standing(tells, truth))
    }

    /// Forgets the truth at the answer before: an epoch that isn't compared lies between.
    #[inline]
    pub(super) fn lost(&mut self) {
        if self.scorer.has_truth() {
            self.scorer.stand(None);
        }
    }

    /// Takes an answer between two that are scored in full, at the truth of the answer before; false if there is none.
    #[inline(always)]
    pub(super) fn between(&mut self, output: &Output) -> bool {
        let Some(start_ns) = self.start_ns.filter(|_| self.scorer.has_truth()) else {
            return false;
        };
        let since_ns = output.device_time.ns.saturating_sub(start_ns);
        self.scorer.between(since_ns, &answered(output));
        true
    }

    /// Returns whether an answer between two that are scored in full is to be compared with its truth, which moves.
    #[inline(always)]
    pub(super) fn strays(&mut self, output: &Output) -> bool {
        self.start_ns.is_some() && self.scorer.strays(&answered(output))
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

/// Truth with which answers are compared.
fn standing(tells: Tells, truth: &Truth) -> StandingTruth {
    let told = |tells: bool, value: f64| if tells { value } else { f64::NAN };
    let [north, east, _] = truth.velocity_mps;
    let right = AnsweredSolution {
        latitude_rad: truth.latitude_rad,
        longitude_rad: truth.longitude_rad,
        velocity_mps: [north, east].map(|value| told(tells.velocity, value)),
        q_nb: truth.q_nb.map(|value| told(tells.attitude, value)),
    };
    StandingTruth::new(&right, truth.height_m, truth.gimbal_rad)
}

/// Solution of an answer.
#[inline(always)]
fn answered(output: &Output) -> AnsweredSolution {
    let Navigation { latitude_rad, longitude_rad, velocity_mps: [north, east, _], q_nb, .. } =
        output.navigation;
    AnsweredSolution { latitude_rad, longitude_rad, velocity_mps: [north, east], q_nb }
}

/// Largest changes of the truth so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrueMotion {
    last: Option<(u64, Truth)>,
    rates: [f64; 3],
}

impl TrueMotion {
    /// Takes the truth at a time, ns.
    pub(super) fn push(&mut self, now_ns: u64, truth: &Truth) {
        let last = self.last.replace((now_ns, *truth));
        let Some((before_ns, before)) = last.filter(|(before_ns, _)| *before_ns < now_ns) else {
            return;
        };
        let elapsed_s = (now_ns - before_ns) as f64 * 1e-9;
        let earth = Ellipsoid::at(before.latitude_rad, before.height_m);
        let across_m = earth.transverse_radius_m * earth.cos_latitude;
        let north_m = (truth.latitude_rad - before.latitude_rad) * earth.meridian_radius_m;
        let east_m = (truth.longitude_rad - before.longitude_rad) * across_m;
        let change = |axis: usize| truth.velocity_mps[axis] - before.velocity_mps[axis];
        // The chord of unit quaternions is 2 sin(angle / 4), the shorter way round.
        let chord = |sign: f64| -> f64 {
            let parts = before.q_nb.iter().zip(&truth.q_nb);
            libm::sqrt(parts.map(|(a, b)| (a - sign * b) * (a - sign * b)).sum::<f64>())
        };
        let turned_rad = 4.0 * libm::asin((0.5 * chord(1.0).min(chord(-1.0))).min(1.0));
        let changes = [libm::hypot(north_m, east_m), libm::hypot(change(0), change(1)), turned_rad];
        for (most, change) in self.rates.iter_mut().zip(changes) {
            // NaN: the source doesn't tell it.
            *most = most.max(change / elapsed_s);
        }
    }

    /// Largest speed, acceleration and turning rate of the body so far: m/s, m/s², rad/s. Between two
    /// comparisons, normally a second, they are means.
    #[must_use]
    pub fn rates(&self) -> [f64; 3] {
        self.rates
    }
}
