//! `octant fmu`: builds, checks and steps FMUs.

mod arguments;
mod build;
mod check;
mod host;
mod run;
mod run_source;

pub(crate) use run::time_limit_of;

use crate::failure::Failure;
use crate::given::GivenOptions;
use clap::{Args, Subcommand};
use octant_verdict::Verdict;

/// Build, check and step FMUs.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Build the FMUs of the calibration core and the plant.
    Build(build::Arguments),
    /// Check an FMU of any tool.
    Check(check::Arguments),
    /// Step any FMU, with inputs from a file or a source.
    Run(arguments::Arguments),
    /// Hold an FMU for another process: for the program's own use.
    #[command(hide = true)]
    Host(host::Arguments),
}

/// Runs the command.
pub(super) fn command(arguments: &Arguments, given: &GivenOptions) -> Result<Verdict, Failure> {
    let Arguments { command } = arguments;
    match command {
        Command::Build(arguments) => build::command(arguments),
        Command::Check(arguments) => check::command(arguments),
        Command::Run(arguments) => run::command(arguments, given),
        Command::Host(arguments) => host::command(arguments),
    }
}
