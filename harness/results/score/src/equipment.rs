//! Findings about the equipment of a run, from its certificates and the day on which the run ended.

use super::finding::{Finding, FindingSubject};
use octant_verdict::Verdict;
use octant_verdict::equipment::{Day, Equipment};

/// Findings about the equipment of a run that ended on a day: one for each piece whose certificate had
/// expired. Without a known day there is one for every piece.
#[must_use]
pub fn findings(equipment: &[Equipment], ended: Option<&Day>) -> Vec<Finding> {
    let one = |piece: &Equipment| {
        let reason = match ended {
            None => format!(
                "the run has no date, against which certificate {} of {} could be held",
                piece.certificate,
                piece.named()
            ),
            Some(ended) if *ended <= piece.expires => return None,
            Some(ended) => format!(
                "certificate {} of {} had expired: it held until {}, the run ended on {ended}",
                piece.certificate,
                piece.named(),
                piece.expires
            ),
        };
        Some(Finding { verdict: Verdict::Inconclusive, about: FindingSubject::Equipment, reason })
    };
    equipment.iter().filter_map(one).collect()
}
