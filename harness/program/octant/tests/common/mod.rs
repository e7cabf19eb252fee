//! Parts that the tests share.

pub mod allocations;
#[cfg(target_os = "linux")]
pub mod attended;
#[path = "../../../../results/recorder/tests/common/epochs.rs"]
pub mod epochs;
pub mod foreign;
#[path = "../../../../results/watch/tests/known.rs"]
pub mod known;
pub mod program;
pub mod readers;
pub mod results;
#[cfg(target_os = "linux")]
pub mod running;
#[cfg(feature = "dashboard")]
#[path = "../../../../results/watch/tests/screen.rs"]
pub mod screen;
#[path = "../../../../results/recorder/tests/common/stream.rs"]
pub mod stream;
#[cfg(unix)]
pub mod table;
