//! `octant fmu host`.

use crate::failure::Failure;
use clap::Args;
use octant_requirements::Verdict;

/// Hold an FMU for another process: for the program's own use.
#[derive(Debug, Args)]
pub(super) struct Arguments {}

/// Runs the command.
#[cfg(target_os = "linux")]
pub(super) fn command(_arguments: &Arguments) -> Result<Verdict, Failure> {
    octant_fmu_host::process::host::serve().map_err(Failure::input)?;
    Ok(Verdict::Pass)
}

/// Refuses the command, which doesn't exist on this system.
#[cfg(not(target_os = "linux"))]
pub(super) fn command(_arguments: &Arguments) -> Result<Verdict, Failure> {
    Err(Failure::input("octant fmu host works on Linux only"))
}
