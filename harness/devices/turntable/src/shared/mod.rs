//! One table under several units: a run drives it, others on the same host get its angles.
//!
//! The run that drives the table takes the others on at its stop button's socket ([`Button`](crate::Button)). It waits
//! at zero until all of them are there, tells them to begin, and then tells every look and the set point. A guest
//! commands nothing: it gives its samples the angles that it is told, and ends its run if its own core wants another
//! set point, if the table was stopped, or if the driving run is gone. Times cross between the processes as the host's
//! monotonic time, which they share.

mod ends;
#[cfg(target_os = "linux")]
mod guest;
#[cfg(unix)]
mod host;
#[cfg(target_os = "linux")]
mod monotonic;
#[cfg(all(unix, not(target_os = "linux")))]
#[path = "no_monotonic.rs"]
mod monotonic;
#[cfg(not(target_os = "linux"))]
mod no_guest;
#[cfg(not(unix))]
mod no_host;
#[cfg(unix)]
mod words;

pub use ends::GuestEnd;
#[cfg(target_os = "linux")]
pub use guest::TableGuest;
#[cfg(unix)]
pub use host::TableHost;
#[cfg(not(target_os = "linux"))]
pub use no_guest::NoTableGuest as TableGuest;
#[cfg(not(unix))]
pub use no_host::NoTableHost as TableHost;
