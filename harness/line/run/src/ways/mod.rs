//! Ways to run: each opens a bench from a plan, and says only when to step.
//!
//! [`once`] runs one method to its end, in simulated time or by the clock ([`realtime`]); [`prepared`] all methods of a
//! scenario with their twins, which share their beginning ([`twin`]); [`branches`] many runs that share theirs, [`many`]
//! judges them, [`stem`] keeps one beginning for runs with some of the faults, [`paired`] compares two methods over seeds.
//! [`stepped`] is for a host program. [`replayed`] repeats a recording, [`smoothed`] with the filter's history,
//! [`passes`] a calibration several times on the same samples.

mod beginning;
pub mod branches;
pub mod many;
pub mod minimise;
pub(crate) mod once;
pub mod paired;
pub mod passes;
pub mod prepared;
pub mod realtime;
pub mod replayed;
mod sessions;
pub mod side_by_side;
pub mod smoothed;
pub mod smoothing_doubts;
pub mod stem;
pub mod stepped;
mod trunk;
mod twin;
