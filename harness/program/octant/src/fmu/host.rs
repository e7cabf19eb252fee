//! `octant fmu host`.

use crate::failure::Failure;
use clap::Args;
use octant_verdict::Verdict;

/// Hold an FMU for another process: for the program's own use.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Name of the FMU in messages.
    #[arg(long, hide = true, default_value = "the FMU", conflicts_with = "unguarded")]
    name: String,
    /// Hold the FMU in this process, which another of these started.
    #[arg(long, hide = true)]
    unguarded: bool,
}

/// Runs the command.
#[cfg(target_os = "linux")]
pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    use octant_fmu_host::process::{guard::guard, host::serve};
    let Arguments { name, unguarded } = arguments;
    let served = if *unguarded { serve() } else { guard(name) };
    served.map_err(Failure::input)?;
    Ok(Verdict::Pass)
}

/// Refuses the command, which doesn't exist on this system.
#[cfg(not(target_os = "linux"))]
pub(super) fn command(_arguments: &Arguments) -> Result<Verdict, Failure> {
    Err(Failure::input("octant fmu host works on Linux only"))
}
