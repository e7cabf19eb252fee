//! What a hostile unit can do, and how each ends: none in a pass. Each attack is a test over each port, and
//! all of them are the table of `docs/qualification/attacks.md`.
//!
//! The unit is the core itself, behind a port, with its answers altered: without an attack it passes, which is
//! the honest neighbour of each.

mod answers;
mod bench;
mod fmu;
mod honest;
mod page;
mod program;
mod sessions;
mod studies;
mod unit;

use octant_requirements::Verdict;

/// How an attack ends: with a verdict, or before there is one.
#[derive(Clone, Copy, Debug)]
pub struct Ends {
    /// Exit status of the program.
    pub status: u8,
    /// Words of a reason.
    pub because: &'static str,
}

pub const fn fails(because: &'static str) -> Ends {
    Ends { status: Verdict::Fail.exit_code(), because }
}

pub const fn open(because: &'static str) -> Ends {
    Ends { status: Verdict::Inconclusive.exit_code(), because }
}

pub const fn breaks(because: &'static str) -> Ends {
    Ends { status: Verdict::Error.exit_code(), because }
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub group: &'static str,
    pub about: &'static str,
    pub over: &'static str,
    pub ends: Ends,
}
