//! Known-answer self-test: cases whose ends are known, through the program as users have it.
//!
//! [`judge`](mod@judge) holds what came of a case against what has to come, [`bench`](mod@bench) starts the program
//! for it, [`golden`] has the numbers of whole runs that are known from elsewhere, [`answers`] those of every
//! part, [`verdicts`] the cases that have to pass and those that must not, [`same`] those that have to give the same bytes, [`record`] what is
//! left of it.
//!
//! Nothing is taken from the repository: scenarios and numbers are in the program.

pub mod answers;
pub mod bench;
pub mod golden;
pub mod judge;
pub mod record;
pub mod same;
pub mod verdicts;

use bench::Bench;
use judge::{Expectation, Outcome};
use record::CaseRecord;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// A case: what is done, and what has to come of it.
#[derive(Debug)]
pub struct Case {
    /// Its name.
    pub id: &'static str,
    /// What it shows, as a sentence.
    pub about: &'static str,
    /// What has to come of it.
    pub expectation: Expectation,
    /// Does it, in a folder of its own. An error is one of the self-test: the case could not be made.
    pub run: fn(&Bench) -> Result<Outcome, String>,
}

/// All cases, in the order in which they are told.
#[must_use]
pub fn cases() -> Vec<Case> {
    let mut all = golden::cases();
    all.extend(answers::cases());
    all.extend(verdicts::must_pass());
    all.extend(verdicts::must_fail());
    all.extend(same::cases());
    all
}

/// Runs cases with a program, so many at a time, and judges each. `tell` hears of each as it ends, in any
/// order. What was not begun when `cancel` was set is left out.
///
/// # Errors
/// In words, if there is no room for the files of the cases.
pub fn run(
    program: &Path,
    cases: &[Case],
    jobs: usize,
    cancel: &AtomicBool,
    tell: &(dyn Fn(&CaseRecord) + Sync),
) -> Result<Vec<CaseRecord>, String> {
    let folder = tempfile::tempdir().map_err(|error| format!("make a folder: {error}"))?;
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, CaseRecord)>> = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, cases.len().max(1)) {
            scope.spawn(|| {
                while !cancel.load(Ordering::Relaxed) {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(case) = cases.get(index) else { break };
                    let outcome = Bench::new(program, &folder.path().join(case.id), cancel)
                        .and_then(|bench| (case.run)(&bench));
                    // What was broken off by us says nothing.
                    if cancel.load(Ordering::Relaxed) {
                        break;
                    }
                    let record = CaseRecord::of(case, &outcome);
                    tell(&record);
                    done.lock().unwrap_or_else(PoisonError::into_inner).push((index, record));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(index, _)| *index);
    Ok(done.into_iter().map(|(_, record)| record).collect())
}
