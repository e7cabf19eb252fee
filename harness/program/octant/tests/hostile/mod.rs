//! Attacks of a hostile unit, and their ends: none is a pass. Each attack is a test over each port,
//! and all of them are the table of `docs/qualification/attacks.md`.
//!
//! The unit is the core itself, behind a port, with its answers altered: without an attack it
//! passes, which is the honest counterpart of each.

mod adaptive;
mod answers;
mod bench;
mod campaign_content;
mod campaign_twins;
mod campaigns;
mod fmu;
mod honest;
mod numbers;
mod page;
mod program;
mod sessions;
mod studies;
mod twins;
mod unit;

use octant_verdict::Verdict;

/// End of an attack: with a verdict, or before there is one.
#[derive(Clone, Copy, Debug)]
pub struct Ends {
    /// Exit status of the program.
    pub status: u8,
    /// Words that a reason must contain.
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

/// Row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub group: &'static str,
    pub about: &'static str,
    pub over: &'static str,
    pub ends: Ends,
}
