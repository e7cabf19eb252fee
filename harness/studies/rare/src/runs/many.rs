//! Runs points of a scenario, on several threads, with the journal.

use crate::estimators::estimate::RarePlan;
use crate::estimators::point::{RareBench, RarePoint, RareStage};
use crate::estimators::subset::beginning;
use crate::runs::error::RareError;
use crate::runs::input::RareInputs;
use crate::runs::journal::{PointDigest, RareIdentity, RareJournal, digest};
use crate::runs::outcome::{RareOutcome, RareSubject, outcome};
use octant_base::control::Control;
use octant_base::pool::in_order;
use octant_scenario::{Scenario, SourceSpec};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::atomic::Ordering;

/// Runs that are kept together: an interruption loses no more.
const TOGETHER: usize = 64;

/// Counts of the runs of a stage.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StageCounts {
    /// Runs.
    pub runs: usize,
    /// Runs that were judged.
    pub judged: usize,
    /// Runs that refused their calibration.
    pub refused: usize,
    /// Runs that ended without the measure.
    pub unpublished: usize,
    /// Runs with a report of the core, where that counts.
    pub noticed: usize,
    /// Runs that broke down, or whose measure is not a number.
    pub broken: usize,
}

impl StageCounts {
    fn add(&mut self, outcome: &RareOutcome) {
        self.runs += 1;
        let count = match outcome {
            RareOutcome::Judged(..) | RareOutcome::Published(_) => &mut self.judged,
            RareOutcome::Noticed(_) => &mut self.noticed,
            RareOutcome::Refused(_) => &mut self.refused,
            RareOutcome::Unpublished(_) => &mut self.unpublished,
            RareOutcome::Broken(_) => &mut self.broken,
        };
        *count += 1;
    }

    /// Runs that gave no measure for a reason of their own: a refusal, or none published.
    #[must_use]
    pub fn silent(&self) -> usize {
        self.refused + self.unpublished
    }
}

/// How the severity of a run is found.
#[derive(Clone, Debug, PartialEq)]
pub enum SeverityOf {
    /// Margin of the requirement; true if a run without a measure counts as a failure.
    Margin(bool),
    /// Magnitude of the error of a parameter.
    Error(String),
}

/// The runs of a scenario.
pub struct RareRuns<'a> {
    scenario: &'a Scenario,
    inputs: RareInputs,
    subject: RareSubject,
    severity: SeverityOf,
    jobs: usize,
    control: &'a Control,
    known: HashMap<PointDigest, RareOutcome>,
    journal: Option<RareJournal>,
    /// Points that were counted.
    seen: HashMap<PointDigest, RareStage>,
    counts: BTreeMap<RareStage, StageCounts>,
    reasons: BTreeMap<String, usize>,
    tell: &'a (dyn Fn() + Sync),
}

impl std::fmt::Debug for RareRuns<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RareRuns").field("subject", &self.subject).finish_non_exhaustive()
    }
}

impl<'a> RareRuns<'a> {
    /// Makes ready to run a scenario, `jobs` at a time. `tell` is called after each run.
    ///
    /// # Errors
    /// If its runs can't be repeated with other draws.
    pub fn new(
        scenario: &'a Scenario,
        subject: RareSubject,
        severity: SeverityOf,
        jobs: usize,
        control: &'a Control,
        tell: &'a (dyn Fn() + Sync),
    ) -> Result<Self, RareError> {
        if !matches!(scenario.source, SourceSpec::Plant) || !scenario.endpoint.is_in_process() {
            return Err(RareError::NotSimulated);
        }
        if scenario.realtime.by_clock {
            return Err(RareError::ByClock);
        }
        if let Some(step) = scenario.operator.first() {
            return Err(RareError::Attended(step.id.clone()));
        }
        if subject == RareSubject::Calibration && scenario.calibration.is_none() {
            return Err(RareError::NoCalibration);
        }
        Ok(Self {
            scenario,
            inputs: RareInputs::of(scenario),
            subject,
            severity,
            jobs,
            control,
            known: HashMap::new(),
            journal: None,
            seen: HashMap::new(),
            counts: BTreeMap::new(),
            reasons: BTreeMap::new(),
            tell,
        })
    }

    /// Takes over the runs of a journal, and keeps further ones there.
    ///
    /// # Errors
    /// As [`RareJournal`] has them.
    pub fn resume(&mut self, path: &Path, identity: &RareIdentity) -> Result<(), RareError> {
        self.journal = Some(RareJournal::open(path, identity, &mut self.known)?);
        Ok(())
    }

    /// Looks at another parameter.
    pub fn look_at(&mut self, severity: SeverityOf) {
        self.severity = severity;
    }

    /// The random inputs.
    #[must_use]
    pub fn inputs(&self) -> &RareInputs {
        &self.inputs
    }

