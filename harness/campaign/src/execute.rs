//! Runs all cases of a plan, each in a process of its own: a crash, a hang or excessive memory is
//! an error of that case alone.

pub use super::shard::{Shard, ShardError};

use super::case::{self, CaseJob, CaseResult, StoreOutcome, differing};
use super::plan::{Case, Plan, PlanError};
use super::process::{TRIES, command};
use super::selection::CaseSelection;
use super::status::StatusError;
use octant_base::child::{ChildEnded, finish};
use octant_base::pool::in_order;
use octant_requirements::Verdict;
use std::path::{Path, PathBuf};
use std::process::{ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Exit status of a process that stored its result.
const KEPT: i32 = 0;
/// Exit status of a process that has a result and can't store it (EX_CANTCREAT of sysexits.h): not
/// the fault of its case, and the next process would fail too.
pub const NOT_KEPT: u8 = 73;
/// Bytes of a process's standard error that are kept.
const WORDS: u64 = 4096;

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
    /// Set to end the execution.
    pub cancel: &'a AtomicBool,
}

/// Event of an execution.
#[derive(Clone, Debug)]
pub enum ExecutionEvent {
    /// Number of cases that have results already.
    There(usize),
    /// A case has begun, given by its place in the plan.
    Begun(usize),
    /// A case has ended.
    Done(CaseDone),
}

/// Outcome of a case.
#[derive(Clone, Debug)]
pub struct CaseDone {
    /// Place in the plan.
    pub index: usize,
    /// Verdict.
    pub verdict: Verdict,
    /// First reason, unless the verdict is a pass.
    pub reason: Option<String>,
    /// Path of this result beside an earlier, different result of the same case.
    pub differs: Option<PathBuf>,
}

/// Summary of an execution.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExecutionSummary {
    /// Cases that were run.
    pub run: usize,
    /// Cases that had results already.
    pub skipped: usize,
    /// Cases that were not begun because the end was requested.
    pub left: usize,
    /// Results that differ from an earlier one of the same case.
    pub differing: Vec<PathBuf>,
}

/// Reasons why a campaign could not be run.
#[derive(Debug, thiserror::Error)]
pub enum ExecuteError {
    /// The plan isn't valid, or a scenario was changed.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The folder has results that are not of this plan.
    #[error(
        "run {folder}: it has results of {count} cases that the plan doesn't have, such as {one}"
    )]
    Foreign {
        /// The folder.
        folder: PathBuf,
        /// Number of such cases.
        count: usize,
        /// Example of such a case.
        one: String,
    },
    /// An existing result doesn't belong to its case, or contradicts itself.
    #[error(transparent)]
    Result(#[from] StatusError),
    /// A process could not store its result; its own message.
    #[error("{0}")]
    NotKept(String),
    /// The process of a case was ended from outside in every attempt.
    #[error(
        "run case {case}: its process was ended from outside {TRIES} times, the last time by {by}: the \
         case has no result"
    )]
    Ended {
        /// The case.
        case: String,
        /// Signal, or other cause.
        by: String,
    },
    /// A result could not be stored, or a process could not be started.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// Path that the action concerned.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

