//! All measures of a heading test, as the summary of a run has them.

use crate::motion::{dynamic_error, error_after_deg};
use crate::reading::Series;
use crate::repeatability::greatest_difference_deg;
use crate::settle::{SettlePoint, settle_point, settling};
use serde::{Deserialize, Serialize};

/// A heading test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeadingTest {
    /// Settling and settle point at rest.
    Settle,
    /// Settling and settle point while the table moves, and settle point after it stopped.
    SettleInMotion,
    /// Heading after a motion of the table.
    Scorsby,
    /// Error while the table moves.
    Dynamic,
}

impl HeadingTest {
    /// Name, as in scenarios.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Settle => "settle",
            Self::SettleInMotion => "settle-in-motion",
            Self::Scorsby => "scorsby",
            Self::Dynamic => "dynamic",
        }
    }
}

/// Plan of a heading test: times in s since the unit was switched on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingPlan {
    /// The test.
    pub test: HeadingTest,
    /// Time for which the unit stays switched on in each run-up.
    pub run_up_s: f64,
    /// Number of run-ups.
    pub run_ups: usize,
    /// Beginning and end of the table's motion in each run-up, where it moves.
    pub motion_s: Option<[f64; 2]>,
    /// Resolution of the headings that are read, deg; 0: exact.
    pub resolution_deg: f64,
    /// Latitude of the site, deg.
    pub latitude_deg: f64,
}

/// Results of a heading test. A value that the record doesn't give is null.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeadingScore {
    /// The test.
    pub test: HeadingTest,
    /// Latitude of the site, deg: limits with the factor sec φ are taken for it.
    pub latitude_deg: f64,
    /// Resolution of the headings that were read, deg.
    pub resolution_deg: f64,
    /// Longest settling time of the run-ups, min; where one isn't settled the earliest time at which it could be.
    pub settling_time_min: Option<f64>,
    /// True if every run-up settled.
    pub settled: bool,
    /// Settle point heading of the first run-up, deg.
    pub settle_point_heading_deg: Option<f64>,
    /// Settle point error of the run-up in which it is largest, deg.
    pub settle_point_error_deg: Option<f64>,
    /// Largest root mean square of the ten readings about their mean, deg.
    pub readings_rms_deg: Option<f64>,
    /// Greatest difference of the settle points of any two run-ups, deg.
    pub repeatability_deg: Option<f64>,
    /// The same while the table moves.
    pub in_motion: Option<SettledScore>,
    /// Settle point after the table stopped.
    pub after_motion: Option<PointScore>,
    /// Error after the table's motion, against the settle point, of the run-up in which it is largest, deg.
    pub scorsby_error_deg: Option<f64>,
    /// Largest magnitude of the error while the table moves, against the settle point, deg.
    pub dynamic_amplitude_deg: Option<f64>,
    /// Frequency of that error's largest component where the amplitude is above 0.5°, Hz; else 0.
    pub dynamic_frequency_hz: Option<f64>,
    /// The run-ups, in their order.
    pub run_ups: Vec<RunUpScore>,
}

/// Settling and settle point over the run-ups, on a table that moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SettledScore {
    /// Longest settling time, min; where a run-up isn't settled the earliest time at which it could be.
    pub settling_time_min: Option<f64>,
    /// True if every run-up settled.
    pub settled: bool,
    /// Largest settle point error, deg.
    pub settle_point_error_deg: Option<f64>,
    /// Largest root mean square of the ten readings about their mean, deg.
    pub readings_rms_deg: Option<f64>,
    /// Greatest difference of the settle points of any two run-ups, deg.
    pub repeatability_deg: Option<f64>,
}

/// Settle point over the run-ups.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointScore {
    /// Largest settle point error, deg.
    pub settle_point_error_deg: Option<f64>,
    /// Greatest difference of the settle points of any two run-ups, deg.
    pub repeatability_deg: Option<f64>,
}

/// Results of one run-up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunUpScore {
    /// Settling time, min; of a unit that isn't settled the earliest time at which it could be.
    pub settling_time_min: Option<f64>,
    /// True if it settled.
    pub settled: bool,
    /// Settle point.
    pub settle_point: Option<SettlePoint>,
    /// Settle point after the table stopped.
    pub after_motion: Option<SettlePoint>,
    /// Error after the table's motion, deg.
    pub scorsby_error_deg: Option<f64>,
    /// Largest magnitude of the error while the table moves, deg.
    pub dynamic_amplitude_deg: Option<f64>,
    /// Frequency of that error's largest component, Hz.
    pub dynamic_frequency_hz: Option<f64>,
}

