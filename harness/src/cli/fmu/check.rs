//! `octant fmu check`.

use super::super::Failure;
use crate::score::verdict::Verdict;
use clap::Args;

/// Check any FMU, ours or another's.
#[derive(Debug, Args)]
pub(super) struct Arguments {}

/// Runs the command.
pub(super) fn command(_arguments: &Arguments) -> Result<Verdict, Failure> {
    Err(Failure::input("octant fmu check is not part of this version"))
}
