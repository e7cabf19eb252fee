//! Progress of a campaign, and its failures.

use super::case_states::{CaseState, checked, each_state};
use super::independence::{self, Shown};
pub use super::joint::JointStatement;
use super::looks::{JudgedDraws, LookState};
use super::stop::{self, StopDecision};
use crate::execute::case::ResultError;
use crate::plan::shard::Shard;
use crate::plan::{Case, Plan, StopRule};
use crate::store::CampaignResults;
use crate::store::stream_key::StreamKey;
use octant_account::Account;
use octant_base::number::plain;
use octant_base::pool::spawn;
use octant_score::numerics::differs;
use octant_statistics::cluster::{DrawCounts, RowResult};
use octant_statistics::proportion::Needed;
use octant_verdict::Verdict;
use octant_verdict::requirement::EnsembleRequirement;
use octant_verdict::trace::VerdictCounts;
use serde::Serialize;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// Maximum number of cases that are named.
const NAMED: usize = 10;

/// State of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CampaignStatus {
    /// Name of the campaign.
    pub title: String,
    /// Plan.
    pub plan: String,
    /// Cases.
    pub cases: usize,
    /// Cases without a result.
    pub open: usize,
    /// Independent draws among the cases, on which any bound is based.
    pub draws: usize,
    /// Cases with the same stream of samples: each group is one run, repeated.
    pub repeated: Vec<Vec<String>>,
    /// Factors without effect.
    pub idle_factors: Vec<String>,
    /// Cases by verdict.
    pub verdicts: BTreeMap<&'static str, usize>,
    /// Worst verdict of the cases except for their requirements: a case that ended as an error, a
    /// refused calibration, a fault that never fired, a case that checks nothing.
    pub besides: Verdict,
    /// Status of each requirement.
    pub requirements: BTreeMap<String, RequirementStatus>,
    /// Statement on all requirements together; null without one that asks for a probability.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<JointStatement>,
    /// Requirements that no run can verify.
    pub not_by_test: Vec<String>,
    /// Reasons in the accounts of the documents of requirements why no campaign on them passes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<String>,
    /// First cases that failed or ended as errors, with reasons.
    pub bad: Vec<Bad>,
    /// Cases with two results.
    pub differing: Vec<String>,
    /// Cases by other numerics versions, counted, with the meaning of the difference.
    pub numerics: Vec<String>,
    /// Reason why no more cases are run; null if all are.
    pub stopped: Option<String>,
    /// Looks at the results.
    pub looks: LookState,
}

/// Status of a requirement over the cases.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RequirementStatus {
    /// Overall verdict.
    pub verdict: Verdict,
    /// Reason, in plain words.
    pub reason: String,
    /// Checks.
    pub counts: VerdictCounts,
    /// Independent draws.
    pub draws: DrawCounts,
    /// Requirement on all cases together; null if every case must pass.
    pub ensemble: Option<EnsembleRequirement>,
    /// Further draws that suffice if all of them pass; null if nothing is required of them together. Unless the campaign
    /// is looked at openly they have to be those of a new plan, which shows it with as many failures.
    pub needed: Option<Needed>,
    /// Lower bound of the probability that a draw passes; null if nothing is required of the draws together.
    #[serde(skip)]
    pub bound: Option<f64>,
}

/// Case that isn't a pass.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Bad {
    /// The case.
    pub case: String,
    /// Verdict.
    pub verdict: Verdict,
    /// First reason.
    pub reason: String,
}

