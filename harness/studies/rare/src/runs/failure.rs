//! The probability that a requirement fails.

use crate::estimators::estimate::{PlainCount, RareEstimate, RarePlan, estimate};
use crate::estimators::point::{RareSample, RareStage};
use crate::estimators::subset::{SubsetGoal, SubsetLevel};
use crate::runs::error::RareError;
use crate::runs::input::InputValue;
use crate::runs::many::{RareRuns, SeverityOf, StageCounts};
use crate::runs::outcome::RareOutcome;
use crate::runs::words;
use octant_base::names::suggestion;
use octant_base::number::{counted, fixed, plain, significant};
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{RequirementSpec, Scenario};
use octant_verdict::Verdict;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of `rare.json`.
pub const RARE_SCHEMA: u32 = 1;

/// A replicate of subset simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RareReplicate {
    /// Its own probability; null if it didn't reach a failure.
    pub probability: Option<f64>,
    /// Its levels, the first first.
    pub levels: Vec<SubsetLevel>,
}

/// A run that failed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailingRun {
    /// Margin to the limit, in the unit of the measure; null if it had no measure.
    pub margin: Option<f64>,
    /// Distance of the instrument from the mean of all draws, σ.
    pub radius_sigma: f64,
    /// Seed of the run.
    pub seed: u64,
    /// Drawn errors, those farthest from their mean first.
    pub values: Vec<InputValue>,
}

/// The probability that a requirement fails.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RareFailure {
    /// [`RARE_SCHEMA`].
    pub schema: u32,
    /// Version of the program.
    pub octant: String,
    /// Title of the scenario.
    pub scenario: String,
    /// Id of the requirement.
    pub requirement: String,
    /// Its measure.
    pub measure: String,
    /// Its comparison.
    pub comparison: String,
    /// Its limit, in the unit of the measure.
    pub limit: f64,
    /// True if a run without the measure counts as a failure.
    pub silent_fails: bool,
    /// Seed of the estimate.
    pub seed: u64,
    /// Drawn instrument errors: the components that the chains move.
    pub components: usize,
    /// Estimate of the probability; null if no weighted sample failed.
    pub probability: Option<f64>,
    /// Its interval; null as the estimate.
    pub interval: Option<[f64; 2]>,
    /// Confidence of the interval, two-sided.
    pub confidence: f64,
    /// Standard error of the estimate, as a share of it.
    pub relative_error: Option<f64>,
    /// Failures among the weighted samples.
    pub failures: usize,
    /// The same, as if their weights were equal.
    pub failures_effective: f64,
    /// True if the interval is taken for shown.
    pub shown: bool,
    /// Reasons why it is not.
    pub doubts: Vec<String>,
    /// Plain samples, with their failures.
    pub plain_runs: u64,
    /// Failures among them.
    pub plain_failures: u64,
    /// Interval of the probability by the plain samples alone, Clopper and Pearson.
    pub plain_interval: [f64; 2],
    /// Runs in all.
    pub runs: usize,
    /// Runs of each stage by their end.
    pub stages: BTreeMap<RareStage, StageCounts>,
    /// Reasons of the runs without a measure.
    pub reasons: BTreeMap<String, usize>,
    /// The subset simulations.
    pub replicates: Vec<RareReplicate>,
    /// The most probable failure that was met, by the instrument's errors.
    pub most_probable: Option<FailingRun>,
    /// Without a failure, the run that came nearest to one.
    pub nearest: Option<FailingRun>,
    /// Probability that was asked about.
    pub below: Option<f64>,
    /// Answer.
    pub verdict: Verdict,
}

/// The requirement of this id, or the only one.
///
/// # Errors
/// If there is none, or several.
pub fn requirement<'a>(
    scenario: &'a Scenario,
    id: Option<&str>,
) -> Result<&'a RequirementSpec, RareError> {
    let ids: Vec<&str> = scenario.requirements.iter().map(|r| r.check.id.as_str()).collect();
    match (id, scenario.requirements.as_slice()) {
        (_, []) => Err(RareError::NothingRequired),
        (None, [one]) => Ok(one),
        (None, several) => Err(RareError::Several(several.len(), ids.join(", "))),
        (Some(id), all) => {
            let expected = || suggestion(id, ids.iter().copied(), "requirements");
            all.iter().find(|r| r.check.id == id).ok_or_else(|| RareError::NoRequirement {
                found: id.to_owned(),
                expected: expected(),
            })
        }
    }
}

