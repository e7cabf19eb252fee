//! `octant fmu host`.

use super::super::Failure;
use crate::score::verdict::Verdict;
use clap::Args;

/// Hold an FMU for another process: for the program's own use.
#[derive(Debug, Args)]
pub(super) struct Arguments {}

/// Runs the command.
pub(super) fn command(_arguments: &Arguments) -> Result<Verdict, Failure> {
    Err(Failure::input("octant fmu host is not part of this version"))
}
