//! Seed, looks and their price, as a plan says them.

use super::looks::{LookWay, Looks, at_each_of};
use super::seed::seed_of;
use super::{Case, Plan};
use crate::journal::PlannedEvent;
use octant_statistics::looks::{LookBoundary, open_further_if_all_pass};
use octant_statistics::proportion::{Demand, Needed, further_if_all_pass};
use std::fmt::Write as _;

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

fn runs(needed: Needed) -> Option<u64> {
    match needed {
        Needed::Runs(runs) => Some(runs),
        Needed::CannotBeMet => None,
    }
}

fn draws(count: u64) -> String {
    format!("{count} draw{}", if count == 1 { "" } else { "s" })
}