/// Runs the selected cases that have no result yet, and the repetitions. `tell` is called with each as it ends, in any order.
///
/// # Errors
/// If the folder isn't of this plan, or the operating system refuses; stored results stay.
pub fn execute(
    plan: &Plan,
    options: &ExecuteOptions<'_>,
    tell: &(dyn Fn(&ExecutionEvent) + Sync),
) -> Result<ExecutionSummary, ExecuteError> {
    plan.check_files()?;
    refuse_foreign(plan, options.folder)?;
    clean(options.folder);
    if options.again {
        forget_errors(plan, options)?;
    }
    let up_to_end = || plan.cases.iter().enumerate().take(options.end);
    let mine = || {
        up_to_end()
            .filter(|(index, _)| options.shard.has(*index) && options.selection.picks(*index))
    };
    let is_open = |(index, case): &(usize, &Case)| {
        options.selection.repeats(*index) || !case::file(options.folder, &case.id).exists()
    };
    let open: Vec<(usize, &Case)> = mine().filter(is_open).collect();
    let skipped = mine().count() - open.len();
    tell(&ExecutionEvent::There(skipped));
    let work = |task: usize| {
        let (index, case) = open[task];
        tell(&ExecutionEvent::Begun(index));
        let done = one(plan, (index, case), options)?.map(|done| CaseDone { index, ..done });
        Ok::<_, ExecuteError>(done.map(|done| {
            let differs = done.differs.clone();
            tell(&ExecutionEvent::Done(done));
            differs
        }))
    };
    let is_cancelled = || options.cancel.load(Ordering::Relaxed);
    let done = in_order(options.jobs, open.len(), is_cancelled, work);
    // A process that was ended may have left incomplete files.
    clean(options.folder);
    let done: Vec<_> = done?.into_iter().flatten().collect();
    let run = done.len();
    let mut differing: Vec<PathBuf> = done.into_iter().flatten().collect();
    differing.sort();
    Ok(ExecutionSummary { run, skipped, left: open.len() - run, differing })
}

/// Removes incomplete results that killed processes left.
fn clean(folder: &Path) {
    for part in std::fs::read_dir(folder.join("cases")).into_iter().flatten().flatten() {
        super::clean(&part.path());
    }
}

/// Removes the results of cases without a summary.
fn forget_errors(plan: &Plan, options: &ExecuteOptions<'_>) -> Result<(), ExecuteError> {
    for (index, case) in plan.cases.iter().enumerate() {
        let path = case::file(options.folder, &case.id);
        if options.shard.has(index)
            && options.selection.picks(index)
            && path.exists()
            && CaseResult::read(&path).is_ok_and(|result| result.error.is_some())
        {
            std::fs::remove_file(&path).map_err(|source| ExecuteError::System {
                action: "remove",
                path: path.clone(),
                source,
            })?;
        }
    }
    Ok(())
}

/// Runs one case, again if its process is ended from outside; `None` if it was ended by a request.
fn one(
    plan: &Plan,
    (index, case): (usize, &Case),
    options: &ExecuteOptions<'_>,
) -> Result<Option<CaseDone>, ExecuteError> {
    let is_repeated = options.selection.repeats(index);
    let mut by = String::new();
    for _ in 0..TRIES {
        match try_one(plan, case, options, is_repeated)? {
            Tried::Done(done) => return Ok(Some(done)),
            Tried::Cancelled => return Ok(None),
            Tried::Outside(signal) => by = signal,
        }
    }
    Err(ExecuteError::Ended { case: case.id.clone(), by })
}

enum Tried {
    Done(CaseDone),
    Cancelled,
    /// The process was ended from outside.
    Outside(String),
}

