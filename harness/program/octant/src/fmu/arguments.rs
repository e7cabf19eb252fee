//! Arguments of `octant fmu run`.

use crate::failure::Failure;
use clap::{Args, ValueEnum};
use octant_fmu_host::instance::OpenOptions;
use std::path::{Path, PathBuf};

/// Step any FMU, with inputs from a file; or a core, with the samples of a scenario's source.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The FMU, or the folder of an unpacked one.
    #[arg(value_name = "FILE")]
    pub(super) fmu: PathBuf,
    /// Scenario whose source gives the samples for a core: the FMU replaces the scenario's endpoint.
    #[arg(long, value_name = "SCENARIO")]
    pub(super) source: Option<PathBuf>,
    #[command(flatten)]
    pub(super) stepping: SteppingArguments,
    /// Set a parameter, or a constant input, before the start.
    #[arg(long, value_name = "NAME=VALUE")]
    pub(super) set: Vec<String>,
    #[command(flatten)]
    pub(super) opening: OpeningArguments,
    /// File for the outputs, CSV or MCAP; with --source a recording in MCAP.
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Replace an existing file.
    #[arg(long, requires = "out")]
    pub(super) force: bool,
    /// Print one JSON object.
    #[arg(long)]
    pub(super) json: bool,
}

/// Inputs, times and outputs, which with `--source` are those of the scenario.
#[derive(Debug, Args)]
pub(super) struct SteppingArguments {
    /// Inputs: a CSV file with a column of time and one for each variable, with the unit in brackets
    /// where it differs from the variable's: "imu.w [deg/s]".
    #[arg(long, value_name = "FILE.csv")]
    pub(super) input: Option<PathBuf>,
    /// Start time, in s or with a unit; by default that of the FMU's default experiment, else 0.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(super) start: Option<String>,
    /// Stop time; by default that of the default experiment, else the last row of the inputs.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(super) stop: Option<String>,
    /// Communication step; by default that of the default experiment, else 1/500 of the time span.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(super) step: Option<String>,
    /// Relative tolerance of the solver; by default that of the default experiment.
    #[arg(long, value_name = "NUMBER")]
    pub(super) tolerance: Option<f64>,
    /// Variable to record, repeatable; by default all numeric outputs.
    #[arg(long, value_name = "NAME", requires = "out")]
    pub(super) output: Vec<String>,
}

/// How an FMU is opened.
#[derive(Debug, Args)]
pub(super) struct OpeningArguments {
    /// Interface type; by default co-simulation where the FMU has it.
    #[arg(long, value_enum)]
    pub(super) interface: Option<Interface>,
    /// Process that runs the FMU.
    #[arg(long, value_enum, default_value_t = Process::Own)]
    pub(super) process: Process,
    /// Run also an FMU that needs the tool that made it.
    #[arg(long)]
    pub(super) allow_tool: bool,
    #[arg(long, value_name = "TIME", help = OpenOptions::limits_help())]
    pub(super) time_limit: Option<String>,
}

/// Options that both ways of the command obey.
pub(super) struct SharedRunOptions<'a> {
    pub(super) fmu: &'a Path,
    pub(super) set: &'a [String],
    pub(super) opening: &'a OpeningArguments,
    pub(super) out: Option<&'a Path>,
    pub(super) force: bool,
    pub(super) json: bool,
}

/// Interface types.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Interface {
    /// Co-simulation: the FMU steps itself.
    #[value(name = "cs", alias = "co-simulation")]
    CoSimulation,
    /// Model exchange: its equations are integrated here.
    #[value(name = "me", alias = "model-exchange")]
    ModelExchange,
    /// Scheduled execution: its model partitions are activated at the ticks of their clocks.
    #[value(name = "se", alias = "scheduled-execution")]
    ScheduledExecution,
}

/// Where an FMU runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Process {
    /// In a process of its own: a crash or a hang is reported.
    Own,
    /// In this process: faster.
    Shared,
}

/// Refuses to overwrite an existing file without `--force`.
pub(super) fn in_the_way(out: Option<&Path>, force: bool) -> Result<(), Failure> {
    match out {
        Some(path) if path.exists() && !force => Err(Failure::input(format!(
            "failed to create {}: the file exists already; --force replaces it",
            path.display()
        ))),
        _ => Ok(()),
    }
}
