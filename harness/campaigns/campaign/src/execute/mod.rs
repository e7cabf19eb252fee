//! Runs all cases of a plan in processes that do many of them, one after another. A crash, a hang or
//! excessive memory is an error of one case alone.

pub mod alike;
pub mod case;
mod execution;
pub mod process;
pub mod reexecute;
mod running;
pub mod selection;
pub mod work;
mod worker;

pub use crate::plan::shard::{Shard, ShardError};
pub use execution::{CaseDone, ExecuteError, ExecutionEvent, ExecutionSummary};

use super::plan::CasePlaces;
use crate::journal::{Journal, JournalEvent};
use crate::judge::status::StatusError;
use crate::plan::{Case, Plan};
use crate::store::error::ResultPlace;
use crate::store::writer::PartWriter;
use crate::store::{CampaignResults, forget_errors};
use alike::groups;
use octant_base::pool::in_order_with;
use process::TRIES;
use running::Running;
pub use running::remove_locks;
use selection::CaseSelection;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use worker::{Tried, Worker, WorkerOf};

/// Settings of an execution.
#[derive(Debug)]
pub struct ExecuteOptions<'a> {
    /// Folder.
    pub folder: &'a Path,
    /// Program that runs a case.
    pub program: &'a Path,
    /// Number of cases run at a time.
    pub jobs: usize,
    /// Part of the plan to run.
    pub shard: Shard,
    /// End of the cases to run, as a place in the plan.
    pub end: usize,
    /// True if cases that ended as errors are run again.
    pub again: bool,
    /// Cases that may be run, and those that are run although they have a result.
    pub selection: CaseSelection,
    /// True if cases that begin alike are run together, and a case with its twin.
    pub together: bool,
    /// Set to end the execution.
    pub cancel: &'a AtomicBool,
}

/// Runs the selected cases that have no result yet, and the repetitions. `tell` is called with each
/// as it ends, in any order.
///
/// # Errors
/// If the folder isn't of this plan, or the operating system refuses; stored results stay.
pub fn execute(
    plan: &Plan,
    options: &ExecuteOptions<'_>,
    tell: &(dyn Fn(&ExecutionEvent) + Sync),
) -> Result<ExecutionSummary, ExecuteError> {
    plan.check_files()?;
    let _running = Running::begin(options.folder, options.shard)?;
    let mut results = open(options.folder)?;
    refuse_foreign(plan, options.folder, &results)?;
    clean(options.folder);
    if !results.journal.is_there {
        let (results, plan) = (results.ids().count(), plan.in_journal());
        Journal::append(options.folder, JournalEvent::Begun { results, plan })?;
    }
    if let Some(event) = options.selection.in_journal(plan.cases.len()) {
        Journal::append(options.folder, event)?;
    }
    note_repetitions(plan, options, &results)?;
    if options.again {
        let mine = plan
            .cases
            .iter()
            .enumerate()
            .filter(|(index, _)| options.shard.has(*index) && options.selection.picks(*index));
        let mut writer = PartWriter::new(options.folder, &options.shard.stem());
        forget_errors(&results, &mut writer, mine.map(|(_, case)| case.id.as_str()))
            .map_err(StatusError)?;
        results = open(options.folder)?;
    }
    let up_to_end = || plan.cases.iter().enumerate().take(options.end);
    let mine = || {
        up_to_end()
            .filter(|(index, _)| options.shard.has(*index) && options.selection.picks(*index))
    };
    let is_open = |(index, case): &(usize, &Case)| {
        options.selection.repeats(*index) || !results.has(&case.id)
    };
    let open: Vec<(usize, &Case)> = mine().filter(is_open).collect();
    let skipped = mine().count() - open.len();
    tell(&ExecutionEvent::There(skipped));
    let of = WorkerOf {
        plan,
        folder: options.folder,
        program: options.program,
        stem: &options.shard.stem(),
        cancel: options.cancel,
    };
    // A case that is run again is run as it is alone.
    let (again, new): (Vec<_>, Vec<_>) =
        open.iter().partition(|(index, _)| options.selection.repeats(*index));
    let cases: Vec<&Case> = new.iter().map(|(_, case)| *case).collect();
    let alike = if options.together { groups(&cases, options.jobs) } else { Vec::new() };
    let alike = alike.into_iter().map(|group| group.into_iter().map(|place| new[place]).collect());
    let alone = again.iter().chain(new.iter().filter(|_| !options.together));
    let groups: Vec<Vec<(usize, &Case)>> = alike.chain(alone.map(|one| vec![*one])).collect();
    let work = |worker: &mut Worker<'_>, task: usize| {
        let mut ended = Vec::new();
        for (place, (index, case)) in groups[task].iter().copied().enumerate() {
            if options.cancel.load(Ordering::Relaxed) {
                break;
            }
            tell(&ExecutionEvent::Begun(index));
            let known = if options.selection.repeats(index) {
                results.known(&case.id).map_err(StatusError)?
            } else {
                Vec::new()
            };
            let next: Vec<&Case> = match place {
                0 => groups[task].iter().skip(1).map(|(_, case)| *case).collect(),
                _ => Vec::new(),
            };
            let undivided = !options.together || options.selection.repeats(index);
            let Some(done) = one(worker, case, &known, &next, undivided)? else { break };
            ended.push(done.differs.clone());
            tell(&ExecutionEvent::Done(CaseDone { index, ..done }));
        }
        Ok::<_, ExecuteError>(Some(ended))
    };
    let is_cancelled = || options.cancel.load(Ordering::Relaxed);
    let begin = || Worker::of(of);
    let done = in_order_with(options.jobs, groups.len(), is_cancelled, begin, work)?;
    let done: Vec<_> = done.into_iter().flatten().flatten().collect();
    let run = done.len();
    let mut differing: Vec<ResultPlace> = done.into_iter().flatten().collect();
    differing.sort();
    Ok(ExecutionSummary { run, skipped, left: open.len() - run, differing })
}