/// Runs one case in a process of its own.
fn try_one(
    plan: &Plan,
    case: &Case,
    options: &ExecuteOptions<'_>,
    is_repeated: bool,
) -> Result<Tried, ExecuteError> {
    let system = |action, path: &Path, source| ExecuteError::System {
        action,
        path: path.to_owned(),
        source,
    };
    let job = CaseJob {
        case: case.clone(),
        scenario: plan.planned(case)?.clone(),
        memory_mib: plan.limits.memory_mib,
        folder: options.folder.to_owned(),
    };
    let job = serde_json::to_vec(&job)
        .map_err(|error| system("describe the case to", options.program, error.into()))?;
    let child = command(options.program)
        .args(["campaign", "one"])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| system("start", options.program, error))?;
    // A limit that isn't a number counts as no limit.
    let limit = Duration::try_from_secs_f64(plan.limits.time_s).unwrap_or(Duration::MAX);
    let outcome = finish(child, &job, WORDS, limit, options.cancel)
        .map_err(|error| system("wait for", options.program, error))?;
    let words = outcome.err;
    let error = match outcome.ended {
        ChildEnded::Cancelled => return Ok(Tried::Cancelled),
        // The stored result is the one of the first time.
        ChildEnded::Outside(by) if is_repeated => return Ok(Tried::Outside(by)),
        // The process may have been ended after it stored the result.
        ChildEnded::Outside(_) | ChildEnded::TooLong
            if case::file(options.folder, &case.id).exists() =>
        {
            return Ok(Tried::Done(kept(case, options)?));
        }
        ChildEnded::Outside(by) => return Ok(Tried::Outside(by)),
        ChildEnded::Status(status) if status.code() == Some(KEPT) => {
            return Ok(Tried::Done(kept(case, options)?));
        }
        ChildEnded::Status(status) if status.code() == Some(i32::from(NOT_KEPT)) => {
            return Err(ExecuteError::NotKept(said(&words).to_owned()));
        }
        ChildEnded::Status(status) => failure(status, &words, plan.limits.memory_mib),
        ChildEnded::TooLong => format!("it took more than its {} s", plan.limits.time_s),
    };
    let result = CaseResult::broken(&case.id, error);
    let bytes = result.to_json().map_err(|error| system("write", options.folder, error.into()))?;
    let path = case::file(options.folder, &case.id);
    let kept = case::keep(options.folder, &case.id, bytes.as_bytes())
        .map_err(|error| system("write", &path, error))?;
    let differs = if let StoreOutcome::Differs(other) = kept { Some(other) } else { None };
    Ok(Tried::Done(CaseDone { index: 0, verdict: result.verdict, reason: result.error, differs }))
}

/// Returns the outcome from the stored result.
fn kept(case: &Case, options: &ExecuteOptions<'_>) -> Result<CaseDone, ExecuteError> {
    let path = case::file(options.folder, &case.id);
    let result = CaseResult::read(&path).map_err(|reason| ExecuteError::System {
        action: "read",
        path: path.clone(),
        source: std::io::Error::other(reason),
    })?;
    let reasons = result.summary.as_ref().map(|summary| summary.reasons.as_slice());
    let reason = reasons.and_then(|reasons| reasons.first().cloned());
    let reason = reason.filter(|_| result.verdict != Verdict::Pass);
    Ok(CaseDone { index: 0, verdict: result.verdict, reason, differs: differing(&path, &case.id) })
}

/// Returns the message of a process, without the name of the program.
fn said(words: &str) -> &str {
    let said = words.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or("");
    said.trim_start_matches("error: ")
}

/// Describes why a process stored nothing.
fn failure(status: ExitStatus, words: &str, memory_mib: u64) -> String {
    let said = said(words);
    if words.contains("memory allocation of") {
        return format!("it wanted more than its {memory_mib} MiB of memory");
    }
    match status.code() {
        Some(_) if !said.is_empty() => said.to_owned(),
        Some(code) => format!("it ended with status {code} and no word"),
        None => format!("it crashed: {status}{}{said}", if said.is_empty() { "" } else { ", " }),
    }
}

/// Refuses a folder with results of another plan, which would be counted as well.
pub(crate) fn refuse_foreign(plan: &Plan, folder: &Path) -> Result<(), ExecuteError> {
    let known: std::collections::HashSet<&str> =
        plan.cases.iter().map(|case| case.id.as_str()).collect();
    let mut foreign: Vec<String> =
        results(folder).into_iter().filter(|id| !known.contains(id.as_str())).collect();
    foreign.sort();
    match foreign.first() {
        None => Ok(()),
        Some(one) => Err(ExecuteError::Foreign {
            folder: folder.to_owned(),
            count: foreign.len(),
            one: one.clone(),
        }),
    }
}

/// Lists the ids of the cases that have results in a folder.
pub(crate) fn results(folder: &Path) -> Vec<String> {
    let read = |folder: PathBuf| std::fs::read_dir(folder).into_iter().flatten().flatten();
    read(folder.join("cases"))
        .flat_map(|part| read(part.path()))
        .filter_map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            let id = name.strip_suffix(".json")?;
            (!id.contains('.')).then(|| id.to_owned())
        })
        .collect()
}
