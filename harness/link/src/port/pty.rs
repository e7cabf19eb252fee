//! Pseudo terminals: a serial line without hardware, for a device that is a program.

use super::{Bytes, PortError};
use std::time::Duration;

/// The near end of a pseudo terminal; the far end is opened by its name like a serial port.
#[derive(Debug)]
pub struct Pty {
    #[cfg(unix)]
    inner: unix::Pair,
}

#[cfg(unix)]
mod unix {
    use super::PortError;
    use serialport::{SerialPort, TTYPort};
    use std::path::PathBuf;

    #[derive(Debug)]
    pub(super) struct Pair {
        pub(super) near: TTYPort,
        /// Held open: a near end whose far end was closed by its last user reads errors.
        _far: TTYPort,
        pub(super) name: String,
        /// Removed in the end.
        link: Option<PathBuf>,
    }

    impl Pair {
        pub(super) fn open(link: &str) -> Result<Self, PortError> {
            let refused = |reason: String| PortError::open(format!("pty:{link}"), reason);
            // The far end takes no lock as it comes from here: its user's open will.
            let (near, far) = TTYPort::pair().map_err(|error| refused(error.to_string()))?;
            let name = far.name().ok_or_else(|| refused("it has no name".to_owned()))?;
            let link = match link {
                "" => None,
                link => {
                    make(&name, link).map_err(|error| refused(error.to_string()))?;
                    Some(PathBuf::from(link))
                }
            };
            Ok(Self { near, _far: far, name, link })
        }
    }

    /// Makes a link, also over one that a device left behind.
    fn make(name: &str, link: &str) -> std::io::Result<()> {
        let stale = std::fs::symlink_metadata(link).is_ok_and(|about| {
            about.file_type().is_symlink() && !std::fs::exists(link).unwrap_or(true)
        });
        if stale {
            std::fs::remove_file(link)?;
        }
        std::os::unix::fs::symlink(name, link)
    }

    impl Drop for Pair {
        fn drop(&mut self) {
            if let Some(link) = &self.link {
                // It may be gone already.
                let _ = std::fs::remove_file(link);
            }
        }
    }
}

impl Pty {
    /// Makes one; with a link to its far end, unless that is empty.
    ///
    /// # Errors
    /// If there are none on this system, none is free, or the link can't be made.
    #[cfg(unix)]
    pub fn open(link: &str) -> Result<Self, PortError> {
        Ok(Self { inner: unix::Pair::open(link)? })
    }

    /// Makes one.
    ///
    /// # Errors
    /// Always: there are none on this system.
    #[cfg(not(unix))]
    pub fn open(link: &str) -> Result<Self, PortError> {
        Err(PortError::open(format!("pty:{link}"), "there are no pseudo terminals on this system"))
    }

    /// Name of the far end.
    #[must_use]
    pub fn name(&self) -> &str {
        #[cfg(unix)]
        return &self.inner.name;
        #[cfg(not(unix))]
        return "";
    }
}

#[cfg(unix)]
impl Bytes for Pty {
    fn send(&mut self, bytes: &[u8], wait: Duration) -> Result<bool, PortError> {
        super::serial::write(&mut self.inner.near, &self.inner.name, bytes, wait)
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        super::serial::read(&mut self.inner.near, &self.inner.name, buffer, wait)
    }

    fn datagrams(&self) -> bool {
        false
    }

    fn reached_at(&self) -> String {
        format!("serial:{}", self.inner.name)
    }

    fn hold_peer(&mut self, _: bool) {}
}

#[cfg(not(unix))]
impl Bytes for Pty {
    fn send(&mut self, _: &[u8], _: Duration) -> Result<bool, PortError> {
        Err(PortError::gone("pty:", "there are no pseudo terminals on this system"))
    }

    fn receive(&mut self, _: &mut [u8], _: Duration) -> Result<usize, PortError> {
        Err(PortError::gone("pty:", "there are no pseudo terminals on this system"))
    }

    fn datagrams(&self) -> bool {
        false
    }

    fn reached_at(&self) -> String {
        String::new()
    }

    fn hold_peer(&mut self, _: bool) {}
}
