//! `octant fmu build`.

use super::super::Failure;
use crate::score::verdict::Verdict;
use clap::Args;

/// Make the FMUs of the calibration core and the plant.
#[derive(Debug, Args)]
pub(super) struct Arguments {}

/// Runs the command.
pub(super) fn command(_arguments: &Arguments) -> Result<Verdict, Failure> {
    Err(Failure::input("octant fmu build is not part of this version"))
}
