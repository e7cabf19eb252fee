//! The command line: results on stdout, progress and diagnostics on stderr.
//!
//! Exit status: 0 pass, 1 fail, 2 bad input or usage, 3 inconclusive, 4 error (the bench failed).
#![allow(clippy::print_stdout, reason = "results go to stdout")]

mod arguments;
mod asked;
mod attendant;
mod campaign;
mod capture;
pub mod case_progress;
mod characterise;
mod commands;
mod compare;
mod completions;
mod design;
mod diff;
mod doctor;
pub mod embedded;
mod evidenced;
mod export;
mod failure;
mod fault_page;
mod faults;
mod fmu;
mod followed;
mod given;
mod line_solution;
mod live;
mod minimise;
pub mod new;
mod nightly;
mod observe;
mod operator;
mod operator_page;
mod operator_terminal;
mod place;
mod power;
mod progress;
pub mod progress_bar;
mod rare;
mod reexecute;
mod rejudge;
mod replay;
mod report;
mod requirements;
mod run;
mod run_folder;
mod run_request;
mod run_system;
mod score;
mod score_solution;
#[cfg(feature = "dashboard")]
mod screen;
mod search;
mod selftest;
mod serve;
mod signing;
mod smooth;
mod solution_keys;
pub mod source_uri;
mod sweep;
pub mod terminal;
mod turntable;
mod verify;
mod watch;

pub use commands::{RefusedCommand, command_line, main, parses};
