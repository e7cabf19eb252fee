//! Events and outcome of an execution, and reasons why there is none.

use super::process::TRIES;
use crate::journal::JournalError;
use crate::judge::status::StatusError;
use crate::plan::PlanError;
use crate::store::error::{PartError, ResultPlace};
use octant_base::failing::{Failing, FailureKind};
use octant_verdict::Verdict;
use std::path::PathBuf;

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
    /// Place of this result beside an earlier, different result of the same case.
    pub differs: Option<ResultPlace>,
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
    pub differing: Vec<ResultPlace>,
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
    /// Another run works on the folder.
    #[error(
        "run {folder}: another octant campaign run works on it: wait for its end, or give each run a shard of its own, \
         --shard K/N"
    )]
    Running {
        /// The folder.
        folder: PathBuf,
    },
    /// The journal of the campaign can't be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// An existing result doesn't belong to its case, or contradicts itself.
    #[error(transparent)]
    Result(#[from] StatusError),
    /// A process could not store a result that it had; its own message.
    #[error("{0}")]
    NotKept(String),
    /// The outcome of a case could not be stored.
    #[error(transparent)]
    Part(#[from] PartError),
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

impl Failing for ExecuteError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Plan(error) => error.kind(),
            Self::Journal(error) => error.kind(),
            Self::Foreign { .. } | Self::Running { .. } => FailureKind::Input,
            Self::Result(_)
            | Self::NotKept(_)
            | Self::Part(_)
            | Self::Ended { .. }
            | Self::System { .. } => FailureKind::Bench,
        }
    }
}
