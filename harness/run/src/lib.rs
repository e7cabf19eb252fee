//! A run: epochs driven from source to endpoint to recorder, observed on the way, then scored.
//!
//! [`drive()`] is the loop, [`faulted`] the one with faults between source and endpoint,
//! [`realtime`] the one by the clock, [`host`] the faults of the host; [`watch`] collects
//! observations: [`follow`] checks that answers follow their input, [`done`] counts the completed
//! work; [`method`] runs one method from its scenario to its scores; [`concluded`] stores a
//! calibration that ended with the stream; [`findings`] lists findings besides requirements that
//! affect the verdict; [`assemble()`] builds summary and report of a run of one or two methods.

pub mod assemble;
pub mod concluded;
pub mod done;
pub mod drive;
mod error;
pub mod faulted;
pub mod findings;
pub mod follow;
pub mod host;
pub mod method;
pub mod minimise;
pub mod paired;
pub mod passes;
pub mod prepared;
pub mod raw_counts;
pub mod realtime;
mod recording;
pub mod twin;
pub mod unit;
pub mod watch;

pub use assemble::{Run, assemble};
pub use drive::{Ended, RunError, drive};
pub use faulted::{Faulted, drive_faulted};
pub use host::Host;
pub use method::{MethodRun, Recording, run_method};
pub use prepared::{Prepared, PreparedError};
pub use watch::Watcher;
