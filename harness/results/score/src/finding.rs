//! Findings other than requirements that affect the verdict.

use octant_verdict::Verdict;
use serde::{Deserialize, Serialize};

/// Subject of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FindingSubject {
    /// The unit under test, whose misbehaviour counts against it.
    Unit,
    /// The bench; the unit isn't judged from then on.
    Bench,
    /// Equipment of the bench without a valid certificate: measurements with it show nothing.
    Equipment,
    /// The run: somebody ended it, or omitted something that it needs.
    Run,
}

/// Something other than a requirement that affects the verdict: an invalid answer, an overrun, a
/// dropped record, a failed bench.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Finding {
    /// Verdict of the finding.
    pub verdict: Verdict,
    /// Subject of the finding.
    pub about: FindingSubject,
    /// Event, in plain words.
    pub reason: String,
}

impl Finding {
    /// Finding about an error of the unit.
    #[must_use]
    pub fn of_unit(verdict: Verdict, reason: String) -> Self {
        Self { verdict, about: FindingSubject::Unit, reason }
    }

    /// Finding about a failure of the bench.
    #[must_use]
    pub fn of_bench(verdict: Verdict, reason: String) -> Self {
        Self { verdict, about: FindingSubject::Bench, reason }
    }

    /// Inconclusive finding about the run.
    #[must_use]
    pub fn of_run(reason: String) -> Self {
        Self { verdict: Verdict::Inconclusive, about: FindingSubject::Run, reason }
    }
}
