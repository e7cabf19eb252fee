//! A run: epochs driven from source to endpoint to recorder, watched on the way, then scored.
//!
//! [`drive()`] is the loop, [`faulted`] the one with faults between source and endpoint, [`realtime`] the one that goes by the clock, [`host`] what faults do to the host; [`watch`] what is noticed while it runs: [`follow`] whether it follows its input, [`done`] what was done of the plan; [`method`] one method from its
//! scenario to its scores; [`concluded`] what the end of a stream concludes; [`findings`] what besides requirements bears on the verdict; [`assemble()`] the summary and report of a run of one or two methods.

pub mod assemble;
pub mod concluded;
pub mod done;
pub mod drive;
pub mod faulted;
pub mod findings;
pub mod follow;
pub mod host;
pub mod method;
pub mod minimise;
pub mod paired;
pub mod raw_counts;
pub mod realtime;
pub mod side_by_side;
pub mod sweep;
pub mod twin;
pub mod unit;
pub mod watch;

pub use assemble::{Run, assemble};
pub use drive::{Control, Ended, RunError, drive};
pub use faulted::{Faulted, drive_faulted};
pub use host::Host;
pub use method::{MethodRun, Recording, run_method};
pub use watch::Watcher;
