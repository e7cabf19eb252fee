//! A run: epochs driven from source to endpoint to recorder, observed on the way, then scored.
//!
//! [`drive`] has the loop, the only one over samples; [`in_time`] runs it in simulated time, [`realtime`] by the clock,
//! [`replayed`] on a recording, [`passes`] several times on the same samples. [`faulted`] has the
//! faults of a run, [`host`] those of the host; [`watch`] collects observations: [`follow`] checks
//! that answers follow their input, [`done`] counts the completed work, [`at_rest`] keeps the noise of
//! the sensors, `attended` asks a person, [`filtered`] the σ of the filter; [`method`] runs one method from its scenario to its
//! scores, `set_up` opens its source and endpoint once; [`mod@side_by_side`] runs the first steps with faults and without, for a picture;
//! [`findings`] lists findings besides requirements that affect the verdict; [`assemble()`] builds
//! summary and report of a run of one or two methods, [`scores_text`] writes scores for the terminal.
//! [`stepped`] runs one method a step at a time, with parts that others made; [`branches`] runs many that
//! share their beginning, [`many`] judges them; `with_twin` shares that of a
//! recorded run and its twin, [`stem`] keeps one for runs with some of the faults.

mod aligned;
pub mod assemble;
pub mod at_rest;
mod attended;
mod beginning;
mod branch;
pub mod branches;
pub mod done;
pub mod drive;
mod ended;
mod error;
pub mod faulted;
pub mod filtered;
pub mod findings;
pub mod follow;
mod health_events;
pub mod host;
pub mod in_time;
mod interfere;
pub mod many;
mod measured;
pub mod method;
pub mod minimise;
pub mod paired;
pub mod passes;
mod planned;
pub mod prepared;
pub mod raw_counts;
pub mod realtime;
mod recording;
pub mod refusal;
pub mod replayed;
pub mod rotation;
pub mod scores_text;
mod set_up;
pub mod side_by_side;
pub mod smoothed;
pub mod smoothing_doubts;
mod solution;
pub mod stem;
pub mod stepped;
mod true_motion;
mod trunk;
pub mod twin;
pub mod unit;
pub mod watch;
pub mod whiteness;
mod with_twin;

pub use assemble::{Run, assemble};
pub use drive::{Ended, Line, RunError};
pub use faulted::Faulted;
pub use host::RunHost;
pub use in_time::drive_in_time;
pub use interfere::Interferes;
pub use method::{MethodRun, StreamKeeping, run_method};
pub use prepared::{Prepared, PreparedError};
pub use stepped::{Parts, SteppedRun};
pub use watch::Watcher;
