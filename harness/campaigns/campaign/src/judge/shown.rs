//! Outcomes that are shown: none before a look, and each look is in the journal.

use super::status::{CampaignStatus, RequirementStatus};
use crate::journal::{Journal, JournalError, JournalEvent};
use crate::plan::Plan;
use octant_statistics::cluster::DrawCounts;
use octant_verdict::Verdict;
use octant_verdict::trace::VerdictCounts;
use std::path::Path;

impl CampaignStatus {
    /// Returns the state as it may be shown: before a look is due, progress and errors of the bench without any outcome.
    #[must_use]
    pub fn shown(self) -> Self {
        if self.looks.is_due {
            return self;
        }
        let error = Verdict::Error.name();
        let errors = self.verdicts.get(error).copied();
        let waits = "not looked at yet".to_owned();
        let hidden = |status: RequirementStatus| RequirementStatus {
            verdict: Verdict::Inconclusive,
            reason: waits.clone(),
            counts: VerdictCounts::default(),
            draws: DrawCounts::default(),
            needed: None,
            bound: None,
            ..status
        };
        Self {
            verdicts: errors.map(|errors| (error, errors)).into_iter().collect(),
            besides: if errors.is_some() { Verdict::Error } else { Verdict::Inconclusive },
            requirements: (self.requirements.into_iter())
                .map(|(id, status)| (id, hidden(status)))
                .collect(),
            joint: None,
            bad: (self.bad.into_iter()).filter(|bad| bad.verdict == Verdict::Error).collect(),
            ..self
        }
    }
}

/// Notes in the journal of a folder that outcomes are shown, unless the last look showed the same.
///
/// # Errors
/// If the journal can't be written: then nothing may be shown.
pub fn note_look(
    plan: &Plan,
    folder: &Path,
    status: &CampaignStatus,
    by: &str,
) -> Result<(), JournalError> {
    let results = status.cases - status.open;
    let journal = Journal::read(folder)?;
    if journal.last_look() == Some((plan.id.as_str(), results)) {
        return Ok(());
    }
    if !journal.is_there {
        Journal::append(folder, JournalEvent::Begun { results, plan: plan.in_journal() })?;
    }
    let (plan, cases, by) = (plan.id.clone(), plan.cases.len(), by.to_owned());
    Journal::append(folder, JournalEvent::Look { plan, by, cases, results })
}
