//! Positions over time, as other instruments and programs write them.
//!
//! | module | idea |
//! |---|---|
//! | [`point`] | a position with velocity and attitude at a time, or a heading alone, and the scale of that time |
//! | [`reader`] | files: columns of text, NMEA 0183 with positions or headings alone, RTKLIB, SBET, messages of units |
//! | [`survey`] | what a file holds, from one pass through it |
//! | [`track`] | a reference trajectory at any time |
//! | [`pairs`] | the points of a solution, each with its reference |
//! | [`comparison`] | what both show besides the errors: likeness, bands by the reference's own σ |
//!
//! Nothing here is scored: a source and an endpoint of the harness give the points of two files to the run.

#[cfg(test)]
mod account_tests;
mod bands;
mod columns;
pub mod comparison;
mod gaps;
#[cfg(test)]
mod heading_tests;
mod likeness;
mod messages;
mod nmea;
pub mod pairs;
mod pairs_error;
pub mod point;
pub mod reader;
mod rtklib;
#[cfg(test)]
mod run_up_tests;
mod run_ups;
mod sbet;
pub mod survey;
mod tally;
#[cfg(test)]
mod tests;
pub mod track;

pub use bands::StatedBand;
pub use comparison::Comparison;
pub use likeness::{Differences, Likeness};
pub use nmea::tag_time_ns;
pub use pairs::{PairsError, SolutionPair, SolutionPairs};
pub use point::{TimeScale, TrajectoryPoint};
pub use reader::{TrajectoryError, TrajectoryReader};
pub use survey::TrajectorySurvey;
pub use track::ReferenceTrack;