/// Estimates the probability that the requirement of the runs fails. With it comes the scenario of the most probable
/// failure, as a file that gives it again.
///
/// # Errors
/// If it can't run, or the end was asked for.
pub fn failure(
    runs: &mut RareRuns<'_>,
    scenario: &Scenario,
    of: &RequirementSpec,
    plan: &RarePlan,
    (below, silent_fails): (Option<f64>, bool),
) -> Result<(RareFailure, Option<String>), RareError> {
    runs.look_at(SeverityOf::Margin(silent_fails));
    let found = estimate(runs, SubsetGoal::Above(0.0), plan)?;
    let failing = found.most_probable.as_ref();
    let file = failing.map(|sample| file_of(runs, scenario, sample)).transpose()?;
    let all = words::together(runs.counts());
    let mut doubts: Vec<String> = found.doubts.iter().map(words::doubt).collect();
    if all.broken > 0 {
        let were = counted(all.broken, "run", "runs");
        doubts.push(format!("{were} broke down, and may have failed"));
    }
    let mut out = RareFailure {
        schema: RARE_SCHEMA,
        octant: env!("CARGO_PKG_VERSION").to_owned(),
        scenario: scenario.title.clone(),
        requirement: of.check.id.clone(),
        measure: of.check.measure.clone(),
        comparison: of.check.comparison.sign().to_owned(),
        limit: of.check.limit,
        silent_fails,
        seed: plan.seed,
        components: runs.inputs().len(),
        probability: found.mean.map(|mean| mean.probability),
        interval: found.mean.map(|mean| mean.interval),
        confidence: plan.confidence,
        relative_error: found.mean.map(|mean| mean.error),
        failures: found.mean.map_or(0, |mean| mean.failures),
        failures_effective: found.mean.map_or(0.0, |mean| mean.effective),
        shown: found.mean.is_some() && doubts.is_empty(),
        doubts,
        plain_runs: found.plain.runs,
        plain_failures: found.plain.failures,
        plain_interval: found.plain.interval(0.5 + 0.5 * plan.confidence),
        runs: all.runs,
        stages: runs.counts().clone(),
        reasons: runs.reasons().clone(),
        replicates: replicates(&found),
        most_probable: failing.map(|sample| run_of(runs, sample)),
        nearest: found.worst.as_ref().filter(|_| failing.is_none()).map(|s| run_of(runs, s)),
        below,
        verdict: Verdict::None,
    };
    out.verdict = out.judged(found.plain, silent_fails || all.silent() == 0);
    Ok((out, file))
}

pub(crate) fn replicates(found: &RareEstimate) -> Vec<RareReplicate> {
    let of = found.found.iter().map(|found| RareReplicate {
        probability: found.probability,
        levels: found.levels.clone(),
    });
    of.collect()
}

fn run_of(runs: &RareRuns<'_>, sample: &RareSample) -> FailingRun {
    let margin = match runs.outcome_of(&sample.point) {
        Some(RareOutcome::Judged(margin, _)) => Some(*margin),
        _ => None,
    };
    FailingRun {
        margin,
        radius_sigma: sample.point.radius(),
        seed: sample.point.noise,
        values: runs.inputs().values(&sample.point),
    }
}

/// Writes the scenario of a sample with all that was drawn, reads it again, runs it, and compares.
fn file_of(
    runs: &RareRuns<'_>,
    scenario: &Scenario,
    sample: &RareSample,
) -> Result<String, RareError> {
    let at = runs.scenario_of(&sample.point);
    let seed = sample.point.noise;
    let text = at.to_resolved_toml(seed, &DrawnValues::of(&at, &Seeded(seed)));
    let differs = || RareError::Differs(format!("of seed {seed}"));
    let again =
        Scenario::parse(&text, "failing.toml", &scenario.folder, &[]).map_err(|_| differs())?;
    if Some(&runs.again(&again)?) != runs.outcome_of(&sample.point) {
        return Err(differs());
    }
    Ok(text)
}

