//! Probability that a run passes, estimated from runs that passed and failed.

use serde::{Deserialize, Serialize};
use statrs::distribution::{Beta, ContinuousCDF};

/// Largest number of runs that is considered.
const RUNS_MAX: u64 = 10_000_000;

/// Lower bound of the probability of success after `failures` in `runs`, with one-sided
/// `confidence` (Clopper and Pearson, Biometrika 26, 1934). Zero failures in 59 runs show 95 % at 95 %.
#[must_use]
pub fn success_lower_bound(failures: u64, runs: u64, confidence: f64) -> f64 {
    let successes = runs.saturating_sub(failures);
    if successes == 0 {
        return 0.0;
    }
    let (a, b) = (successes as f64, (runs - successes + 1) as f64);
    Beta::new(a, b).map_or(0.0, |beta| beta.inverse_cdf(1.0 - confidence))
}

/// Upper bound of the probability of success, one-sided like [`success_lower_bound`].
#[must_use]
pub fn success_upper_bound(failures: u64, runs: u64, confidence: f64) -> f64 {
    1.0 - success_lower_bound(runs.saturating_sub(failures), runs, confidence)
}

/// Required probability: runs pass with at least this probability, shown with this one-sided
/// confidence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Demand {
    /// Probability, above 0 and below 1.
    pub pass: f64,
    /// Confidence, above 0 and below 1.
    pub confidence: f64,
}

impl Demand {
    fn sane(self) -> bool {
        let inside = |p: f64| p > 0.0 && p < 1.0;
        inside(self.pass) && inside(self.confidence)
    }

    /// True if this many failures in this many runs show that the demand is met.
    #[must_use]
    pub fn is_shown(self, failures: u64, runs: u64) -> bool {
        self.sane() && success_lower_bound(failures, runs, self.confidence) >= self.pass
    }

    /// True if this many failures in this many runs show that the demand isn't met.
    #[must_use]
    pub fn is_refuted(self, failures: u64, runs: u64) -> bool {
        self.sane() && runs > 0 && success_upper_bound(failures, runs, self.confidence) < self.pass
    }
}

/// Smallest number of runs, at least `runs` and at most [`RUNS_MAX`], for which `shown` is true; it must
/// stay true with more runs.
fn first(runs: u64, shown: impl Fn(u64) -> bool) -> Option<u64> {
    let mut high = runs.max(1);
    while !shown(high) {
        high = high.checked_mul(2).filter(|n| *n <= RUNS_MAX)?;
    }
    let mut low = runs.max(1);
    while low < high {
        let middle = low + (high - low) / 2;
        if shown(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    Some(high)
}

pub(crate) fn further(runs: u64, shown: impl Fn(u64) -> bool) -> Needed {
    first(runs, shown).map_or(Needed::CannotBeMet, |all| Needed::Runs(all - runs))
}

/// Number of further runs needed to show a demand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Needed {
    /// This many further runs; 0: the demand is already shown.
    Runs(u64),
    /// No number of runs: at this rate the demand isn't met, or would take more than ten million runs.
    CannotBeMet,
}

/// Number of further runs that show the demand if all of them pass.
#[must_use]
pub fn further_if_all_pass(demand: Demand, failures: u64, runs: u64) -> Needed {
    if failures > runs {
        return Needed::CannotBeMet;
    }
    further(runs, |n| demand.is_shown(failures, n))
}

/// Number of further runs that show the demand if runs continue to fail at the rate so far.
///
/// This is a forecast: the bound of Clopper and Pearson is used with the real number rate · n as the
/// number of failures among n runs. If the rate itself doesn't meet the demand, no number of runs is
/// enough.
#[must_use]
pub fn further_at_rate(demand: Demand, failures: u64, runs: u64) -> Needed {
    if demand.is_shown(failures, runs) {
        return Needed::Runs(0);
    }
    if failures == 0 {
        return further_if_all_pass(demand, 0, runs);
    }
    let rate = failures as f64 / runs.max(1) as f64;
    if !demand.sane() || failures >= runs || 1.0 - rate <= demand.pass {
        return Needed::CannotBeMet;
    }
    further(runs, |n| {
        let (n, failed) = (n as f64, rate * n as f64);
        Beta::new(n - failed, failed + 1.0)
            .is_ok_and(|beta| beta.inverse_cdf(1.0 - demand.confidence) >= demand.pass)
    })
}
