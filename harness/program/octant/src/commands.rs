//! Commands of the program, and its entry point.

use crate::failure::Failure;
use crate::given::GivenOptions;
use crate::terminal::{note, print, printable, styled};
use crate::{
    campaign, capture, characterise, compare, completions, design, diff, doctor, export, faults,
    fmu, new, nightly, observe, operator, power, progress, rare, rejudge, replay, report,
    requirements, run, score, selftest, serve, smooth, turntable, verify, watch,
};
use clap::{FromArgMatches, Parser, Subcommand};
use octant_verdict::Verdict;
use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

/// Test harness for the self-calibration of dual-axis rotational inertial navigation systems.
#[derive(Debug, Parser)]
#[command(name = "octant", version, max_term_width = 100, propagate_version = true)]
struct Cli {
    /// Id of the parent process that runs this case: this process ends with it, and leaves signals to it.
    #[arg(long, value_name = "PID", hide = true)]
    parent: Option<u32>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Write a commented scenario, from flags and from questions on a terminal.
    New(new::NewArguments),
    /// Run a scenario or a system of FMUs: calibrate, navigate, score, and write a folder of evidence.
    Run(run::Arguments),
    /// Answer a question that a run asks its operator.
    Answer(operator::AnswerArguments),
    /// Hold, resume or abort a run, or list what its operator was asked.
    Operator(operator::OperatorArguments),
    /// Compare two methods over many seeds, on the same instruments with the same noise.
    Compare(compare::Arguments),
    /// Compare two runs or two campaigns: settings, samples, scores.
    Diff(diff::Arguments),
    /// Run the core again on a recorded stream, and compare the outputs.
    Replay(replay::Arguments),
    /// Smooth the calibration of a run, and test what it takes for constant.
    Smooth(smooth::SmoothArguments),
    /// Run a campaign of many cases: plan it, run it on any number of hosts, merge and report results.
    Campaign(campaign::Arguments),
    /// Run the nightly regression: a fault suite and campaigns, compared with the accepted baseline.
    Nightly(nightly::Arguments),
    /// Run known-answer tests through this program, and check its own verdicts.
    Selftest(selftest::Arguments),
    /// Check a file of requirements, or convert it to the format of another tool.
    Requirements(requirements::Arguments),
    /// Serve the core as a device that a harness drives over a port.
    Serve(serve::Arguments),
    /// Keep what an instrument sends over a port, byte for byte.
    Capture(capture::CaptureArguments),
    /// Score a recording, without running the core.
    Score(score::Arguments),
    /// Export a recording to CSV, Parquet, MAT, KML, or MCAP with messages of ROS 2.
    Export(export::Arguments),
    /// Predict the observability and the accuracy of a sequence, without running it.
    Observe(observe::Arguments),
    /// Design the calibration sequence with the least drift, and tell the bound of all sequences.
    Design(design::Arguments),
    /// Characterise an instrument from a recording at rest: noise terms, lines, and a scenario with its twin.
    Characterise(characterise::Arguments),
    /// Write the report of a finished run again.
    Report(report::Arguments),
    /// Check that a folder of evidence is unchanged, bit for bit.
    Verify(verify::Arguments),
    /// Derive the verdicts of a stored folder again, and compare them with the stored ones.
    Rejudge(rejudge::Arguments),
    /// Watch a run: its progress, drift, parameters, faults and lateness.
    Watch(watch::Arguments),
    /// List and describe the kinds of faults, sweep a fault, search for the worst, or minimise a set of faults.
    Faults(faults::Arguments),
    /// Estimate the probability of a rare failure of a requirement, or protection levels of a calibration.
    Rare(rare::Arguments),
    /// Build, check and step FMUs.
    Fmu(fmu::Arguments),
    /// Look at the supply or the relay of a device, and switch it by hand.
    Power(power::Arguments),
    /// Query, move or stop a turntable by hand, or simulate one.
    Turntable(turntable::Arguments),
    /// Check whether this host is fit for real-time runs, and advise what to change.
    Doctor(doctor::Arguments),
    /// Print the JSON Schema of scenarios, for completion in editors.
    Schema,
    /// Print the completion script of a shell.
    Completions(completions::CompletionArguments),
    /// Write the manual pages of all commands.
    Man(completions::ManArguments),
    #[command(external_subcommand)]
    Other(Vec<OsString>),
}

/// Returns the command line with all of its commands and options, hidden ones too.
#[must_use]
pub fn command_line() -> clap::Command {
    <Cli as clap::CommandFactory>::command()
}

/// Reports an unknown command.
fn other(words: &[OsString]) -> Failure {
    let name = words.first().map_or("".into(), |word| word.to_string_lossy());
    let command = command_line();
    let known: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
    let known = octant_base::names::suggestion(&name, known.into_iter(), "commands");
    Failure::input(format!("unknown command {name:?}, {known}"))
}

