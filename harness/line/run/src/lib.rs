//! A run: epochs on their way from source to endpoint to recorder, observed as they go by, then scored.
//!
//! | folder | what it has |
//! |---|---|
//! | [`observers`] | what is observed of a run as it goes by, one small type for each subject |
//! | [`mod@bench`] | the one owner of a run: source, faults, endpoint, recorder and observers, with the loop over samples |
//! | `results` | what is said of a run that ended: scores, findings, summary and report |
//! | `ways` | the ways to run: once, with a twin, branched, by the clock, stepped by a host, replayed; each says when to step |
//!
//! A folder uses those above it.

pub mod acquired;
pub mod bench;
pub mod observers;
mod results;
mod ways;

pub use bench::ended::{BenchEnd, Ended, RunError, TimeKeeping};
pub use bench::error::{MethodError, SetupError};
pub use bench::faulted::Faulted;
pub use bench::host::RunHost;
pub use bench::interfere::Interferes;
pub use bench::plan::Plan;
pub use bench::recording::StreamKeeping;
pub use bench::{Bench, Records, unit};
pub use observers::Observers;
pub use results::assemble::{Run, assemble};
pub use results::method::{MethodRun, planned_of};
pub use results::{assemble, difference, findings, raw_counts, refusal};
pub use ways::once::{core_of, run_as_far_as_it_goes, run_method};
pub use ways::prepared::{Prepared, PreparedError};
pub use ways::stepped::{Parts, SteppedRun};
pub use ways::{
    branches, many, minimise, paired, passes, prepared, realtime, replayed, side_by_side, smoothed,
    smoothing_doubts, stem, stepped,
};
