//! Looks at a campaign: which of its cases count in claims, whether a look is due, and the verdict of a requirement on
//! all draws by the way in which they are looked at.
//!
//! The first look fixes the draws of a claim, unless the campaign is looked at openly: those that are added later are
//! nominal. Before a look is due, progress is shown and no outcome.

use crate::journal::Journal;
use crate::plan::looks::{LookWay, at_each_of};
use crate::plan::{Case, Plan};
use octant_statistics::cluster::{DrawCounts, RowResult};
use octant_statistics::looks::{
    LookBoundary, open_further_if_all_pass, open_lower_bound, open_upper_bound,
};
use octant_statistics::proportion::{Demand, Needed, further_if_all_pass};
use octant_verdict::Verdict;
use octant_verdict::requirement::EnsembleRequirement;
use octant_verdict::trace::{ClaimBounds, ONCE, VerdictCounts, judge, judge_by};
use serde::Serialize;

/// Bounds of data that is looked at openly.
const OPEN: ClaimBounds = ClaimBounds {
    lower: open_lower_bound,
    upper: open_upper_bound,
    looks: 1,
    words: " whenever it is looked at",
};

/// Looks at a campaign, as they are now.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LookState {
    /// How it is looked at, in words.
    pub way: String,
    /// Cases whose draws a claim counts: those of the plan at the first look.
    pub claim_cases: usize,
    /// Cases that were added after it, whose draws are nominal.
    pub nominal_cases: usize,
    /// Number of planned looks that are due.
    pub looks_due: u32,
    /// Cases of the next look, all of which have to have a result; null if none comes.
    pub next_cases: Option<usize>,
    /// True if outcomes may be shown.
    pub is_due: bool,
    #[serde(skip)]
    kind: Kind,
}

/// Way of looking with what is needed to judge by it.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Kind {
    Once,
    Stop {
        looks: u64,
    },
    Open,
    /// Cases and draws of each look.
    Planned {
        looks: Vec<(usize, u64)>,
    },
}

impl LookState {
    /// Finds out how far the looks of a campaign are. `has` tells whether a case has a result, `end` is the number of
    /// cases that the stopping rule leaves, and `is_decided` tells that it has decided.
    #[must_use]
    pub fn of(
        plan: &Plan,
        journal: &Journal,
        end: usize,
        is_decided: bool,
        has: impl Fn(&Case) -> bool,
    ) -> Self {
        let all = plan.cases.len();
        let first = journal.cases_at_first_look().unwrap_or(all).min(all);
        let way = plan.look_way(first);
        let claim_cases = if way == LookWay::Open { all } else { first };
        let run = plan.cases.iter().take_while(|case| has(case)).count();
        let (mut looks_due, mut next_cases) = (0, None);
        let kind = match way {
            LookWay::Once => Kind::Once,
            LookWay::Open => Kind::Open,
            LookWay::Stop(looks) => Kind::Stop { looks },
            LookWay::Planned(count) => {
                let replicates = u64::from(plan.replicates(claim_cases));
                let looks = LookBoundary::equal(replicates, count);
                let cases = |draws: u64| plan.cases_of(u32::try_from(draws).unwrap_or(u32::MAX));
                let looks: Vec<_> = looks.into_iter().map(|draws| (cases(draws), draws)).collect();
                let due = looks.iter().take_while(|(cases, _)| *cases <= run).count();
                looks_due = u32::try_from(due).unwrap_or(u32::MAX);
                next_cases = looks.get(due).map(|(cases, _)| *cases);
                Kind::Planned { looks }
            }
        };
        let is_due = match kind {
            Kind::Open => true,
            Kind::Planned { .. } => looks_due > 0,
            Kind::Stop { .. } | Kind::Once => {
                let needed = end.min(claim_cases);
                next_cases = (run < needed).then_some(needed);
                is_decided || run >= needed
            }
        };
        Self {
            way: plan.way_in_words(way, claim_cases),
            claim_cases,
            nominal_cases: all - claim_cases,
            looks_due,
            next_cases,
            is_due: is_due || !plan.has_claims(),
            kind,
        }
    }

