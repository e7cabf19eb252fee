//! Real-time pacing of samples.
//!
//! A run with a device at the other end of a wire follows the clock: sample k leaves at the start of
//! the run plus k periods. This crate has the parts of that, and doesn't depend on samples:
//!
//! | module | |
//! |---|---|
//! | [`clock`] | host time as a type of its own, and sleep until an absolute deadline |
//! | [`pace`] | the frame clock: waits for a deadline and measures the lateness |
//! | [`lateness`] | the histogram of the lateness |
//! | [`host_clocks`] | the realtime clock against the monotonic one |
//! | [`hardware_clock`] | clocks of network cards that PTP sets |
//! | [`pps`] | pulses that the kernel stamps |
//! | [`kernel_clock`] | state of the kernel's realtime clock |
//! | [`schedule`] | real-time scheduling and locked memory, as far as the host permits them |
//! | [`latency`] | wake-up latency of this host |
//! | [`host`] | properties of a host that matter for all this, and advice |
//!
//! The frame clock is a monitor and not a scheduler: it doesn't call anything, and the time in a sample
//! is the sample's number times the period, whatever the clock shows. So a run gives the same results
//! paced or as fast as possible.
//!
//! Linux supports all of it. On other systems a thread sleeps and its lateness is measured; missing
//! functions are reported as not granted.

pub mod clock;
pub mod hardware_clock;
pub mod host;
pub mod host_clocks;
pub mod kernel_clock;
pub mod latency;
pub mod lateness;
pub mod pace;
pub mod pps;
pub mod schedule;
pub mod series;
