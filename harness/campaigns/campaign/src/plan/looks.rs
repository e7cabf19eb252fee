//! How often the results of a campaign are looked at, as its plan says, and the seed that comes from the plan.

use super::requirements::Planned;
use super::{Case, Plan, PlannedScenario, StopRule};
use crate::journal::PlannedEvent;
use octant_scenario::campaign::LookSpec;
use octant_statistics::looks::{LookBoundary, open_further_if_all_pass};
use octant_statistics::proportion::{Demand, Needed, further_if_all_pass};
use octant_verdict::verdict::LimitCheck;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// Bits of a seed that comes from a plan: JSON and TOML hold such a number exactly.
const SEED_BITS: u32 = 48;

/// How often the results of a campaign are looked at before a required probability counts as shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Looks {
    /// Once, when every case has run.
    #[default]
    Once,
    /// So many times, after equal parts of the draws.
    Planned(u32),
    /// At any time.
    Open,
}

impl From<LookSpec> for Looks {
    fn from(spec: LookSpec) -> Self {
        match spec {
            LookSpec::Once => Self::Once,
            LookSpec::Planned(count) => Self::Planned(count),
            LookSpec::Open => Self::Open,
        }
    }
}

impl Looks {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives a reference")]
    pub(super) fn is_once(&self) -> bool {
        *self == Self::Once
    }
}

/// Way in which a campaign is looked at: that of its plan, or that of its stopping rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookWay {
    /// Once.
    Once,
    /// So many times, each with its part of the draws.
    Planned(u32),
    /// At any time.
    Open,
    /// By the stopping rule, at most so many times.
    Stop(u64),
}

/// Content of a plan from which its seed comes: neither the number of replicates nor the values of a grid, so that a
/// campaign can grow, and no free text.
#[derive(Serialize)]
struct SeedContent<'a> {
    what: &'static str,
    scenarios: Vec<(&'a str, &'a str, &'a [String], &'a [LimitCheck])>,
    requirements: &'a [Planned],
    not_by_test: &'a [String],
    factors: &'a [String],
    stop: &'a Option<StopRule>,
    looks: Looks,
}

/// Computes the seed that comes from what a plan says.
pub(super) fn seed_of(
    scenarios: &[PlannedScenario],
    (requirements, not_by_test): (&[Planned], &[String]),
    factors: &[String],
    stop: &Option<StopRule>,
    looks: Looks,
) -> u64 {
    let scenarios = (scenarios.iter())
        .map(|PlannedScenario { id, blake3, requirements, checks, .. }| {
            (id.as_str(), blake3.as_str(), requirements.as_slice(), checks.as_slice())
        })
        .collect();
    let what = "seed of an octant campaign";
    let content = SeedContent { what, scenarios, requirements, not_by_test, factors, stop, looks };
    // Values of these types can always be serialised.
    let text = serde_json::to_vec(&content).unwrap_or_default();
    let mut first = [0; 8];
    first.copy_from_slice(&blake3::hash(&text).as_bytes()[..8]);
    u64::from_le_bytes(first) >> (64 - SEED_BITS)
}

impl Plan {
    /// Returns the seed of the first replicate.
    #[must_use]
    pub fn seed(&self) -> Option<u64> {
        self.cases.first().map(|case| case.seed)
    }

    /// Returns the seed that comes from what the plan says.
    pub(super) fn own_seed(&self) -> u64 {
        let documents = (self.requirements.as_slice(), self.not_by_test.as_slice());
        seed_of(&self.scenarios, documents, &self.factors, &self.stop, self.looks)
    }

    /// Describes the seed, and where it comes from.
    #[must_use]
    pub fn seed_in_words(&self) -> String {
        match self.seed() {
            None => "no seed".to_owned(),
            Some(seed) if self.seed_from_plan => format!("seed {seed}, from the plan's hash"),
            Some(seed) => format!("seed {seed}, given in the campaign's file"),
        }
    }

    /// Returns how a number of its cases are looked at.
    #[must_use]
    pub fn look_way(&self, cases: usize) -> LookWay {
        match (&self.stop, self.looks) {
            (Some(rule), _) => LookWay::Stop(rule.looks(cases)),
            (None, Looks::Once) => LookWay::Once,
            (None, Looks::Planned(count)) => LookWay::Planned(count),
            (None, Looks::Open) => LookWay::Open,
        }
    }

    /// Returns whether looks count: a requirement asks for a probability.
    #[must_use]
    pub fn has_claims(&self) -> bool {
        self.requirements.iter().any(|planned| planned.ensemble.is_some())
    }