impl RunUpScore {
    /// Scores one run-up.
    fn of(plan: &HeadingPlan, series: &Series) -> Self {
        let all_s = plan.run_up_s;
        let [from_s, to_s] = plan.motion_s.unwrap_or([all_s; 2]);
        // On a table that moves from the start the readings are taken in its motion, else before it.
        let until_s = if plan.test == HeadingTest::SettleInMotion { to_s } else { from_s };
        let settling = settling(series, until_s.min(all_s));
        let settled = settling.filter(|settling| settling.settled);
        let point = settled.and_then(|settled| settle_point(series, settled.time_s, until_s));
        let mut score = Self {
            settling_time_min: settling.map(|settling| settling.time_s / 60.0),
            settled: settled.is_some(),
            settle_point: point,
            ..Self::default()
        };
        let settle_error_deg = point.and_then(|point| point.error_deg);
        match (plan.test, settle_error_deg) {
            (HeadingTest::SettleInMotion, _) if to_s < all_s => {
                score.after_motion = settle_point(series, to_s, all_s);
            }
            (HeadingTest::Scorsby, Some(error_deg)) => {
                score.scorsby_error_deg = error_after_deg(series, error_deg, to_s);
            }
            (HeadingTest::Dynamic, Some(error_deg)) => {
                let found = dynamic_error(series, error_deg, from_s, to_s);
                score.dynamic_amplitude_deg = found.map(|found| found.amplitude_deg);
                score.dynamic_frequency_hz = found.map(|found| found.frequency_hz);
            }
            _ => {}
        }
        score
    }
}

/// Value of all run-ups with the largest magnitude; `None` if one run-up has none.
fn worst(run_ups: &[RunUpScore], value: impl Fn(&RunUpScore) -> Option<f64>) -> Option<f64> {
    let values: Option<Vec<f64>> = run_ups.iter().map(value).collect();
    values?.into_iter().reduce(|worst, next| if next.abs() > worst.abs() { next } else { worst })
}

impl HeadingScore {
    /// Scores the run-ups of a test. A run-up of the plan that isn't among them leaves all values null.
    #[must_use]
    pub fn of(plan: &HeadingPlan, series: &[Series]) -> Self {
        let mut run_ups: Vec<_> = series.iter().map(|one| RunUpScore::of(plan, one)).collect();
        if run_ups.len() < plan.run_ups {
            run_ups.resize(plan.run_ups, RunUpScore::default());
        }
        let all = &run_ups[..];
        let points = |of: fn(&RunUpScore) -> Option<SettlePoint>| {
            greatest_difference_deg(&all.iter().map(of).collect::<Vec<_>>())
        };
        let settled = SettledScore {
            settling_time_min: worst(all, |one| one.settling_time_min),
            settled: all.iter().all(|one| one.settled),
            settle_point_error_deg: worst(all, |one| one.settle_point?.error_deg),
            readings_rms_deg: worst(all, |one| Some(one.settle_point?.readings_rms_deg)),
            repeatability_deg: points(|one| one.settle_point),
        };
        let after = PointScore {
            settle_point_error_deg: worst(all, |one| one.after_motion?.error_deg),
            repeatability_deg: points(|one| one.after_motion),
        };
        let moves = plan.test == HeadingTest::SettleInMotion;
        let at_rest = if moves { SettledScore::default() } else { settled };
        let first = all.first().filter(|_| !moves).and_then(|first| first.settle_point);
        Self {
            test: plan.test,
            latitude_deg: plan.latitude_deg,
            resolution_deg: plan.resolution_deg,
            settling_time_min: at_rest.settling_time_min,
            settled: at_rest.settled,
            settle_point_heading_deg: first.map(|point| point.heading_deg),
            settle_point_error_deg: at_rest.settle_point_error_deg,
            readings_rms_deg: at_rest.readings_rms_deg,
            repeatability_deg: at_rest.repeatability_deg,
            in_motion: moves.then_some(settled),
            after_motion: moves.then_some(after),
            scorsby_error_deg: worst(all, |one| one.scorsby_error_deg),
            dynamic_amplitude_deg: worst(all, |one| one.dynamic_amplitude_deg),
            dynamic_frequency_hz: worst(all, |one| one.dynamic_frequency_hz),
            run_ups,
        }
    }

    /// Returns whether a true heading was known: without it nothing has an error, and what is left is scatter, settling and
    /// repeatability.
    #[must_use]
    pub fn knows_truth(&self) -> bool {
        let points = self.run_ups.iter().flat_map(|one| [one.settle_point, one.after_motion]);
        points.flatten().all(|point| point.error_deg.is_some())
    }

    /// Returns whether a measure (its path, without bars) is the settling time of a unit that isn't settled: a lower bound.
    #[must_use]
    pub fn is_unsettled(&self, measure: &str) -> bool {
        match measure {
            "heading.settling_time_min" => !self.settled,
            "heading.in_motion.settling_time_min" => !self.in_motion.is_some_and(|of| of.settled),
            _ => false,
        }
    }

    /// Largest error of a measure (its path, without bars) by the resolution of the headings that were read, in the unit of
    /// the measure: half a step for one heading or a mean of several, a step for a difference of two.
    #[must_use]
    pub fn resolution_error(&self, measure: &str) -> f64 {
        let steps = match measure.rsplit('.').next().unwrap_or(measure) {
            "settle_point_heading_deg" | "settle_point_error_deg" | "readings_rms_deg" => 0.5,
            "repeatability_deg" | "scorsby_error_deg" | "dynamic_amplitude_deg" => 1.0,
            _ => 0.0,
        };
        if measure.starts_with("heading.") { steps * self.resolution_deg } else { 0.0 }
    }
}