    /// State of a part of a campaign, whose results alone make no claim: they are judged as if they were looked at once.
    #[must_use]
    pub fn of_part(self, cases: usize, has_claims: bool) -> Self {
        let is_due = !has_claims || matches!(self.kind, Kind::Open);
        Self { claim_cases: cases, nominal_cases: 0, is_due, kind: Kind::Once, ..self }
    }

    /// Combines the checks of a requirement. `rows` are the draw and the result of each case that checks it, with the
    /// place of the case, in their order.
    #[must_use]
    pub fn judge(
        &self,
        ensemble: Option<EnsembleRequirement>,
        counts: VerdictCounts,
        rows: impl Iterator<Item = (usize, usize, RowResult)> + Clone,
    ) -> JudgedDraws {
        let draws_up_to = |end: usize| {
            let own = rows.clone().filter(|(place, ..)| *place < end);
            DrawCounts::of(own.map(|(_, draw, result)| (draw, result)))
        };
        let all = draws_up_to(usize::MAX);
        let Some(asked) = ensemble else {
            let (verdict, reason) = judge(None, counts, all);
            return JudgedDraws { verdict, reason, draws: all, needed: None, bound: None };
        };
        let demand = Demand { pass: asked.pass, confidence: asked.confidence };
        let draws = draws_up_to(self.counted_cases());
        let bounds = match self.kind {
            Kind::Once | Kind::Planned { .. } => ONCE,
            Kind::Open => OPEN,
            Kind::Stop { looks } => {
                ClaimBounds { looks, words: " at each of the looks of [stop], together", ..ONCE }
            }
        };
        let (verdict, mut reason) = match &self.kind {
            Kind::Planned { looks } if counts.error == 0 && counts.all() > 0 => {
                self.judge_looks(asked, looks, draws_up_to)
            }
            _ => judge_by(ensemble, counts, draws, &bounds),
        };
        if self.nominal_cases > 0 && all != draws {
            let lower = (ONCE.lower)(all.not_passed, all.known(), asked.confidence);
            reason += &format!(
                "; nominal, with what was drawn after the first look: {} of {} passed, at least {:.2} %, no part of the \
                 claim",
                all.passed,
                all.known(),
                (1e4 * lower).floor() / 1e2
            );
        }
        let (failures, runs) = (draws.not_passed, draws.known());
        let looks = match &self.kind {
            Kind::Once | Kind::Open => 1,
            Kind::Stop { looks } => *looks,
            Kind::Planned { looks } => looks.len() as u64,
        };
        let each = at_each_of(demand, looks);
        let needed = match self.kind {
            _ if verdict == Verdict::Pass => Needed::Runs(0),
            Kind::Open => open_further_if_all_pass(demand, failures, runs),
            _ => further_if_all_pass(each, failures, runs),
        };
        let bound = (runs > 0).then(|| (bounds.lower)(failures, runs, each.confidence));
        JudgedDraws { verdict, reason, draws, needed: Some(needed), bound }
    }

