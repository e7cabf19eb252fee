//! The command line: results on stdout, progress and diagnostics on stderr.
//!
//! Exit status: 0 pass, 1 fail, 2 bad input or usage, 3 inconclusive, 4 error (the bench failed).
#![allow(clippy::print_stdout, reason = "results go to stdout")]

/// A line for people on stderr, in which nothing is obeyed by a terminal.
macro_rules! note {
    ($($words:tt)*) => { eprintln!("{}", $crate::cli::printable(&format!($($words)*))) };
}

mod campaign;
mod compare;
mod doctor;
mod fault_page;
mod faults;
mod fmu;
mod live;
mod minimise;
mod nightly;
mod observe;
mod progress;
mod reexecute;
mod rejudge;
mod replay;
mod report;
mod requirements;
mod run;
mod run_system;
mod score;
mod selftest;
mod serve;
mod sweep;
mod turntable;
mod verify;
mod watch;

use clap::{Args, Parser, Subcommand};
use octant_requirements::Verdict;
use octant_scenario::{Dimension, quantity_of};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// Test harness for the self-calibration of dual-axis rotational inertial navigation systems.
#[derive(Debug, Parser)]
#[command(name = "octant", version, max_term_width = 100, propagate_version = true)]
struct Cli {
    /// The process that started this one for a case: this one ends with it, and leaves signals to it.
    #[arg(long, value_name = "PID", hide = true)]
    parent: Option<u32>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scenario: calibrate, navigate, score, and write a folder of evidence; or a system of FMUs.
    Run(run::Arguments),
    /// Compare two methods over many seeds, on the same instruments with the same noise.
    Compare(compare::Arguments),
    /// Put a recorded stream through the core again.
    Replay(replay::Arguments),
    /// Run many cases: plan them, run them anywhere, merge what came of them.
    Campaign(campaign::Arguments),
    /// Run the fault suite and campaigns, and tell what got worse since the accepted baseline.
    Nightly(nightly::Arguments),
    /// Run cases whose ends are known through this program, and tell whether it can be believed.
    Selftest(selftest::Arguments),
    /// Check a file of requirements, or turn it into one of another tool.
    Requirements(requirements::Arguments),
    /// Serve the core as a device, that a harness drives over a port.
    Serve(serve::Arguments),
    /// Score a recording.
    Score(score::Arguments),
    /// Tell what a sequence can observe and reach, before anything is run.
    Observe(observe::Arguments),
    /// Write the report of a finished run again.
    Report(report::Arguments),
    /// Tell whether a folder of evidence is what was written, to the last bit.
    Verify(verify::Arguments),
    /// Derive the verdicts of a stored folder anew, beside those that it holds.
    Rejudge(rejudge::Arguments),
    /// Watch a run: how far it is, its drift, parameters, faults and lateness.
    Watch(watch::Arguments),
    /// Tell what kinds of faults there are, and what each does.
    Faults(faults::Arguments),
    /// Make, check and step FMUs.
    Fmu(fmu::Arguments),
    /// Look at a turntable, move it and stop it by hand, and play one.
    Turntable(turntable::Arguments),
    /// Tell what this host can do for runs by the clock, and what to change.
    Doctor(doctor::Arguments),
    /// Print the JSON Schema of scenarios, for completion in editors.
    Schema,
    #[command(external_subcommand)]
    Other(Vec<OsString>),
}

/// A command that isn't there.
fn other(words: &[OsString]) -> Failure {
    let name = words.first().map_or("".into(), |word| word.to_string_lossy());
    let command = <Cli as clap::CommandFactory>::command();
    let known: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
    let known = octant_base::names::suggestion(&name, known.into_iter(), "commands");
    Failure::input(format!("unknown command {name:?}, {known}"))
}