    /// Counts of each stage.
    #[must_use]
    pub fn counts(&self) -> &BTreeMap<RareStage, StageCounts> {
        &self.counts
    }

    /// Why runs gave no measure, with how many there were.
    #[must_use]
    pub fn reasons(&self) -> &BTreeMap<String, usize> {
        &self.reasons
    }

    /// True if a calibration publishes a parameter: by the plain runs that every estimate of the plan begins with. If
    /// none of them publishes anything, it may.
    ///
    /// # Errors
    /// If the end was asked for.
    pub fn publishes(&mut self, name: &str, plan: &RarePlan) -> Result<bool, RareError> {
        let points = beginning(self.inputs.len(), &plan.subset(0));
        self.severities(&points, RareStage::Plain)?;
        let mut published = points.iter().filter_map(|point| match self.outcome_of(point) {
            Some(RareOutcome::Published(parameters)) => Some(parameters.contains_key(name)),
            _ => None,
        });
        Ok(published.next().unwrap_or(true))
    }

    /// The scenario of a point.
    #[must_use]
    pub fn scenario_of(&self, point: &RarePoint) -> Scenario {
        self.inputs.scenario(self.scenario, point)
    }

    /// Outcome of a point that was run.
    #[must_use]
    pub fn outcome_of(&self, point: &RarePoint) -> Option<&RareOutcome> {
        self.known.get(&digest(point))
    }

    /// Runs a scenario as the points are run.
    ///
    /// # Errors
    /// If the end was asked for.
    pub fn again(&self, scenario: &Scenario) -> Result<RareOutcome, RareError> {
        outcome(scenario, &self.subject, self.control).ok_or(RareError::Cancelled)
    }

    fn run_new(&mut self, points: &[&RarePoint]) -> Result<(), RareError> {
        for points in points.chunks(TOGETHER) {
            let is_cancelled = || self.control.cancel.load(Ordering::Relaxed);
            let outcomes = in_order(self.jobs, points.len(), is_cancelled, |index| {
                let found = outcome(&self.scenario_of(points[index]), &self.subject, self.control);
                (self.tell)();
                Ok::<_, RareError>(found)
            })?;
            let outcomes: Option<Vec<RareOutcome>> = outcomes.into_iter().collect();
            let Some(outcomes) = outcomes else { return Err(RareError::Cancelled) };
            let digests = points.iter().map(|point| digest(point));
            let runs: Vec<(PointDigest, RareOutcome)> = digests.zip(outcomes).collect();
            if let Some(journal) = &mut self.journal {
                journal.keep(&runs)?;
            }
            self.known.extend(runs);
        }
        Ok(())
    }

    fn severity(&self, outcome: Option<&RareOutcome>) -> f64 {
        match (outcome, &self.severity) {
            // A value on its limit that isn't kept has no margin, and fails.
            (Some(RareOutcome::Judged(margin, false)), _) => (-margin).max(f64::MIN_POSITIVE),
            (Some(RareOutcome::Judged(margin, true)), _) => (-margin).min(0.0),
            (
                Some(RareOutcome::Refused(_) | RareOutcome::Unpublished(_)),
                SeverityOf::Margin(true),
            ) => f64::MAX,
            (Some(RareOutcome::Published(parameters)), SeverityOf::Error(name)) => {
                parameters.get(name).map_or(f64::NEG_INFINITY, |[error, _]| error.abs())
            }
            _ => f64::NEG_INFINITY,
        }
    }
}

impl RareBench for RareRuns<'_> {
    type Error = RareError;

    fn dimension(&self) -> usize {
        self.inputs.len()
    }

    fn severities(
        &mut self,
        points: &[RarePoint],
        stage: RareStage,
    ) -> Result<Vec<f64>, RareError> {
        let new: Vec<&RarePoint> =
            points.iter().filter(|point| !self.known.contains_key(&digest(point))).collect();
        self.run_new(&new)?;
        let mut severities = Vec::with_capacity(points.len());
        for point in points {
            let digest = digest(point);
            let outcome = self.known.get(&digest);
            severities.push(self.severity(outcome));
            if let (Some(outcome), None) = (outcome, self.seen.insert(digest, stage)) {
                self.counts.entry(stage).or_default().add(outcome);
                let reason = match outcome {
                    RareOutcome::Judged(..) | RareOutcome::Published(_) => continue,
                    RareOutcome::Noticed(reason) => format!("noticed: {reason}"),
                    RareOutcome::Refused(reason) => format!("refused: {reason}"),
                    RareOutcome::Unpublished(reason) => format!("without a measure: {reason}"),
                    RareOutcome::Broken(reason) => format!("broken: {reason}"),
                };
                *self.reasons.entry(reason).or_default() += 1;
            }
        }
        Ok(severities)
    }
}
