//! Case of the self-test: an action, and its expected outcome.

use crate::bench::CaseBench;
use crate::error::CaseSetupError;
use crate::judge::{CaseOutcome, Expectation};

/// Case: an action, and its expected outcome.
#[derive(Debug)]
pub struct SelftestCase {
    /// Name.
    pub id: &'static str,
    /// Purpose, as a sentence.
    pub about: &'static str,
    /// Expected outcome.
    pub expectation: Expectation,
    /// Runs the case in a folder of its own. An error is one of the self-test itself: the case
    /// could not be prepared.
    pub run: fn(&CaseBench) -> Result<CaseOutcome, CaseSetupError>,
}
