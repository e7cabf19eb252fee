//! Case of the self-test: an action, and its expected outcome.

use crate::bench::Bench;
use crate::error::CaseError;
use crate::judge::{Expectation, Outcome};

/// Case: an action, and its expected outcome.
#[derive(Debug)]
pub struct Case {
    /// Name.
    pub id: &'static str,
    /// Purpose, as a sentence.
    pub about: &'static str,
    /// Expected outcome.
    pub expectation: Expectation,
    /// Runs the case in a folder of its own. An error is one of the self-test itself: the case
    /// could not be prepared.
    pub run: fn(&Bench) -> Result<Outcome, CaseError>,
}
