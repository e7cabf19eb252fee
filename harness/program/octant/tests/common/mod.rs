//! Parts that the tests share.

pub mod allocations;
#[cfg(target_os = "linux")]
pub mod attended;
pub mod epochs;
pub mod foreign;
pub mod program;
pub mod readers;
pub mod results;
#[cfg(target_os = "linux")]
pub mod running;
#[cfg(unix)]
pub mod table;