    /// Judges by the boundary of the looks that are due.
    fn judge_looks(
        &self,
        asked: EnsembleRequirement,
        looks: &[(usize, u64)],
        draws_up_to: impl Fn(usize) -> DrawCounts,
    ) -> (Verdict, String) {
        let EnsembleRequirement { pass, confidence } = asked;
        let sizes: Vec<u64> = looks.iter().map(|(_, draws)| *draws).collect();
        let boundary = LookBoundary::of(Demand { pass, confidence }, &sizes);
        let percent = |p: f64| format!("{:.2} %", 100.0 * p);
        let count = looks.len();
        let (mut kept, mut last) = (None, None);
        let due = usize::try_from(self.looks_due).unwrap_or(usize::MAX);
        for (number, (look, (cases, planned))) in
            boundary.looks.iter().zip(looks).take(due).enumerate()
        {
            let found = draws_up_to(*cases);
            // Draws that are the same run are fewer than planned: the others count against either claim.
            let lacking = planned.saturating_sub(found.all());
            let not_passed = found.not_passed + found.open + lacking;
            let told = format!("look {} of {count}: {not_passed} of {planned} draws", number + 1);
            if let Some(from) = look.broken_from.filter(|from| found.failed() >= *from) {
                let reason = format!(
                    "look {} of {count}: {} of {planned} draws failed, {from} or more show with {} confidence over \
                     all looks that a draw passes with a probability below the required {}",
                    number + 1,
                    found.failed(),
                    percent(confidence),
                    percent(pass)
                );
                return (Verdict::Fail, reason);
            }
            let allowed = look.kept_at_most;
            if kept.is_none() && allowed.is_some_and(|most| not_passed <= most) {
                kept = Some(format!(
                    "{told} didn't pass, {} may: with {} confidence over all looks a draw passes with a probability of \
                     at least the required {}",
                    allowed.unwrap_or(0),
                    percent(confidence),
                    percent(pass)
                ));
            }
            last = Some(match allowed {
                Some(most) => format!("{told} didn't pass, {most} may"),
                None => format!("{told} didn't pass, too few draws to show it"),
            });
        }
        if let Some(kept) = kept {
            return (Verdict::Pass, kept);
        }
        let required = format!("required {} at {} confidence", percent(pass), percent(confidence));
        let next = boundary
            .looks
            .get(due)
            .map(|next| format!("the next look is after {} draws", next.draws));
        let told = match (last, next) {
            (Some(last), Some(next)) => format!("{last}; {next}"),
            (Some(last), None) => format!("{last}; no look is left"),
            (None, Some(next)) => format!("not looked at yet: {next}"),
            (None, None) => "no look is planned".to_owned(),
        };
        (Verdict::Inconclusive, format!("{told}, {required}"))
    }

    /// Number of cases whose draws count now: with planned looks those of the last one that is due.
    fn counted_cases(&self) -> usize {
        match &self.kind {
            Kind::Planned { looks } => {
                let due = usize::try_from(self.looks_due).unwrap_or(usize::MAX);
                looks.iter().take(due).next_back().map_or(0, |(cases, _)| *cases)
            }
            _ => self.claim_cases,
        }
    }

    /// Counts the draws that pass all of their checks of all requirements, and bounds their probability at each look.
    /// `rows` are the draw of each case and its worst result, with the place of the case, in their order.
    #[must_use]
    pub fn joint(
        &self,
        confidence: f64,
        rows: impl Iterator<Item = (usize, usize, RowResult)>,
    ) -> (DrawCounts, Option<f64>) {
        let end = self.counted_cases();
        let counted = rows.filter(|(place, ..)| *place < end);
        let draws = DrawCounts::of(counted.map(|(_, draw, result)| (draw, result)));
        let (looks, bounds) = match &self.kind {
            Kind::Once => (1, ONCE),
            Kind::Open => (1, OPEN),
            Kind::Stop { looks } => (*looks, ONCE),
            Kind::Planned { looks } => (looks.len() as u64, ONCE),
        };
        let each = at_each_of(Demand { pass: 0.5, confidence }, looks).confidence;
        let runs = draws.known();
        (draws, (runs > 0).then(|| (bounds.lower)(draws.not_passed, runs, each)))
    }

    /// Describes the looks and what they wait for.
    #[must_use]
    pub fn in_words(&self) -> String {
        let mut text = self.way.clone();
        if let Some(next) = self.next_cases {
            text += &format!("; the next look is due when {next} cases have run");
        }
        if self.nominal_cases > 0 {
            text += &format!(
                "; {} cases were added after the first look and are no part of a claim",
                self.nominal_cases
            );
        }
        text
    }

    /// Returns whether further draws of this plan may count.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.kind == Kind::Open
    }
}

/// Draws of a requirement, judged.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedDraws {
    /// Verdict.
    pub verdict: Verdict,
    /// Reason, in plain words.
    pub reason: String,
    /// Draws of the claim.
    pub draws: DrawCounts,
    /// Further draws that show it if all of them pass: of this plan if it is looked at openly, else a new plan with so
    /// many more shows it with as many failures.
    pub needed: Option<Needed>,
    /// Lower bound of the probability that a draw passes, at each look that is made; the looks together keep the
    /// confidence.
    pub bound: Option<f64>,
}
