//! `octant answer` and `octant operator`: the operator of a run, from another process.

use crate::failure::Failure;
use crate::operator_terminal::operator_name;
use crate::terminal::{note, print};
use clap::{Args, Subcommand};
use octant_base::failing::{Failing, FailureKind};
use octant_operator::mailbox::{self, DeskReply, DeskRequest};
use octant_operator::{Act, journal};
use octant_verdict::Verdict;
use octant_watch::place::RunPlace;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How long a run is given to take a request: it looks many times a second.
const PATIENCE: Duration = Duration::from_secs(5);

#[derive(Debug, Args)]
pub(super) struct AnswerArguments {
    /// Folder of the run.
    #[arg(value_name = "RUN")]
    run: PathBuf,
    /// Step of the scenario that is asked.
    #[arg(value_name = "ID")]
    id: String,
    /// The answer: yes or no, a number, a text, a choice.
    #[arg(value_name = "VALUE", allow_hyphen_values = true)]
    value: String,
    #[command(flatten)]
    who: Who,
}

#[derive(Debug, Args)]
struct Who {
    /// Name of who answers or asks for it; by default the value of OCTANT_OPERATOR.
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct OperatorArguments {
    #[command(subcommand)]
    command: OperatorCommand,
}

#[derive(Debug, Subcommand)]
enum OperatorCommand {
    /// Hold a run before its next sample.
    Hold(OfRun),
    /// Let a run go on that is held.
    Resume(OfRun),
    /// End a run: it is inconclusive, and its evidence is written.
    Abort(OfRun),
    /// List what was asked and answered in a run, and what is open.
    Status {
        /// Folder of the run.
        #[arg(value_name = "RUN")]
        run: PathBuf,
    },
}

#[derive(Debug, Args)]
struct OfRun {
    /// Folder of the run.
    #[arg(value_name = "RUN")]
    run: PathBuf,
    #[command(flatten)]
    who: Who,
}

impl Who {
    fn name(&self) -> Result<String, Failure> {
        let Self { by } = self;
        let given = by.clone().filter(|name| !name.trim().is_empty());
        given.or_else(operator_name).ok_or_else(|| {
            Failure::input("--by: expected the name of who answers, or a value of OCTANT_OPERATOR")
        })
    }
}

pub(super) fn answer(arguments: &AnswerArguments) -> Result<Verdict, Failure> {
    let AnswerArguments { run, id, value, who } = arguments;
    let request = DeskRequest::Answer { id: id.clone(), value: value.clone(), by: who.name()? };
    send(run, &request)
}

pub(super) fn command(arguments: &OperatorArguments) -> Result<Verdict, Failure> {
    let OperatorArguments { command } = arguments;
    match command {
        OperatorCommand::Hold(OfRun { run, who }) => {
            send(run, &DeskRequest::Hold { by: who.name()? })
        }
        OperatorCommand::Resume(OfRun { run, who }) => {
            send(run, &DeskRequest::Resume { by: who.name()? })
        }
        OperatorCommand::Abort(OfRun { run, who }) => {
            send(run, &DeskRequest::Abort { by: who.name()? })
        }
        OperatorCommand::Status { run } => status(run),
    }
}

/// Finds the present folder of a run, and whether the run goes on.
fn place(run: &Path) -> Result<(PathBuf, bool), Failure> {
    let error = match RunPlace::of(run) {
        Ok(place) => return Ok((place.folder().to_owned(), place.is_written())),
        Err(error) => error,
    };
    // A run that was killed before its start has a journal and no recording.
    let mut partial = run.as_os_str().to_owned();
    partial.push(".partial");
    [run.to_owned(), partial.into()]
        .into_iter()
        .find(|folder| folder.join(journal::FILE_NAME).is_file())
        .map(|folder| (folder, false))
        .ok_or_else(|| Failure::input(format!("failed to {error}")))
}

fn send(run: &Path, request: &DeskRequest) -> Result<Verdict, Failure> {
    let (folder, _) = place(run)?;
    match mailbox::request(&folder, request, PATIENCE) {
        Ok(DeskReply::Taken(words)) => {
            note!("octant: taken: {words}");
            Ok(Verdict::Pass)
        }
        Ok(DeskReply::Refused(reason)) => Err(Failure::input(format!("not taken: {reason}"))),
        Err(error) => Err(match error.kind() {
            FailureKind::Input => Failure::input(error),
            kind => Failure::of_kind(kind, format!("failed to ask: {error}")),
        }),
    }
}

fn status(run: &Path) -> Result<Verdict, Failure> {
    let (folder, goes_on) = place(run)?;
    let records =
        journal::read(&folder).map_err(|error| Failure::input(format!("failed to {error}")))?;
    let mut text = String::new();
    for record in &records {
        text += &format!("{} {}\n", record.at, record.text());
    }
    for asked in journal::open(&records) {
        text += &format!("open: {}\n", asked.step.as_deref().unwrap_or_default());
    }
    let of_hold = |act: &Act| matches!(act, Act::Held | Act::Resumed);
    let is_held = records.iter().map(|record| record.act).rfind(of_hold) == Some(Act::Held);
    text += match (goes_on, is_held) {
        (false, _) => "the run doesn't go on\n",
        (true, true) => "the run is held\n",
        (true, false) => "the run goes on\n",
    };
    print(&text)?;
    Ok(Verdict::Pass)
}
