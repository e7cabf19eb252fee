//! `octant fmu run`.

use super::super::Failure;
use crate::score::verdict::Verdict;
use clap::Args;

/// Step any FMU, with inputs from a file or a source.
#[derive(Debug, Args)]
pub(super) struct Arguments {}

/// Runs the command.
pub(super) fn command(_arguments: &Arguments) -> Result<Verdict, Failure> {
    Err(Failure::input("octant fmu run is not part of this version"))
}
