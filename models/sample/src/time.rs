//! Clocks. Device time is the instrument's own; simulated and host time never enter a computation
//! of the core, and the types prevent mixing them up.

/// Time of the instrument's clock, integer nanoseconds since its first interval began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DeviceTime {
    /// Nanoseconds since the start of the first interval.
    pub ns: u64,
}

/// Time of the simulated world, integer nanoseconds since the start of the run.
///
/// Equal to [`DeviceTime`] only while the device's clock has no error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SimulatedTime {
    /// Nanoseconds since the start of the run.
    pub ns: u64,
}

/// Time of the computer that runs the harness, integer nanoseconds of its monotonic clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HostTime {
    /// Nanoseconds of a monotonic clock with an arbitrary start.
    pub ns: u64,
}

macro_rules! seconds {
    ($($clock:ty),*) => {$(
        impl $clock {
            /// Makes a time from nanoseconds.
            #[must_use]
            pub const fn from_ns(ns: u64) -> Self {
                Self { ns }
            }

            /// Seconds as f64: exact to a nanosecond for the first 104 days.
            #[must_use]
            pub fn seconds(self) -> f64 {
                self.ns as f64 * 1e-9
            }
        }
    )*};
}
seconds!(DeviceTime, SimulatedTime, HostTime);
