//! All cases of a plan, each in a process of its own: one that crashes, hangs or wants too much memory
//! is one case's error.

use super::case::{self, CaseResult, Job, Kept};
use super::plan::{Case, Plan, PlanError};
use super::process::{Ended, TRIES, command, wait};
use octant_requirements::Verdict;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Exit status of a process that kept its result.
const KEPT: i32 = 0;
/// Exit status of a process that has a result and can't keep it (EX_CANTCREAT of sysexits.h): that says
/// nothing of its case, and the next one would do no better.
pub const NOT_KEPT: u8 = 73;
/// Of what a process says on its standard error, so much is kept.
const WORDS: u64 = 4096;

/// A part of a plan: every so many-th case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which one, from 1.
    pub number: u32,
    /// How many there are.
    pub of: u32,
}

impl Shard {
    /// All cases.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Whether a case, by its place in the plan, is in it.
    #[must_use]
    pub fn has(self, index: usize) -> bool {
        index % self.of as usize == self.number as usize - 1
    }

    /// The part that a scheduler names in the environment of a task, by the variables that Slurm
    /// (array jobs) and Kubernetes (indexed jobs) set; everything where there is none.
    ///
    /// # Errors
    /// If there is a number of a part, and nothing says how many there are.
    pub fn of_scheduler(variable: impl Fn(&str) -> Option<String>) -> Result<Self, String> {
        let number = |name: &str| variable(name).and_then(|text| text.trim().parse::<u32>().ok());
        let slurm = number("SLURM_ARRAY_TASK_ID");
        let kubernetes = number("JOB_COMPLETION_INDEX").map(|index| index.saturating_add(1));
        let Some(part) = slurm.or(kubernetes) else { return Ok(Self::WHOLE) };
        // Some tasks of an array that are submitted again have a count of their own.
        let array = || {
            let (least, most) = (number("SLURM_ARRAY_TASK_MIN")?, number("SLURM_ARRAY_TASK_MAX")?);
            (least == 1 && number("SLURM_ARRAY_TASK_COUNT") == Some(most)).then_some(most)
        };
        match number("OCTANT_SHARDS").or_else(array) {
            Some(of) if (1..=of).contains(&part) => Ok(Self { number: part, of }),
            Some(of) => Err(format!("the scheduler names part {part} of {of}: expected 1 to {of}")),
            None => Err(format!(
                "the scheduler names part {part}, and not of how many: expected OCTANT_SHARDS in the \
                 environment, or --shard K/N"
            )),
        }
    }

    /// `3/16`.
    ///
    /// # Errors
    /// In words: what was found and what was expected.
    pub fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').map(|(a, b)| (a.trim().parse(), b.trim().parse()));
        match parts {
            Some((Ok(number), Ok(of))) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => {
                Err(format!("found {text:?}, expected a part and the number of parts, as in 3/16"))
            }
        }
    }
}

/// What a campaign is run with.
#[derive(Debug)]
pub struct Options<'a> {
    /// Its folder.
    pub folder: &'a Path,
    /// The program that runs a case.
    pub program: &'a Path,
    /// Cases at a time.
    pub jobs: usize,
    /// Which cases.
    pub shard: Shard,
    /// Cases of the plan up to here alone.
    pub end: usize,
    /// Cases that ended as errors are run again.
    pub again: bool,
    /// Somebody wants it to end.
    pub cancel: &'a AtomicBool,
}

/// What happens while a campaign runs.
#[derive(Clone, Debug)]
pub enum Event {
    /// So many cases have results already.
    There(usize),
    /// A case has ended.
    Done(Done),
}

/// What became of a case.
#[derive(Clone, Debug)]
pub struct Done {
    /// Its place in the plan.
    pub index: usize,
    /// Its verdict.
    pub verdict: Verdict,
    /// The first reason of a verdict that is no pass.
    pub reason: Option<String>,
    /// The same case came to another result before: it is there, and this one beside it.
    pub differs: Option<PathBuf>,
}

