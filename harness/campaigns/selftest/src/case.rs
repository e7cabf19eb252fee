//! Case of the self-test: an action, and its expected outcome.

use crate::bench::CaseBench;
use crate::error::CaseSetupError;
use crate::judge::{CaseOutcome, Expectation};
use std::time::Duration;

/// Time limit of a case that computes in this process: all of them together take some seconds of a processor.
pub const COMPUTED_LIMIT: Duration = Duration::from_secs(120);
/// Time limit of a case that starts the program, each start of which has a limit of its own.
pub const STARTED_LIMIT: Duration = Duration::from_secs(3600);

/// Case: an action, and its expected outcome.
#[derive(Debug)]
pub struct Case {
    /// Name.
    pub id: &'static str,
    /// Purpose, as a sentence.
    pub about: &'static str,
    /// Expected outcome.
    pub expectation: Expectation,
    /// Time after which it is left, and has failed.
    pub limit: Duration,
    /// Runs the case in a folder of its own. An error is one of the self-test itself: the case
    /// could not be prepared.
    pub run: fn(&CaseBench) -> Result<CaseOutcome, CaseSetupError>,
}
