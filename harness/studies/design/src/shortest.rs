//! The shortest calibration that keeps a measure.

use crate::bound::bound;
use crate::search::{Found, SearchEffort, SearchError, SearchProblem, SearchState};
use crate::setup::DesignError;

/// Durations are found to within this time, s.
pub const STEP_S: f64 = 300.0;

/// Result of the search for the shortest calibration.
#[derive(Clone, Debug)]
pub struct Shortest {
    /// Its duration, s.
    pub duration_s: f64,
    /// Its sequence.
    pub found: Found,
    /// Shortest duration, of whole steps of [`STEP_S`], at which the bound is as low as the measure: no
    /// sequence whatever is shorter by a step.
    pub bound_s: f64,
}

impl SearchProblem {
    /// Searches for the shortest duration, in whole steps of [`STEP_S`], that keeps the measure at or below
    /// `target`; `None` if the problem's own duration doesn't.
    ///
    /// Durations are halved between the one at which the bound allows it and the problem's own.
    /// `after_round` is called as by [`SearchProblem::search`], with the duration, s.
    ///
    /// # Errors
    /// As [`SearchProblem::search`].
    pub fn shortest(
        &self,
        target: f64,
        effort: SearchEffort,
        jobs: usize,
        after_round: &mut dyn FnMut(f64, &SearchState, usize, f64) -> bool,
    ) -> Result<Option<Shortest>, SearchError> {
        let judge = self.judge();
        let allowed = |steps: u32| -> Result<bool, SearchError> {
            let bound = bound(&judge, f64::from(steps) * STEP_S).map_err(DesignError::from)?;
            Ok(bound.value <= target)
        };
        let all = libm::floor(self.duration_s / STEP_S + 1e-9) as u32;
        if all == 0 || !allowed(all)? {
            return Ok(None);
        }
        let (mut below, mut above) = (0, all);
        while above - below > 1 {
            let middle = below + (above - below) / 2;
            if allowed(middle)? { above = middle } else { below = middle }
        }
        let bound_steps = above;
        let mut try_steps = |steps: u32| -> Result<Option<Found>, SearchError> {
            let duration_s = f64::from(steps) * STEP_S;
            let problem = Self { duration_s, ..self.clone() };
            let mut told = |state: &SearchState, rounds: usize, best: f64| {
                after_round(duration_s, state, rounds, best)
            };
            match problem.search(effort, jobs, None, &mut told) {
                Ok(found) => Ok(Some(found).filter(|found| found.score <= target)),
                Err(SearchError::NothingFits { .. }) => Ok(None),
                Err(error) => Err(error),
            }
        };
        let Some(mut found) = try_steps(all)? else { return Ok(None) };
        let (mut short, mut long) = (bound_steps - 1, all);
        while long - short > 1 {
            let middle = short + (long - short) / 2;
            match try_steps(middle)? {
                Some(better) => (long, found) = (middle, better),
                None => short = middle,
            }
        }
        Ok(Some(Shortest {
            duration_s: f64::from(long) * STEP_S,
            found,
            bound_s: f64::from(bound_steps) * STEP_S,
        }))
    }
}
