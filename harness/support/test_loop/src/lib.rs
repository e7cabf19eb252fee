//! Plant and core of the reference instrument in a closed loop, without scenario, recorder or program between them: what
//! the tests of the core's behaviour run.
//!
//! It is for tests, and panics where a configuration is refused.
//!
//! ```
//! use octant_calibration::positions::EIGHT;
//! use octant_test_loop::plant_and_core::ClosedLoop;
//! use octant_test_loop::instrument::InstrumentCase;
//!
//! let mut run = ClosedLoop::of(&InstrumentCase::table_1(1, EIGHT));
//! run.run_to(200);
//! assert_eq!(run.output.sequence, 200);
//! ```
#![allow(clippy::unwrap_used, clippy::print_stdout)]

pub mod instrument;
pub mod plant_and_core;
pub mod squares;

/// Returns how many cases a test draws: all, or fewer where many changes wait for it (`CI=true`). The fewer are the
/// first of all.
pub fn draws<T>(all: T, in_ci: T) -> T {
    if std::env::var("CI").is_ok_and(|ci| ci == "true") { in_ci } else { all }
}