/// Notes in the journal which cases are run again although they have a result.
fn note_repetitions(
    plan: &Plan,
    options: &ExecuteOptions<'_>,
    results: &CampaignResults,
) -> Result<(), ExecuteError> {
    let (mut forgotten, mut cases) = (0, Vec::new());
    let of = |(index, case)| {
        (options.shard.has(index) && options.selection.picks(index)).then_some(case)
    };
    let mine = plan.cases.iter().enumerate().filter_map(of).filter(|_| options.again);
    for case in mine {
        let errors = results.errors(&case.id).map_err(StatusError)?.len();
        forgotten += errors;
        cases.extend((errors > 0).then_some(case.id.as_str()));
    }
    let repeated = options.selection.repeated().filter(|index| options.shard.has(*index));
    let repeated: Vec<&str> =
        (repeated.filter_map(|index| plan.cases.get(index))).map(|case| case.id.as_str()).collect();
    let count = repeated.len();
    cases.extend(repeated);
    if !cases.is_empty() {
        let event = JournalEvent::rerun(forgotten, count, cases.into_iter());
        Journal::append(options.folder, event)?;
    }
    Ok(())
}

fn open(folder: &Path) -> Result<CampaignResults, ExecuteError> {
    CampaignResults::open(folder).map_err(|error| StatusError(error).into())
}

/// Removes incomplete results that killed processes of older versions left.
fn clean(folder: &Path) {
    for part in std::fs::read_dir(folder.join("cases")).into_iter().flatten().flatten() {
        octant_base::whole_file::clean(&part.path());
    }
}

/// Runs one case, again if its process is ended from outside; `None` if it was ended by a request.
/// `known` are the results of a case that is run a second time; `alike` are cases that begin alike and come next.
fn one(
    worker: &mut Worker<'_>,
    case: &Case,
    known: &[String],
    mut alike: &[&Case],
    undivided: bool,
) -> Result<Option<CaseDone>, ExecuteError> {
    let mut by = String::new();
    let mut tries = 0;
    while tries < TRIES {
        match worker.try_case(case, known, alike, undivided)? {
            Tried::Done(done) => return Ok(Some(done)),
            Tried::Cancelled => return Ok(None),
            Tried::InUsed => alike = &[],
            Tried::Outside(signal) => {
                by = signal;
                tries += 1;
            }
        }
    }
    Err(ExecuteError::Ended { case: case.id.to_string(), by })
}

/// Refuses a folder with results of another plan, which would be counted as well.
pub(crate) fn refuse_foreign(
    plan: &Plan,
    folder: &Path,
    results: &CampaignResults,
) -> Result<(), ExecuteError> {
    let known = CasePlaces::of(plan);
    let mut foreign = results.ids().filter(|id| known.get(id).is_none()).peekable();
    match foreign.peek().map(|one| (*one).to_owned()) {
        None => Ok(()),
        Some(one) => {
            Err(ExecuteError::Foreign { folder: folder.to_owned(), count: foreign.count(), one })
        }
    }
}
