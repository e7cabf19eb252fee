//! Known-answer self-test: cases with known outcomes, run with the program that users have.
//!
//! [`judge`](mod@judge) compares outcome and expectation, [`bench`](mod@bench) starts the program,
//! [`golden`] has the known numbers of whole runs, [`answers`] those of every part, [`verdicts`]
//! the cases that must pass and those that must not, [`same`] those that must give the same bytes,
//! [`record`] the stored result. Each case has a limit of time: a program with another number may compute for ever.
//!
//! Nothing is taken from the repository: scenarios and numbers are built into the program.

pub mod answers;
pub mod bench;
mod case;
pub mod error;
pub mod golden;
pub mod judge;
pub mod record;
pub mod same;
mod scenarios;
pub mod verdicts;
mod within;

pub use case::{COMPUTED_LIMIT, Case, STARTED_LIMIT};

use error::CaseFolderError;
use octant_base::pool::in_order;
use record::CaseRecord;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Lists all cases, in the order of the report.
#[must_use]
pub fn cases() -> Vec<Case> {
    let mut all = golden::cases();
    all.extend(answers::cases());
    all.extend(verdicts::must_pass());
    all.extend(verdicts::must_fail());
    all.extend(same::cases());
    all
}

/// Runs cases with a program, several at a time, and judges each. `tell` is called with each as it
/// ends, in any order. Cases not begun when `cancel` was set are left out.
///
/// # Errors
/// If the folders of the cases can't be made.
pub fn run(
    program: &Path,
    cases: &[Case],
    jobs: usize,
    cancel: &AtomicBool,
    tell: &(dyn Fn(&CaseRecord) + Sync),
) -> Result<Vec<CaseRecord>, CaseFolderError> {
    let folder = tempfile::tempdir()?;
    let is_cancelled = || cancel.load(Ordering::Relaxed);
    let work = |index: usize| {
        let case = &cases[index];
        let outcome = within::outcome(program, &folder.path().join(case.id), case, cancel);
        // The outcome of a case that was interrupted by us has no meaning.
        if is_cancelled() {
            return Ok::<_, CaseFolderError>(None);
        }
        let record = CaseRecord::of(case, &outcome);
        tell(&record);
        Ok(Some(record))
    };
    let done = in_order(jobs, cases.len(), is_cancelled, work)?;
    Ok(done.into_iter().flatten().collect())
}
