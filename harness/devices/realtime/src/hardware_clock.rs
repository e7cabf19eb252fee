//! Clocks of network cards that PTP sets (`/dev/ptp0`).
//!
//! The program that speaks PTP keeps such a clock at TAI, unless it is told otherwise. Only this program
//! knows how far it is off: the kernel doesn't.

use crate::host_clocks::HostClocks;
use std::fs::File;
use std::path::{Path, PathBuf};

/// The clock can't be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {reason}", path.display())]
pub struct HardwareClockError {
    /// Device of the clock.
    pub path: PathBuf,
    /// Reason.
    pub reason: String,
}

/// An open clock.
#[derive(Debug)]
pub struct HardwareClock {
    path: PathBuf,
    // Only Linux has such clocks.
    #[cfg_attr(not(target_os = "linux"), expect(dead_code, reason = "never opened"))]
    device: File,
}

impl HardwareClock {
    /// Opens a clock and reads it once.
    ///
    /// # Errors
    /// If there is no such device, or it is no clock.
    pub fn open(path: &Path) -> Result<Self, HardwareClockError> {
        let reason = |error: std::io::Error| error.to_string();
        let of_path = |reason| HardwareClockError { path: path.to_owned(), reason };
        let device = File::open(path).map_err(|error| of_path(reason(error)))?;
        let clock = Self { path: path.to_owned(), device };
        clock.read()?;
        Ok(clock)
    }

    /// Reads the clock between two readings of the monotonic one. [`HostClocks::other_ns`] is its time,
    /// of the scale that the program keeps it at.
    ///
    /// # Errors
    /// If the device doesn't answer any more.
    pub fn read(&self) -> Result<HostClocks, HardwareClockError> {
        HostClocks::read_with(|| self.time_ns())
    }

    #[cfg(target_os = "linux")]
    fn time_ns(&self) -> Result<i128, HardwareClockError> {
        use rustix::time::{DynamicClockId, clock_gettime_dynamic};
        use std::os::fd::AsFd;
        let time = clock_gettime_dynamic(DynamicClockId::Dynamic(self.device.as_fd()));
        let time = time.map_err(|error| HardwareClockError {
            path: self.path.clone(),
            reason: format!("found no clock, expected one of PTP, such as /dev/ptp0: {error}"),
        })?;
        Ok(i128::from(time.tv_sec) * 1_000_000_000 + i128::from(time.tv_nsec))
    }

    #[cfg(not(target_os = "linux"))]
    fn time_ns(&self) -> Result<i128, HardwareClockError> {
        let reason = "Octant reads hardware clocks on Linux alone".to_owned();
        Err(HardwareClockError { path: self.path.clone(), reason })
    }
}
