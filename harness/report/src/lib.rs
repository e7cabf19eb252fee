//! Pages for the user: one HTML file without network access, and the comparison of two methods.
//!
//! - [`run`] renders `report.html` of one run
//! - [`compare`] renders `compare.html` and the plain text of `octant compare`
//! - [`chart`] draws lines as inline SVG in the colours of the page

mod calibration;
pub mod chart;
pub mod compare;
pub mod counterfactual;
mod data;
pub mod discrepancies;
mod drift;
mod pacing;
pub mod page;
mod parameters;
pub mod run;
mod scores;

pub use run::{GimbalPoint, HealthEvent, NisPoint, ParameterPoint, Provenance, ReportData};