/// What every command that takes a scenario has.
#[derive(Debug, Args)]
struct ScenarioArguments {
    /// The scenario, a TOML file.
    #[arg(value_name = "SCENARIO")]
    scenario: PathBuf,
    /// Change one key of the scenario, such as procedure.calibration.duration="12 h".
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
}

/// Why a command ended without a verdict.
#[derive(Debug)]
struct Failure {
    status: u8,
    message: String,
}

impl Failure {
    /// Bad input or usage.
    fn input(error: impl std::fmt::Display) -> Self {
        Self { status: 2, message: error.to_string() }
    }

    /// The bench failed.
    fn bench(error: impl std::fmt::Display) -> Self {
        Self { status: Verdict::Error.exit_code(), message: error.to_string() }
    }
}

impl Failure {
    /// With "failed to" before the message.
    fn failed(self) -> Self {
        Self { message: format!("failed to {}", self.message), ..self }
    }
}

impl From<crate::run::method::MethodError> for Failure {
    fn from(error: crate::run::method::MethodError) -> Self {
        use crate::endpoint::OpenError;
        use crate::fmu::mapping::stepper::UseError;
        use crate::run::RunError;
        use crate::run::method::{MethodError, SetupError};
        use crate::source::SourceError;
        use octant_link::harness::SessionError;
        match &error {
            MethodError::Setup(
                SetupError::Recorder(_)
                | SetupError::Source(
                    SourceError::Use(UseError::Gone { .. })
                    | SourceError::Gone { .. }
                    | SourceError::TableStopped { .. },
                )
                | SetupError::Endpoint(
                    OpenError::Use(UseError::Gone { .. })
                    | OpenError::Live(
                        SessionError::Port(_)
                        | SessionError::NoAnswer { .. }
                        | SessionError::Bye { .. }
                        | SessionError::StartedAnew { .. },
                    ),
                ),
            ) => Self::bench(error),
            MethodError::Setup(SetupError::Source(SourceError::Table(table)))
                if !matches!(table, octant_turntable::Error::Dialect { .. }) =>
            {
                Self::bench(error)
            }
            // A file that can't be read to its end is bad input, not a bench that failed.
            MethodError::Setup(_)
            | MethodError::Run(RunError::Source(SourceError::Read { .. })) => Self::input(error),
            MethodError::Run(_) => Self::bench(error),
        }
    }
}

impl From<crate::run::paired::PairedError> for Failure {
    fn from(error: crate::run::paired::PairedError) -> Self {
        use crate::run::paired::PairedError;
        let message = format!("failed to {error}");
        match error {
            PairedError::Method(error) => Self::from(error),
            PairedError::NoNavigation | PairedError::NotSimulated => Self::input(message),
            PairedError::Cancelled => Self { status: Verdict::Inconclusive.exit_code(), message },
        }
    }
}

/// Whether the program takes a command line, program first; nothing is run.
///
/// # Errors
/// In the words in which it would be refused.
pub fn parses<'a>(words: impl IntoIterator<Item = &'a str>) -> Result<(), String> {
    match Cli::try_parse_from(words) {
        Ok(Cli { command: Command::Other(words), .. }) => Err(other(&words).message),
        Ok(_) => Ok(()),
        Err(error) => Err(error.to_string()),
    }
}

