//! The work of a process that runs cases: a case on each line of standard input, its outcome on a
//! line of standard output.

use super::alike::run_alike;
use super::case::{self, CaseError, CaseResult, hash_of};
use super::process::limit_memory;
use crate::plan::{Case, PlannedScenario};
use crate::store::error::ResultPlace;
use crate::store::writer::PartWriter;
use crate::store::{StoreOutcome, keep_in};
use octant_base::child::SEPARATOR;
use octant_base::control::Control;
use octant_verdict::Verdict;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::{self, BufRead, Write};
use std::path::PathBuf;

/// Bytes of a process's messages that are kept.
pub(crate) const WORDS: usize = 4096;

/// A case to run, as a line on standard input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseJob {
    /// The case.
    pub case: Case,
    /// Scenario.
    pub scenario: PlannedScenario,
    /// Limit of the process's memory, MiB.
    pub memory_mib: u64,
    /// The folder of the campaign.
    pub folder: PathBuf,
    /// Beginning of the part file's name.
    pub stem: String,
    /// BLAKE3 of the results that the case has already, if it is run a second time.
    pub known: Vec<String>,
    /// Cases of the same scenario that begin alike and that this process is asked for next: they are run together with
    /// this one, and wait here.
    pub alike: Vec<Case>,
    /// Whether the case and its twin are run from their beginnings.
    pub undivided: bool,
}

/// A line on standard output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum WorkReply {
    /// The process is about to store the result of the case, as this record.
    Stores(RecordAt),
    /// The outcome of a case is stored.
    Done {
        verdict: Verdict,
        /// First reason, unless the verdict is a pass.
        reason: Option<String>,
        /// Place of this result beside a different one.
        differs: Option<RecordAt>,
    },
    /// The result can't be stored: not the fault of the case, and the next one would fail too.
    NotKept { message: String },
}

/// Place of a record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RecordAt {
    pub(crate) part: PathBuf,
    pub(crate) offset: u64,
    pub(crate) case: String,
}

impl From<RecordAt> for ResultPlace {
    fn from(RecordAt { part, offset, case }: RecordAt) -> Self {
        Self::Record { part, offset, case }
    }
}

/// Reasons why a process ends before its input does.
#[derive(Debug, thiserror::Error)]
pub enum WorkError {
    /// The line is no case.
    #[error("read a case on standard input: {0} (octant campaign run starts this)")]
    Job(#[from] serde_json::Error),
    /// The memory can't be limited.
    #[error("limit the memory to {mib} MiB: {source}")]
    Memory {
        /// The limit, MiB.
        mib: u64,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The command that started this process can't be heard or told.
    #[error("talk to the command that started this process: {0}")]
    Pipe(#[from] io::Error),
}

/// Runs the cases of an input, one after another, until it ends.
///
/// # Errors
/// If a line is no case, or the pipes are broken.
pub fn work(
    input: impl BufRead,
    mut output: impl Write,
    mut messages: impl Write,
) -> Result<(), WorkError> {
    let mut writer: Option<PartWriter> = None;
    let mut waiting = BTreeMap::new();
    let mut tell = |reply: &WorkReply| -> Result<(), WorkError> {
        let mut line = serde_json::to_vec(reply)?;
        line.push(b'\n');
        output.write_all(&line)?;
        Ok(output.flush()?)
    };
    for line in input.lines() {
        let line = line?;
        // Messages from here on are those of this case.
        messages.write_all(&[SEPARATOR])?;
        messages.flush()?;
        let job: CaseJob = serde_json::from_str(&line)?;
        let mib = job.memory_mib;
        limit_memory(mib).map_err(|source| WorkError::Memory { mib, source })?;
        let (result, json) = outcome(&job, &mut waiting);
        let not_kept = |error: &dyn std::fmt::Display| WorkReply::NotKept {
            message: format!("failed to {error}"),
        };
        let writer = writer.get_or_insert_with(|| PartWriter::new(&job.folder, &job.stem));
        match writer.next_record() {
            Ok((part, offset)) => {
                let (part, case) = (part.to_owned(), job.case.id.to_string());
                tell(&WorkReply::Stores(RecordAt { part, offset, case }))?;
            }
            Err(error) => {
                tell(&not_kept(&error))?;
                continue;
            }
        }
        let reply = match keep_in(writer, &job.case.id, json.as_bytes(), &job.known) {
            Err(error) => not_kept(&error),
            Ok(kept) => {
                let differs = match kept {
                    StoreOutcome::Differs(ResultPlace::Record { part, offset, case }) => {
                        Some(RecordAt { part, offset, case })
                    }
                    _ => None,
                };
                let reasons = result.summary.as_ref().map(|summary| summary.reasons.as_slice());
                let first = reasons.and_then(|reasons| reasons.first().cloned());
                let reason = result.error.clone().or(first);
                let reason = reason.filter(|_| result.verdict != Verdict::Pass);
                WorkReply::Done { verdict: result.verdict, reason, differs }
            }
        };
        tell(&reply)?;
    }
    Ok(())
}

/// Runs a case, and those that begin alike; or takes its result, if it was one of those. A case that can't be run is
/// an error with the reason.
fn outcome(job: &CaseJob, waiting: &mut BTreeMap<String, CaseResult>) -> (CaseResult, String) {
    let broken = |error: &dyn std::fmt::Display| {
        let message = format!("failed to {error}");
        let result = CaseResult::broken(&job.case.id, cut(said(&message)).to_owned());
        // Values of these types can always be serialised.
        let json = result.to_json().unwrap_or_default();
        (result, json)
    };
    let run = match waiting.remove(&hash_of(&job.scenario, &job.case)) {
        Some(result) => Ok(result),
        None if job.undivided => case::run(&job.scenario, &job.case, &Control::default()),
        None => together(job, waiting),
    };
    match run {
        Err(error) => broken(&error),
        Ok(result) => match result.to_json() {
            Ok(json) => (result, json),
            Err(error) => broken(&error),
        },
    }
}

/// Runs a case and those that begin alike; their results wait. One that has none runs alone when it is asked for.
fn together(
    job: &CaseJob,
    waiting: &mut BTreeMap<String, CaseResult>,
) -> Result<CaseResult, CaseError> {
    let cases: Vec<&Case> = std::iter::once(&job.case).chain(&job.alike).collect();
    let mut results = run_alike(&job.scenario, &cases).into_iter();
    let first = results.next();
    let others = job.alike.iter().zip(results);
    let others = others.filter_map(|(case, result)| Some((case, result.ok()?)));
    waiting.extend(others.map(|(case, result)| (hash_of(&job.scenario, case), result)));
    first.unwrap_or_else(|| case::run(&job.scenario, &job.case, &Control::default()))
}

/// Returns the message of a process, without the name of the program.
pub(crate) fn said(words: &str) -> &str {
    let said = words.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or("");
    said.trim_start_matches("error: ")
}

/// Cuts a message to the length that is kept of it.
fn cut(words: &str) -> &str {
    let end = (0..=WORDS.min(words.len())).rev().find(|end| words.is_char_boundary(*end));
    &words[..end.unwrap_or(0)]
}