/// Error of a state that can't be determined, because a result can't be read.
#[derive(Debug, thiserror::Error)]
#[error("failed to {0}")]
pub struct StatusError(#[from] pub ResultError);

/// Determines the state of a part of the campaign in a folder.
///
/// # Errors
/// If an existing result can't be read.
pub fn of(plan: &Plan, folder: &Path, shard: Shard) -> Result<CampaignStatus, StatusError> {
    of_results(plan, &CampaignResults::open(folder)?, shard)
}

/// Determines the state of the campaign in a folder, with its plan. Its results are looked for while its plan is read.
///
/// # Errors
/// If the plan can't be read; the inner error: if an existing result can't be read.
pub fn of_folder<E>(
    folder: &Path,
    read_plan: impl FnOnce() -> Result<Plan, E>,
) -> Result<(Plan, Result<CampaignStatus, StatusError>), E> {
    let (plan, results) = std::thread::scope(|scope| {
        let results = spawn(scope, || CampaignResults::open(folder));
        (read_plan(), results.join())
    });
    let results = results.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    let plan = plan?;
    let found = results.map_err(StatusError);
    let found = found.and_then(|found| of_results(&plan, &found, Shard::WHOLE));
    Ok((plan, found))
}

/// Determines the state of a part of a campaign from results.
///
/// # Errors
/// If an existing result can't be read.
pub fn of_results(
    plan: &Plan,
    results: &CampaignResults,
    shard: Shard,
) -> Result<CampaignStatus, StatusError> {
    let decision = plan.stop.as_ref().map(|rule| decide_by(plan, results, rule)).transpose()?;
    let end = decision.map_or(plan.cases.len(), |decision| decision.end(plan.cases.len()));
    let is_decided =
        decision.is_some_and(|decision| !matches!(decision, StopDecision::Open { .. }));
    let has = |case: &Case| results.has(&case.id);
    let mut looks = LookState::of(plan, &results.journal, end, is_decided, has);
    if shard != Shard::WHOLE {
        looks = looks.of_part(plan.cases.len(), plan.has_claims());
    }
    let mut status = CampaignStatus {
        title: plan.title.clone(),
        plan: plan.id.clone(),
        cases: 0,
        open: 0,
        draws: 0,
        repeated: Vec::new(),
        idle_factors: Vec::new(),
        verdicts: BTreeMap::new(),
        besides: Verdict::Pass,
        requirements: BTreeMap::new(),
        joint: None,
        not_by_test: plan.not_by_test.clone(),
        doubts: plan.accounts.iter().flat_map(Account::doubts).collect(),
        bad: Vec::new(),
        differing: Vec::new(),
        numerics: Vec::new(),
        stopped: plan.stop.as_ref().zip(decision).and_then(|(rule, found)| in_words(rule, found)),
        looks,
    };
    let mut tally = StatusTally::of(plan);
    each_state(
        plan,
        results,
        end,
        |index| shard.has(index),
        |case, state| tally.add(case, state, &mut status),
    )?;
    let others = std::mem::take(&mut tally.numerics).into_iter().filter_map(|(version, cases)| {
        Some(format!("{cases} of {} cases: {}", status.cases, differs(version)?))
    });
    status.numerics = others.collect();
    let mine = || plan.cases.iter().take(end).enumerate().filter(|(index, _)| shard.has(*index));
    let looked = || mine().map(|(_, case)| case).zip(tally.streams.iter().map(Option::as_ref));
    let draws = independence::draws(looked());
    status.draws = draws.iter().max().map_or(0, |last| *last as usize + 1);
    let idle = independence::idle(plan, looked());
    (status.repeated, status.idle_factors) = (idle.repeated, idle.factors);
    status.joint = tally.joint(&draws, &status.looks);
    status.requirements = tally.requirements(&draws, &status.looks);
    Ok(status)
}

/// Counts over the cases of a plan.
struct StatusTally<'p> {
    plan: &'p Plan,
    requirements: BTreeMap<&'p str, RequirementTally>,
    streams: Vec<Option<StreamKey>>,
    numerics: BTreeMap<Option<u32>, usize>,
    /// All checks of each case, as those of one requirement.
    all: RequirementTally,
}

/// Checks of a requirement so far.
#[derive(Debug, Default)]
struct RequirementTally {
    counts: VerdictCounts,
    /// Whether each of the cases that count shows it, as one of [`SHOWN`]; those after the last one that checks it are
    /// missing.
    shown: Vec<u8>,
    /// First case that shows nothing, with its reason.
    why_unknown: Option<String>,
}