/// What a run of a campaign did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Cases that were run.
    pub run: usize,
    /// Cases whose results were there.
    pub skipped: usize,
    /// Cases that were not begun: somebody wanted it to end.
    pub left: usize,
    /// Results that differ from those of the same case.
    pub differing: Vec<PathBuf>,
}

/// Why a campaign could not be run.
#[derive(Debug, thiserror::Error)]
pub enum ExecuteError {
    /// The plan isn't right, or a scenario was changed.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The folder has results that are not of this plan.
    #[error(
        "run {folder}: it has results of {count} cases that the plan doesn't have, such as {one}"
    )]
    Foreign {
        /// The folder.
        folder: PathBuf,
        /// How many.
        count: usize,
        /// One of them.
        one: String,
    },
    /// A result that is there is none of its case, or contradicts itself; in words.
    #[error("{0}")]
    Result(String),
    /// A process could not keep its result; in its words.
    #[error("{0}")]
    NotKept(String),
    /// A process was ended by somebody else, each time that its case was run.
    #[error(
        "run case {case}: its process was ended from outside {TRIES} times, the last time by {by}: the \
         case has no result"
    )]
    Ended {
        /// The case.
        case: String,
        /// The signal.
        by: String,
    },
    /// A result could not be kept, or a process not started.
    #[error("{action} {path}: {source}")]
    System {
        /// What was tried.
        action: &'static str,
        /// On what.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// Runs the cases that have no result yet. `tell` hears of each as it ends, in any order.
///
/// # Errors
/// If the folder isn't of this plan, or the system refuses: what was kept before stays.
pub fn execute(
    plan: &Plan,
    options: &Options<'_>,
    tell: &(dyn Fn(&Event) + Sync),
) -> Result<Outcome, ExecuteError> {
    plan.check_files()?;
    refuse_foreign(plan, options.folder)?;
    clean(options.folder);
    if options.again {
        forget_errors(plan, options)?;
    }
    let up_to_end = || plan.cases.iter().enumerate().take(options.end);
    let mine = || up_to_end().filter(|(index, _)| options.shard.has(*index));
    let open: Vec<(usize, &Case)> =
        mine().filter(|(_, case)| !case::file(options.folder, &case.id).exists()).collect();
    let skipped = mine().count() - open.len();
    tell(&Event::There(skipped));
    let next = AtomicUsize::new(0);
    let run = AtomicUsize::new(0);
    let broken: Mutex<Option<ExecuteError>> = Mutex::new(None);
    let differing: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
    let cancelled = || options.cancel.load(Ordering::Relaxed);
    std::thread::scope(|scope| {
        for _ in 0..options.jobs.clamp(1, open.len().max(1)) {
            scope.spawn(|| {
                while !cancelled() {
                    let Some((index, case)) = open.get(next.fetch_add(1, Ordering::Relaxed)) else {
                        break;
                    };
                    match one(plan, case, options) {
                        Ok(None) => {}
                        Ok(Some(ended)) => {
                            run.fetch_add(1, Ordering::Relaxed);
                            let ended = Done { index: *index, ..ended };
                            let mut all = differing.lock().unwrap_or_else(PoisonError::into_inner);
                            all.extend(ended.differs.clone());
                            drop(all);
                            tell(&Event::Done(ended));
                        }
                        Err(error) => {
                            next.fetch_max(open.len(), Ordering::Relaxed);
                            let mut first = broken.lock().unwrap_or_else(PoisonError::into_inner);
                            first.get_or_insert(error);
                        }
                    }
                }
            });
        }
    });
    // A process that was ended may have left something.
    clean(options.folder);
    if let Some(error) = broken.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    let run = run.into_inner();
    let mut differing = differing.into_inner().unwrap_or_else(PoisonError::into_inner);
    differing.sort();
    Ok(Outcome { run, skipped, left: open.len() - run, differing })
}

/// Removes what killed processes left of results that were not whole.
fn clean(folder: &Path) {
    for part in std::fs::read_dir(folder.join("cases")).into_iter().flatten().flatten() {
        super::clean(&part.path());
    }
}

/// Takes away the results of cases that came to no summary.
fn forget_errors(plan: &Plan, options: &Options<'_>) -> Result<(), ExecuteError> {
    for (index, case) in plan.cases.iter().enumerate() {
        let path = case::file(options.folder, &case.id);
        if options.shard.has(index)
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

/// Runs one case, again where somebody else ends its process; `None`: it was ended because somebody wanted
/// that.
fn one(plan: &Plan, case: &Case, options: &Options<'_>) -> Result<Option<Done>, ExecuteError> {
    let mut by = String::new();
    for _ in 0..TRIES {
        match try_one(plan, case, options)? {
            Tried::Done(done) => return Ok(Some(done)),
            Tried::Cancelled => return Ok(None),
            Tried::Outside(signal) => by = signal,
        }
    }
    Err(ExecuteError::Ended { case: case.id.clone(), by })
}

enum Tried {
    Done(Done),
    Cancelled,
    /// Its process was ended by somebody else.
    Outside(String),
}

/// Runs one case in a process of its own.
fn try_one(plan: &Plan, case: &Case, options: &Options<'_>) -> Result<Tried, ExecuteError> {
    let system = |action, path: &Path, source| ExecuteError::System {
        action,
        path: path.to_owned(),
        source,
    };
    let job = Job {
        case: case.clone(),
        scenario: plan.planned(case)?.clone(),
        memory_mib: plan.limits.memory_mib,
        folder: options.folder.to_owned(),
    };
    let mut child = command(options.program)
        .args(["campaign", "one"])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| system("start", options.program, error))?;
    let input = child.stdin.take();
    let words = child.stderr.take();
    // What it says is read beside it: a full pipe would hold it up.
    let (status, words) = std::thread::scope(|scope| {
        let words = scope.spawn(move || {
            let mut text = String::new();
            if let Some(mut words) = words {
                // A process that says what is no text, or goes, says less.
                let _ = words.by_ref().take(WORDS).read_to_string(&mut text);
                let _ = std::io::copy(&mut words, &mut std::io::sink());
            }
            text
        });
        if let Some(mut input) = input {
            // One that is gone already is told by its status.
            let _ = serde_json::to_writer(&mut input, &job);
            let _ = input.flush();
        }
        // A limit of no number is none.
        let limit = Duration::try_from_secs_f64(plan.limits.time_s).unwrap_or(Duration::MAX);
        let status = wait(&mut child, limit, options.cancel);
        (status, words.join().unwrap_or_default())
    });
    let error = match status.map_err(|error| system("wait for", options.program, error))? {
        Ended::Cancelled => return Ok(Tried::Cancelled),
        // Its end may have come after the result.
        Ended::Outside(_) | Ended::TooLong if case::file(options.folder, &case.id).exists() => {
            return Ok(Tried::Done(kept(case, options)?));
        }
        Ended::Outside(by) => return Ok(Tried::Outside(by)),
        Ended::Status(status) if status.code() == Some(KEPT) => {
            return Ok(Tried::Done(kept(case, options)?));
        }
        Ended::Status(status) if status.code() == Some(i32::from(NOT_KEPT)) => {
            return Err(ExecuteError::NotKept(said(&words).to_owned()));
        }
        Ended::Status(status) => failure(status, &words, plan.limits.memory_mib),
        Ended::TooLong => format!("it took more than its {} s", plan.limits.time_s),
    };
    let result = CaseResult::broken(&case.id, error);
    let bytes = result.to_json().map_err(|error| system("write", options.folder, error.into()))?;
    let path = case::file(options.folder, &case.id);
    let kept = case::keep(options.folder, &case.id, bytes.as_bytes())
        .map_err(|error| system("write", &path, error))?;
    let differs = if let Kept::Differs(other) = kept { Some(other) } else { None };
    Ok(Tried::Done(Done { index: 0, verdict: result.verdict, reason: result.error, differs }))
}

/// What a process kept.
fn kept(case: &Case, options: &Options<'_>) -> Result<Done, ExecuteError> {
    let path = case::file(options.folder, &case.id);
    let result = CaseResult::read(&path).map_err(|reason| ExecuteError::System {
        action: "read",
        path: path.clone(),
        source: std::io::Error::other(reason),
    })?;
    let reasons = result.summary.as_ref().map(|summary| summary.reasons.as_slice());
    let reason = reasons.and_then(|reasons| reasons.first().cloned());
    let reason = reason.filter(|_| result.verdict != Verdict::Pass);
    Ok(Done { index: 0, verdict: result.verdict, reason, differs: differing(&path, &case.id) })
}

/// A result of the same case that isn't the same.
pub(crate) fn differing(path: &Path, id: &str) -> Option<PathBuf> {
    let start = format!("{id}.differs-");
    let mut found: Vec<PathBuf> = std::fs::read_dir(path.parent()?)
        .ok()?
        .flatten()
        .filter(|entry| entry.file_name().to_string_lossy().starts_with(&start))
        .map(|entry| entry.path())
        .collect();
    found.sort();
    found.into_iter().next()
}

/// What a process said itself, without the name of the program.
fn said(words: &str) -> &str {
    let said = words.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or("");
    said.trim_start_matches("octant: ")
}

/// Why a process kept nothing.
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

/// That a folder has no results but those of a plan: others would be counted with ours.
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

/// Ids of the cases that have results in a folder.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn shard(variables: &[(&str, &str)]) -> Result<Shard, String> {
        let value = |name: &str| {
            let found = variables.iter().find(|(other, _)| *other == name);
            found.map(|(_, value)| (*value).to_owned())
        };
        Shard::of_scheduler(value)
    }

    #[test]
    fn the_scheduler_names_the_part() {
        assert_eq!(shard(&[]), Ok(Shard::WHOLE));
        let array = |id, least, most, count| {
            shard(&[
                ("SLURM_ARRAY_TASK_ID", id),
                ("SLURM_ARRAY_TASK_MIN", least),
                ("SLURM_ARRAY_TASK_MAX", most),
                ("SLURM_ARRAY_TASK_COUNT", count),
            ])
        };
        assert_eq!(array("3", "1", "16", "16"), Ok(Shard { number: 3, of: 16 }));
        // Two of sixteen, submitted again.
        assert!(array("5", "5", "6", "2").unwrap_err().contains("not of how many"));
        assert!(array("1", "1", "16", "4").is_err(), "every fourth");
        let indexed = [("JOB_COMPLETION_INDEX", "0"), ("OCTANT_SHARDS", "7")];
        assert_eq!(shard(&indexed), Ok(Shard { number: 1, of: 7 }));
        assert!(shard(&indexed[..1]).unwrap_err().contains("OCTANT_SHARDS"));
        let again = [("SLURM_ARRAY_TASK_ID", "5"), ("OCTANT_SHARDS", "16")];
        assert_eq!(shard(&again), Ok(Shard { number: 5, of: 16 }));
        let beyond = [("SLURM_ARRAY_TASK_ID", "17"), ("OCTANT_SHARDS", "16")];
        assert!(shard(&beyond).unwrap_err().contains("expected 1 to 16"));
    }

    #[test]
    fn every_case_is_in_one_shard() {
        for of in 1..9 {
            for index in 0..50 {
                let of_it = (1..=of).filter(|number| Shard { number: *number, of }.has(index));
                assert_eq!(of_it.count(), 1);
            }
        }
        assert_eq!(Shard::parse("3/16"), Ok(Shard { number: 3, of: 16 }));
        for wrong in ["", "3", "0/4", "5/4", "a/b", "1/0"] {
            assert!(Shard::parse(wrong).unwrap_err().contains("as in 3/16"), "{wrong}");
        }
    }
}
