//! Octant: the harness around the calibration core.
//!
//! A sample flows one way, and the modules are named for its stations:
//! **source → endpoint → recorder → score → report**.

pub mod calibrate;
pub mod campaign;
pub mod cli;
pub mod endpoint;
pub mod evidence;
pub mod fmu;
pub mod nightly;
pub mod observe;
pub mod report;
pub mod run;
pub mod selftest;
pub mod source;
pub mod watch;
