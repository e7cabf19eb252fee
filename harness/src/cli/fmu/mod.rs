//! `octant fmu`: FMUs made, checked and stepped.

mod build;
mod check;
mod host;
mod run;
mod run_source;

use super::Failure;
use clap::{Args, Subcommand};
use octant_requirements::Verdict;

/// What is done with FMUs.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Make the FMUs of the calibration core and the plant.
    Build(build::Arguments),
    /// Check any FMU, ours or another's.
    Check(check::Arguments),
    /// Step any FMU, with inputs from a file or a source.
    Run(run::Arguments),
    /// Hold an FMU for another process: for the program's own use.
    #[command(hide = true)]
    Host(host::Arguments),
}

/// Runs the command.
pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    match &arguments.command {
        Command::Build(arguments) => build::command(arguments),
        Command::Check(arguments) => check::command(arguments),
        Command::Run(arguments) => run::command(arguments),
        Command::Host(arguments) => host::command(arguments),
    }
}
