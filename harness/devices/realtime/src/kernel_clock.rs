//! State of the kernel's realtime clock: who keeps it, and how well.

use std::time::Duration;

/// State of the realtime clock, as the kernel keeps it for the program that sets it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KernelClock {
    /// True if a program keeps the clock set.
    pub is_synchronised: bool,
    /// Bound of its error. It grows while no program sets the clock.
    pub error_most: Duration,
    /// Seconds by which TAI is ahead of UTC; 0: nobody told the kernel.
    pub tai_offset_s: u32,
}

impl KernelClock {
    /// Asks the kernel.
    ///
    /// # Errors
    /// If it doesn't answer, as on other systems than Linux.
    #[cfg(target_os = "linux")]
    #[allow(unsafe_code, reason = "a function of C is called")]
    pub fn read() -> std::io::Result<Self> {
        // SAFETY: all fields are numbers. Zero modes set nothing.
        let mut state: libc::timex = unsafe { std::mem::zeroed() };
        // SAFETY: the pointer is valid during the call, which keeps none.
        let found = unsafe { libc::adjtimex(&raw mut state) };
        if found < 0 {
            return Err(std::io::Error::last_os_error());
        }
        let is_synchronised = found != libc::TIME_ERROR && state.status & libc::STA_UNSYNC == 0;
        let error_most = Duration::from_micros(u64::try_from(state.maxerror).unwrap_or(u64::MAX));
        Ok(Self {
            is_synchronised,
            error_most,
            tai_offset_s: u32::try_from(state.tai).unwrap_or_default(),
        })
    }

    /// Says that the system can't be asked.
    ///
    /// # Errors
    /// Always.
    #[cfg(not(target_os = "linux"))]
    pub fn read() -> std::io::Result<Self> {
        let reason = "Octant asks the kernel of Linux alone";
        Err(std::io::Error::new(std::io::ErrorKind::Unsupported, reason))
    }
}