/// Runs the program and returns its exit status.
#[must_use]
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    if let Some(parent) = cli.parent
        && let Err(error) = progress::interrupts::leave_to(parent)
    {
        note!("octant: failed to follow process {parent}: {error}");
        return ExitCode::from(Verdict::Error.exit_code());
    }
    let outcome = match cli.command {
        Command::Run(arguments) => run::command(&arguments),
        Command::Campaign(arguments) => campaign::command(&arguments),
        Command::Nightly(arguments) => nightly::command(&arguments),
        Command::Selftest(arguments) => selftest::command(&arguments),
        Command::Requirements(arguments) => requirements::command(&arguments),
        Command::Compare(arguments) => compare::command(&arguments),
        Command::Replay(arguments) => replay::command(&arguments),
        Command::Serve(arguments) => serve::command(&arguments),
        Command::Score(arguments) => score::command(&arguments),
        Command::Observe(arguments) => observe::command(&arguments),
        Command::Report(arguments) => report::command(&arguments),
        Command::Verify(arguments) => verify::command(&arguments),
        Command::Rejudge(arguments) => rejudge::command(&arguments),
        Command::Watch(arguments) => watch::command(&arguments),
        Command::Faults(arguments) => faults::command(&arguments),
        Command::Doctor(arguments) => doctor::command(&arguments),
        Command::Turntable(arguments) => turntable::command(&arguments),
        Command::Fmu(arguments) => fmu::command(&arguments),
        Command::Other(words) => Err(other(&words)),
        Command::Schema => {
            print(&format!("{:#}\n", octant_scenario::schema())).map(|()| Verdict::Pass)
        }
    };
    match outcome {
        Ok(verdict) => ExitCode::from(verdict.exit_code()),
        Err(failure) => {
            note!("octant: {}", failure.message);
            ExitCode::from(failure.status)
        }
    }
}

/// A time of the command line: a number of seconds, or a quantity.
fn seconds(name: &str, text: &str) -> Result<f64, Failure> {
    let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let quantity = || quantity_of(text).ok().filter(|quantity| quantity.is(Dimension::TIME));
    number.or_else(|| quantity().map(|quantity| quantity.si)).ok_or_else(|| {
        Failure::input(format!("{name}: found {text:?}, expected a time such as 10 or \"10 s\""))
    })
}

/// A text in which nothing is obeyed by a terminal: control characters as their escapes, line breaks and tabs
/// as they are. Names come from files, devices and file systems.
fn printable(text: &str) -> std::borrow::Cow<'_, str> {
    let turns = |c: char| matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_bad = |c: char| turns(c) || (c.is_control() && !"\n\t".contains(c));
    if !text.contains(is_bad) {
        return text.into();
    }
    let mut all = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_bad(c) {
            // As JSON writes it: results are JSON too.
            all += &format!("\\u{:04x}", u32::from(c));
        } else {
            all.push(c);
        }
    }
    all.into()
}

/// Writes a result to stdout. A reader that has gone (`| head`) is no failure.
fn print(text: &str) -> Result<(), Failure> {
    use std::io::Write;
    match std::io::stdout().write_all(printable(text).as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::bench(format!("failed to write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes a file: whole or not at all, where it is one or isn't there yet.
fn write(path: &std::path::Path, contents: impl AsRef<[u8]>) -> Result<(), Failure> {
    let is_other = std::fs::symlink_metadata(path).is_ok_and(|there| !there.is_file());
    let written = if is_other {
        std::fs::write(path, contents)
    } else {
        crate::campaign::keep(path, contents.as_ref())
    };
    written.map_err(|error| Failure::bench(format!("failed to write {}: {error}", path.display())))
}

/// One JSON value and a newline on stdout.
fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::bench(format!("failed to write the result as JSON: {error}")))?;
    print(&(text + "\n"))
}

/// Reads a scenario with what the command line changes in it.
fn load(
    arguments: &ScenarioArguments,
    more: &[String],
) -> Result<octant_scenario::Scenario, Failure> {
    load_fired(arguments, more, &[])
}

/// As [`load`], with faults fired by hand. What is worth a warning goes to stderr.
fn load_fired(
    arguments: &ScenarioArguments,
    more: &[String],
    fires: &[String],
) -> Result<octant_scenario::Scenario, Failure> {
    let mut overrides = arguments.set.clone();
    overrides.extend_from_slice(more);
    let path = &arguments.scenario;
    let scenario =
        octant_scenario::Scenario::load_fired(path, &overrides, fires).map_err(Failure::input)?;
    for warning in scenario.warnings() {
        note!("octant: {}: {warning}", path.display());
    }
    Ok(scenario)
}