    /// Returns the number of replicates among its first cases, each of which is complete.
    #[must_use]
    pub fn replicates(&self, cases: usize) -> u32 {
        let cases = self.cases.get(..cases).unwrap_or(&self.cases);
        cases.last().map_or(0, |case| case.replicate + 1)
    }

    /// Returns the number of cases of the first replicates.
    #[must_use]
    pub fn cases_of(&self, replicates: u32) -> usize {
        self.cases.partition_point(|case: &Case| case.replicate < replicates)
    }

    /// Returns what the journal says of it.
    #[must_use]
    pub fn in_journal(&self) -> PlannedEvent {
        let cases = self.cases.len();
        let looks = self.way_in_words(self.look_way(cases), cases);
        PlannedEvent {
            plan: self.id.clone(),
            cases: self.cases.len(),
            replicates: self.replicates(self.cases.len()),
            seed: self.seed_in_words(),
            looks,
        }
    }

    /// Describes how its first cases are looked at.
    pub(crate) fn way_in_words(&self, way: LookWay, cases: usize) -> String {
        let replicates = u64::from(self.replicates(cases));
        match way {
            LookWay::Once => format!("looked at once, after {}", draws(replicates)),
            LookWay::Planned(count) => {
                format!("looked at {count} times, the last time after {}", draws(replicates))
            }
            LookWay::Open => "looked at openly, at any time".to_owned(),
            LookWay::Stop(looks) => format!(
                "looked at by [stop], at most {looks} times, each with that part of the error"
            ),
        }
    }

    /// Describes how it is looked at, with the price: what the looks allow, and the draws that are needed if all pass.
    #[must_use]
    pub fn looks_in_words(&self) -> String {
        let replicates = u64::from(self.replicates(self.cases.len()));
        let way = self.look_way(self.cases.len());
        let mut text = self.way_in_words(way, self.cases.len()) + "\n";
        let mut told: Vec<Demand> = Vec::new();
        for ensemble in self.requirements.iter().filter_map(|planned| planned.ensemble) {
            let demand = Demand { pass: ensemble.pass, confidence: ensemble.confidence };
            if !told.contains(&demand) {
                told.push(demand);
                text += &price(demand, way, replicates);
            }
        }
        text
    }
}

/// Describes what a way of looking asks for, and what a single look at a fixed number of draws would.
fn price(demand: Demand, way: LookWay, replicates: u64) -> String {
    let asked = format!(
        "{} % at a confidence of {} %",
        octant_base::number::plain(100.0 * demand.pass, 6),
        octant_base::number::plain(100.0 * demand.confidence, 6)
    );
    let once = runs(further_if_all_pass(demand, 0, 0));
    let needed = match way {
        LookWay::Once => once,
        LookWay::Planned(_) => None,
        LookWay::Open => runs(open_further_if_all_pass(demand, 0, 0)),
        LookWay::Stop(looks) => runs(further_if_all_pass(at_each_of(demand, looks), 0, 0)),
    };
    let mut text = format!("  {asked}: ");
    if let LookWay::Planned(count) = way {
        let boundary = LookBoundary::of(demand, &LookBoundary::equal(replicates, count));
        let looks = boundary.looks.iter().map(|look| {
            let kept = look.kept_at_most.map_or_else(
                || "can't be shown yet".to_owned(),
                |most| format!("at most {most} may fail"),
            );
            format!("after {} {kept}", look.draws)
        });
        text += &looks.collect::<Vec<_>>().join(", ");
        if boundary.looks.iter().all(|look| look.kept_at_most.is_none()) {
            text += ": it can't be shown with so few draws";
        }
    } else {
        _ = write!(
            text,
            "needs {} if all pass",
            needed.map_or_else(|| "too many draws".to_owned(), draws)
        );
        if needed.is_none_or(|needed| needed > replicates) && way != LookWay::Open {
            _ = write!(text, ", and the plan has {replicates}: it can't be shown");
        }
    }
    if let (Some(once), true) = (once, way != LookWay::Once) {
        _ = write!(text, " ({once} if it is looked at once)");
    }
    text + "\n"
}

/// Demand with the part of the error that each of several looks has.
#[must_use]
pub fn at_each_of(demand: Demand, looks: u64) -> Demand {
    Demand { confidence: 1.0 - (1.0 - demand.confidence) / looks.max(1) as f64, ..demand }
}

fn runs(needed: Needed) -> Option<u64> {
    match needed {
        Needed::Runs(runs) => Some(runs),
        Needed::CannotBeMet => None,
    }
}

fn draws(count: u64) -> String {
    format!("{count} draw{}", if count == 1 { "" } else { "s" })
}