/// Results of a case for a requirement, by their place; `None`: it isn't checked.
const SHOWN: [Option<RowResult>; 5] = [
    None,
    Some(RowResult::Open),
    Some(RowResult::Unknown),
    Some(RowResult::Failed),
    Some(RowResult::Passed),
];

impl RequirementTally {
    /// Adds a case by its place among those that count.
    fn show(&mut self, case: usize, result: RowResult) {
        self.shown.resize(case, 0);
        let place = SHOWN.iter().position(|shown| *shown == Some(result));
        self.shown.push(place.and_then(|place| u8::try_from(place).ok()).unwrap_or(0));
    }

    /// Returns the place of each case that checks it, its draw, and its result.
    fn rows(&self, draws: &[u32]) -> impl Iterator<Item = (usize, usize, RowResult)> + Clone {
        let shown = self.shown.iter().map(|place| SHOWN[usize::from(*place)]);
        let rows = draws.iter().zip(shown).enumerate();
        rows.filter_map(|(place, (draw, shown))| Some((place, *draw as usize, shown?)))
    }
}

impl<'p> StatusTally<'p> {
    /// Begins with all requirements, also those that no case checks.
    fn of(plan: &'p Plan) -> Self {
        let of_file = plan.requirements.iter().map(|planned| &planned.check.id);
        let of_scenarios = plan.scenarios.iter().flat_map(|scenario| &scenario.requirements);
        let requirements = of_file
            .chain(of_scenarios)
            .map(|id| (id.as_str(), RequirementTally::default()))
            .collect();
        Self {
            plan,
            requirements,
            streams: Vec::new(),
            numerics: BTreeMap::new(),
            all: RequirementTally::default(),
        }
    }

    fn add(&mut self, case: &Case, state: Option<CaseState>, status: &mut CampaignStatus) {
        let number = status.cases;
        status.cases += 1;
        let plan = self.plan;
        let checked = checked(plan, case);
        let Some(state) = state else {
            status.open += 1;
            if !checked.is_empty() {
                self.all.show(number, RowResult::Open);
            }
            for id in checked {
                let tally = self.requirements.entry(id).or_default();
                tally.counts.missing += 1;
                tally.show(number, RowResult::Open);
            }
            self.streams.push(None);
            return;
        };
        *status.verdicts.entry(state.verdict.name()).or_default() += 1;
        let counted = |id: &String| plan.ensemble(id).is_some();
        let is_counted = !checked.is_empty() && checked.iter().all(counted);
        if !(is_counted && state.refused_alone) {
            status.besides = status.besides.worst(state.besides);
        }
        if let Some(worst) = state.checks.iter().map(|(_, result, _)| *result).max() {
            self.all.show(number, worst);
        }
        for (id, (verdict, result, why)) in checked.iter().zip(&state.checks) {
            let tally = self.requirements.entry(id).or_default();
            tally.show(number, *result);
            if tally.why_unknown.is_none() {
                tally.why_unknown = why.as_ref().map(|why| format!("case {}: {why}", case.id));
            }
            let counts = &mut tally.counts;
            *match verdict {
                Verdict::Pass => &mut counts.pass,
                Verdict::None | Verdict::Inconclusive => &mut counts.inconclusive,
                Verdict::Fail => &mut counts.fail,
                Verdict::Error => &mut counts.error,
            } += 1;
        }
        self.streams.push(state.stream);
        if let Some(version) = state.numerics {
            *self.numerics.entry(version).or_default() += 1;
        }
        if state.differs {
            status.differing.push(case.id.to_string());
        }
        if state.verdict > Verdict::Inconclusive && status.bad.len() < NAMED {
            let reason = state.why.unwrap_or_default();
            status.bad.push(Bad { case: case.id.to_string(), verdict: state.verdict, reason });
        }
    }

