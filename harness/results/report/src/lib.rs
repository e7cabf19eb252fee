//! Pages for the user: one HTML file without network access, and the comparison of two methods.
//!
//! - [`run`] renders `report.html` of one run
//! - [`compare`] renders `compare.html` and the plain text of `octant compare`
//! - [`chart`] draws lines as inline SVG in the colours of the page; `script/` draws them again for the
//!   reader's width and range, with one cursor for all of them
//! - [`fault_picture`] draws what a kind of fault does to a run, as one SVG
//! - [`certificate`] is the first page of a heading test, of a run or a campaign
//! - [`page`] is the frame of every page: style, script, contents
//! - [`filtered`], [`innovations`] and [`marks`] have what the page of a run derives for its plots: scales,
//!   statistics, moves and stops

mod allan;
mod calibration;
pub mod certificate;
pub mod chart;
pub mod compare;
mod convergence;
mod correlation;
pub mod counterfactual;
mod data;
pub mod discrepancies;
mod drift;
pub mod fault_picture;
pub mod filtered;
mod followed;
mod gimbals;
mod heading;
mod heading_output;
pub mod innovations;
pub mod inputs;
pub mod marks;
mod pacing;
pub mod page;
mod parameters;
mod requirements;
pub mod run;
mod scores;
mod solution;
pub mod units;

pub use octant_score::points::{GimbalPoint, HealthEvent, NisPoint, ParameterPoint};
pub use octant_score::run_series::SolutionSeries;
pub use run::{ReportData, ReportProvenance, StopLabel};