impl RareFailure {
    /// The answer to the probability that was asked about. The interval of the plain samples is exact, and answers too.
    /// A pass needs a measure from every run, or runs without one counted as failures.
    fn judged(&self, plain: PlainCount, complete: bool) -> Verdict {
        let Some(below) = self.below else { return Verdict::None };
        let [plain_low, plain_high] = plain.interval(0.5 + 0.5 * self.confidence);
        let shown = self.interval.filter(|_| self.shown);
        let is_broken = self.stages.values().any(|stage| stage.broken > 0);
        if shown.is_some_and(|[low, _]| low > below) || plain_low > below {
            return Verdict::Fail;
        }
        let by_plain = shown.is_none() && plain_high <= below;
        let is_below = shown.is_some_and(|[_, high]| high <= below) || by_plain;
        if is_below && complete && !is_broken { Verdict::Pass } else { Verdict::Inconclusive }
    }

    /// Describes the result for a terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = format!(
            "{}: P({} fails), {} {} {}\n",
            self.scenario,
            self.requirement,
            self.measure,
            self.comparison,
            plain(self.limit, 6)
        );
        out += &self.estimate_text();
        out += &words::counts(&self.stages);
        for (reason, count) in self.reasons.iter().take(5) {
            out += &format!("    {count} × {reason}\n");
        }
        out += &self.chains_text();
        for doubt in &self.doubts {
            out += &format!("  not shown: {doubt}\n");
        }
        let silent = self.stages.values().map(StageCounts::silent).sum::<usize>();
        if silent > 0 && !self.silent_fails {
            out += &format!(
                "  {} counted apart: with --count-refused they are failures\n",
                counted(silent, "run without a measure is", "runs without a measure are")
            );
        }
        if let Some(run) = &self.most_probable {
            out += &format!("most probable failure met: {}", run_text(run));
        }
        if let Some(run) = &self.nearest {
            out += &format!("no failure was met; nearest to one: {}", run_text(run));
        }
        if let Some(below) = self.below {
            let below = significant(below, 3);
            out += &match self.verdict {
                Verdict::Pass => format!("shown to be at or below {below}\n"),
                Verdict::Fail => format!("shown to be above {below}\n"),
                _ => format!("not decided whether it is at or below {below}\n"),
            };
        }
        out
    }

    fn estimate_text(&self) -> String {
        let percent = fixed(100.0 * self.confidence, 0);
        let mut out = String::new();
        if let (Some(p), Some([low, high])) = (self.probability, self.interval) {
            let [p, low, high] = [p, low, high].map(|p| significant(p, 3));
            let what = if self.shown { "probability" } else { "indication, not shown:" };
            out += &format!("  {what} {p}, {percent} % interval {low} to {high}\n");
            out += &format!(
                "  {} among the weighted samples, as many as {} of equal weight\n",
                counted(self.failures, "failure", "failures"),
                fixed(self.failures_effective, 0)
            );
        }
        let [low, high] = self.plain_interval.map(|p| significant(p, 3));
        let of = counted(self.plain_runs, "plain run", "plain runs");
        out += &match self.plain_failures {
            0 => format!("  no failure in {of}: by these alone p < {high} ({percent} %)\n"),
            n => format!(
                "  {} in {of}: by these alone {low} to {high}\n",
                counted(n, "failure", "failures")
            ),
        };
        out
    }

    fn chains_text(&self) -> String {
        let of = |replicate: &RareReplicate| {
            let p = replicate.probability.map_or_else(|| "none".to_owned(), |p| significant(p, 2));
            let accepted = replicate.levels.iter().map(|l| l.accepted).fold(1.0, f64::min);
            let of_chains = if replicate.levels.is_empty() {
                "no chains".to_owned()
            } else {
                format!(
                    "{} levels, {} % accepted or more",
                    replicate.levels.len(),
                    fixed(100.0 * accepted, 0)
                )
            };
            format!("{p} ({of_chains})")
        };
        let all: Vec<String> = self.replicates.iter().map(of).collect();
        format!("  subset simulation: {}\n", all.join("; "))
    }
}

fn run_text(run: &FailingRun) -> String {
    let margin = run.margin.map_or_else(
        || "without a measure".to_owned(),
        |margin| format!("margin {}", significant(margin, 3)),
    );
    let mut out = format!(
        "{margin}, seed {}, {} σ from the mean instrument\n",
        run.seed,
        fixed(run.radius_sigma, 2)
    );
    for value in run.values.iter().take(4) {
        out += &format!(
            "  {} {} {} ({} σ)\n",
            value.name,
            significant(value.value, 4),
            value.unit,
            fixed(value.sigmas, 2)
        );
    }
    out
}