    /// States what the draws show of all requirements together, where one asks for a probability.
    fn joint(&self, draws: &[u32], looks: &LookState) -> Option<JointStatement> {
        let asked = self.requirements.keys().filter_map(|id| self.plan.ensemble(id));
        let asked: Vec<f64> = asked.map(|ensemble| ensemble.confidence).collect();
        let confidence = asked.iter().copied().max_by(f64::total_cmp)?;
        let error: f64 = asked.iter().map(|confidence| 1.0 - confidence).sum();
        let (draws, lower_bound) = looks.joint(confidence, self.all.rows(draws));
        Some(JointStatement {
            requirements: self.requirements.len(),
            draws,
            confidence,
            lower_bound,
            claims: asked.len(),
            together: (1.0 - error).max(0.0),
        })
    }

    /// Judges each requirement by the draws of the cases.
    fn requirements(self, draws: &[u32], looks: &LookState) -> BTreeMap<String, RequirementStatus> {
        let of = |(id, tally): (&str, RequirementTally)| {
            let (ensemble, counts) = (self.plan.ensemble(id), tally.counts);
            let found = looks.judge(ensemble, counts, tally.rows(draws));
            let JudgedDraws { verdict, mut reason, draws, needed, bound } = found;
            if let (true, Some(why)) = (verdict != Verdict::Pass, &tally.why_unknown) {
                _ = write!(reason, "; {why}");
            }
            let status =
                RequirementStatus { verdict, reason, counts, draws, ensemble, needed, bound };
            (id.to_owned(), status)
        };
        self.requirements.into_iter().map(of).collect()
    }
}

/// Evaluates the stopping rule on the results in a folder.
///
/// # Errors
/// If an existing result can't be read, or contradicts itself.
pub fn decide(plan: &Plan, folder: &Path, rule: &StopRule) -> Result<StopDecision, StatusError> {
    decide_by(plan, &CampaignResults::open(folder)?, rule)
}

/// Evaluates the stopping rule on results.
///
/// # Errors
/// If an existing result can't be read, or contradicts itself.
pub fn decide_by(
    plan: &Plan,
    results: &CampaignResults,
    rule: &StopRule,
) -> Result<StopDecision, StatusError> {
    let wrong = RefCell::new(None);
    let decision = stop::decide(plan, rule, |case| {
        let read = results.facts(plan, case).unwrap_or_else(|error| {
            wrong.borrow_mut().get_or_insert(error);
            None
        });
        Some(Shown::of(&read?, &rule.requirement))
    });
    wrong.into_inner().map_or(Ok(decision), |error| Err(error.into()))
}

fn in_words(rule: &StopRule, decision: StopDecision) -> Option<String> {
    let StopRule { requirement, demand, .. } = rule;
    let asked = format!(
        "{} % at a confidence of {} %",
        plain(100.0 * demand.pass, 6),
        plain(100.0 * demand.confidence, 6)
    );
    match decision {
        StopDecision::Shown { end } => Some(format!(
            "{requirement} is shown to be kept with {asked} after {end} cases: no more are needed"
        )),
        StopDecision::Refuted { end } => Some(format!(
            "{requirement} is shown not to be kept with {asked} after {end} cases: no more are needed"
        )),
        StopDecision::Open { .. } => None,
    }
}

impl CampaignStatus {
    /// Returns the verdict: the worst of the requirements and the other findings, an error if a
    /// case has two results, and no pass before all cases have run, without any case, or where requirements are missing.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if !self.differing.is_empty() {
            return Verdict::Error;
        }
        // A requirement that nobody tests can't pass in silence.
        let unfinished = self.open > 0
            || self.cases == 0
            || self.requirements.is_empty()
            || !self.doubts.is_empty();
        let least = if unfinished { Verdict::Inconclusive } else { Verdict::Pass };
        let requirements = self.requirements.values().map(|requirement| requirement.verdict);
        requirements.fold(self.besides.worst(least), Verdict::worst)
    }
}
