//! Twins that cases share: cases of one scenario and draw that differ by their faults alone have the same run without
//! faults.

use crate::plan::Case;
use crate::plan::shared::SharedText;
use octant_score::counterfactual::Counterfactual;
use octant_score::summary::Summary;
use std::collections::BTreeMap;

/// Everything but its faults that makes the scenario of a case.
type WithoutFaults = (SharedText, Vec<SharedText>);

/// Statement of a result on its twins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct TwinsSaid {
    of: WithoutFaults,
    seed: u64,
    case: String,
    /// Hash of the stream, and number of reports, of the twin of each method.
    twins: Vec<(String, u64)>,
}

impl TwinsSaid {
    /// Returns what a result says; `None` where it has no twin, or one of a unit that has a session for each.
    pub(crate) fn of(case: &Case, summary: Option<&Summary>) -> Option<Self> {
        let summary = summary?;
        let baseline = summary.baseline.as_ref().and_then(|b| b.counterfactual.as_ref());
        let both: Vec<&Counterfactual> = summary.counterfactual.iter().chain(baseline).collect();
        if both.is_empty() || both.iter().any(|found| found.sessions.is_some()) {
            return None;
        }
        let others = case.set.iter().filter(|set| !set.starts_with("faults."));
        let twin = |found: &&Counterfactual| (found.twin_stream_hash.clone(), found.false_alarms);
        Some(Self {
            of: (case.scenario.clone(), others.cloned().collect()),
            seed: case.seed,
            case: case.id.to_string(),
            twins: both.iter().map(twin).collect(),
        })
    }
}

/// Twins of the cases so far, in the order of the plan.
#[derive(Debug, Default)]
pub(crate) struct SharedTwins {
    /// All cases of a seed stand together in a plan.
    seed: Option<u64>,
    known: BTreeMap<WithoutFaults, TwinsSaid>,
}

impl SharedTwins {
    /// Takes what the next result says; returns how it contradicts an earlier one.
    pub(crate) fn contradiction(&mut self, said: Option<TwinsSaid>) -> Option<String> {
        let said = said?;
        if self.seed.replace(said.seed) != Some(said.seed) {
            self.known.clear();
        }
        let Some(known) = self.known.get(&said.of) else {
            self.known.insert(said.of.clone(), said);
            return None;
        };
        if known.twins == said.twins {
            return None;
        }
        let words = |said: &TwinsSaid| {
            let twin = |(hash, alarms): &(String, u64)| {
                format!("{} with {alarms} reports", hash.get(..16).unwrap_or(hash))
            };
            said.twins.iter().map(twin).collect::<Vec<_>>().join(" and ")
        };
        Some(format!(
            "case {}: its twin without faults is {}, that of case {}, which has the same but for the faults, is {}",
            said.case,
            words(&said),
            known.case,
            words(known)
        ))
    }
}
