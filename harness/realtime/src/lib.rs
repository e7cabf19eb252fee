//! Samples at their time.
//!
//! A run with a device at the other end of a wire goes by the clock: sample k leaves at the start
//! of the run plus k periods. This crate has the parts of that, and knows nothing of samples:
//!
//! | module | |
//! |---|---|
//! | [`clock`] | host time as a type of its own, and sleep until an absolute deadline |
//! | [`pace`] | the frame clock: waits for a deadline and tells how late it was |
//! | [`lateness`] | the histogram of that |
//! | [`schedule`] | real-time scheduling and locked memory, as far as the host permits them |
//! | [`latency`] | how late this host wakes a thread that sleeps |
//! | [`host`] | what of a host matters for all this, and what to change |
//!
//! The frame clock is a monitor and not a scheduler: it doesn't call anything, and the time in a
//! sample is the sample's number times the period, whatever the clock says. The same run goes
//! paced or as fast as it can, and computes the same.
//!
//! Linux has all of it. On other systems a thread sleeps and its lateness is measured; what isn't
//! there is told as not granted.

pub mod clock;
pub mod host;
pub mod latency;
pub mod lateness;
pub mod pace;
pub mod schedule;