/// Checks whether the program accepts a command line, program first; nothing is run.
///
/// # Errors
/// If it would be refused.
pub fn parses<'a>(words: impl IntoIterator<Item = &'a str>) -> Result<(), RefusedCommand> {
    match Cli::try_parse_from(words) {
        Ok(Cli { command: Command::Other(words), .. }) => {
            Err(RefusedCommand { message: other(&words).message })
        }
        Ok(_) => Ok(()),
        Err(error) => Err(RefusedCommand { message: error.to_string() }),
    }
}

/// Refusal of a command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefusedCommand {
    message: String,
}

impl std::fmt::Display for RefusedCommand {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for RefusedCommand {}

/// Prints help, the version, or the error of a command line, as clap does it.
fn help(told: &clap::Error) -> u8 {
    // The style of the program's own errors: fragments without a full stop.
    let text = printable(&told.render().to_string()).into_owned();
    let text = text.replace("For more information, try '--help'.", "try --help for all options");
    let text = text.replace("invalid digit found in string", "expected a whole number");
    // A reader that has gone (`| head`) is no failure.
    let _ = match told.use_stderr() {
        true => std::io::stderr().write_all(styled(&text, &std::io::stderr()).as_bytes()),
        false => std::io::stdout().write_all(styled(&text, &std::io::stdout()).as_bytes()),
    };
    u8::try_from(told.exit_code()).unwrap_or(2)
}

/// Names this build in the manifests that the process writes.
pub(crate) fn say_build() {
    octant_evidence::build::say(octant_evidence::build::Build {
        git_commit: env!("OCTANT_GIT_COMMIT"),
        is_git_dirty: env!("OCTANT_GIT_DIRTY") == "true",
        rustc: env!("OCTANT_RUSTC"),
        lock_file_sha256: env!("OCTANT_LOCK_FILE"),
    });
}

/// Runs the program and returns its exit status.
#[must_use]
pub fn main() -> ExitCode {
    octant_base::memory::on_no_thread();
    ExitCode::from(status())
}

/// Parses the command line of this process.
fn parsed() -> Result<(Cli, GivenOptions), clap::Error> {
    let mut command = command_line();
    let matches = command.try_get_matches_from_mut(std::env::args_os())?;
    let cli = Cli::from_arg_matches(&matches).map_err(|error| error.format(&mut command))?;
    Ok((cli, GivenOptions::of(&command, &matches)))
}

/// Runs the program; its exit status as a number.
pub(crate) fn status() -> u8 {
    say_build();
    let (Cli { parent, command }, given) = match parsed() {
        Ok(parsed) => parsed,
        Err(told) => return help(&told),
    };
    if let Some(parent) = parent
        && let Err(error) = progress::leave_interrupts_to(parent)
    {
        note!("error: failed to follow process {parent}: {error}");
        return Verdict::Error.exit_code();
    }
    let outcome = match command {
        Command::New(arguments) => new::command(&arguments),
        Command::Run(arguments) => run::command(&arguments, &given),
        Command::Answer(arguments) => operator::answer(&arguments),
        Command::Operator(arguments) => operator::command(&arguments),
        Command::Campaign(arguments) => campaign::command(&arguments, &given),
        Command::Nightly(arguments) => nightly::command(&arguments),
        Command::Selftest(arguments) => selftest::command(&arguments),
        Command::Requirements(arguments) => requirements::command(&arguments),
        Command::Compare(arguments) => compare::command(&arguments),
        Command::Replay(arguments) => replay::command(&arguments),
        Command::Smooth(arguments) => smooth::command(&arguments),
        Command::Serve(arguments) => serve::command(&arguments),
        Command::Capture(arguments) => capture::command(&arguments),
        Command::Score(arguments) => score::command(&arguments, &given),
        Command::Diff(arguments) => diff::command(&arguments),
        Command::Export(arguments) => export::command(&arguments),
        Command::Observe(arguments) => observe::command(&arguments),
        Command::Design(arguments) => design::command(&arguments),
        Command::Characterise(arguments) => characterise::command(&arguments),
        Command::Report(arguments) => report::command(&arguments),
        Command::Verify(arguments) => verify::command(&arguments),
        Command::Rejudge(arguments) => rejudge::command(&arguments),
        Command::Watch(arguments) => watch::command(&arguments),
        Command::Faults(arguments) => faults::command(&arguments, &given),
        Command::Rare(arguments) => rare::command(&arguments),
        Command::Doctor(arguments) => doctor::command(&arguments),
        Command::Power(arguments) => power::command(&arguments, &given),
        Command::Turntable(arguments) => turntable::command(&arguments),
        Command::Fmu(arguments) => fmu::command(&arguments, &given),
        Command::Other(words) => Err(other(&words)),
        Command::Completions(arguments) => completions::completions(&arguments, command_line()),
        Command::Man(arguments) => completions::man(&arguments, command_line()),
        Command::Schema => {
            print(&format!("{:#}\n", octant_scenario::schema())).map(|()| Verdict::Pass)
        }
    };
    match outcome {
        Ok(verdict) => verdict.exit_code(),
        Err(failure) => {
            let line = format!("error: {}\n", printable(&failure.message));
            eprint!("{}", styled(&line, &std::io::stderr()));
            failure.status
        }
    }
}
