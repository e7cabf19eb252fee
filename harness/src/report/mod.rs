//! What a person reads: one HTML file without network, and the comparison of two methods.
//!
//! - [`run`] makes `report.html` of one run
//! - [`compare`] makes `compare.html` and the plain text of `octant compare`
//! - [`campaign`] makes `report.html` of a campaign
//! - [`fault_picture`] draws what a fault does
//! - [`chart`] draws lines as inline SVG that follows the colours of the page

mod calibration;
pub mod campaign;
pub mod chart;
pub mod compare;
pub mod counterfactual;
mod discrepancies;
mod drift;
pub mod fault_picture;
mod pacing;
pub(crate) mod page;
mod parameters;
pub mod run;
pub mod sweep;

pub use run::{GimbalPoint, HealthEvent, NisPoint, ParameterPoint, Provenance, ReportData};
