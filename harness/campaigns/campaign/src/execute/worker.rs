//! A process that runs cases one after another, as the command that started it sees it.
//!
//! The outcome of a case doesn't depend on the cases that its process ran before: what ends a process
//! that has run others is tried again in a new one, and counts there.

use super::case::CaseResult;
use super::execution::{CaseDone, ExecuteError};
use super::process::command;
use super::work::{CaseJob, RecordAt, WORDS, WorkReply, said};
use crate::judge::status::StatusError;
use crate::plan::{Case, Plan};
use crate::store::writer::PartWriter;
use crate::store::{CampaignResults, StoreOutcome, has_at, keep_in};
use octant_base::child::{AskedChild, AskedReply, ChildEnded};
use octant_base::memory::OUT_OF_MEMORY;
use octant_verdict::Verdict;
use std::path::Path;
use std::process::ExitStatus;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Settings of a worker.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WorkerOf<'a> {
    pub(crate) plan: &'a Plan,
    /// The folder of the campaign.
    pub(crate) folder: &'a Path,
    /// Program that runs cases.
    pub(crate) program: &'a Path,
    /// Beginning of the names of its part files.
    pub(crate) stem: &'a str,
    pub(crate) cancel: &'a AtomicBool,
}

/// A place for one process at a time.
#[derive(Debug)]
pub(crate) struct Worker<'a> {
    of: WorkerOf<'a>,
    process: Option<WorkerProcess>,
}

#[derive(Debug)]
struct WorkerProcess {
    child: AskedChild,
    /// Record as which it stores the result of its case, once it has told.
    record: Option<RecordAt>,
    /// True if it has run a case to its end.
    is_used: bool,
}

/// Outcome of an attempt at a case.
#[derive(Debug)]
pub(crate) enum Tried {
    Done(CaseDone),
    Cancelled,
    /// The process was ended from outside.
    Outside(String),
    /// A process that had run other cases, or ran others together with this one, has crashed or taken too long: a new
    /// one tells whether the case is to blame.
    InUsed,
}

impl<'a> Worker<'a> {
    pub(crate) fn of(of: WorkerOf<'a>) -> Self {
        Self { of, process: None }
    }

    /// Runs a case. `known` are the results of a case that is run a second time: one that is the same
    /// isn't stored again. `alike` are those that are tried next and begin alike. An `undivided` case doesn't share its
    /// beginning with its twin.
    pub(crate) fn try_case(
        &mut self,
        case: &Case,
        known: &[String],
        alike: &[&Case],
        undivided: bool,
    ) -> Result<Tried, ExecuteError> {
        let WorkerOf { plan, folder, program, stem, cancel } = self.of;
        let system =
            |action, source| ExecuteError::System { action, path: program.to_owned(), source };
        let job = CaseJob {
            case: case.clone(),
            scenario: plan.planned(case)?.clone(),
            memory_mib: plan.limits.memory_mib,
            folder: folder.to_owned(),
            stem: stem.to_owned(),
            known: known.to_vec(),
            alike: alike.iter().map(|case| (*case).clone()).collect(),
            undivided,
        };
        let job = serde_json::to_vec(&job)
            .map_err(|error| system("describe the case to", error.into()))?;
        let mut process = match self.process.take() {
            Some(process) => process,
            None => {
                let mut command = command(program);
                let child = AskedChild::start(command.args(["campaign", "work"]), WORDS);
                let child = child.map_err(|error| system("start", error))?;
                WorkerProcess { child, record: None, is_used: false }
            }
        };
        process.record = None;
        process.child.ask(job);
        // A limit that isn't a number counts as no limit.
        let limit_s = plan.limits.time_s * (1 + alike.len()) as f64;
        let limit = Duration::try_from_secs_f64(limit_s).unwrap_or(Duration::MAX);
        let (ended, words) = loop {
            let reply = process.child.reply(limit, cancel);
            match reply.map_err(|error| system("wait for", error))? {
                AskedReply::Line(line) => match serde_json::from_str(&line) {
                    Ok(WorkReply::Stores(record)) => process.record = Some(record),
                    Ok(WorkReply::Done { verdict, reason, differs }) => {
                        process.is_used = true;
                        self.process = Some(process);
                        let differs = differs.map(Into::into);
                        return Ok(Tried::Done(CaseDone { index: 0, verdict, reason, differs }));
                    }
                    Ok(WorkReply::NotKept { message }) => {
                        return Err(ExecuteError::NotKept(message));
                    }
                    // Something else wrote to standard output.
                    Err(_) => {}
                },
                AskedReply::Ended(ended, words) => break (ended, words),
            }
        };
        let WorkerProcess { child, record, is_used } = process;
        // Its part is free only when it is gone.
        drop(child);
        // The process may have been ended, by a request too, after it stored the result. A case that is run a second time
        // is run once more instead, to compare its results.
        if known.is_empty()
            && let Some(RecordAt { part, offset, .. }) = &record
            && has_at(part, *offset, &case.id)?
        {
            return Ok(Tried::Done(self.stored(case)?));
        }
        let error = match ended {
            ChildEnded::Cancelled => return Ok(Tried::Cancelled),
            ChildEnded::Outside(by) => return Ok(Tried::Outside(by)),
            ChildEnded::Status(_) if is_used => return Ok(Tried::InUsed),
            ChildEnded::Status(_) | ChildEnded::TooLong if !alike.is_empty() => {
                return Ok(Tried::InUsed);
            }
            ChildEnded::Status(status) => failure(status, &words, plan.limits.memory_mib),
            ChildEnded::TooLong => format!("it took more than its {} s", plan.limits.time_s),
        };
        self.broken(case, error, known)
    }

    /// Stores that a case has no summary.
    fn broken(&self, case: &Case, error: String, known: &[String]) -> Result<Tried, ExecuteError> {
        let result = CaseResult::broken(&case.id, error);
        let json = result.to_json().map_err(|error| ExecuteError::System {
            action: "write",
            path: self.of.folder.to_owned(),
            source: error.into(),
        })?;
        let mut writer = PartWriter::new(self.of.folder, self.of.stem);
        let kept = keep_in(&mut writer, &case.id, json.as_bytes(), known)?;
        let differs = if let StoreOutcome::Differs(place) = kept { Some(place) } else { None };
        let done = CaseDone { index: 0, verdict: result.verdict, reason: result.error, differs };
        Ok(Tried::Done(done))
    }

    /// Returns the outcome of a case from its result.
    fn stored(&self, case: &Case) -> Result<CaseDone, ExecuteError> {
        let results = CampaignResults::open(self.of.folder).map_err(StatusError)?;
        let facts = results.facts(self.of.plan, case).map_err(StatusError)?;
        let verdict = facts.as_ref().map_or(Verdict::Error, |facts| facts.verdict);
        let reason = facts.as_ref().and_then(|facts| facts.why().cloned());
        Ok(CaseDone { index: 0, verdict, reason, differs: None })
    }
}

/// Describes why a process stored nothing.
fn failure(status: ExitStatus, words: &str, memory_mib: u64) -> String {
    let said = said(words);
    // The second words are those of `std`, in a program whose allocator says nothing.
    if [OUT_OF_MEMORY, "memory allocation of"].iter().any(|said| words.contains(said)) {
        return format!("it wanted more than its {memory_mib} MiB of memory");
    }
    match status.code() {
        Some(_) if !said.is_empty() => said.to_owned(),
        Some(code) => format!("it ended with status {code} and no word"),
        None => format!("it crashed: {status}{}{said}", if said.is_empty() { "" } else { ", " }),
    }
}
