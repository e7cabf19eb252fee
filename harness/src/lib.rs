//! Octant: the harness around the calibration core.
//!
//! A sample flows one way, and the modules are named for its stations:
//! **source → faults → endpoint → recorder → score → report**.

pub mod source;
pub mod endpoint;
pub mod scenario;
