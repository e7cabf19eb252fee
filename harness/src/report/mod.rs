//! What a person reads: one HTML file without network, and the comparison of two methods.
//!
//! - [`run`]: `report.html` of one run
//! - [`compare`]: `compare.html` and the plain text of `octant compare`
//! - [`chart`]: line charts as inline SVG that follow the colours of the page
//! - [`number`]: numbers as people read them

pub mod chart;
pub mod compare;
pub mod number;
mod page;
mod parameters;
pub mod run;

pub use run::{GimbalPoint, HealthEvent, NisPoint, ParameterPoint, Provenance, ReportData};
